//! `octagloss bake --extract-sun`: the sun as numbers, and bakes of the environment without it.

use crate::cli::{done, fails, json_file, names, octagloss, with_sky, write_panorama};
use octagloss::internals::io;
use serde_json::Value;
use std::fs;
use std::path::Path;

const SMALL: [&str; 7] = ["--size", "16", "--levels", "2", "--extract-sun", "--sunless", "--quiet"];

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
    let folder = with_sky();
    bake(folder.path(), "sky.exr", "whole.ktx2", &SMALL[..4]);
    bake(folder.path(), "sky.exr", "a.ktx2", &SMALL);
    assert_eq!(
        names(folder.path())[..4],
        ["a.ktx2", "a.ktx2.report.json", "a.ktx2.sun.json", "a.ktx2.sunless.exr"]
    );
    let (report, whole) = (
        json_file(&folder.path().join("a.ktx2.report.json")),
        json_file(&folder.path().join("whole.ktx2.report.json")),
    );
    let sun = json_file(&folder.path().join("a.ktx2.sun.json"));
    assert_eq!(sun, report["sun"]);
    assert!(whole["sun"].is_null() && report["options"]["extract_sun"] == true);
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
    let folder = with_sky();
    // A sun of 2 degrees: the disc of the other tests is too large for a sun in a fine cube.
    write_panorama(&folder.path().join("sky.exr"), 256, |d| {
        if d.z > 0.999_78 { [5e4, 4e4, 3e4] } else { [0.3, 0.5, 1.0 + d.y as f32] }
    });
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
    let folder = with_sky();
    let args = [&SMALL[..2], &SMALL[4..], &["--target", "three,bevy"]].concat();
    bake(folder.path(), "sky.exr", "out", &args);
    assert_eq!(names(&folder.path().join("out")), ["bevy", "sun.json", "sunless.exr", "three"]);
    let report = json_file(&folder.path().join("out/three/report.json"));
    assert_eq!(json_file(&folder.path().join("out/sun.json")), report["sun"]);
    bake(folder.path(), "sky.exr", "out", &[&args[..], &["--force"]].concat());
    let printed =
        done(folder.path(), &[&["bake", "sky.exr", "-o", "dry", "--dry-run"], &args[..]].concat()).out;
    assert!(printed.contains("dry/sun.json\t") && printed.contains("dry/sunless.exr\t"), "{printed}");
}

#[test]
fn without_a_sun_there_is_a_warning_and_null() {
    let folder = with_sky();
    write_panorama(&folder.path().join("even.exr"), 32, |d| [1.0, 1.0, 1.5 + d.y as f32]);
    let args = ["bake", "even.exr", "-o", "a.ktx2", "--size", "4", "--extract-sun", "--strict"];
    let ran = done(folder.path(), &args);
    assert!(ran.err.contains("warning: even.exr: no sun detected"), "{}", ran.err);
    let report = json_file(&folder.path().join("a.ktx2.report.json"));
    assert!(report["sun"].is_null() && json_file(&folder.path().join("a.ktx2.sun.json")).is_null());
    assert!(report["warnings"].to_string().contains("no sun"), "{}", report["warnings"]);
    // The same bytes as without the option.
    bake(folder.path(), "even.exr", "b.ktx2", &["--size", "4"]);
    let read = |name: &str| fs::read(folder.path().join(name)).expect("readable");
    assert_eq!(read("a.ktx2"), read("b.ktx2"));
    fails(folder.path(), &["bake", "sky.exr", "--sunless"], 2, "--extract-sun");
}
