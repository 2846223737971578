//! `--chain` of `bake`, its record in files, and its use by `compare`.

use super::{done, fails, json_file, octagloss, with_sky};
use octagloss_core::files::io::load_chain;
use octagloss_core::light::chain::ChainKind;
use octagloss_fixtures::common::sweep;
use serde_json::Value;
use std::fs;
use std::path::Path;

#[test]
fn files_and_reports_name_the_chain() {
    let folder = with_sky();
    let at = folder.path();
    let small = ["--size", "32", "--levels", "4", "--chain", "solved", "--quiet"];
    for output in ["a.ktx2", "a.ktx", "a.dds", "a.exr"] {
        let layout: &[&str] = if output.ends_with("exr") { &["--out-layout", "parts"] } else { &[] };
        done(at, &[&["bake", "sky.exr", "-o", output][..], &small, layout].concat());
        assert_eq!(
            load_chain(&at.join(output)).unwrap().provenance.chain,
            Some(ChainKind::Solved),
            "{output}"
        );
    }
    done(at, &[&["bake", "sky.exr", "-o", "levels", "--format", "exr"][..], &small].concat());
    assert_eq!(load_chain(&at.join("levels")).unwrap().provenance.chain, Some(ChainKind::Solved));
    let report: Value = serde_json::from_slice(&fs::read(at.join("levels/report.json")).unwrap()).unwrap();
    assert_eq!(report["recipe"]["chain"], "solved");
    assert!(report["levels"][1]["error_bound_max"].is_null(), "{}", report["levels"][1]);
    // Sheen and irradiance of a solved bake are sampled, and record that or nothing.
    let sheen = ["bake", "sky.exr", "-o", "k", "--target", "khronos", "--filter", "adaptive:0.5"];
    done(at, &[&sheen[..], &small].concat());
    let of = |path: &str| load_chain(&at.join(path)).unwrap().provenance.chain;
    assert_eq!(of("k/ggx/specular.ktx2"), Some(ChainKind::Solved));
    assert_eq!(of("k/charlie/sheen.ktx2"), Some(ChainKind::Sampled));
    done(at, &["bake", "sky.exr", "-o", "b.ktx2", "--size", "32", "--levels", "4", "--quiet"]);
    assert_eq!(of("b.ktx2"), Some(ChainKind::Mixed));
}

#[test]
fn chains_that_cannot_be_solved_are_usage_errors() {
    let folder = with_sky();
    let refused = |args: &[&str], words: &str| {
        let all = [&["bake", "sky.exr", "--chain", "solved", "--size", "16"], args].concat();
        fails(folder.path(), &all, 2, words);
    };
    refused(&["--bounds"], "--bounds");
    refused(&["--lobe", "phong"], "--chain solved is for cubes of the lobe ggx");
    refused(&["--lobe", "cosine"], "--chain solved is for cubes of the lobe ggx");
    refused(&["--out-layout", "equirect"], "--chain solved is for cubes of the lobe ggx");
    refused(&["--target", "oem"], "--chain solved is for cubes of the lobe ggx");
    done(folder.path(), &["bake", "sky.exr", "--bounds", "--size", "16", "--quiet"]);
}

