//! `octagloss bake --out-layout` on the command line, and its outputs read back.

use crate::cli::targets::{bake, done, fails, json, octagloss, tree, with_environments};
use exr::prelude::{ReadChannels as _, ReadLayers as _, read as read_exr};
use octagloss::{Layout, Rgb};
use octagloss_core::files::io::{ReadOptions, read, read_chain};
use octagloss_core::sphere::equirect::{direction_from_equirect, equirect_from_direction};
use std::path::Path;

const SIZE: [&str; 4] = ["--size", "16", "--levels", "3"];

fn baked(folder: &Path, layout: &str, out: &str, more: &[&str]) {
    done(folder, &bake(&[&SIZE[..], &["--out-layout", layout, "-o", out], more].concat()));
}

#[test]
fn unfolded_cubes_and_parts_read_back_as_the_faces() {
    let folder = with_environments();
    let at = |name: &str| folder.path().join(name);
    baked(folder.path(), "faces", "faces", &["--format", "exr", "--pixel", "f32"]);
    let faces = read_chain(&at("faces")).unwrap();
    for layout in ["cross", "cross-vertical", "strip", "strip-vertical"] {
        baked(folder.path(), layout, layout, &["--pixel", "f32", "--irradiance", "4"]);
        let files = ["irradiance.exr", "m0.exr", "m1.exr", "m2.exr", "report.json"];
        assert_eq!(tree(&at(layout)), files, "{layout}");
        assert_eq!(read_chain(&at(layout)).unwrap(), faces, "{layout}");
        assert_eq!(json(&at(layout).join("report.json"))["recipe"]["out_layout"], layout);
        // A single image is an environment, and so is the folder.
        for path in [at(layout).join("m0.exr"), at(layout)] {
            let loaded = read(&path, &ReadOptions::default()).unwrap();
            assert_eq!(loaded.environment.layout(), Layout::Cube { size: 16 }, "{layout}");
            assert_eq!(loaded.environment.texels(), faces.levels[0].texels, "{layout}");
        }
        let zero = done(folder.path(), &["compare", layout, "faces", "--fail-above", "0", "--quiet"]);
        assert!(zero.contains("relRMSE"), "{zero}");
    }
    baked(folder.path(), "parts", "parts.exr", &["--pixel", "f32"]);
    assert_eq!(read_chain(&at("parts.exr")).unwrap(), faces);
    assert!(at("parts.exr.report.json").is_file());
    let loaded = read(&at("parts.exr"), &ReadOptions::default()).unwrap();
    assert_eq!(loaded.environment.texels(), faces.levels[0].texels);
    done(folder.path(), &["compare", "parts.exr", "faces", "--fail-above", "0", "--quiet"]);
    assert!(done(folder.path(), &["info", "parts.exr"]).contains("16"));
    // A chain from another source is detected.
    done(
        folder.path(),
        &["bake", "b.exr", "--quiet", "--size", "16", "--levels", "3", "--format", "exr", "-o", "other"],
    );
    let other = octagloss(folder.path(), &["compare", "cross", "other", "--fail-above", "0", "--quiet"]);
    assert_eq!(other.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&other.stderr).contains("is above 0"));
    // Radiance files hold the same within RGBE precision.
    baked(folder.path(), "cross", "hdr", &["--format", "hdr"]);
    assert_eq!(tree(&at("hdr")), ["m0.hdr", "m1.hdr", "m2.hdr", "report.json"]);
    for (found, exact) in read_chain(&at("hdr")).unwrap().levels.iter().zip(&faces.levels) {
        for (found, exact) in found.texels.iter().zip(&exact.texels) {
            let most = exact.iter().copied().fold(0.0, f32::max);
            assert!((0..3).all(|c| (found[c] - exact[c]).abs() <= most / 250.0), "{found:?} for {exact:?}");
        }
    }
}

/// Returns the direction of the brightest texel of a panorama.
fn brightest(width: usize, texels: &[Rgb]) -> glam::DVec3 {
    let brightest = (0..texels.len()).max_by(|a, b| texels[*a][0].total_cmp(&texels[*b][0])).unwrap();
    let height = texels.len() / width;
    let (i, j) = (brightest % width, brightest / width);
    direction_from_equirect((i as f64 + 0.5) / width as f64, (j as f64 + 0.5) / height as f64)
}

