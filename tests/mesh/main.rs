//! Mesh files: reading and refusals.

use octagloss_core::common::error::Error;
use octagloss_fixtures::files::gltf::{data_uri, triangle};
use octagloss_mesh::{Material, Mesh, Texture, Wrap};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

const CUBE: &str = "\
v 1 1 1\nv 3 1 1\nv 3 3 1\nv 1 3 1\nv 1 1 3\nv 3 1 3\nv 3 3 3\nv 1 3 3
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
";

fn read(name: &str, bytes: &[u8]) -> Result<Mesh, Error> {
    Mesh::read_from_memory(Path::new(name), bytes)
}

#[test]
fn a_cube_is_centred_and_scaled_and_gets_the_normals_of_its_faces() {
    let mesh = read("cube.obj", CUBE.as_bytes()).expect("a mesh");
    assert_eq!(mesh.indices.len(), 36, "two triangles per face");
    let corner = 1.0 / 3.0_f32.sqrt();
    for vertex in &mesh.vertices {
        assert!(vertex.position.iter().all(|c| (c.abs() - corner).abs() < 1e-6), "{vertex:?}");
        // The normal points to the face that the vertex is on.
        let along: f32 = vertex.position.iter().zip(vertex.normal).map(|(p, n)| p * n).sum();
        assert!((along - corner).abs() < 1e-6, "{vertex:?}");
    }
}

/// Positions of the corners of [`triangle`].
const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// Returns a buffer with `positions`, then the indices 0, 1 and 2 in 16 bits.
fn buffer(positions: &[f32]) -> Vec<u8> {
    let mut bytes: Vec<u8> = positions.iter().flat_map(|p| p.to_le_bytes()).collect();
    bytes.extend([0, 0, 1, 0, 2, 0]);
    bytes
}