#[test]
fn costly_ladders_and_levels_are_warned_about() {
    let folder = with_sky();
    let warned = |args: &[&str]| {
        let out = format!("out{}", args.concat());
        let small = ["bake", "sky.exr", "-o", &out, "--size", "64"];
        let fast = ["--filter", "box", "--oem-size", "16"];
        done(folder.path(), &[&small[..], &fast, args].concat()).err.contains("off by estimate")
    };
    // Defaults, choices near them, and one level, which is not looked up by roughness.
    for fine in
        [&[][..], &["--levels", "5"], &["--levels", "1"], &["--target", "three", "--ladder", "filament"]]
    {
        assert!(!warned(fine), "{fine:?}");
    }
    // One texel at roughness 1, no level between mirror and 1, and a renderer that expects more levels.
    for costly in [&["--levels", "7"][..], &["--levels", "2"], &["--target", "filament", "--levels", "2"]] {
        assert!(warned(costly), "{costly:?}");
    }
    // Only GGX was measured.
    assert!(!warned(&["--levels", "7", "--lobe", "phong"]));
    let bake = ["bake", "sky.exr", "-o", "a.ktx2", "--size", "32", "--levels", "6", "--quiet"];
    done(folder.path(), &bake);
    let report = json_file(&folder.path().join("a.ktx2.report.json"));
    let warnings = report["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|warning| warning.as_str().unwrap().contains("--levels")), "{warnings:?}");
}

#[test]
fn unchanged_bakes_are_those_of_the_same_chain() {
    let folder = with_sky();
    let run = |kind: &str| {
        let args = [
            "bake",
            "sky.exr",
            "-o",
            "u.ktx2",
            "--size",
            "16",
            "--levels",
            "3",
            "--skip-unchanged",
            "--force",
        ];
        octagloss(folder.path(), &[&args[..], &["--chain", kind]].concat()).err
    };
    assert!(!run("solved").contains("unchanged"));
    assert!(run("solved").contains("unchanged"));
    assert!(!run("sampled").contains("unchanged"));
}

/// Bakes sampled.ktx2 and solved.ktx2 in `folder`.
fn bake_both(folder: &Path, size: &[&str]) {
    for kind in ["sampled", "solved"] {
        let output = format!("{kind}.ktx2");
        done(folder, &[&["bake", "sky.exr", "-o", &output, "--chain", kind, "--quiet"], size].concat());
    }
}

#[test]
fn solved_chains_are_judged_by_what_they_deliver() {
    let folder = with_sky();
    let at = folder.path();
    bake_both(at, &["--size", "32", "--levels", "4"]);
    let json = |args: &[&str]| -> Value {
        let all = [&["compare"], args, &["sky.exr", "--json", "--quiet"]].concat();
        serde_json::from_str(&done(at, &all).out).unwrap()
    };
    let solved = json(&["solved.ktx2"]);
    assert_eq!((&solved["chain"], solved["levels"].as_array().unwrap().len()), (&Value::from("solved"), 0));
    let figures = solved["delivered"]["roughnesses"].as_array().unwrap();
    assert_eq!((&solved["delivered"]["ladder"], figures.is_empty()), (&Value::from("linear"), false));
    let sampled = json(&["sampled.ktx2", "--texels", "6", "--delivered=0.5,0.8"]);
    assert_eq!(sampled["chain"], "sampled");
    assert!(!sampled["levels"].as_array().unwrap().is_empty());
    let rmse = |value: &Value, k: usize| value["delivered"]["roughnesses"][k]["rel_rmse"].as_f64().unwrap();
    let other = json(&["solved.ktx2", "--delivered=0.5,0.8"]);
    assert!(rmse(&other, 0) < rmse(&sampled, 0), "{other} {sampled}");
    assert!(json(&["sampled.ktx2", "--texels", "6"]).get("delivered").is_none());

    let text = done(at, &["compare", "solved.ktx2", "sky.exr", "--delivered=0.5", "--quiet"]).out;
    assert!(text.contains("delivered: look-ups by the ladder linear along 20000 directions\n"), "{text}");
    done(at, &["compare", "solved.ktx2", "sky.exr", "--delivered=0.5", "--fail-above", "0.5", "--quiet"]);
    let strict =
        octagloss(at, &["compare", "solved.ktx2", "sky.exr", "--delivered=0.5", "--fail-above", "1e-6"]);
    assert!(
        strict.code == 1 && strict.err.contains("at roughness 0.5000 is above 0.000001"),
        "{}",
        strict.err
    );
    fails(at, &["compare", "solved.ktx2", "sampled.ktx2", "--delivered"], 2, "both inputs are bakes");
    fails(at, &["compare", "solved.ktx2", "sky.exr", "--texels", "9"], 2, "solved chain");
    fails(at, &["compare", "solved.ktx2", "sky.exr", "--delivered=1.5"], 2, "between 0 and 1");
}

#[test]
fn chains_of_every_map_are_measured() {
    let folder = with_sky();
    let at = folder.path();
    for layout in ["equirect", "octahedral", "faces"] {
        let args =
            ["bake", "sky.exr", "-o", layout, "--out-layout", layout, "--format", "exr", "--size", "32"];
        let sampled =
            ["--levels", "4", "--chain", "sampled", "--pixel", "f32", "--rotate-y", "40", "--quiet"];
        done(at, &[&args[..], &sampled].concat());
        let args = ["compare", layout, "sky.exr", "--json", "--quiet", "--texels", "60"];
        // Look-ups at 20,000 directions take seconds; those of cubes have tests of their own.
        let is_tried = sweep(&["octahedral"][..], &["octahedral", "equirect"]).contains(&layout);
        let delivered: &[&str] = if is_tried { &["--delivered=0.9"] } else { &[] };
        let found: Value = serde_json::from_str(&done(at, &[&args[..], delivered].concat()).out).unwrap();
        let levels = found["levels"].as_array().unwrap();
        assert_eq!(found["delivered"].is_null(), delivered.is_empty(), "{found}");
        // The lobe of the second is narrower than two texels of the source.
        assert_eq!(levels.len(), 2, "{layout}: {found}");
        for level in levels {
            let error = level["rel_rmse"].as_f64().unwrap();
            assert!(error < 0.02, "{layout}: {level}");
            assert_eq!(level["worst"]["face"].is_null(), layout != "faces", "{level}");
        }
        for error in found["delivered"]["roughnesses"].as_array().into_iter().flatten() {
            // The octahedral square of the last level has 16 texels.
            assert!(error["rel_rmse"].as_f64().unwrap() < 0.3, "{layout}: {error}");
        }
        // The wrong world is far off.
        let turned = done(at, &[&args[..], &["--rotate-y", "-140"]].concat()).out;
        let turned: Value = serde_json::from_str(&turned).unwrap();
        assert!(turned["levels"][0]["rel_rmse"].as_f64().unwrap() > 0.1, "{layout}: {turned}");
        done(at, &["compare", layout, layout, "--fail-above", "0", "--quiet"]);
        assert!(done(at, &["info", layout]).out.contains("roughness"), "{layout}");
    }
    fails(at, &["compare", "equirect", "octahedral"], 1, "a panorama of 32");
    fails(at, &["compare", "equirect", "sky.exr", "--picture", "a.png"], 2, "--picture shows cubes");
}

#[test]
fn folders_of_cmgen_are_measured() {
    let folder = with_sky();
    let at = folder.path();
    let args = ["bake", "sky.exr", "-o", "ours", "--out-layout", "faces", "--format", "hdr", "--size", "64"];
    let ladder = ["--levels", "3", "--ladder", "filament", "--rotate-y", "-90", "--quiet"];
    done(at, &[&args[..], &ladder].concat());
    // cmgen writes the same names, without any of our lines.
    fs::create_dir(at.join("theirs")).unwrap();
    for entry in fs::read_dir(at.join("ours")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "hdr") {
            let bytes = fs::read(&path).unwrap();
            let end = bytes.windows(2).position(|pair| pair == b"\n\n").unwrap();
            let header = String::from_utf8(bytes[..end].to_vec()).unwrap();
            let plain: Vec<&str> = header.lines().filter(|line| !line.starts_with("octagloss")).collect();
            assert!(plain.len() < header.lines().count(), "{header}");
            let plain = [plain.join("\n").as_bytes(), &bytes[end..]].concat();
            fs::write(at.join("theirs").join(path.file_name().unwrap()), plain).unwrap();
        }
    }
    let json = |path: &str| -> (Value, String) {
        let ran =
            octagloss(at, &["compare", path, "sky.exr", "--delivered=0.6,0.9", "--json", "--texels", "20"]);
        assert_eq!(ran.code, 0, "{}", ran.err);
        (serde_json::from_str(&ran.out).unwrap(), ran.err)
    };
    let ((ours, _), (theirs, warnings)) = (json("ours"), json("theirs"));
    assert_eq!((&ours["levels"], &ours["delivered"]), (&theirs["levels"], &theirs["delivered"]));
    assert!(
        warnings.contains("theirs: neither a report nor roughness in its files; assuming cmgen's 3 levels")
    );
    // Theirs does not record that nothing was done to the light.
    let pair =
        done(at, &["compare", "ours", "theirs", "sky.exr", "--delivered=0.6", "--json", "--quiet"]).out;
    let pair: Value = serde_json::from_str(&pair).unwrap();
    let relative = |k: usize| &pair["bakes"][k]["delivered"]["roughnesses"];
    assert!(relative(0).is_array() && relative(0) == relative(1), "{pair}");
    // Six faces alone are a source.
    for level in [1, 2] {
        for face in ["px", "nx", "py", "ny", "pz", "nz"] {
            fs::remove_file(at.join(format!("theirs/m{level}_{face}.hdr"))).unwrap();
        }
    }
    fails(at, &["compare", "theirs", "sky.exr"], 1, "theirs");
}

