//! `octagloss bake --extract-sun`: the sun as numbers, and bakes of the environment without it.

use crate::cli::{done, fails, json_file, names, octagloss, write_panorama};
use octagloss_core::files::format::Pixel;
use octagloss_core::files::io;
use octagloss_core::files::io::exr::write::{Samples, exr_bytes};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SMALL: [&str; 7] = ["--size", "16", "--levels", "2", "--extract-sun", "--sunless", "--quiet"];

/// Returns a folder with `sky.exr`: a gradient and a sun of 3.6 degrees towards +Z, fine enough for a lamp.
pub(crate) fn with_sun() -> TempDir {
    let folder = TempDir::new().expect("a temporary folder");
    write_panorama(&folder.path().join("sky.exr"), 256, |d| {
        if d.z > 0.9995 { [5000.0, 4000.0, 3000.0] } else { [0.3, 0.5, 1.0 + d.y as f32] }
    });
    folder
}

fn energy(report: &Value) -> Vec<f64> {
    numbers(&report["energy"]["source"])
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("an array").iter().map(|v| v.as_f64().expect("a number")).collect()
}

fn bake(folder: &Path, input: &str, out: &str, more: &[&str]) {
    done(folder, &[&["bake", input, "-o", out], more].concat());
}

#[test]
fn the_sun_is_reported_and_the_rest_is_baked_without_it() {
    let folder = with_sun();
    bake(folder.path(), "sky.exr", "whole.ktx2", &SMALL[..4]);
    bake(folder.path(), "sky.exr", "a.ktx2", &SMALL);
    assert_eq!(
        names(folder.path())[..5],
        ["a.ktx2", "a.ktx2.report.json", "a.ktx2.sun.gltf", "a.ktx2.sun.json", "a.ktx2.sunless.exr"]
    );
    let (report, whole) = (
        json_file(&folder.path().join("a.ktx2.report.json")),
        json_file(&folder.path().join("whole.ktx2.report.json")),
    );
    let sun = json_file(&folder.path().join("a.ktx2.sun.json"));
    assert_eq!((&sun, &report["suns"]), (&report["sun"], &Value::from(vec![sun.clone()])));
    assert_eq!(report["recipe"]["extract_sun"], "brightest");
    assert!(whole["sun"].is_null() && whole["recipe"]["extract_sun"].is_null());
    // The sun is towards +Z, with colour 5:4:3, over a sky of 0.3, 0.5 and 1.
    assert!(numbers(&sun["direction"])[2] > 0.999, "{sun}");
    let color = numbers(&sun["color"]);
    assert!(color[0] == 1.0 && (color[1] - 0.8).abs() < 0.01 && (color[2] - 0.6).abs() < 0.01, "{sun}");
    for ((rest, taken), all) in energy(&report).iter().zip(numbers(&sun["irradiance"])).zip(energy(&whole)) {
        assert!(((rest + taken) / all - 1.0).abs() < 1e-12, "{rest} + {taken} is not {all}");
    }
    // The written environment is the one that was baked.
    bake(folder.path(), "a.ktx2.sunless.exr", "b.ktx2", &SMALL[..4]);
    let read = |name: &str| io::read_chain(&folder.path().join(name)).expect("a bake");
    assert!(read("a.ktx2") == read("b.ktx2") && read("a.ktx2") != read("whole.ktx2"));
    let brightest = |name: &str| {
        let chain = io::read_chain(&folder.path().join(name)).expect("a bake");
        chain.levels[0].texels.iter().map(|texel| texel[0]).fold(0.0, f32::max)
    };
    assert!(brightest("whole.ktx2") > 100.0 && brightest("a.ktx2") < 0.5);
    // The source is compared without its sun as well.
    let compare = ["compare", "a.ktx2", "sky.exr", "--texels", "60", "--fail-above", "0.05", "--quiet"];
    done(folder.path(), &compare);
    assert_eq!(octagloss(folder.path(), &[&["compare", "b.ktx2"], &compare[2..]].concat()).code, 1);
}

#[test]
fn cubes_and_turned_environments_lose_the_same_sun() {
    let folder = with_sun();
    // A cube of the same sky, from its mirror level.
    let cube = ["--size", "64", "--levels", "1", "--pixel", "f32", "--quiet"];
    bake(folder.path(), "sky.exr", "cube.ktx2", &cube);
    for (input, turn) in [("cube.ktx2", "0"), ("sky.exr", "90"), ("cube.ktx2", "90")] {
        let args = [&SMALL[..], &["--rotate-y", turn, "--force"]].concat();
        bake(folder.path(), input, "out", &[&args[..], &["--format", "exr"]].concat());
        let found = names(&folder.path().join("out"));
        assert!(
            ["report.json", "sun.json", "sunless.exr"].iter().all(|name| found.iter().any(|f| f == name))
        );
        let sun = json_file(&folder.path().join("out/sun.json"));
        let towards = numbers(&sun["direction"])[if turn == "0" { 2 } else { 0 }];
        assert!(towards > 0.999, "{input} turned by {turn}: {sun}");
        // The file is not turned: a separate bake with the turn gives the same result.
        bake(
            folder.path(),
            "out/sunless.exr",
            "again",
            &["--size", "16", "--levels", "2", "--rotate-y", turn, "--format", "exr", "--force"],
        );
        let read = |out: &str| io::read_chain(&folder.path().join(out)).expect("a bake");
        assert_eq!(read("out"), read("again"), "{input} {turn}");
    }
}

