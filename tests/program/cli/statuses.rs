//! Exit statuses and counts: usage is 2, what is missing is 1.

use crate::cli::{done, fails, json, json_file, octagloss, with_sky, write_panorama};
use std::fs;
use std::thread;
use std::time::Duration;
use tempfile::TempDir;

#[test]
fn what_is_missing_is_a_failure_and_not_usage() {
    let folder = with_sky();
    let at = folder.path();
    fs::create_dir(at.join("empty")).expect("a folder");
    fs::write(at.join("up.csv"), "x,y,z\n0,1,0\n").expect("writable");
    let query = ["--directions", "up.csv", "--roughness", "0.5"];
    for (args, words) in [
        (&["bake", "none.exr", "-o", "a.ktx2"][..], "none.exr"),
        (&["bake", "none*.exr", "-o", "out"], "none*.exr: matches no readable file"),
        (&["bake", "empty", "-o", "out"], "empty: holds no readable file"),
        (&["bake", "none*.exr", "-o", "out", "--dry-run"], "none*.exr"),
        (&["bake", "none*.exr", "-o", "a.ktx2", "--layout", "faces"], "none*.exr"),
        (&["convert", "none.exr", "-o", "a.exr", "--layout", "cube"], "none.exr"),
        (&["info", "none.exr"], "none.exr"),
        (&["compare", "none.ktx2", "sky.exr"], "none.ktx2"),
        (&["bench", "none.exr", "--size", "64", "--runs", "1"], "none.exr"),
        (&[&["query", "none.exr"][..], &query].concat(), "none.exr"),
        (&["query", "sky.exr", "--directions", "none.csv", "--roughness", "0.5"], "none.csv"),
        #[cfg(feature = "view")]
        (&["view", "none.exr", "--screenshot", "a.png"], "none.exr"),
        #[cfg(feature = "view")]
        (&["view", "--scene", "none.glb", "--screenshot", "a.png"], "none.glb"),
        #[cfg(feature = "view")]
        (&["view", "--mesh", "none.glb", "--screenshot", "a.png"], "none.glb"),
    ] {
        fails(at, args, 1, words);
    }
    for usage in [
        &["bake", "sky.exr", "--rotate-y", "1e300"][..],
        &["convert", "sky.exr", "-o", "a.exr", "--layout", "cube", "--rotate-y=-1e7"],
        &["info", "sky.exr", "--rotate-y", "nan"],
        &["bench", "sky.exr", "--direct"],
        &["bake", "sky.exr", "--target", "unity", "--levels", "5"],
        #[cfg(feature = "view")]
        &["view", "--turn", "1e300"],
        #[cfg(feature = "view")]
        &["view", "--yaw", "1e300"],
        #[cfg(feature = "view")]
        &["view", "--pitch", "91"],
        #[cfg(feature = "view")]
        &["view", "--distance", "1e300"],
        #[cfg(feature = "view")]
        &["view", "--angle", "180"],
        #[cfg(feature = "view")]
        &["view", "--scene", "--scene-time", "1e300"],
    ] {
        let ran = octagloss(at, usage);
        assert_eq!(ran.code, 2, "{usage:?}: {}", ran.err);
        assert!(
            usage[0] == "bench"
                || usage.contains(&"--target")
                || ran.err.contains("between")
                || ran.err.contains("must be 0 to"),
            "{}",
            ran.err
        );
    }
}

#[test]
fn patterns_without_matches_do_not_stop_the_others() {
    let folder = with_sky();
    let small = ["--size", "4", "--levels", "1", "-o", "out"];
    let ran = octagloss(folder.path(), &[&["bake", "none*", "sky.exr"], &small[..]].concat());
    assert_eq!(ran.code, 1, "{}", ran.err);
    assert!(ran.err.contains("1 baked, 0 skipped, 1 failed"), "{}", ran.err);
    assert!(folder.path().join("out/sky.ktx2").is_file());
}

#[test]
fn dry_runs_count_and_list_what_fails() {
    let folder = with_sky();
    let at = folder.path();
    fs::write(at.join("bad.exr"), "not an image").expect("writable");
    let args = ["bake", "sky.exr", "bad.exr", "none*", "-o", "out", "--size", "4", "--dry-run"];
    let ran = octagloss(at, &args);
    assert_eq!(ran.code, 1);
    assert!(ran.err.contains("1 to bake, 0 to skip, 2 failed"), "{}", ran.err);
    let ran = octagloss(at, &[&args[..], &["--json"]].concat());
    let lines: Vec<_> = ran.out.lines().map(json).collect();
    assert_eq!(lines.len(), 3, "{}", ran.out);
    for line in &lines {
        let input = line["input"].as_str().expect("an input");
        let error = line["error"].as_str().unwrap_or_default();
        assert_eq!(line["files"].is_array(), input == "sky.exr", "{line}");
        assert_eq!(error.contains(input), input != "sky.exr", "{line}");
    }
    assert!(!octagloss(at, &[&args[..], &["--quiet"]].concat()).err.contains("to bake"));
}

