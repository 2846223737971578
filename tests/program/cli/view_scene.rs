//! `octagloss view --scene`: pictures of moving scenes, and refusals.

use crate::cli::{done, fails, names};
use octagloss_fixtures::files::gltf::triangle;
use serde_json::json;
use std::fs;
use std::path::Path;

/// A small picture of coarse maps.
const QUICK: [&str; 7] = ["--size", "48x32", "--samples", "1", "--oem-size", "32", "--quiet"];

fn bytes(positions: [f32; 9]) -> Vec<u8> {
    let mut bytes: Vec<u8> = positions.iter().flat_map(|p| p.to_le_bytes()).collect();
    bytes.extend([0, 0, 1, 0, 2, 0]);
    bytes
}

fn picture(folder: &Path, name: &str, scene: &[&str], more: &[&str]) -> image::RgbImage {
    done(folder, &[&["view", "--screenshot", name, "--scene"], scene, &QUICK[..], more].concat());
    image::open(folder.join(name)).expect("a picture").to_rgb8()
}

#[test]
fn scenes_are_drawn_at_a_time_by_a_number_of_probes() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let first = picture(folder, "a.png", &[], &["--scene-time", "2.5", "--probes", "1"]);
    assert_eq!(first.dimensions(), (48, 32));
    assert!(first.pixels().any(|pixel| pixel.0.iter().any(|byte| *byte > 60)), "something is lit");
    let others =
        ["--scene-time 4 --probes 1", "--scene-time 2.5 --probes 1 --roughness 1", "--scene-time 2.5"];
    for (k, other) in others.iter().enumerate() {
        let more: Vec<&str> = other.split(' ').collect();
        assert_ne!(first, picture(folder, &format!("{k}.png"), &[], &more), "{other}");
    }
}

#[test]
fn files_are_drawn_with_their_emission() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let mut json = triangle(&bytes([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]));
    json["meshes"][0]["primitives"][0]["material"] = 0.into();
    let mut greens = [[0, 0, 0], [0, 1, 0]].into_iter().enumerate().map(|(k, emission)| {
        json["materials"] = json!([
            {"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0, 0, 0, 1]},
                "emissiveFactor": emission}
        ]);
        fs::write(folder.join("lit.gltf"), json.to_string()).expect("writable");
        let picture = picture(folder, &format!("{k}.png"), &["lit.gltf"], &[]);
        picture.pixels().filter(|pixel| pixel[1] > 150 && pixel[0] < 50 && pixel[2] < 50).count()
    });
    let (dark, lit) = (greens.next().expect("a count"), greens.next().expect("a count"));
    assert!(dark == 0 && lit > 50, "{dark} and {lit} green pixels");
}

/// A PNG of `width` x `height` texels.
fn png(width: u32, height: u32, colour: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_fn(width, height, |x, y| image::Rgb(colour(x, y)))
        .write_to(&mut bytes, image::ImageFormat::Png)
        .expect("a picture");
    bytes.into_inner()
}

/// A triangle whose corners, but not the middle, have the texture at `uri` in black.
fn painted(uri: &str) -> serde_json::Value {
    let mut json = triangle(&bytes([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]));
    json["meshes"][0]["primitives"][0]["material"] = 0.into();
    // The corners' positions.
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2.into();
    let uv = json!({"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2"});
    json["accessors"].as_array_mut().expect("accessors").push(uv);
    let view = json!({"buffer": 0, "byteLength": 36, "byteStride": 12});
    json["bufferViews"].as_array_mut().expect("views").push(view);
    json["materials"] = json!([{
        "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0, 0, 0, 1]},
        "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0}
    }]);
    json["textures"] = json!([{"source": 0}]);
    json["images"] = json!([{"uri": uri}]);
    json
}

#[test]
fn files_are_drawn_with_their_textures() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let inside = |x: u32, y: u32| (8..24).contains(&x) && (8..24).contains(&y);
    let lit = png(64, 64, |x, y| if inside(x, y) { [0, 255, 0] } else { [0; 3] });
    fs::write(folder.join("lit.png"), lit).expect("writable");
    fs::write(folder.join("painted.gltf"), painted("lit.png").to_string()).expect("writable");
    let picture = picture(folder, "painted.png", &["painted.gltf"], &[]);
    let green = picture.pixels().filter(|pixel| pixel[1] > 150 && pixel[0] < 50 && pixel[2] < 50).count();
    // The square is an eighth of the triangle, of which files_are_drawn_with_their_emission sees 50 pixels.
    assert!(green > 6, "{green} green pixels");
}

#[test]
fn bad_textures_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    fs::write(folder.join("wide.png"), png(9000, 1, |_, _| [255; 3])).expect("writable");
    for (uri, words) in
        [("wide.png", "9000 x 1 texels; use a texture of at most 8192 per side"), ("none.png", "none.png")]
    {
        fs::write(folder.join("bad.gltf"), painted(uri).to_string()).expect("writable");
        fails(folder, &["view", "--screenshot", "x.png", "--scene", "bad.gltf"], 1, words);
    }
    assert!(!names(folder).contains(&"x.png".to_owned()));
}

#[test]
fn bad_scenes_and_options_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let good = triangle(&bytes([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]));
    let nan = triangle(&bytes([0.0, f32::NAN, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]));
    let mut cycle = good.clone();
    cycle["nodes"] = json!([{"mesh": 0, "children": [1]}, {"children": [0]}]);
    let mut empty = good.clone();
    empty["scenes"] = json!([{"nodes": []}]);
    let mut no_texture = good.clone();
    no_texture["meshes"][0]["primitives"][0]["material"] = 0.into();
    no_texture["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 7}}}]);
    for (json, words) in
        [(nan, "bad.gltf"), (cycle, "cycle"), (empty, "no triangles"), (no_texture, "bad.gltf")]
    {
        fs::write(folder.join("bad.gltf"), json.to_string()).expect("writable");
        fails(folder, &["view", "--screenshot", "x.png", "--scene", "bad.gltf"], 1, words);
    }
    fails(folder, &["view", "--screenshot", "x.png", "--scene", "none.glb"], 1, "none.glb");
    fails(folder, &["view", "--screenshot", "x.png", "--scene", "a.fbx"], 1, "a.fbx");
    let usage: [(&[&str], &str); 8] = [
        (&["--scene", "--filter", "box"], "use pyramid"),
        (&["--scene", "--probes", "9"], "1..=8"),
        (&["--scene", "--probe-budget", "4"], "--screenshot"),
        (&["--scene", "--metal", "1,1,1"], "--metal"),
        (&["--scene", "--turn", "90"], "--turn"),
        (&["--scene", "--direct", "magic"], "--direct"),
        (&["--scene", "--proxy", "cone"], "--proxy"),
        (&["--proxy", "box"], "--scene"),
    ];
    for (args, words) in usage {
        fails(folder, &[&["view", "--screenshot", "x.png"], args].concat(), 2, words);
    }
    assert!(!names(folder).contains(&"x.png".to_owned()));
}