#[test]
fn targets_write_the_sun_once() {
    let folder = with_sun();
    let args = [&SMALL[..2], &SMALL[4..], &["--target", "three,bevy"]].concat();
    bake(folder.path(), "sky.exr", "out", &args);
    assert_eq!(names(&folder.path().join("out")), ["bevy", "sun.gltf", "sun.json", "sunless.exr", "three"]);
    let report = json_file(&folder.path().join("out/three/report.json"));
    assert_eq!(json_file(&folder.path().join("out/sun.json")), report["sun"]);
    bake(folder.path(), "sky.exr", "out", &[&args[..], &["--force"]].concat());
    let printed =
        done(folder.path(), &[&["bake", "sky.exr", "-o", "dry", "--dry-run"], &args[..]].concat()).out;
    assert!(printed.contains("dry/sun.json\t") && printed.contains("dry/sunless.exr\t"), "{printed}");
}

#[test]
fn without_a_sun_there_is_a_warning_and_null() {
    let folder = with_sun();
    write_panorama(&folder.path().join("even.exr"), 32, |d| [1.0, 1.0, 1.5 + d.y as f32]);
    let args = ["bake", "even.exr", "-o", "a.ktx2", "--size", "4", "--extract-sun", "--strict"];
    let ran = done(folder.path(), &args);
    assert!(ran.err.contains("warning: even.exr: no sun detected"), "{}", ran.err);
    let report = json_file(&folder.path().join("a.ktx2.report.json"));
    assert!(report["sun"].is_null() && json_file(&folder.path().join("a.ktx2.sun.json")).is_null());
    assert!(report["warnings"].to_string().contains("no sun"), "{}", report["warnings"]);
    assert!(json_file(&folder.path().join("a.ktx2.sun.gltf"))["nodes"].is_null());
    // The same light as without the option.
    bake(folder.path(), "even.exr", "b.ktx2", &["--size", "4"]);
    let read = |name: &str| io::read_chain(&folder.path().join(name)).expect("a bake");
    assert_eq!(read("a.ktx2"), read("b.ktx2"));
    fails(folder.path(), &["bake", "sky.exr", "--sunless"], 2, "--extract-sun");
}

/// A panorama with a sun towards +Z, a weaker one towards +X and a window towards -X.
fn write_lights(path: &Path) {
    write_panorama(path, 256, |d| match () {
        () if d.z > 0.9995 => [5000.0, 4000.0, 3000.0],
        () if d.x > 0.9996 => [1000.0, 2000.0, 1500.0],
        () if d.x < -0.9 => [900.0; 3],
        () => [0.3, 0.5, 1.0 + d.y as f32],
    });
}