#[test]
fn edited_reports_are_changes() {
    let folder = with_sky();
    let at = folder.path();
    let single =
        ["bake", "sky.exr", "-o", "a.ktx2", "--size", "4", "--levels", "2", "--skip-unchanged", "--force"];
    let target = [
        "bake",
        "sky.exr",
        "-o",
        "b",
        "--target",
        "three,bevy",
        "--size",
        "16",
        "--skip-unchanged",
        "--force",
    ];
    for (args, report) in [(&single[..], "a.ktx2.report.json"), (&target, "b/bevy/report.json")] {
        assert!(!done(at, args).err.contains("unchanged"), "{report}");
        assert!(done(at, args).err.contains("unchanged"), "{report}");
        let path = at.join(report);
        let sound = fs::read_to_string(&path).expect("a report");
        let own =
            serde_json::from_str::<serde_json::Value>(&sound).expect("JSON")["fingerprint"]["report"].clone();
        let own = own.as_str().expect("a hash").to_owned();
        // Of all but the times, which differ between equal runs.
        for edited in [
            sound.replacen("sky.exr", "sea.exr", 1),
            sound.replacen('\n', "\n\n", 1),
            sound.clone() + " ",
            sound.replace(&own, &"0".repeat(64)),
            sound.replace(&own, &own.replace(|c: char| c.is_ascii_digit(), "7")),
        ] {
            assert_ne!(edited, sound, "{report}");
            fs::write(&path, edited).expect("writable");
            assert!(!done(at, args).err.contains("unchanged"), "{report}: an edit went unseen");
            assert!(done(at, args).err.contains("unchanged"), "{report}: baked again");
        }
    }
    // A printed report has no hash of its own.
    let printed =
        done(at, &["bake", "sky.exr", "-o", "c.ktx2", "--size", "4", "--levels", "1", "--json"]).out;
    assert!(json(&printed)["fingerprint"]["report"].is_null(), "{printed}");
}

#[test]
fn benches_time_an_input_as_often_as_asked() {
    let folder = with_sky();
    let at = folder.path();
    let bench =
        |args: &[&str]| json(&done(at, &[&["bench", "--size", "64", "--engine", "cpu"], args].concat()).out);
    let own = bench(&["--runs", "2"]);
    assert!(own["input"].is_null());
    assert_eq!((own["runs"].as_u64(), own["bake"]["source_width"].as_u64()), (Some(2), Some(64)));
    let given = bench(&["--runs", "1", "sky.exr", "--threads", "1"]);
    assert_eq!(given["input"].as_str(), Some("sky.exr"));
    assert_eq!(given["bake"]["source_width"].as_u64(), Some(32));
    assert!(given["oem"]["one"]["median_seconds"].as_f64().expect("a time") > 0.0);
    fails(at, &["bench", "sky.exr", "sky.exr"], 2, "one environment is needed");
}

/// Commands in the README are run in the checkout: what they write must not look like a change of it.
#[test]
fn git_ignores_what_the_readmes_commands_write() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let ignored = fs::read_to_string(root.join(".gitignore")).expect("a list");
    let patterns: Vec<_> =
        ignored.lines().filter_map(|line| glob::Pattern::new(line.strip_prefix('/')?).ok()).collect();
    let readme = fs::read_to_string(root.join("README.md")).expect("the README");
    let mut outputs = Vec::new();
    for line in readme.lines().filter(|line| line.contains("octagloss") || line.contains("cargo run")) {
        let words: Vec<&str> = line.split_whitespace().collect();
        for pair in words.windows(2).filter(|pair| ["-o", "--preview", ">"].contains(&pair[0])) {
            outputs.push(pair[1]);
            if pair[1].ends_with(".ktx2") {
                outputs.push("sky.ktx2.report.json");
            }
        }
    }
    assert!(outputs.contains(&"sky.ktx2") && outputs.contains(&"baked"), "{outputs:?}");
    for output in outputs {
        assert!(patterns.iter().any(|pattern| pattern.matches(output)), "{output} is not in .gitignore");
    }
}

/// Whatever the moment, the report describes the light that was baked, or the bake fails.
#[test]
fn inputs_that_change_during_a_bake_are_told_or_baked_whole() {
    let folder = TempDir::new().expect("a temporary folder");
    let (path, other) = (folder.path().join("a.exr"), folder.path().join("b.exr"));
    write_panorama(&path, 512, |_| [1.0; 3]);
    write_panorama(&other, 512, |_| [4.0; 3]);
    let contents = [&path, &other].map(|path| fs::read(path).expect("written"));
    for milliseconds in [0, 3, 6, 10, 15, 25] {
        fs::write(&path, &contents[0]).expect("writable");
        let ran = thread::scope(|scope| {
            scope.spawn(|| {
                thread::sleep(Duration::from_millis(milliseconds));
                fs::write(&path, &contents[1]).expect("writable");
            });
            octagloss(
                folder.path(),
                &["bake", "a.exr", "--size", "8", "--levels", "3", "--force", "-o", "a.ktx2"],
            )
        });
        if ran.code != 0 {
            let words = ["changed while it was read; run again", "truncated", "the file is empty"];
            assert!(ran.code == 1 && words.iter().any(|words| ran.err.contains(words)), "{}", ran.err);
            continue;
        }
        let report = json_file(&folder.path().join("a.ktx2.report.json"));
        let mean = report["energy"]["mean_luminance"].as_f64().expect("a number");
        let baked = [1.0, 4.0].iter().position(|whole| (mean - whole).abs() < 1e-6);
        let hash = blake3::hash(&contents[baked.expect("one of both, whole")]).to_hex().to_string();
        assert_eq!(report["input_files"][0]["blake3"], *hash, "after {milliseconds} ms");
    }
}