#[test]
fn panoramas_and_squares_read_back_as_environments() {
    let folder = with_environments();
    let at = |name: &str| folder.path().join(name);
    // The sun of the source: texel 100 of 32 columns.
    let sun = direction_from_equirect(4.5 / 32.0, 3.5 / 16.0);
    for (layout, out) in [("equirect", "equirect"), ("mips", "mips.exr"), ("octahedral", "octahedral")] {
        let levels: &[&str] = if layout == "mips" { &["--size", "16"] } else { &SIZE };
        done(
            folder.path(),
            &bake(&[levels, &["--out-layout", layout, "--pixel", "f32", "-o", out]].concat()),
        );
        let loaded = read(&at(out), &ReadOptions::default()).unwrap();
        let texels = loaded.environment.texels();
        if layout == "octahedral" {
            assert_eq!(loaded.environment.layout(), Layout::Octahedral { size: 16 });
        } else {
            assert_eq!(loaded.environment.layout(), Layout::Panorama { width: 32, height: 16 });
            assert!(brightest(32, texels).distance(sun) < 1e-9, "{layout}");
            assert_eq!(equirect_from_direction(sun).0, 4.5 / 32.0);
        }
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    }
    assert_eq!(tree(&at("equirect")), ["m0.exr", "m1.exr", "m2.exr", "report.json"]);
    let rough = read(&at("equirect").join("m1.exr"), &ReadOptions::default()).unwrap();
    assert_eq!(rough.environment.layout(), Layout::Panorama { width: 16, height: 8 });
    assert!(brightest(16, rough.environment.texels()).distance(sun) < 0.3);
    let report = json(&at("mips.exr.report.json"));
    assert_eq!(report["levels"].as_array().unwrap().len(), 6);
    let chain = read_chain(&at("equirect")).unwrap();
    let layouts: Vec<Layout> = chain.levels.iter().map(|level| level.layout).collect();
    assert_eq!(layouts, [16, 8, 4].map(|height| Layout::Panorama { width: 2 * height, height }));
    assert!(done(folder.path(), &["info", "equirect"]).contains("roughness"));
    // Every MIP level, by another reader.
    let image =
        read_exr().no_deep_data().all_resolution_levels().all_channels().first_valid_layer().all_attributes();
    let image = image.from_file(at("mips.exr")).unwrap();
    for channel in &image.layer_data.channel_data.list {
        let exr::prelude::Levels::Mip { level_data, .. } = &channel.sample_data else { panic!("MIP levels") };
        let counts: Vec<usize> = level_data.iter().map(exr::prelude::FlatSamples::len).collect();
        assert_eq!(counts, [32 * 16, 16 * 8, 8 * 4, 4 * 2, 2, 1]);
        assert!(level_data.iter().all(|level| level.values_as_f32().all(|v| v > 0.0 && v.is_finite())));
    }
}

#[test]
fn an_octahedral_map_with_a_border_is_read_without_it() {
    let folder = with_environments();
    let at = |name: &str| folder.path().join(name);
    for format in ["ktx2", "exr"] {
        let options = [
            "--target", "oem", "--size", "64", "--levels", "3", "--pixel", "f32", "--format", format, "-o",
            format,
        ];
        done(folder.path(), &bake(&options));
        let loaded = read(&at(format).join(format!("a_oem.{format}")), &ReadOptions::default()).unwrap();
        assert_eq!(loaded.environment.layout(), Layout::Octahedral { size: 64 }, "{}", loaded.format);
        assert!(loaded.format.contains("border 4"), "{}", loaded.format);
        done(
            folder.path(),
            &bake(&[
                "--out-layout",
                "octahedral",
                "--size",
                "64",
                "--levels",
                "1",
                "--pixel",
                "f32",
                "-o",
                "flat",
                "--force",
            ]),
        );
        let flat = read(&at("flat").join("m0.exr"), &ReadOptions::default()).unwrap();
        assert_eq!(loaded.environment.texels(), flat.environment.texels(), "{format}");
    }
}

#[test]
fn impossible_layouts_are_refused() {
    let folder = with_environments();
    for (more, words) in [
        (&["--out-layout", "cross", "--format", "ktx2"][..], "exr and hdr"),
        (&["--out-layout", "parts", "--format", "hdr"], "an exr file"),
        (&["--out-layout", "mips", "-o", "a.ktx2"], "an exr file"),
        (&["--out-layout", "equirect", "--pixel", "rgb9e5"], "f16 and f32"),
        (&["--out-layout", "strip", "--bounds"], "--bounds"),
        (&["--out-layout", "octahedral", "--irradiance", "4"], "--irradiance"),
        (&["--out-layout", "equirect", "--skybox", "4"], "--skybox"),
        (&["--out-layout", "cross", "--target", "three"], "--target"),
        (&["--target", "oem", "--size", "100", "--levels", "4"], "multiple of 8"),
        (&["--target", "oem", "--format", "dds"], "ktx2 or exr"),
        (&["--target", "babylon", "--size", "100"], "power of two"),
        (&["--target", "babylon", "--format", "dds"], "a fixed format"),
        (&["--target", "babylon", "--diffuse", "sh"], "a fixed format"),
        (&["--target", "babylon", "--irradiance", "4"], "a fixed format"),
        (&["--target", "playcanvas", "--size", "100"], "power of two"),
        (&["--target", "playcanvas", "--levels", "5"], "6 levels"),
        (&["--target", "playcanvas", "--pixel", "f32"], "a fixed format"),
        (&["--target", "gltf-ext", "--pixel", "f16"], "a fixed format"),
        (&["--target", "godot", "--levels", "3"], "one level"),
        (&["--target", "blender", "--flip", "x"], "no cube"),
    ] {
        fails(folder.path(), &bake(&[more, &["--engine", "cpu"]].concat()), 2, words);
    }
    // A MIP map goes down to one texel.
    let args = bake(&["--out-layout", "mips", "--size", "16", "--levels", "2", "-o", "short.exr"]);
    fails(folder.path(), &args, 1, "omit --levels");
    assert!(!octagloss(folder.path(), &args).status.success());
    assert_eq!(tree(folder.path()), ["a.exr", "b.exr"]);
}