#[test]
fn several_suns_are_chosen_recorded_and_read_back() {
    let folder = with_sun();
    write_lights(&folder.path().join("sky.exr"));
    // An option's value is never an input.
    let plain = [&["bake", "--extract-sun", "sky.exr", "-o", "plain.ktx2"], &SMALL[..4]].concat();
    let plain = done(folder.path(), &plain).err;
    assert!(plain.contains("sky.exr: removed a sun: azimuth 90.0, elevation 0.0 ("), "{plain}");
    assert!(plain.contains("% of the light") && plain.contains("degrees across"), "{plain}");
    let extract = |out: &str, which: &str, more: &[&str]| {
        let option = format!("--extract-sun={which}");
        let bake = ["bake", "sky.exr", "-o", out, "--sunless", &option];
        let said = done(folder.path(), &[&bake[..], &SMALL[..4], more].concat()).err;
        (json_file(&folder.path().join(format!("{out}.sun.json"))), said)
    };
    let (suns, said) = extract("two.ktx2", "2", &[]);
    assert_eq!(said.matches("removed a sun").count(), 2, "{said}");
    assert!(
        said.contains("a light stays: azimuth 180.0") || said.contains("a light stays: azimuth -180.0"),
        "{said}"
    );
    let directions: Vec<Vec<f64>> =
        suns.as_array().expect("a list").iter().map(|sun| numbers(&sun["direction"])).collect();
    assert!(directions.len() == 2 && directions[0][2] > 0.999 && directions[1][0] > 0.999, "{suns}");
    let report = json_file(&folder.path().join("two.ktx2.report.json"));
    assert_eq!((&report["suns"], &report["sun"]), (&suns, &suns[0]));
    assert_eq!(report["recipe"]["extract_sun"], 2);
    // Directions choose the same, by azimuth and elevation or as vectors, after a turn.
    let (one, _) = extract("one.ktx2", "0,0", &[]);
    assert_eq!(one[0]["direction"], suns[1]["direction"]);
    let (turned, _) = extract("turned.ktx2", "0,0,-5", &["--rotate-y", "90"]);
    let towards = numbers(&turned[0]["direction"]);
    assert!(towards[2] < -0.999 && turned.as_array().expect("a list").len() == 1, "{turned}");
    let (none, said) = extract("none.ktx2", "0,80", &[]);
    assert_eq!(none, Value::from(Vec::<Value>::new()));
    assert!(
        said.contains("no sun detected") && said.contains("no light stands out within 10 degrees"),
        "{said}"
    );
    // The source loses the same suns again.
    let compare = |bake: &str| {
        let args = ["compare", bake, "sky.exr", "--texels", "60", "--fail-above", "0.05", "--quiet"];
        octagloss(folder.path(), &args).code
    };
    assert_eq!(["two.ktx2", "one.ktx2", "turned.ktx2"].map(compare), [0, 0, 0]);
    let said = done(folder.path(), &["compare", "two.ktx2", "sky.exr", "--texels", "4"]).err;
    assert_eq!(said.matches("removed a sun").count(), 2, "{said}");
    let info = done(folder.path(), &["info", "two.ktx2"]).out;
    assert_eq!(info.matches("removed, direction").count(), 2, "{info}");
    let info = done(folder.path(), &["info", "two.ktx2", "--json"]).out;
    let info: Value = serde_json::from_str(&info).expect("JSON");
    assert_eq!(info["suns"][1]["direction"], suns[1]["direction"], "{info}");
    for wrong in ["0", "33", "up", "0,91", "0,0,0"] {
        let option = format!("--extract-sun={wrong}");
        fails(folder.path(), &["bake", "sky.exr", &option], 2, "a number of lights from 1 to 32");
    }
}

#[test]
fn lights_of_gltf_shine_from_the_suns() {
    let folder = with_sun();
    write_lights(&folder.path().join("sky.exr"));
    bake(folder.path(), "sky.exr", "a.ktx2", &["--size", "4", "--levels", "1", "--extract-sun=2", "--quiet"]);
    let gltf = json_file(&folder.path().join("a.ktx2.sun.gltf"));
    let suns = json_file(&folder.path().join("a.ktx2.sun.json"));
    assert_eq!(gltf["asset"]["version"], "2.0");
    assert_eq!(gltf["extensionsUsed"], serde_json::json!(["KHR_lights_punctual"]));
    assert_eq!(gltf["scenes"][0]["nodes"], serde_json::json!([0, 1]));
    for k in 0..2 {
        let node = &gltf["nodes"][k];
        let light = &node["extensions"]["KHR_lights_punctual"]["light"];
        let light =
            &gltf["extensions"]["KHR_lights_punctual"]["lights"][light.as_u64().expect("an index") as usize];
        assert_eq!(light["type"], "directional");
        let intensity = light["intensity"].as_f64().expect("a number");
        for (color, irradiance) in numbers(&light["color"]).into_iter().zip(numbers(&suns[k]["irradiance"])) {
            assert!((color * intensity / irradiance - 1.0).abs() < 1e-9 && color <= 1.0, "{light}");
        }
        // The light shines along -Z of its node.
        let [x, y, z, w] = numbers(&node["rotation"]).try_into().expect("four");
        let along = glam::DQuat::from_xyzw(x, y, z, w) * glam::DVec3::NEG_Z;
        let towards = glam::DVec3::from_slice(&numbers(&suns[k]["direction"]));
        assert!((along + towards).length() < 1e-6, "{along} {towards}");
    }
}

#[test]
fn a_picture_of_few_texels_has_no_sun() {
    let folder = TempDir::new().expect("a temporary folder");
    let texels: Vec<[f32; 3]> = (0..5).map(|k| [if k == 2 { 100.0 } else { 1e-3 }; 3]).collect();
    let bytes = exr_bytes(5, 1, Samples::Rgb(&texels), Pixel::F32, &[]).expect("valid");
    fs::write(folder.path().join("row.exr"), bytes).expect("writable");
    for pad in ["--pad", "--pad=edge"] {
        let info = done(folder.path(), &["info", "row.exr", pad, "--json"]).out;
        let info: Value = serde_json::from_str(&info).expect("JSON");
        assert!(info["sun"].is_null(), "{info}");
    }
}