#[test]
fn ktx_files_of_cmgen_are_measured() {
    let folder = with_sky();
    let at = folder.path();
    let args = ["bake", "sky.exr", "-o", "ours", "--target", "filament", "--size", "64", "--levels", "3"];
    done(at, &[&args[..], &["--rotate-y", "-90", "--quiet"]].concat());
    // cmgen writes the same file without our keys.
    let own = fs::read(at.join("ours/sky_ibl.ktx")).unwrap();
    let mut bytes = own.clone();
    while let Some(found) = bytes.windows(9).position(|word| word == b"octagloss") {
        bytes[found..found + 9].copy_from_slice(b"othertool");
    }
    assert_ne!(bytes, own);
    fs::write(at.join("theirs.ktx"), &bytes).unwrap();
    let json = |path: &str| -> (Value, String) {
        let ran =
            octagloss(at, &["compare", path, "sky.exr", "--delivered=0.6,0.9", "--json", "--texels", "20"]);
        assert_eq!(ran.code, 0, "{}", ran.err);
        (serde_json::from_str(&ran.out).unwrap(), ran.err)
    };
    let ((ours, _), (theirs, warnings)) = (json("ours"), json("theirs.ktx"));
    assert_eq!((&ours["levels"], &ours["delivered"]), (&theirs["levels"], &theirs["delivered"]));
    assert!(warnings.contains("assuming cmgen's 3 levels"), "{warnings}");
    // A file without cmgen's harmonics could be anyone's.
    let key = bytes.windows(3).position(|word| word == b"sh\0").unwrap();
    bytes[key] = b'x';
    fs::write(at.join("theirs.ktx"), &bytes).unwrap();
    fails(at, &["compare", "theirs.ktx", "sky.exr"], 1, "it has no roughness of its levels");
}

