//! `--chain` of `bake`, its record in files, and its use by `compare`.

use super::{done, fails, octagloss, with_sky};
use octagloss::internals::chain::ChainKind;
use octagloss::internals::io::load_chain;
use serde_json::Value;
use std::fs;

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
    assert_eq!(report["chain"], "solved");
    assert!(report["levels"][1]["error_bound_max"].is_null(), "{}", report["levels"][1]);
    // Sheen and irradiance of a solved bake are sampled, and record that or nothing.
    done(at, &[&["bake", "sky.exr", "-o", "k", "--target", "khronos"][..], &small].concat());
    let of = |path: &str| load_chain(&at.join(path)).unwrap().provenance.chain;
    assert_eq!(of("k/ggx/specular.ktx2"), Some(ChainKind::Solved));
    assert_eq!(of("k/charlie/sheen.ktx2"), Some(ChainKind::Sampled));
    done(at, &["bake", "sky.exr", "-o", "b.ktx2", "--size", "32", "--levels", "4", "--quiet"]);
    assert_eq!(of("b.ktx2"), Some(ChainKind::Sampled));
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

#[test]
fn solved_chains_are_judged_by_what_they_deliver() {
    let folder = with_sky();
    let at = folder.path();
    for kind in ["sampled", "solved"] {
        let output = format!("{kind}.ktx2");
        let args =
            ["bake", "sky.exr", "-o", &output, "--size", "32", "--levels", "4", "--chain", kind, "--quiet"];
        done(at, &args);
    }
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
    assert!(text.starts_with("delivered: look-ups by the ladder linear along 20000 directions\n"), "{text}");
    done(at, &["compare", "solved.ktx2", "sky.exr", "--delivered=0.5", "--fail-above", "0.5", "--quiet"]);
    let strict =
        octagloss(at, &["compare", "solved.ktx2", "sky.exr", "--delivered=0.5", "--fail-above", "1e-6"]);
    assert!(strict.code == 1 && strict.err.contains("delivered relRMSE"), "{}", strict.err);
    fails(at, &["compare", "solved.ktx2", "sampled.ktx2", "--delivered"], 2, "both inputs are bakes");
    fails(at, &["compare", "solved.ktx2", "sky.exr", "--texels", "9"], 2, "solved chain");
    fails(at, &["compare", "solved.ktx2", "sky.exr", "--delivered=1.5"], 2, "between 0 and 1");
}
