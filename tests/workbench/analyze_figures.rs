//! `octagloss-workbench analyze --plot`.

use crate::analyze::{done, fails};
use octagloss_fixtures::program::{names, write_panorama};
use std::fs;
use tempfile::TempDir;

#[test]
fn figures_are_drawn_into_a_folder() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    let plot = ["analyze", "--plot", "-o", "figures"];
    let run = |more: &[&str]| done(folder, &[&plot, more].concat());
    let ran = run(&["--figure", "layout-cube", "--figure", "border", "--size", "4", "--border", "4"]);
    let files = ["border.png", "border.svg", "layout-cube.png", "layout-cube.svg"];
    assert_eq!(names(&folder.join("figures")), files);
    assert!(files.iter().all(|name| ran.err.contains(name)), "{}", ran.err);

    // New figures are added; existing ones stay unless --force is given.
    let svg = fs::read_to_string(folder.join("figures/border.svg")).expect("there");
    fails(folder, &[&plot[..], &["--figure", "border"]].concat(), 1, "--force");
    assert_eq!(fs::read_to_string(folder.join("figures/border.svg")).expect("there"), svg);
    run(&["--figure", "border", "--force", "-q"]);
    assert_ne!(fs::read_to_string(folder.join("figures/border.svg")).expect("there"), svg);
    write_panorama(&folder.join("in.exr"), 16, |_| [1.0; 3]);
    run(&["--figure", "panorama", "--map", "cube", "--panorama", "in.exr"]);
    let svg = fs::read_to_string(folder.join("figures/panorama-cube.svg")).expect("there");
    assert!(svg.contains("in.exr resampled"), "the caption names the file");
    assert_eq!(names(&folder.join("figures")).len(), 6);
}

#[test]
fn what_cannot_be_drawn_is_named_and_nothing_written() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    let plot = |more: &[&str], words: &str, code: i32| {
        fails(folder, &[&["analyze", "--plot", "-o", "figures"], more].concat(), code, words);
    };
    plot(&["--map", "globe"], "globe", 2);
    plot(&["--figure", "globe"], "unknown figure \"globe\"; choose one of solid-angle, anisotropy", 2);
    plot(&["--figure", "seam", "--map", "cube"], "--figure seam is not a figure of --map cube", 2);
    plot(&["--figure", "seam", "--size", "3"], "--size 3 is for the figure border, which is not drawn", 2);
    plot(&["--figure", "seam", "--border", "3"], "--border 3 is for the figure border", 2);
    plot(&["--figure", "seam", "--panorama", "a.exr"], "--panorama a.exr is for the figure panorama", 2);
    plot(&["--size", "0"], "--size 0 must be 1 to 12 texels", 2);
    plot(&["--size", "4", "--border", "5"], "--border 5 exceeds the map's side of 4 texels", 2);
    plot(&["--panorama", "none.exr"], "none.exr", 1);
    plot(&["--table"], "--table", 2);
    fails(folder, &["analyze", "--plot"], 2, "--output");
    fails(folder, &["analyze", "--map", "cube", "--table"], 2, "--plot");
    fails(folder, &["analyze", "--plot", "-o", "figures.png"], 2, "use -o figures");
    #[cfg(target_os = "linux")]
    {
        fails(
            folder,
            &["analyze", "--plot", "-o", "/proc/foo"],
            1,
            "/proc/foo: is in /proc, where the system",
        );
        fails(folder, &["analyze", "--plot", "-o", "none/foo"], 1, "its folder none");
    }
    assert_eq!(names(folder), [""; 0]);
}
