//! The line after a bake: what was written, its size, the time, a true typical error and the next step.

use super::{done, json, json_file, with_sky, write_panorama};
use octagloss_fixtures::common::sweep;
use std::fs;

/// The line that names `output`.
fn line_of(err: &str, output: &str) -> String {
    let mut lines = err.lines().filter(|line| line.contains(&format!("{output}: ")));
    let line = lines.next().unwrap_or_else(|| panic!("no line of {output}: {err}")).to_owned();
    assert_eq!(lines.next(), None, "{err}");
    line
}

#[test]
fn the_line_tells_the_size_without_pictures_and_the_next_step() {
    let folder = with_sky();
    let args = ["bake", "sky.exr", "--size", "16", "-o", "a.ktx2", "--preview", "p.png"];
    let line = line_of(&done(folder.path(), &args).err, "a.ktx2");
    let size = |name: &str| fs::metadata(folder.path().join(name)).expect("written").len();
    let bytes = size("a.ktx2") + size("a.ktx2.report.json");
    assert!(line.contains(&format!(", {:.1} kB, in ", bytes as f64 / 1e3)), "{line}, {bytes}");
    assert!(line.starts_with("octagloss: a.ktx2: cube 16, ") && !line.contains("certified"), "{line}");
    assert!(
        line.contains("; next: ") && line.ends_with("bake with --target ENGINE for an engine's own files"),
        "{line}"
    );
    #[cfg(feature = "view")]
    assert!(line.contains("octagloss view a.ktx2, or "), "{line}");

    // Panoramas are viewed from their source; a single unfiltered one has no error.
    let args = ["bake", "sky.exr", "--size", "16", "-o", "my bake", "--target"];
    let line = line_of(&done(folder.path(), &[&args[..], &["godot"]].concat()).err, "my bake");
    assert!(line.contains("files for godot, panorama 32x16, ") && !line.contains("error"), "{line}");
    assert!(line.ends_with("/docs/engines.md"), "{line}");
    #[cfg(feature = "view")]
    assert!(line.contains("octagloss view sky.exr, "), "{line}");
    let line =
        line_of(&done(folder.path(), &[&args[..], &["three,bevy", "--force"]].concat()).err, "my bake");
    assert!(line.contains("files for three, bevy, ") && line.contains("typical error at most "), "{line}");
    // What the line suggests for a target works, in a shell.
    let line = line_of(&done(folder.path(), &[&args[..], &["three", "--force"]].concat()).err, "my bake");
    #[cfg(feature = "view")]
    assert!(line.contains("octagloss view 'my bake', "), "{line}");
    assert!(done(folder.path(), &["info", "my bake"]).out.contains("levels"), "{line}");
}

#[test]
fn several_inputs_have_a_short_line_each_and_quiet_runs_none() {
    let folder = with_sky();
    fs::copy(folder.path().join("sky.exr"), folder.path().join("other.exr")).expect("copied");
    let args = ["bake", "sky.exr", "other.exr", "--size", "8", "-o", "out"];
    let err = done(folder.path(), &args).err;
    for (number, name) in [(1, "sky"), (2, "other")] {
        let line = line_of(&err, &format!("{name}.ktx2"));
        assert!(line.contains(&format!("[{number}/2] ")) && line.len() < 120, "{line}");
        assert!(line.contains(", typical error ") && !line.contains("next"), "{line}");
    }
    assert!(err.ends_with("2 baked, 0 skipped, 0 failed\n"), "{err}");
    assert_eq!(done(folder.path(), &[&args[..], &["--force", "--quiet"]].concat()).err, "");
}

#[test]
fn the_typical_error_is_that_of_delivered_look_ups() {
    let folder = with_sky();
    // Grey, so that every channel has the error of luminance: a sky, a lamp, and two small ones.
    let lamps = [([0.6, 0.7, 0.4], 0.9998), ([-0.8, 0.2, 0.5], 0.999), ([0.1, -0.3, -0.95], 0.97)];
    write_panorama(&folder.path().join("grey.exr"), 128, |d| {
        let lit = lamps.iter().filter(|(lamp, edge)| d.dot(glam::DVec3::from(*lamp).normalize()) > *edge);
        [(1.0 + 0.5 * d.y + 60.0 * lit.count() as f64) as f32; 3]
    });
    let cases: [&[&str]; 5] = [
        &[],
        &["--ladder", "filament", "--filter", "adaptive:0.02"],
        &["--filter", "pyramid", "--oem-size", "128"],
        &["--chain", "sampled", "--levels", "4"],
        &["--filter", "box"],
    ];
    for options in cases.into_iter().take(sweep(3, 5)) {
        let args = [&["bake", "grey.exr", "--size", "64", "-o", "g.ktx2", "--force"], options].concat();
        let line = line_of(&done(folder.path(), &args).err, "g.ktx2");
        let said =
            json_file(&folder.path().join("g.ktx2.report.json"))["typical_error"].as_f64().expect("measured");
        let percent: f64 =
            line.split("typical error ").nth(1).and_then(|rest| rest.split(" %").next()).map_or_else(
                || panic!("no error in {line}"),
                |number| number.parse().unwrap_or_else(|_| panic!("{number} in {line}")),
            );
        assert!((percent / 100.0 / said - 1.0).abs() < 0.15, "{line}, {said}");
        let args = ["compare", "g.ktx2", "grey.exr", "--delivered", "--json", "--quiet", "--texels", "1"];
        let measured = json(&done(folder.path(), &args).out);
        let rows = measured["delivered"]["roughnesses"].as_array().expect("rows");
        let mut errors: Vec<f64> =
            rows.iter().map(|row| row["rel_rmse"].as_f64().expect("a number")).collect();
        errors.sort_unstable_by(f64::total_cmp);
        let median = errors[errors.len() / 2];
        assert!((0.5..2.0).contains(&(said / median)), "{options:?}: {said} for {median}");
    }
}
