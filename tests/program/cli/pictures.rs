//! `--preview`: a picture of every bake, whatever its target and map.

use super::{done, fails, names, with_sky};
use image::RgbImage;
use octagloss_core::files::target::TARGETS;
use std::path::Path;

fn picture(path: &Path) -> RgbImage {
    image::open(path).expect("a picture").into_rgb8()
}

#[test]
fn every_target_has_a_picture() {
    let folder = with_sky();
    for target in &TARGETS {
        // The least size of those that need many levels.
        let size = if ["unity", "playcanvas", "pyramid"].contains(&target.name) { "64" } else { "16" };
        let args =
            ["bake", "sky.exr", "--target", target.name, "--size", size, "--preview", "p.png", "--force"];
        done(
            folder.path(),
            &[&args[..], &["-o", target.name, "--quiet", "--filter", "adaptive:0.5"]].concat(),
        );
        let sheet = picture(&folder.path().join("p.png"));
        assert!(sheet.width() >= 260 && sheet.height() > 240, "{}", target.name);
        let light = sheet.pixels().filter(|pixel| pixel.0.iter().any(|c| *c > 100)).count();
        assert!(light > 10_000, "{}: {light}", target.name);
    }
}

#[test]
fn several_targets_stand_one_below_the_other() {
    let folder = with_sky();
    let bake = |targets: &str, out: &str| {
        let args = ["bake", "sky.exr", "--target", targets, "--size", "16", "-o", out, "--preview"];
        let name = format!("{out}.png");
        let printed = done(folder.path(), &[&args[..], &[&name, "--dry-run"]].concat()).out;
        assert!(printed.contains(&format!("{name}\tpicture\n")), "{printed}");
        done(folder.path(), &[&args[..], &[&name, "--quiet"]].concat());
        picture(&folder.path().join(name))
    };
    let (three, godot) = (bake("three", "a"), bake("godot", "b"));
    let both = bake("three,godot", "c");
    assert_eq!(both.width(), three.width().max(godot.width()));
    assert_eq!(both.height(), three.height() + godot.height());
    let lower =
        image::imageops::crop_imm(&both, 0, both.height() - godot.height(), godot.width(), godot.height());
    assert_eq!(lower.to_image(), godot);
}

#[test]
fn maps_are_shown_alike() {
    let folder = with_sky();
    let bake = |layout: &str| {
        let name = format!("{layout}.png");
        let args = ["bake", "sky.exr", "--out-layout", layout, "--size", "64", "--levels", "3", "-o", layout];
        done(folder.path(), &[&args[..], &["--format", "exr", "--quiet", "--preview", &name]].concat());
        picture(&folder.path().join(name))
    };
    let cube = bake("faces");
    for layout in ["equirect", "octahedral"] {
        let other = bake(layout);
        assert_eq!(other.width(), cube.width(), "{layout}");
        // The spheres, below the title and their labels, without the faces.
        let pairs = cube.enumerate_rows().flat_map(|(_, row)| row).filter(|(_, y, _)| (92..332).contains(y));
        let off = pairs.map(|(x, y, a)| {
            let b = other.get_pixel(x, y);
            (0..3).map(|c| f64::from(a.0[c].abs_diff(b.0[c]))).sum::<f64>() / 3.0
        });
        let (sum, count) = off.fold((0.0, 0), |(sum, count), off| (sum + off, count + 1));
        assert!(sum / f64::from(count) < 6.0, "{layout}: {}", sum / f64::from(count));
    }
    fails(folder.path(), &["bake", "sky.exr", "--target", "oem", "--preview", "p.jpg"], 2, ".png");
    assert!(!names(folder.path()).contains(&"p.jpg".to_owned()));
}