#[test]
fn charts_show_several_bakes() {
    let folder = with_sky();
    let at = folder.path();
    bake_both(at, &["--size", "16", "--levels", "3"]);
    let both = ["compare", "sampled.ktx2", "sky.exr", "--delivered=0.6,0.8,1", "--overlay", "solved.ktx2"];
    let text = done(at, &[&both[..], &["--texels", "6"]].concat()).out;
    for name in ["sampled.ktx2", "solved.ktx2"] {
        assert!(text.contains(&format!("{name}: look-ups by the ladder linear")), "{text}");
    }
    let found: Value =
        serde_json::from_str(&done(at, &[&both[..], &["--texels", "6", "--json"]].concat()).out).unwrap();
    assert_eq!(found["overlays"][0]["bake"], "solved.ktx2");
    let of = |value: &Value| value["roughnesses"][1]["rel_rmse"].as_f64().unwrap();
    assert_ne!(of(&found["delivered"]), of(&found["overlays"][0]["delivered"]));
    let alone = ["compare", "sampled.ktx2", "sky.exr", "--texels", "6", "--overlay", "solved.ktx2"];
    fails(at, &alone, 2, "--delivered");
    fails(at, &[&both[..], &["--overlay", "sky.exr"]].concat(), 1, "sky.exr: not a bake");

    let chart = |path: &str, more: &[&str]| {
        octagloss(at, &[&both[..], &["--texels", "6", "--chart", path], more].concat())
    };
    if cfg!(feature = "plot") {
        assert_eq!(chart("c.svg", &[]).code, 0);
        let drawn = fs::read_to_string(at.join("c.svg")).unwrap();
        for words in
            ["perceptual roughness", "relative RMS error", "sampled.ktx2 (linear)", "solved.ktx2 (linear)"]
        {
            assert!(drawn.contains(words), "{words} is not in the chart");
        }
        assert!(chart("c.svg", &[]).err.contains("exists"), "{}", chart("c.svg", &[]).err);
        assert_eq!((chart("c.svg", &["--force"]).code, chart("c.png", &[]).code), (0, 0));
        assert!(fs::read(at.join("c.png")).unwrap().starts_with(b"\x89PNG"));
        assert!(chart("c.gif", &[]).code == 2 && chart("solved.ktx2", &["--force"]).code == 2);
    } else {
        let ran = chart("c.svg", &[]);
        assert!(ran.code == 2 && ran.err.contains("--features plot"), "{}", ran.err);
    }
}
