//! `report.json` against its documentation in `docs/report.md`, and the summary line on standard error.

use crate::cli::{done, json_file, octagloss, with_sky, write_panorama};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Returns the documented keys with their types.
fn documented() -> BTreeMap<&'static str, &'static str> {
    let text = include_str!("../../docs/report.md");
    let rows = text.lines().filter_map(|line| line.strip_prefix("| `"));
    let keys: Vec<_> = rows
        .map(|row| {
            let (key, rest) = row.split_once("` | ").expect("a key and more");
            (key, rest.split_once(" | ").expect("a type and more").0)
        })
        .collect();
    let map: BTreeMap<_, _> = keys.iter().copied().collect();
    assert_eq!(map.len(), keys.len(), "no duplicate keys");
    map
}

/// Returns whether `value` has the documented type `kind`.
fn is_a(kind: &str, value: &Value) -> bool {
    if let Some(kind) = kind.strip_suffix(" or null") {
        return value.is_null() || is_a(kind, value);
    }
    if let Some(kind) = kind.strip_prefix('[').and_then(|kind| kind.strip_suffix(']')) {
        return value.as_array().is_some_and(|values| values.iter().all(|value| is_a(kind, value)));
    }
    match kind {
        "integer" => value.is_u64(),
        "number" => value.as_f64().is_some_and(f64::is_finite),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        _ => panic!("no type is called {kind}"),
    }
}

/// Checks `value` at `place` against `keys`; collects the keys it uses in `used` and returns the errors.
fn check(
    keys: &BTreeMap<&'static str, &'static str>,
    place: &str,
    value: &Value,
    used: &mut BTreeSet<String>,
) -> Vec<String> {
    if let (Some(&"[sun]"), Some(suns)) = (keys.get(place), value.as_array()) {
        used.insert(place.to_owned());
        return suns.iter().flat_map(|sun| check(keys, "sun", sun, used)).collect();
    }
    if let Some(kind) = keys.get(place)
        && (*kind != "null" || value.is_null())
    {
        used.insert(place.to_owned());
        return if is_a(kind, value) { vec![] } else { vec![format!("{place} is {value}, no {kind}")] };
    }
    match value {
        Value::Object(entries) => {
            let any = format!("{place}.*");
            let inside = |key: &str| match place {
                "" => key.to_owned(),
                _ if keys.contains_key(any.as_str()) => any.clone(),
                _ => format!("{place}.{key}"),
            };
            entries.iter().flat_map(|(key, value)| check(keys, &inside(key), value, used)).collect()
        }
        Value::Array(values) => {
            values.iter().flat_map(|value| check(keys, &format!("{place}[]"), value, used)).collect()
        }
        _ => vec![format!("{place} is not documented")],
    }
}

/// Returns reports of every kind of bake.
fn reports(folder: &Path) -> Vec<Value> {
    let small = ["--size", "8", "--levels", "3", "--quiet"];
    let bakes: [(&str, &[&str], &str); 6] = [
        ("a.ktx2", &["--extract-sun", "--sunless", "--irradiance", "2", "--bounds"], "a.ktx2.report.json"),
        ("b.ktx2", &["--filter", "box", "--overflow", "compress"], "b.ktx2.report.json"),
        ("c", &["--format", "exr", "--preview", "c.png"], "c/report.json"),
        ("d", &["--out-layout", "equirect"], "d/report.json"),
        ("e", &["--target", "khronos", "--filter", "adaptive:0.5"], "e/report.json"),
        ("f", &["--target", "three,oem", "--levels", "2"], "f/oem/report.json"),
    ];
    let bake = |(out, more, report): &(&str, &[&str], &str)| {
        let kept: &[&str] = if more.contains(&"--levels") { &["--size", "8", "--quiet"] } else { &small };
        done(folder, &[&["bake", "sky.exr", "-o", out], kept, more].concat());
        json_file(&folder.join(report))
    };
    bakes.iter().map(bake).collect()
}

