//! `octagloss query --frames`.

use super::{done, fails, with_sky};
use std::fs;

#[test]
fn frames_are_answered_by_pyramid_and_reference_alike() {
    let folder = with_sky();
    let rows = ["0,1,0,0,1,0.2,1,0,0", "1,0,0,1,0.5,0,0,0,1", "0,0,2,1,0,0.7,0,1,0", "0,1,0,0.1,-1,0,1,0,0"];
    let text = format!("nx,ny,nz,vx,vy,vz,tx,ty,tz\n{}\n", rows.join("\n"));
    fs::write(folder.path().join("frames.csv"), text).expect("writable");
    let query = |more: &[&str]| -> Vec<[f64; 3]> {
        let args = ["query", "sky.exr", "--quiet", "--frames", "frames.csv", "--roughness", "0.5"];
        let out = done(folder.path(), &[&args[..], more].concat()).out;
        let mut lines = out.lines();
        assert_eq!(lines.next(), Some("nx,ny,nz,vx,vy,vz,tx,ty,tz,r,g,b"));
        let answer = |(line, row): (&str, &&str)| {
            let values = line.strip_prefix(row).expect("the frame first")[1..].split(',');
            let values: Vec<f64> = values.map(|value| value.parse().expect("a number")).collect();
            <[f64; 3]>::try_from(values).expect("three channels")
        };
        lines.zip(&rows).map(answer).collect()
    };
    let exact = query(&["--filter", "reference"]);
    assert_eq!(exact.len(), rows.len());
    let found = query(&["--filter", "pyramid"]);
    // The last is seen from behind; the sun is a thousand times as bright as the rest.
    for (found, exact) in found[..3].as_flattened().iter().zip(exact.as_flattened()) {
        assert!((found - exact).abs() < 0.05 * exact + 0.1, "{found}, not {exact}");
    }
    // The certified bound, which is the default filter's.
    let args = ["query", "sky.exr", "--quiet", "--frames", "frames.csv", "--roughness", "0.5", "--bound"];
    let out = done(folder.path(), &[&args[..], &["--anisotropy", "0.7"]].concat()).out;
    let mut lines = out.lines();
    assert_eq!(lines.next(), Some("nx,ny,nz,vx,vy,vz,tx,ty,tz,r,g,b,bound,bound_r,bound_g,bound_b"));
    let truth = query(&["--filter", "reference", "--anisotropy", "0.7"]);
    for (line, truth) in lines.zip(truth) {
        let values: Vec<f64> =
            line.split(',').skip(9).map(|value| value.parse().expect("a number")).collect();
        for c in 0..3 {
            let (off, bound) = ((values[c] - truth[c]).abs(), values[4 + c]);
            assert!(off <= bound + 1e-5 * truth[c] && bound < 0.5 * truth[c] + 0.1, "{line}: {truth:?}");
        }
    }
    // A darker surface reflects less, and a brushed one something else.
    let dark = query(&["--filter", "reference", "--f0", "0.04"]);
    let brushed = query(&["--filter", "reference", "--anisotropy", "0.7"]);
    assert!(dark[0][0] < 0.3 * exact[0][0] && brushed[0] != exact[0]);
}

#[test]
fn frames_name_what_they_need() {
    let folder = with_sky();
    fs::write(folder.path().join("frames.csv"), "nx,ny,nz,vx,vy,vz\n0,1,0,0,1,0\n").expect("writable");
    let query =
        |more: &[&'static str]| [&["query", "sky.exr", "--quiet", "--frames", "frames.csv"], more].concat();
    fails(folder.path(), &query(&["--filter", "pyramid"]), 2, "--roughness R, R in [0, 1], is required");
    let rough = ["--roughness", "0.5"];
    fails(
        folder.path(),
        &query(&[&rough[..], &["--filter", "box"]].concat()),
        2,
        "--frames has no --filter box; use adaptive:E, pyramid or reference",
    );
    let brushed = [&rough[..], &["--filter", "reference", "--anisotropy", "0.5"]].concat();
    fails(folder.path(), &query(&brushed), 2, "--anisotropy needs tangents: columns tx,ty,tz in --frames");
    let both = [&rough[..], &["--directions", "frames.csv"]].concat();
    fails(folder.path(), &query(&both), 2, "cannot be used with");
}
