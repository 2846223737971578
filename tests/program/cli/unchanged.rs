//! `octagloss bake --skip-unchanged`: keeps outputs that are up to date, and only those.

use crate::cli::{done, fails, json_file, names, octagloss, with_sky};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Lists every file within `folder` with its time of modification.
fn written(folder: &Path) -> Vec<(PathBuf, SystemTime)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("readable").path();
        if path.is_dir() {
            found.extend(written(&path));
        } else {
            let time = fs::metadata(&path).and_then(|metadata| metadata.modified()).expect("a time");
            found.push((path, time));
        }
    }
    found.sort();
    found
}

/// Runs `bake --skip-unchanged` with `args`; returns whether it left everything unchanged.
fn skips(folder: &Path, args: &[&str]) -> bool {
    let before = written(folder);
    let ran = done(folder, &[&["bake"], args, &["--skip-unchanged"]].concat());
    let printed = ran.err.lines().filter(|line| line.ends_with(": unchanged")).count();
    // The closing line of several inputs.
    let closing = ran.err.lines().filter(|line| line.ends_with(" failed")).count();
    let untouched = written(folder) == before;
    assert_eq!(
        untouched,
        printed > 0 && ran.err.lines().count() == printed + closing,
        "{args:?}: {}",
        ran.err
    );
    untouched
}

/// Returns the folder of `path` and its name without digits and face: faces and levels are of one kind.
fn kind_of(path: &Path) -> (PathBuf, String) {
    let name = path.file_name().expect("a file").to_string_lossy().replace(|c: char| c.is_ascii_digit(), "");
    let face =
        ["px", "nx", "py", "ny", "pz", "nz"].into_iter().find(|face| name.contains(&format!("_{face}")));
    let kind = face.map_or(name.clone(), |face| name.replace(face, "face"));
    (path.parent().expect("a folder").to_owned(), kind)
}

const SMALL: [&str; 5] = ["sky.exr", "--size", "4", "--levels", "2"];

#[test]
fn unchanged_outputs_stay_whatever_the_container() {
    let kinds: [&[&str]; 7] = [
        &["-o", "a.ktx2", "--irradiance", "2", "--bounds"],
        &["-o", "a.ktx", "--preview", "a.png"],
        &["-o", "a.dds", "--pixel", "bc6h"],
        &["-o", "a", "--format", "exr", "--bounds"],
        &["-o", "a", "--format", "hdr", "--irradiance", "2"],
        &["-o", "a", "--target", "khronos", "--filter", "adaptive:0.5"],
        &["-o", "a", "--target", "three,bevy,filament"],
    ];
    for kind in kinds {
        let folder = with_sky();
        let args = [&SMALL, kind].concat();
        assert!(!skips(folder.path(), &args), "{args:?}: nothing there yet");
        assert!(skips(folder.path(), &args), "{args:?}");
        assert!(skips(folder.path(), &[&args[..], &["--force", "--threads", "1"]].concat()), "{args:?}");
        fails(folder.path(), &[&["bake"], &args[..]].concat(), 1, "already exists");

        // Damage to any output is detected before baking. One output of each kind is damaged, then deleted,
        // and baked again.
        let outputs = written(folder.path());
        let mut kinds = BTreeSet::new();
        for (path, _) in outputs.iter().filter(|(path, _)| !path.ends_with("sky.exr")) {
            let sound = fs::read(path).expect("readable");
            fs::write(path, &sound[..sound.len() / 2]).expect("writable");
            fails(folder.path(), &[&["bake", "--skip-unchanged"], &args[..]].concat(), 1, "already exists");
            if !kinds.insert(kind_of(path)) {
                fs::write(path, sound).expect("writable");
                continue;
            }
            assert!(!skips(folder.path(), &[&args[..], &["--force"]].concat()), "{}", path.display());
            fs::remove_file(path).expect("there");
            assert!(!skips(folder.path(), &[&args[..], &["--force"]].concat()), "{}", path.display());
            if !path.to_string_lossy().ends_with("report.json") {
                assert_eq!(fs::read(path).expect("readable"), sound, "{}", path.display());
            }
        }
        assert!(kinds.len() >= 2, "{args:?}: outputs of {kinds:?}");
        assert!(skips(folder.path(), &args), "{args:?}: all as before");
    }
}