#[test]
fn every_key_of_real_reports_is_documented_with_its_type_and_the_reverse() {
    let folder = with_sky();
    // Brighter than half floats can hold, to obtain the key for compressed texels.
    write_panorama(&folder.path().join("sky.exr"), 256, |d| {
        if d.z > 0.9995 { [1e8, 8e7, 6e7] } else { [0.3, 0.5, 1.0 + d.y as f32] }
    });
    let (keys, mut used) = (documented(), BTreeSet::new());
    for report in reports(folder.path()) {
        let wrong = check(&keys, "", &report, &mut used);
        assert!(wrong.is_empty(), "{wrong:?}");
        assert_eq!(report["schema_version"], octagloss_core::files::export::report::SCHEMA_VERSION);
    }
    let unused: Vec<_> = keys.keys().filter(|key| !used.contains(**key)).collect();
    assert!(unused.is_empty(), "documented and never written: {unused:?}");
    // The check detects undocumented keys and wrong types.
    let wrong =
        |text: &str| check(&keys, "", &serde_json::from_str(text).expect("JSON"), &mut BTreeSet::new()).len();
    assert_eq!(wrong(r#"{"seconds": 1.5, "oem": {"size": 64}}"#), 0);
    assert_eq!(wrong(r#"{"seconds": null}"#), 1);
    assert_eq!(wrong(r#"{"oem": {"height": 1}, "levels": [{"level": -1}], "news": true}"#), 3);
}

#[test]
fn hashes_and_sizes_are_those_of_the_files_and_options_are_filled_in() {
    let folder = with_sky();
    let args = ["bake", "sky.exr", "--size", "64", "-o", "a.ktx2", "--irradiance", "2", "--preview", "p.png"];
    done(folder.path(), &[&args[..], &["--chain", "sampled"]].concat());
    let report = json_file(&folder.path().join("a.ktx2.report.json"));
    assert!(report.get("compressed").is_none() && report.get("sheen").is_none(), "what there is none of");
    let input = fs::read(folder.path().join("sky.exr")).expect("readable");
    let file = &report["input_files"][0];
    assert_eq!(file["blake3"], blake3::hash(&input).to_hex().to_string());
    assert_eq!((&file["path"], &file["bytes"]), (&"sky.exr".into(), &input.len().into()));
    let outputs = report["outputs"].as_array().expect("outputs");
    assert_eq!(outputs.len(), 3, "{outputs:?}");
    for output in outputs {
        let path = folder.path().join(output["path"].as_str().expect("a path"));
        assert_eq!(output["bytes"], fs::metadata(&path).expect("there").len(), "{}", path.display());
    }
    let options = &report["recipe"];
    assert_eq!((&options["levels"], &options["oem_size"]), (&5.into(), &report["oem"]["size"]));
    assert_eq!((&options["out_layout"], &options["overflow"]), (&"faces".into(), &"clamp".into()));
    // Relative bounds are bounds over the mean luminance.
    let number = |value: &Value| value.as_f64().expect("a number");
    let mean = number(&report["energy"]["mean_luminance"]);
    for level in &report["levels"].as_array().expect("levels")[1..] {
        for name in ["max", "mean", "p99"] {
            let bound = number(&level[format!("error_bound_{name}").as_str()]);
            let relative = number(&level[format!("error_bound_{name}_relative").as_str()]);
            assert!(bound > 0.0 && (relative * mean / bound - 1.0).abs() < 1e-12, "{name}: {level}");
        }
        assert!(number(&level["error_bound_p99"]) <= number(&level["error_bound_max"]), "{level}");
    }
    // A folder's files, and the mean luminance of a constant sky of 2.
    write_panorama(&folder.path().join("even.exr"), 32, |_| [2.0; 3]);
    done(folder.path(), &["bake", "even.exr", "--size", "8", "--format", "exr", "-o", "b", "--quiet"]);
    let report = json_file(&folder.path().join("b/report.json"));
    assert_eq!(report["outputs"].as_array().map(Vec::len), Some(18));
    assert!((number(&report["energy"]["mean_luminance"]) - 2.0).abs() < 1e-6);
}

#[test]
fn negligible_repairs_are_counted_without_a_warning() {
    let folder = with_sky();
    // A negative value and one above 65504, both with negligible energy.
    write_panorama(&folder.path().join("bright.exr"), 64, |d| match d {
        d if d.y > 0.99 => [65_505.0; 3],
        d if d.y < -0.99 => [-1e-3; 3],
        _ => [3e4; 3],
    });
    let args = ["bake", "bright.exr", "--size", "32", "--levels", "1", "-o", "a.ktx2"];
    let ran = done(folder.path(), &args);
    assert!(!ran.err.contains("warning") && !ran.err.contains("0.00 %"), "{}", ran.err);
    let report = json_file(&folder.path().join("a.ktx2.report.json"));
    assert!(report["clamped"].as_u64() > Some(0) && report["repaired"]["negative"].as_u64() > Some(0));
    assert_eq!(report["warnings"], serde_json::json!([]));
    let share = report["clamped_energy_share"].as_f64().expect("a share");
    assert!(0.0 < share && share < 5e-5, "{share}");
    // --strict still refuses them.
    let strict = octagloss(folder.path(), &[&args[..], &["--strict", "--force"]].concat());
    assert!(strict.code == 1 && strict.err.contains("less than 0.01 % of the energy"), "{}", strict.err);
}

#[test]
fn a_window_is_the_brightest_region_and_no_sun() {
    let folder = with_sky();
    write_panorama(&folder.path().join("room.exr"), 128, |d| {
        // 0.5 sr towards +X.
        if d.x > 0.92 { [900.0, 950.0, 1000.0] } else { [0.5; 3] }
    });
    let info = |args: &[&str]| done(folder.path(), &[&["info", "room.exr"], args].concat()).out;
    let json: Value = serde_json::from_str(&info(&["--json"])).expect("JSON");
    assert!(
        json["sun"].is_null() && json["brightest_region"]["direction"][0].as_f64() > Some(0.99),
        "{json}"
    );
    let text = info(&[]);
    assert!(text.contains("sun         none\n") && text.contains("brightest"), "{text}");
    let bake = ["bake", "room.exr", "--size", "4", "-o", "a.ktx2"];
    let ran = done(folder.path(), &[&bake[..], &["--extract-sun"]].concat());
    assert!(ran.err.contains("no sun detected") && ran.err.contains("at most 0.01 sr"), "{}", ran.err);
    assert!(json_file(&folder.path().join("a.ktx2.report.json"))["sun"].is_null());
    // The sky of the other tests has a sun, despite its coarse texels.
    let sky = done(folder.path(), &["info", "sky.exr", "--json"]).out;
    let sky: Value = serde_json::from_str(&sky).expect("JSON");
    assert!(sky["sun"].is_object() && sky["brightest_region"].is_null(), "{sky}");
}

#[test]
fn the_version_lists_the_features() {
    let folder = with_sky();
    let out = done(folder.path(), &["--version"]).out;
    let mut features = "cli".to_owned();
    if cfg!(feature = "gpu") {
        features += " gpu";
    }
    if cfg!(feature = "view") {
        features += " view";
    }
    if cfg!(feature = "plot") {
        features += " plot";
    }
    assert_eq!(out, format!("octagloss {} (features: {features})\n", env!("CARGO_PKG_VERSION")));
}