/// Returns `json` as a .glb file with its buffer as the binary chunk.
fn glb(json: &Value, bytes: &[u8]) -> Vec<u8> {
    let mut json = json.clone();
    json["buffers"][0].as_object_mut().expect("a buffer").remove("uri");
    let pad = |mut chunk: Vec<u8>, with: u8| {
        while !chunk.len().is_multiple_of(4) {
            chunk.push(with);
        }
        chunk
    };
    let (json, bytes) = (pad(json.to_string().into_bytes(), b' '), pad(bytes.to_vec(), 0));
    let mut file = b"glTF".to_vec();
    file.extend(2_u32.to_le_bytes());
    file.extend((28 + json.len() as u32 + bytes.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", bytes)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// Returns [`triangle`] with the value at `pointer` replaced.
fn changed(pointer: &str, value: Value) -> Value {
    let mut json = triangle(&buffer(&CORNERS));
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    match json.pointer_mut(parent).expect("its parent") {
        Value::Array(array) => array[key.parse::<usize>().expect("an index")] = value,
        parent => parent[key] = value,
    }
    json
}

#[test]
fn a_gltf_is_read_where_its_nodes_put_it() {
    let json = triangle(&buffer(&CORNERS));
    let files = [("one.gltf", json.to_string().into_bytes()), ("one.glb", glb(&json, &buffer(&CORNERS)))];
    for (name, bytes) in files {
        let mesh = read(name, &bytes).expect("a mesh");
        assert_eq!(mesh.indices, [0, 1, 2]);
        let [a, b, c] = [0, 1, 2].map(|k| glam::Vec3::from_array(mesh.vertices[k].position));
        // Twice as wide as high, independent of the scale.
        assert!((a.distance(b) / a.distance(c) - 2.0).abs() < 1e-5, "{a} {b} {c}");
        assert!(mesh.vertices.iter().all(|vertex| vertex.normal == [0.0, 0.0, 1.0]));
    }
    // A reflection keeps normals on the outer side.
    let mirrored = changed("/nodes/0/scale", json!([-2, 1, 1])).to_string();
    let mesh = read("mirrored.gltf", mirrored.as_bytes()).expect("a mesh");
    assert!(mesh.vertices.iter().all(|vertex| vertex.normal == [0.0, 0.0, 1.0]));
}

#[test]
fn materials_are_read_from_the_file() {
    let mut json = triangle(&buffer(&CORNERS));
    json["materials"] = json!([
        {"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.25, 1], "metallicFactor": 0.5,
            "roughnessFactor": 0.125, "baseColorTexture": {"index": 0}}, "alphaMode": "MASK"},
    ]);
    json["textures"] = json!([{"source": 0, "sampler": 0}]);
    json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_pixel(2, 1, image::Rgba([10, 20, 30, 40]))
        .write_to(&mut png, image::ImageFormat::Png)
        .expect("a picture");
    json["images"] = json!([{"uri": data_uri(png.get_ref())}]);
    // Two primitives, one with a material and one without.
    let attributes = json!({"POSITION": 0, "TEXCOORD_0": 2});
    json["accessors"]
        .as_array_mut()
        .expect("accessors")
        .push(json!({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"}));
    json["meshes"][0]["primitives"] = json!([
        {"attributes": attributes, "indices": 1, "material": 0},
        {"attributes": {"POSITION": 0}, "indices": 1},
    ]);
    let mesh = read("m.gltf", json.to_string().as_bytes()).expect("a mesh");
    let texture = Texture { image: 0, wrap: [Wrap::Clamp, Wrap::Mirror], nearest: true };
    let first = Material {
        base: [1.0, 0.5, 0.25, 1.0],
        metallic: 0.5,
        roughness: 0.125,
        cutoff: Some(0.5),
        base_texture: Some(texture),
        ..Material::default()
    };
    assert_eq!(mesh.materials, [first.clone(), Material::default()]);
    assert_eq!((mesh.images[0].width, &mesh.images[0].texels), (2, &vec![[10, 20, 30, 40]; 2]));
    let parts: Vec<_> = mesh.parts.iter().map(|part| (part.indices.clone(), part.material)).collect();
    assert_eq!(parts, [(0..3, Some(0)), (3..6, Some(1))]);
    assert_eq!(mesh.vertices[1].uv, [0.0, 1.0]);
    let finish = |extensions: Value| {
        let mut json = json.clone();
        json["materials"][0]["extensions"] = extensions;
        read("m.gltf", json.to_string().as_bytes()).map(|mesh| mesh.materials[0].clone())
    };
    let brushed = finish(json!({
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.75, "anisotropyRotation": 1.5},
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25},
    }));
    let own =
        Material { anisotropy: 0.75, direction: 1.5, clearcoat: 0.5, coat_roughness: 0.25, ..first.clone() };
    assert_eq!(brushed.expect("a mesh"), own);
    for (extensions, words) in [
        (json!({"KHR_materials_anisotropy": {"anisotropyStrength": 1.5}}), "anisotropyStrength 1.5"),
        (json!({"KHR_materials_clearcoat": {"clearcoatFactor": -1}}), "clearcoatFactor -1"),
    ] {
        let error = finish(extensions).expect_err("out of range").to_string();
        assert!(error.contains(words), "{error}");
    }
    json["materials"][0]["emissiveFactor"] = json!([0.5, 0.25, 0.0]);
    json["materials"][0]["emissiveTexture"] = json!({"index": 0});
    let lit = read("m.gltf", json.to_string().as_bytes()).expect("a mesh");
    let shining = Material { emission: [0.5, 0.25, 0.0], emission_texture: Some(texture), ..first };
    assert_eq!(lit.materials, [shining, Material::default()]);
    json["materials"][0]["emissiveFactor"] = json!([0.5, -0.25, 0.0]);
    let error = read("m.gltf", json.to_string().as_bytes()).expect_err("dark").to_string();
    assert!(error.contains("emissiveFactor -0.25"), "{error}");
    json["materials"][0]["emissiveFactor"] = json!([0.5, 0.25, 0.0]);
    let strength = |json: &Value, strength: Value| {
        let mut json = json.clone();
        json["extensionsRequired"] = json!(["KHR_materials_emissive_strength"]);
        json["extensionsUsed"] = json["extensionsRequired"].clone();
        json["materials"][0]["extensions"] = json!({"KHR_materials_emissive_strength": strength});
        read("m.gltf", json.to_string().as_bytes()).map(|mesh| mesh.materials[0].emission)
    };
    for (given, emission) in [
        (json!({"emissiveStrength": 6}), [3.0, 1.5, 0.0]),
        (json!({"emissiveStrength": 0}), [0.0; 3]),
        (json!({}), [0.5, 0.25, 0.0]),
    ] {
        assert_eq!(strength(&json, given).expect("a mesh"), emission);
    }
    for (given, words) in
        [(-2.0, "emissiveStrength -2 is negative or not finite"), (1e39, "number out of range")]
    {
        let error = strength(&json, json!({"emissiveStrength": given})).expect_err("strength").to_string();
        assert!(error.contains(words) && error.starts_with("m.gltf"), "{error}");
    }
    json["materials"][0]["emissiveFactor"] = json!([1e30, 0, 0]);
    let error = strength(&json, json!({"emissiveStrength": 1e30})).expect_err("both").to_string();
    assert!(error.contains("emissiveFactor times emissiveStrength inf"), "{error}");
    json["materials"][0].as_object_mut().expect("a material").remove("emissiveFactor");
    // A material out of range, a texture without coordinates.
    json["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = json!(1.5);
    let error = read("m.gltf", json.to_string().as_bytes()).expect_err("rough").to_string();
    assert!(error.contains("roughnessFactor 1.5 is outside [0, 1]"), "{error}");
    json["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0});
    let error = read("m.gltf", json.to_string().as_bytes()).expect_err("no coordinates").to_string();
    assert!(error.contains("TEXCOORD_0"), "{error}");
}

#[test]
fn sparse_elements_strips_and_fans_are_read() {
    // The second corner is replaced by the first of the buffer's numbers.
    let sparse = json!({"count": 1,
        "indices": {"bufferView": 1, "byteOffset": 2, "componentType": 5123},
        "values": {"bufferView": 0, "byteOffset": 24}});
    let mut json = changed("/accessors/0/sparse", sparse);
    json["nodes"][0] = json!({"mesh": 0});
    json["accessors"][0].as_object_mut().expect("an accessor").remove("bufferView");
    json["accessors"][0]["count"] = json!(3);
    // All zeros except (0, 1, 0): no area, but an extent.
    let mesh = read("s.gltf", json.to_string().as_bytes()).expect("a mesh");
    let heights: Vec<f32> = mesh.vertices.iter().map(|vertex| vertex.position[1]).collect();
    assert_eq!(heights, [-1.0, 1.0, -1.0]);
    for (mode, expected) in [(5, [0, 1, 2]), (6, [1, 2, 0])] {
        let json = changed("/meshes/0/primitives/0/mode", json!(mode));
        let mesh = read("s.gltf", json.to_string().as_bytes()).expect("a mesh");
        let first = |k: usize| mesh.vertices[mesh.indices[k] as usize].position;
        let plain = read("t.gltf", triangle(&buffer(&CORNERS)).to_string().as_bytes()).expect("a mesh");
        for (k, corner) in expected.into_iter().enumerate() {
            assert_eq!(first(k), plain.vertices[corner].position, "mode {mode}");
        }
    }
}

#[test]
fn faults_of_gltf_are_named_with_their_values() {
    let sparse = json!({"componentType": 5126, "count": 3_000_000_000_u64, "type": "VEC3",
        "min": [0, 0, 0], "max": [1, 1, 1],
        "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123},
            "values": {"bufferView": 0}}});
    let own_node = |children: Value| json!([{"mesh": 0, "children": children}, {"children": [0]}]);
    let far = json!({"mesh": 0, "translation": [3e38, 0, 0], "scale": [3e38, 1, 1]});
    let nothing = json!({"attributes": {"POSITION": 0}, "mode": 1});
    let wild = |value: u8| {
        let mut bytes = buffer(&CORNERS);
        bytes[40] = value;
        triangle(&bytes)
    };
    let cases: Vec<(Value, &str)> = vec![
        (changed("/nodes", own_node(json!([1]))), "node 0 is reached twice"),
        (changed("/nodes", own_node(json!([0]))), "node 0 is reached twice"),
        (changed("/scenes/0/nodes", json!([0, 0])), "node 0 is reached twice"),
        (changed("/nodes/0/rotation", json!([0, 0, 0, 0])), "node 0: rotation"),
        (changed("/nodes/0", far), "is out of range"),
        (changed("/nodes/0/translation", json!([1e39, 0, 0])), "number out of range"),
        (changed("/nodes/0/mesh", json!(7)), "Index out of bounds"),
        (changed("/accessors/1/componentType", json!(5126)), "accessor 1: indices of Scalar FLOAT (5126)"),
        (changed("/accessors/1/componentType", json!(5120)), "accessor 1: indices of Scalar BYTE (5120)"),
        (changed("/accessors/1/componentType", json!(1)), "componentType"),
        (changed("/accessors/1/type", json!("VEC2")), "accessor 1: indices of Vec2"),
        (changed("/accessors/0/componentType", json!(5123)), "accessor 0: Vec3 of UNSIGNED_SHORT (5123)"),
        (changed("/bufferViews/0/byteStride", json!(4)), "byteStride 4 is less than the 12 bytes"),
        (changed("/accessors/0", sparse), "accessor 0: 3000000000 elements"),
        (changed("/accessors/1/count", json!(u64::MAX)), "accessor 1: 18446744073709551615 elements"),
        (changed("/accessors/0/count", json!(4)), "4 elements of 12 bytes"),
        (changed("/accessors/1/byteOffset", json!(2)), "3 elements of 2 bytes"),
        (changed("/accessors/1/byteOffset", json!(u64::MAX)), "exceed bufferView 1"),
        (changed("/bufferViews/0/byteLength", json!(99)), "99 bytes at 0 exceed buffer 0 of 42 bytes"),
        (changed("/bufferViews/1/byteOffset", json!(u64::MAX)), "exceed buffer 0"),
        (changed("/buffers/0/byteLength", json!(43)), "buffer 0 has 43 bytes"),
        (changed("/buffers/0/uri", json!("data:;base64,%%%")), "not base64"),
        (changed("/buffers/0/uri", json!("data:nothing")), "without a comma"),
        (changed("/buffers/0/uri", json!("http://x/y.bin")), "\"http://x/y.bin\""),
        (changed("/buffers/0/uri", json!("file:///etc/passwd")), "\"file:///etc/passwd\""),
        (changed("/buffers/0/uri", json!("beside.bin")), "a file in memory"),
        (wild(9), "index 9 at position 2 is out of range for 3 vertices"),
        (changed("/meshes/0/primitives/0", nothing), "no triangles"),
        (changed("/accessors/1/count", json!(2)), "2 indices do not form whole triangles"),
        (changed("/meshes", json!([{"primitives": [{"attributes": {"POSITION": 99}}]}])), "wide.gltf"),
        (changed("/scenes", json!([])), "wide.gltf"),
    ];
    for (json, words) in cases {
        let error = read("wide.gltf", json.to_string().as_bytes()).expect_err(words).to_string();
        assert!(error.starts_with("wide.gltf") && !error.contains('\n'), "{error}");
        assert!(error.contains(words), "{words}: {error}");
    }
    let mut nan = CORNERS;
    nan[4] = f32::NAN;
    let error = read("n.gltf", triangle(&buffer(&nan)).to_string().as_bytes()).expect_err("NaN").to_string();
    assert!(error.contains("accessor 0, element 1: NaN"), "{error}");
}

#[test]
fn lines_and_points_next_to_faces_are_ignored() {
    let mesh = read("both.obj", format!("l 1 2 3\n{CUBE} l 1 2\np 4\nl 1 2 3 4").as_bytes()).expect("a mesh");
    assert_eq!(mesh, read("cube.obj", CUBE.as_bytes()).expect("a mesh"));
}

#[test]
fn long_chains_of_nodes_end() {
    let nodes: Vec<Value> =
        (1..100_000).map(|next| json!({"children": [next]})).chain([json!({"mesh": 0})]).collect();
    let error = read("deep.gltf", changed("/nodes", json!(nodes)).to_string().as_bytes());
    assert!(error.expect_err("too deep").to_string().contains("nested more than 1000 levels deep"));
}

#[test]
fn what_is_no_mesh_is_refused_by_name() {
    let whole = glb(&triangle(&buffer(&CORNERS)), &buffer(&CORNERS));
    let cases: [(&str, Vec<u8>, &str); 13] = [
        ("nothing.obj", Vec::new(), "no triangles"),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n".to_vec(), "no triangles"),
        ("lines.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\np 1\n".to_vec(), "export surfaces"),
        ("wild.obj", b"v 0 0 0\nf 1 2 900\n".to_vec(), "bounds"),
        ("nan.obj", b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(), "NaN in a `v` line"),
        ("inf.obj", b"v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(), "inf in a `v` line"),
        (
            "normal.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn nan 0 1\nf 1//1 2//1 3//1\n".to_vec(),
            "NaN in a `vn` line",
        ),
        ("text.glb", b"these are no triangles".to_vec(), "text.glb"),
        ("short.glb", whole[..60].to_vec(), "short.glb"),
        ("tiny.glb", b"glTF\x02\0\0\0\0\0\0\0".to_vec(), "tiny.glb"),
        ("flat.glb", glb(&triangle(&buffer(&[0.0; 9])), &buffer(&[0.0; 9])), "no extent"),
        ("empty.gltf", Vec::new(), "empty.gltf"),
        ("mesh.stl", CUBE.as_bytes().to_vec(), "unknown mesh format"),
    ];
    for (name, bytes, words) in cases {
        let error = read(name, &bytes).expect_err(name).to_string();
        assert!(error.starts_with(name) && !error.contains('\n') && error.contains(words), "{name}: {error}");
    }
    assert!(matches!(Mesh::read(Path::new("there/is/none.obj")), Err(Error::Io { .. })));
}

/// Writes `json` with its buffer at `uri` into `folder`; returns the path.
fn with_uri(folder: &Path, uri: &str) -> std::path::PathBuf {
    let path = folder.join("mesh.gltf");
    fs::write(&path, changed("/buffers/0/uri", json!(uri)).to_string()).expect("a file");
    path
}

#[test]
fn other_files_are_read_below_the_mesh_s_folder_only() {
    let outside = tempfile::tempdir().expect("a folder");
    let inside = outside.path().join("inside");
    fs::create_dir_all(inside.join("a part")).expect("folders");
    for place in ["inside/b.bin", "inside/a part/b.bin", "b.bin"] {
        fs::write(outside.path().join(place), buffer(&CORNERS)).expect("a file");
    }
    for uri in ["b.bin", "./b.bin", "a%20part/b.bin", "a part/../b.bin"] {
        Mesh::read(&with_uri(&inside, uri)).unwrap_or_else(|error| panic!("{uri}: {error}"));
    }
    let refused = |uri: &str, words: &str| {
        let error = Mesh::read(&with_uri(&inside, uri)).expect_err(uri).to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{uri}: {error}");
    };
    refused("../b.bin", "`mesh_root`");
    refused("a%20part/../../b.bin", "`mesh_root`");
    refused("%2e%2e/b.bin", "`mesh_root`");
    refused("../../../../../../../../etc/passwd", "`mesh_root`");
    refused("/dev/zero", "an absolute path");
    refused("none.bin", "none.bin");
    // An impossibly long name is not echoed in full.
    for long in [format!("{}.bin", "x".repeat(100_000)), "x/".repeat(50_000)] {
        refused(&long, "bytes): ");
        let error = Mesh::read(&with_uri(&inside, &long)).expect_err("no such file").to_string();
        assert!(error.len() < inside.as_os_str().len() + 300, "{} bytes", error.len());
    }
    refused("a part", "a directory where a file is needed");
    refused("b.bin\u{0}", "only files by their relative paths");
    refused("c:b.bin", "only files by their relative paths");
    let path = with_uri(&inside, "../b.bin");
    Mesh::read_within(&path, Some(outside.path())).expect("below the root");
    let elsewhere =
        Mesh::read_within(&path, Some(&inside.join("a part"))).expect_err("not below").to_string();
    assert!(elsewhere.contains("`mesh_root`"), "{elsewhere}");
    // Images are confined like buffers.
    let mut json = changed("/buffers/0/uri", json!("b.bin"));
    json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 0}}}]);
    json["textures"] = json!([{"source": 0}]);
    json["images"] = json!([{"uri": "../secret.png"}]);
    json["accessors"]
        .as_array_mut()
        .expect("accessors")
        .push(json!({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"}));
    json["meshes"][0]["primitives"][0]["material"] = json!(0);
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(2);
    for (uri, words) in
        [("../secret.png", "`mesh_root`"), ("none.png", "none.png"), ("b.bin", "neither PNG nor JPEG")]
    {
        json["images"][0]["uri"] = json!(uri);
        fs::write(inside.join("image.gltf"), json.to_string()).expect("a file");
        let error = Mesh::read(&inside.join("image.gltf")).expect_err(uri).to_string();
        assert!(error.contains(words), "{uri}: {error}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn pipes_devices_and_links_out_are_refused_at_once() {
    use rustix::fs::{CWD, FileType, Mode, mknodat};
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name);
    mknodat(CWD, place("pipe.bin"), FileType::Fifo, Mode::from_raw_mode(0o600), 0).expect("a pipe");
    mknodat(CWD, place("pipe.glb"), FileType::Fifo, Mode::from_raw_mode(0o600), 0).expect("a pipe");
    std::os::unix::fs::symlink("/dev/zero", place("zero.bin")).expect("a link");
    std::os::unix::fs::symlink("/dev/zero", place("zero.obj")).expect("a link");
    for (uri, words) in [("pipe.bin", "a named pipe"), ("zero.bin", "a link out of the mesh's folder")] {
        let error = Mesh::read(&with_uri(folder.path(), uri)).expect_err(uri).to_string();
        assert!(error.contains(words), "{uri}: {error}");
    }
    let zero = with_uri(folder.path(), "zero.bin");
    let error = Mesh::read_within(&zero, Some(Path::new("/"))).expect_err("a device").to_string();
    assert!(error.contains("a device"), "{error}");
    for (name, words) in [("pipe.glb", "a named pipe"), ("zero.obj", "a device")] {
        let error = Mesh::read(&place(name)).expect_err(name).to_string();
        assert!(error.contains(words), "{name}: {error}");
    }
}

#[test]
fn textures_have_a_greatest_size() {
    let mut png = Vec::new();
    image::GrayImage::new(8193, 1)
        .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
        .expect("a picture");
    let mut json = triangle(&buffer(&CORNERS));
    json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    json["textures"] = json!([{"source": 0}]);
    json["images"] = json!([{"uri": data_uri(&png)}]);
    json["accessors"]
        .as_array_mut()
        .expect("accessors")
        .push(json!({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"}));
    json["meshes"][0]["primitives"] =
        json!([{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1, "material": 0}]);
    let error = read("large.gltf", json.to_string().as_bytes()).expect_err("too large").to_string();
    assert!(error.starts_with("large.gltf: image 0") && error.contains("8193 x 1 texels"), "{error}");
}
