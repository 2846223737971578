//! Meshes of files: what is read, and what is refused.

use octagloss::Error;
use octagloss::view::Mesh;
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
    assert_eq!(mesh.indices.len(), 36, "two triangles a face");
    let corner = 1.0 / 3.0_f32.sqrt();
    for vertex in &mesh.vertices {
        assert!(vertex.position.iter().all(|c| (c.abs() - corner).abs() < 1e-6), "{vertex:?}");
        // Its face is the one that its normal points to.
        let along: f32 = vertex.position.iter().zip(vertex.normal).map(|(p, n)| p * n).sum();
        assert!((along - corner).abs() < 1e-6, "{vertex:?}");
    }
}

/// A triangle in a glTF with its data inside.
fn triangle(positions: &[f32], count: usize) -> Vec<u8> {
    let bytes: Vec<u8> = positions.iter().flat_map(|p| p.to_le_bytes()).collect();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"mesh":0,"translation":[5,0,0],"scale":[2,1,1]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "buffers":[{{"byteLength":{}}}],"bufferViews":[{{"buffer":0,"byteLength":{}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{count},"type":"VEC3","min":[0,0,0],"max":[1,1,1]}}]}}"#,
        bytes.len(),
        bytes.len()
    );
    let pad = |mut chunk: Vec<u8>, with: u8| {
        while !chunk.len().is_multiple_of(4) {
            chunk.push(with);
        }
        chunk
    };
    let (json, bytes) = (pad(json.into_bytes(), b' '), pad(bytes, 0));
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

#[test]
fn a_gltf_is_read_where_its_nodes_put_it() {
    let mesh = read("one.glb", &triangle(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], 3)).expect("a mesh");
    assert_eq!(mesh.indices, [0, 1, 2]);
    let [a, b, c] = [0, 1, 2].map(|k| glam::Vec3::from_array(mesh.vertices[k].position));
    // Twice as wide as high, however it was scaled.
    assert!((a.distance(b) / a.distance(c) - 2.0).abs() < 1e-5, "{a} {b} {c}");
    assert!(mesh.vertices.iter().all(|vertex| vertex.normal == [0.0, 0.0, 1.0]));
}

#[test]
fn what_is_no_mesh_is_refused_by_name() {
    let nan = f32::NAN;
    let cases: [(&str, Vec<u8>); 8] = [
        ("nothing.obj", Vec::new()),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n".to_vec()),
        ("wild.obj", b"v 0 0 0\nf 1 2 900\n".to_vec()),
        ("text.glb", b"these are no triangles".to_vec()),
        ("short.glb", triangle(&[0.0; 9], 3)[..60].to_vec()),
        ("flat.glb", triangle(&[0.0; 9], 3)),
        ("nan.glb", triangle(&[nan, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, nan], 3)),
        ("mesh.stl", CUBE.as_bytes().to_vec()),
    ];
    for (name, bytes) in cases {
        let error = read(name, &bytes).expect_err(name).to_string();
        assert!(error.starts_with(name) && !error.contains('\n'), "{name}: {error}");
    }
    assert!(matches!(Mesh::read(Path::new("there/is/none.obj")), Err(Error::Io { .. })));
}
