//! `octagloss info` describes every file that the program writes.

use crate::cli::{done, fails, json, octagloss, with_sky, with_slashes};
use octagloss_core::files::target::TARGETS;
use octagloss_core::sphere::registry::MAPS;
use std::fs;
use std::path::{Path, PathBuf};

/// All files below `folder`.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("readable").path();
        if path.is_dir() { files(&path, found) } else { found.push(path) }
    }
}

/// Writes what options of `bake` can: containers, pixels, layouts, targets, and the files beside them.
fn bake_all(at: &Path) {
    let small = ["bake", "sky.exr", "--size", "8", "--levels", "2", "--quiet", "--filter", "adaptive:0.5"];
    let bake = |more: &[&str]| done(at, &[&small[..], more].concat());
    for container in ["ktx2", "ktx", "dds"] {
        for pixel in ["f16", "f32", "rgb9e5", "r11g11b10f", "bc6h"] {
            if (container, pixel) != ("ktx", "bc6h") {
                bake(&["-o", &format!("{pixel}.{container}"), "--pixel", pixel]);
            }
        }
    }
    for layout in
        ["faces", "cross", "cross-vertical", "strip", "strip-vertical", "equirect", "octahedral", "parts"]
    {
        for format in ["exr", "hdr"] {
            if (layout, format) != ("parts", "hdr") {
                let suffix = if layout == "parts" { "." } else { "-" };
                let out = format!("{layout}{suffix}{format}");
                bake(&["-o", &out, "--out-layout", layout, "--format", format]);
            }
        }
    }
    let beside = ["--irradiance", "2", "--skybox", "4", "--bounds", "--extract-sun", "--sunless"];
    bake(&[&["-o", "all.ktx2", "--preview", "all.png"], &beside[..]].concat());
    bake(&[&["-o", "all", "--format", "exr"], &beside[..]].concat());
    done(at, &["bake", "sky.exr", "-o", "mips.exr", "--out-layout", "mips", "--size", "4", "--quiet"]);
    let targets = TARGETS.map(|target| target.name).join(",");
    let presets = ["bake", "sky.exr", "-o", "targets", "--target", &targets, "--size", "64", "--skybox", "4"];
    done(at, &[&presets[..], &["--quiet", "--filter", "adaptive:0.5"]].concat());
}

#[test]
fn info_describes_every_file_that_the_program_writes() {
    let folder = with_sky();
    let at = folder.path();
    bake_all(at);
    for map in &MAPS {
        for (border, extension) in [("0", "exr"), ("1", "hdr")] {
            let out = format!("{}.{extension}", map.name);
            let args = ["convert", "sky.exr", "-o", &out, "--layout", map.name, "--size", "8", "--quiet"];
            done(at, &[&args[..], &["--border", border]].concat());
        }
    }
    done(at, &["synth", "sky", "-o", "synth.hdr", "--quiet"]);
    for args in [&["-o", "dfg.ktx2"][..], &["-o", "dfg.exr"], &["-o", "charlie.ktx2", "--charlie"]] {
        done(at, &[&["dfg", "--size", "8", "--quiet"], args].concat());
    }
    fs::write(at.join("up.csv"), "x,y,z\n0,1,0\n1,0,0\n").expect("writable");
    for out in ["query.npy", "query.csv"] {
        let args = ["query", "sky.exr", "--directions", "up.csv", "--roughness", "0.5", "-o", out, "--quiet"];
        done(at, &args);
    }

    let mut all = Vec::new();
    files(at, &mut all);
    assert!(all.len() > 150, "{} files", all.len());
    let all: Vec<&str> = all.iter().map(|path| path.to_str().expect("a name")).collect();
    // One line of JSON and one text for each, in one run.
    let text = done(at, &[&["info"], &all[..]].concat()).out;
    let lines = done(at, &[&["info", "--json"], &all[..]].concat()).out;
    assert_eq!(lines.lines().count(), all.len());
    for (path, line) in all.iter().zip(lines.lines()) {
        let info = json(line);
        let printed = with_slashes(path);
        assert_eq!(info["input"], printed);
        assert!(text.contains(&format!("{printed}: ")), "{path}");
        assert_eq!(info["bytes"].as_u64(), Some(fs::metadata(path).expect("a file").len()), "{path}");
        let kind = info["kind"].as_str().expect("a kind");
        let is_light =
            ["exr", "hdr", "ktx", "ktx2", "dds"].iter().any(|name| path.ends_with(&format!(".{name}")));
        assert!(
            ["environment", "bake", "map"].contains(&kind)
                || !is_light
                || path.contains("pyramid")
                || path.contains("dfg")
                || path.contains("charlie.ktx2")
                || path.contains("unreal"),
            "{path}: {line}"
        );
    }
    let words = |path: &str| done(at, &["info", path]).out;
    assert!(words("healpix.exr").contains("HEALPix, 768 texels"), "{}", words("healpix.exr"));
    assert!(words("query.npy").contains("2 rows of 3 numbers"));
    assert!(words("targets/babylon").contains("faces of 64, 7 levels"));
    assert!(words("targets/gltf-ext").contains("3 levels of light"));
    assert!(words("targets/pyramid").contains("KTX2 pyramid, RGBA16F, 2 levels"));
    assert!(words("targets/pyramid/sky_pyramid.json").contains("light of a pyramid"));
    assert!(words("targets/playcanvas").contains("128x128"));
    assert!(words("all.ktx2.report.json").contains("report of a bake of sky.exr"));
    assert!(words("targets/three/report.json").contains("for three"));
    assert!(words("dfg.ktx2").contains("R16G16_SFLOAT"));
}

#[test]
fn info_still_fails_on_files_that_nothing_reads() {
    let folder = with_sky();
    let at = folder.path();
    fs::write(at.join("noise.exr"), [7; 100]).expect("writable");
    fs::write(at.join("noise.json"), "{\"levels\": ").expect("writable");
    fs::write(at.join("noise.env"), b"\x86\x16\x87\x96\xf6\xd6\x96\x36{}\0").expect("writable");
    let sky = fs::read(at.join("sky.exr")).expect("readable");
    fs::write(at.join("cut.exr"), &sky[..sky.len() / 2]).expect("writable");
    for name in ["noise.exr", "noise.json", "noise.env", "cut.exr", "none.exr"] {
        fails(at, &["info", name], 1, name);
    }
    // An error of one does not hide the others.
    let ran = octagloss(at, &["info", "none.exr", "sky.exr", "--json"]);
    assert_eq!((ran.code, ran.out.lines().count()), (1, 1), "{}", ran.err);
}
