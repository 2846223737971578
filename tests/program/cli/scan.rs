//! `--scan`: every scan of the summed-area table gives the same files, answers and pictures.

use crate::cli::{done, fails, json, json_file, with_sky};
use octagloss_fixtures::common::sweep;
use std::fs;
use std::path::Path;

const SCANS: [&str; 5] = ["blocks", "hensley:2", "hensley:4", "hensley:8", "hensley:16"];

/// The filter over a table, and one with a border.
const TABLE: [&str; 6] = ["--filter", "box", "--oem-size", "21", "--border", "5"];

/// Runs `bake` on `engine` with every scan, and `query` with the scans `few`, which takes seconds on a
/// software adapter; their outputs must not differ.
fn every_scan_gives_the_same(engine: &str, few: &[&str]) {
    let folder = with_sky();
    let folder = folder.path();
    fs::write(folder.join("d.csv"), "x,y,z\n0,0,1\n0.3,-0.9,0.1\n-1,0.02,0\n0,-1,0\n1,-1,1\n")
        .expect("writable");
    // On a software adapter a process compiles shaders for seconds.
    let bake = |out: &str, more: &[&str]| {
        let start = ["bake", "sky.exr", "-o", out, "--size", "8", "--levels", "3", "--pixel", "f32"];
        done(folder, &[&start[..], &["--engine", engine], &TABLE, more].concat());
        fs::read(folder.join(out)).expect("written")
    };
    let query = |more: &[&str]| {
        let start = ["query", "sky.exr", "--directions", "d.csv", "--roughness", "0.5"];
        done(folder, &[&start[..], &["--engine", engine], &TABLE, more].concat()).out
    };
    let (file, answers) = (bake("box.ktx2", &[]), query(&[]));
    for scan in SCANS.into_iter().filter(|scan| engine == "cpu" || few.contains(scan)) {
        let out = format!("box-{}.ktx2", scan.replace(':', "-"));
        let same = bake(&out, &["--scan", scan]);
        assert!(same == file, "{scan}: the file differs");
        if few.contains(&scan) {
            assert_eq!(query(&["--scan", scan]), answers, "{scan}");
        }
        let report = json_file(&folder.join(format!("{out}.report.json")));
        assert_eq!((&report["recipe"]["scan"], &report["engine"]), (&scan.into(), &engine.into()));
    }
    // The comparisons detect another light.
    if engine == "gpu" && sweep(true, false) {
        return;
    }
    let other = bake("other.ktx2", &["--scan", "hensley:4", "--rotate-y", "70", "--force"]);
    assert!(other != file && query(&["--scan", "hensley:4", "--rotate-y", "70"]) != answers);
}

#[test]
fn every_scan_gives_the_same_on_the_cpu() {
    every_scan_gives_the_same("cpu", &SCANS);
}

#[test]
#[cfg(feature = "gpu")]
fn every_scan_gives_the_same_on_the_gpu() {
    every_scan_gives_the_same("gpu", sweep(&["hensley:2"], &["hensley:2", "hensley:16"]));
}

#[test]
#[cfg(feature = "view")]
fn every_scan_gives_the_same_picture() {
    let folder = with_sky();
    let folder = folder.path();
    let picture = |name: &str, more: &[&str]| {
        let start = ["view", "sky.exr", "--screenshot", name, "--size", "40x30", "--samples", "1", "--quiet"];
        done(folder, &[&start[..], &["--oem-size", "32", "--roughness", "0.4"], more].concat());
        fs::read(folder.join(name)).expect("written")
    };
    let look = ["--filter", "box", "--show", "oem"];
    let plain = picture("oem.png", &look);
    for scan in sweep(&["hensley:2"][..], &["hensley:2", "hensley:16"]) {
        let out = format!("oem-{}.png", scan.replace(':', "-"));
        let same = picture(&out, &[&look[..], &["--scan", scan, "--border", "7"]].concat());
        assert!(same == plain, "{scan}: the picture differs");
    }
    assert!(picture("other.png", &[&look[..], &["--exposure", "5"]].concat()) != plain);
    let scene = ["view", "sky.exr", "--screenshot", "x.png", "--scan", "hensley:2", "--filter"];
    for filter in ["adaptive", "levels", "pyramid"] {
        fails(folder, &[&scene[..], &[filter]].concat(), 2, "use box, or omit --scan");
    }
    assert!(!folder.join("x.png").exists());
}

#[test]
fn a_bake_is_described_with_its_scan() {
    let folder = with_sky();
    let folder = folder.path();
    let bake = |out: &str, more: &[&str]| {
        let start = ["bake", "sky.exr", "-o", out, "--size", "4", "--levels", "2", "--engine", "cpu"];
        done(folder, &[&start[..], more].concat());
        (done(folder, &["info", out]).out, json(&done(folder, &["info", out, "--json"]).out)["scan"].clone())
    };
    let table = ["--filter", "box", "--scan", "hensley:8"];
    for out in ["a.ktx2", "a.dds", "a.ktx"] {
        let (text, value) = bake(out, &table);
        assert!(text.contains("scan        hensley:8\n") && value == "hensley:8", "{out}: {text}");
    }
    let (text, value) = bake("a", &[&table[..], &["--format", "exr"]].concat());
    assert!(text.contains("scan        hensley:8\n") && value == "hensley:8", "{text}");
    let (text, value) = bake("b.ktx2", &["--filter", "box"]);
    assert!(text.contains("scan        blocks\n") && value == "blocks", "{text}");
    // Quadrature reads no such table.
    let (text, value) = bake("c.ktx2", &[]);
    assert!(!text.contains("scan ") && value.is_null(), "{text}");
    assert!(json_file(&folder.join("c.ktx2.report.json"))["recipe"]["scan"].is_null());
    // The file does not record the scan, so that the files of all scans are equal.
    fs::remove_file(folder.join("a.ktx2.report.json")).expect("there");
    assert!(json(&done(folder, &["info", "a.ktx2", "--json"]).out)["scan"].is_null());
}

#[test]
fn scans_that_are_not_read_or_unknown_are_usage_errors() {
    let folder = with_sky();
    let folder = folder.path();
    fs::write(folder.join("d.csv"), "x,y,z\n0,0,1\n").expect("writable");
    let bake = ["bake", "sky.exr", "-o", "x.ktx2", "--scan"];
    let query = ["query", "sky.exr", "--directions", "d.csv", "--roughness", "0.5", "--scan"];
    for scan in SCANS {
        let words = format!("--scan {scan} is for the filter over a summed-area table; use --filter box");
        for filter in [&[][..], &["--filter", "pyramid"], &["--filter", "reference"]] {
            fails(folder, &[&bake[..], &[scan], filter].concat(), 2, &words);
            fails(folder, &[&query[..], &[scan], filter].concat(), 2, &words);
        }
        fails(folder, &["bake", "sky.exr", "--target", "bevy", "-o", "x", "--scan", scan], 2, &words);
    }
    for wrong in ["hensley", "hensley:3", "hensley:", "hensley:2:2", "hensley:-2", "strips", "serial", ""] {
        let words = if wrong.contains(':') { "2, 4, 8 or 16" } else { "hensley:16" };
        fails(folder, &[&bake[..], &[wrong, "--filter", "box"]].concat(), 2, words);
    }
    assert!(!Path::new(&folder.join("x.ktx2")).exists());
}
