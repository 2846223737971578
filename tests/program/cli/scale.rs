//! `--scale`: radiance multiplied when it is read.

use super::sun::with_sun;
use super::{done, fails, json, json_file, octagloss, with_sky};
use octagloss_core::files::io::{ReadOptions, load_chain, read};
use std::fs;

const SMALL: [&str; 4] = ["--size", "4", "--levels", "2"];

#[test]
fn a_scaled_bake_is_the_bake_scaled() {
    let folder = with_sky();
    let bake = |out: &str, more: &[&str]| {
        let args = [&["bake", "sky.exr", "--pixel", "f32", "-o", out], &SMALL[..], more].concat();
        done(folder.path(), &args);
        load_chain(&folder.path().join(out)).expect("a bake")
    };
    let (one, eight) = (bake("1.ktx2", &[]), bake("8.ktx2", &["--scale", "8"]));
    for (a, b) in one.chain.levels.iter().zip(&eight.chain.levels) {
        for (a, b) in a.texels.as_flattened().iter().zip(b.texels.as_flattened()) {
            assert!((8.0 * a - b).abs() <= 1e-5 * b, "{a} {b}");
        }
    }
    assert_eq!((one.provenance.scale, eight.provenance.scale), (Some(1.0), Some(8.0)));
    let report = |name: &str| json_file(&folder.path().join(format!("{name}.ktx2.report.json")));
    assert_eq!(
        (&report("1")["recipe"]["scale"], &report("8")["recipe"]["scale"]),
        (&1.0.into(), &8.0.into())
    );
    let bound = |name: &str| report(name)["levels"][1]["error_bound_max"].as_f64().expect("a bound");
    assert!((bound("8") / bound("1") - 8.0).abs() < 1e-3, "bounds are of the scaled light");
    assert_ne!(report("1")["fingerprint"]["request"], report("8")["fingerprint"]["request"]);
}

#[test]
fn the_sun_is_that_of_the_scaled_light_and_every_reader_scales() {
    let folder = with_sun();
    let sun = |out: &str, more: &[&str]| {
        let args = [&["bake", "sky.exr", "--extract-sun", "-o", out], &SMALL[..], more].concat();
        done(folder.path(), &args);
        json_file(&folder.path().join(format!("{out}.sun.json")))["irradiance"][0].as_f64().expect("a number")
    };
    let ratio = sun("b.ktx2", &["--scale", "0.25"]) / sun("a.ktx2", &[]);
    assert!((ratio - 0.25).abs() < 1e-6, "{ratio}");

    fs::write(folder.path().join("d.csv"), "x,y,z\n0,1,0\n").expect("writable");
    let query = |more: &[&str]| {
        let args = [&["query", "sky.exr", "--directions", "d.csv", "--roughness", "1"], more].concat();
        let out = done(folder.path(), &args).out;
        out.lines().nth(1).and_then(|line| line.split(',').nth(3)?.parse::<f64>().ok()).expect("red")
    };
    assert!((query(&["--scale", "2"]) / query(&[]) - 2.0).abs() < 1e-5);

    let info =
        |more: &[&str]| json(&done(folder.path(), &[&["info", "sky.exr", "--json"], more].concat()).out);
    assert_eq!(info(&["--scale", "2"])["max"][0], 10_000.0);
    let args = ["convert", "sky.exr", "--layout", "cube", "--size", "8", "-o"];
    done(folder.path(), &[&args[..], &["1.exr"]].concat());
    done(folder.path(), &[&args[..], &["2.exr", "--scale", "2"]].concat());
    let texels = |name: &str| {
        let loaded = read(&folder.path().join(name), &ReadOptions::default()).expect("readable");
        loaded.environment.texels().to_vec()
    };
    let (one, two) = (texels("1.exr"), texels("2.exr"));
    assert!(one.iter().zip(&two).all(|(a, b)| a.map(|c| 2.0 * c) == *b));
}

#[test]
fn compare_scales_the_source_as_the_bake_was() {
    let folder = with_sky();
    for out in ["a.ktx2", "a.dds", "a.exr/"] {
        let name = out.trim_end_matches('/');
        let format: &[&str] =
            if out.ends_with('/') { &["--format", "exr", "-o", "levels"] } else { &["-o", name] };
        done(
            folder.path(),
            &[&["bake", "sky.exr", "--scale", "3", "--size", "8", "--chain", "sampled"], format].concat(),
        );
        let name = if out.ends_with('/') { "levels" } else { name };
        done(
            folder.path(),
            &["compare", name, "sky.exr", "--fail-above", "0.2", "--texels", "20", "--quiet"],
        );
        let wrong =
            ["compare", name, "sky.exr", "--scale", "1", "--fail-above", "0.2", "--texels", "20", "--quiet"];
        let ran = octagloss(folder.path(), &wrong);
        assert!(ran.code == 1 && ran.err.contains("relRMSE"), "{out}: {}", ran.err);
        let info = json(&done(folder.path(), &["info", name, "--json"]).out);
        assert_eq!(info["scale"], 3.0, "{out}");
    }
    let text = done(folder.path(), &["info", "a.ktx2"]).out;
    assert!(text.contains("radiance times 3"), "{text}");
}

#[test]
fn scales_are_positive_and_what_leaves_float32_is_told() {
    let folder = with_sky();
    for (scale, words) in [
        ("0", "above 0"),
        ("-1", "above 0"),
        ("inf", "finite"),
        ("NaN", "finite"),
        ("two", "not a number"),
        ("", "not a number"),
    ] {
        fails(folder.path(), &["bake", "sky.exr", "--scale", scale], 2, words);
    }
    fails(folder.path(), &["bake", "sky.exr", "--scale", "1e37"], 1, "--scale 1e37 moves the greatest value");
    let ran = done(folder.path(), &["bake", "sky.exr", "--scale", "1e-60", "--size", "4"]);
    assert!(ran.err.contains("rounds all its light to 0"), "{}", ran.err);
}