#[test]
fn changed_inputs_and_options_are_baked_again() {
    let folder = with_sky();
    let base = [&SMALL[..], &["-o", "a.ktx2", "--force"]].concat();
    assert!(!skips(folder.path(), &base) && skips(folder.path(), &base));
    let mut changes: Vec<&[&str]> = vec![
        &["--lobe", "phong"],
        &["--ladder", "filament"],
        &["--filter", "adaptive:0.02"],
        &["--filter", "box"],
        &["--filter", "box", "--scan", "hensley:4"],
        &["--pixel", "f32"],
        &["--overflow", "compress"],
        &["--oem-size", "32"],
        &["--border", "3"],
        &["--rotate-y", "10"],
        &["--mirror"],
        &["--scale", "2"],
        &["--crop"],
        &["--pad"],
        &["--pad=edge"],
        &["--skybox", "2"],
        &["--skybox", "source"],
        &["--sanitize"],
        &["--strict"],
        &["--irradiance", "2"],
        &["--bounds"],
        &["--preview", "a.png"],
    ];
    // Back to the first options, which differ from the last.
    changes.push(&[]);
    for change in changes {
        let args = [&base[..], change].concat();
        assert!(!skips(folder.path(), &args), "{change:?}");
        assert!(skips(folder.path(), &args), "{change:?}");
    }
    // Change one byte of the input, then restore and move it.
    let input = folder.path().join("sky.exr");
    let sound = fs::read(&input).expect("readable");
    let mut other = sound.clone();
    // In the last block of texels, which ZIP may store uncompressed.
    let last = other.len() - 1;
    other[last] ^= 1;
    fs::write(&input, &other).expect("writable");
    let ran = octagloss(folder.path(), &[&["bake", "--skip-unchanged"], &base[..]].concat());
    assert!(!ran.err.contains("unchanged"), "{}", ran.err);
    fs::write(&input, &sound).expect("writable");
    octagloss(folder.path(), &[&["bake"], &base[..]].concat());
    fs::create_dir(folder.path().join("moved")).expect("a folder");
    fs::rename(&input, folder.path().join("moved/sky.exr")).expect("moved");
    assert!(skips(folder.path(), &[&["moved/sky.exr"], &base[1..]].concat()));
    fails(folder.path(), &["bake", "moved/sky.exr", "--skip-unchanged", "--json"], 2, "cannot be used with");
}

#[test]
fn of_several_inputs_only_the_changed_are_baked() {
    for target in [&[][..], &["--target", "bevy"]] {
        let folder = with_sky();
        fs::copy(folder.path().join("sky.exr"), folder.path().join("b.exr")).expect("copied");
        let args = [&["b.exr"], &SMALL[..], &["-o", "out", "--force"], target].concat();
        assert!(!skips(folder.path(), &args) && skips(folder.path(), &args));
        // Replace one of them by a world with a lamp.
        crate::cli::write_panorama(&folder.path().join("b.exr"), 32, |d| {
            if d.y > 0.9 { [9.0, 8.0, 7.0] } else { [1.0; 3] }
        });
        let ran = done(folder.path(), &[&["bake", "--skip-unchanged"], &args[..]].concat());
        let lines: Vec<&str> = ran
            .err
            .lines()
            .filter(|line| !line.contains("using the CPU") && !line.contains("estimate"))
            .collect();
        assert_eq!(lines.len(), 3, "{}", ran.err);
        assert_eq!(lines[2], "octagloss: 1 baked, 1 skipped, 0 failed");
        assert!(lines.iter().any(|line| line.contains("sky") && line.ends_with(": unchanged")), "{lines:?}");
        assert!(lines.iter().any(|line| line.contains("/b") && line.contains(" s on cpu")), "{lines:?}");
    }
}

#[test]
fn a_report_has_both_hashes_and_they_are_the_inputs_and_outputs_own() {
    let folder = with_sky();
    let hashes = |out: &str, more: &[&str]| {
        done(folder.path(), &[&["bake"], &SMALL[..], &["-o", out], more].concat());
        let report = json_file(&folder.path().join(format!("{out}.report.json")));
        let hash = |key: &str| report["fingerprint"][key].as_str().expect("text").to_owned();
        (hash("request"), hash("outputs"))
    };
    let (first, again, other) =
        (hashes("a.ktx2", &[]), hashes("b.ktx2", &["--threads", "1"]), hashes("c.ktx2", &["--mirror"]));
    assert_eq!(first, again);
    assert!(first.0 != other.0 && first.1 != other.1 && first.0.len() == 64, "{first:?} {other:?}");
    assert!(names(folder.path()).contains(&"a.ktx2.report.json".to_owned()));
}
