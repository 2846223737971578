//! `--crop` and `--pad`: panoramas that are not 2:1.

use super::{done, fails, json, json_file, names, octagloss, with_sky};
use octagloss_core::files::format::Pixel;
use octagloss_core::files::io::exr::write::{Samples, exr_bytes};
use octagloss_core::files::io::{ReadOptions, read};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A `width` x `height` image with red = column, green = row, and black outside the rows `lit`.
fn write(path: &Path, width: u32, height: u32, lit: std::ops::Range<u32>) {
    let texel = |k: u32| {
        let (x, y) = (k % width, k / width);
        if lit.contains(&y) { [x as f32 + 1.0, y as f32 + 1.0, 1.0] } else { [0.0; 3] }
    };
    let texels: Vec<[f32; 3]> = (0..width * height).map(texel).collect();
    let bytes = exr_bytes(width, height, Samples::Rgb(&texels), Pixel::F32, &[]).expect("valid");
    fs::write(path, bytes).expect("writable");
}

#[test]
fn what_is_not_two_to_one_is_refused_with_both_remedies() {
    let folder = TempDir::new().expect("a temporary folder");
    write(&folder.path().join("band.exr"), 32, 11, 0..11);
    for command in [&["bake", "band.exr"][..], &["bake", "band.exr", "--layout", "equirect"]] {
        fails(folder.path(), command, 1, "--pad fills");
        fails(folder.path(), command, 1, "--crop removes black bars");
    }
    for more in [["--pad", "--layout=cross"], ["--crop", "--layout=octahedral"], ["--pad", "--layout=faces"]]
    {
        fails(folder.path(), &["bake", "band.exr", more[0], more[1]], 2, "omit --layout");
    }
    fails(folder.path(), &["bake", "band.exr", "--pad=white"], 2, "black, edge");
    let args = ["convert", "band.exr", "--layout", "cube", "--from", "healpix", "--pad", "-o", "c.exr"];
    fails(folder.path(), &args, 2, "--from");
    assert_eq!(names(folder.path()), ["band.exr"]);
}

#[test]
fn a_band_is_padded_and_the_bake_says_so() {
    let folder = TempDir::new().expect("a temporary folder");
    write(&folder.path().join("band.exr"), 32, 10, 0..10);
    let bake = |out: &str, pad: &str| {
        let ran =
            done(folder.path(), &["bake", "band.exr", pad, "--size", "8", "--chain", "sampled", "-o", out]);
        let report = json_file(&folder.path().join(format!("{out}.report.json")));
        assert!(report["warnings"][0].as_str().expect("text").contains("padded with 3"), "{}", ran.err);
        (ran.err, report)
    };
    let (said, report) = bake("black.ktx2", "--pad");
    assert!(said.contains("band.exr: padded with 3 black rows above and below"), "{said}");
    assert_eq!((&report["recipe"]["pad"], &report["layout"]), (&"black".into(), &"panorama".into()));
    let (said, report) = bake("edge.ktx2", "--pad=edge");
    assert!(said.contains("padded with 3 edge rows above and below"), "{said}");
    assert_eq!(report["recipe"]["pad"], "edge");
    // The source is padded like the bake's.
    for (bake, other) in [("black.ktx2", "edge"), ("edge.ktx2", "black")] {
        done(
            folder.path(),
            &["compare", bake, "band.exr", "--fail-above", "0.05", "--texels", "20", "--quiet"],
        );
        let wrong = format!("--pad={other}");
        let args = ["compare", bake, "band.exr", "--fail-above", "0.05", "--texels", "20", "--quiet", &wrong];
        let ran = octagloss(folder.path(), &args);
        assert!(ran.code == 1 && ran.err.contains("relRMSE"), "{bake}: {}", ran.err);
    }
    let ran = done(folder.path(), &["info", "band.exr", "--pad", "--json"]);
    assert_eq!((&json(&ran.out)["width"], &json(&ran.out)["height"]), (&32.into(), &16.into()));
    let args = ["convert", "band.exr", "--pad", "--layout", "equirect", "--size", "16", "-o", "whole.exr"];
    done(folder.path(), &args);
    let whole = read(&folder.path().join("whole.exr"), &ReadOptions::default()).expect("a panorama");
    assert_eq!(whole.environment.texels()[0], [0.0; 3]);
}

#[test]
fn a_letterbox_is_cropped_and_the_bake_says_so() {
    let folder = TempDir::new().expect("a temporary folder");
    write(&folder.path().join("film.exr"), 32, 24, 4..20);
    let ran = done(
        folder.path(),
        &["bake", "film.exr", "--crop", "--size", "8", "--chain", "sampled", "-o", "a.ktx2"],
    );
    assert!(ran.err.contains("film.exr: cropped 4 black rows above and below"), "{}", ran.err);
    assert_eq!(json_file(&folder.path().join("a.ktx2.report.json"))["recipe"]["crop"], true);
    done(
        folder.path(),
        &["compare", "a.ktx2", "film.exr", "--fail-above", "0.05", "--texels", "20", "--quiet"],
    );
    // 4:3 without the bars would be a cross.
    let loaded = read(&folder.path().join("film.exr"), &ReadOptions { crop: true, ..ReadOptions::default() });
    let loaded = loaded.expect("a panorama");
    assert_eq!((loaded.layout, loaded.width, loaded.height), ("panorama", 32, 16));
    assert_eq!(loaded.environment.texels()[0], [1.0, 5.0, 1.0]);
    // --pad completes what too small bars leave.
    write(&folder.path().join("few.exr"), 32, 20, 1..20);
    fails(folder.path(), &["bake", "few.exr", "--crop"], 1, "32x19: a panorama must be 2:1");
    let ran = done(folder.path(), &["bake", "few.exr", "--crop", "--pad", "--size", "8", "-o", "few.ktx2"]);
    for words in ["cropped 1 black rows above", "padded with 3 black columns left and right"] {
        assert!(ran.err.contains(words), "{}", ran.err);
    }
}

#[test]
fn what_fits_already_stays_as_it_is() {
    let folder = with_sky();
    let bake = |out: &str, more: &[&str]| {
        done(folder.path(), &[&["bake", "sky.exr", "--size", "4", "-o", out], more].concat()).err
    };
    bake("a.ktx2", &[]);
    let said = bake("b.ktx2", &["--crop", "--pad"]);
    assert!(!said.contains("cropped") && !said.contains("padded"), "{said}");
    let levels =
        |name: &str| octagloss_core::files::io::read_chain(&folder.path().join(name)).expect("a bake").levels;
    assert!(levels("a.ktx2").iter().zip(&levels("b.ktx2")).all(|(a, b)| a.texels == b.texels));
    // Cubes have no bars.
    done(folder.path(), &["bake", "a.ktx2", "--pad", "--size", "4", "-o", "c.ktx2"]);
}
