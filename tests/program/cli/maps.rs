//! `octagloss convert`.

use crate::cli::{done, fails, names, write_panorama};
use octagloss_core::files::format::Pixel;
use octagloss_core::files::io::exr::write::{Samples, exr_bytes};
use octagloss_core::files::io::{self, ReadOptions};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Remedies of reading name options that the command has.
#[test]
fn remedies_name_options_that_there_are() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    let exr = |name: &str, width: u32, height: u32, texel: [f32; 3]| {
        let texels = vec![texel; (width * height) as usize];
        let bytes = exr_bytes(width, height, Samples::Rgb(&texels), Pixel::F32, &[]).expect("valid");
        fs::write(folder.join(name), bytes).expect("writable");
    };
    exr("odd.exr", 7, 3, [1.0; 3]);
    let convert = ["convert", "odd.exr", "-o", "x.exr", "--layout", "cube"];
    fails(folder, &convert, 1, "--crop removes black bars; else resize it, then set --from");
    fails(folder, &[&convert[..], &["--size", "-1"]].concat(), 2, "'-1' for '--size <N>'");
    fails(folder, &[&convert[..], &["--border", "-1"]].concat(), 2, "'-1' for '--border <B>'");
    fails(folder, &["bake", "odd.exr", "--levels", "-3"], 2, "'-3' for '--levels <N>'");
}

#[test]
fn convert_goes_to_another_map_and_back() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    write_panorama(&folder.join("in.exr"), 64, |d| {
        [(2.0 + d.x) as f32, (2.0 + d.y) as f32, (2.0 + d.z) as f32]
    });
    for (map, size, sides) in
        [("tennis-ball", "24", (72, 48)), ("healpix", "16", (64, 48)), ("cube", "16", (96, 16))]
    {
        let file = format!("{map}.exr");
        done(folder, &["convert", "in.exr", "-o", &file, "--layout", map, "--size", size]);
        assert_eq!(sides_of(&folder.join(&file)), sides, "{map}");
        let back = format!("{map}-back.exr");
        done(folder, &["convert", &file, "--from", map, "-o", &back, "--layout", "equirect", "--size", "32"]);
        let before = io::read(&folder.join("in.exr"), &ReadOptions::default()).expect("readable");
        let after = io::read(&folder.join(&back), &ReadOptions::default()).expect("readable");
        let texels = before.environment.texels().iter().zip(after.environment.texels());
        let worst = texels.flat_map(|(a, b)| (0..3).map(move |c| (a[c] - b[c]).abs())).fold(0.0, f32::max);
        // Two means over texels of at most 0.11, of slopes up to 1.
        assert!(worst < 0.2, "{map}: {worst} off");
    }
    done(
        folder,
        &[
            "convert",
            "in.exr",
            "-o",
            "bordered.hdr",
            "--layout",
            "dual-paraboloid",
            "--size",
            "8",
            "--border",
            "2",
        ],
    );
    assert_eq!(sides_of(&folder.join("bordered.hdr")), (24, 12), "two discs of 8 texels with borders of 2");
}

/// Columns and rows of the picture in a file.
fn sides_of(path: &Path) -> (u32, u32) {
    if path.extension().is_some_and(|extension| extension == "hdr") {
        return image::image_dimensions(path).expect("readable");
    }
    let headers = exr::meta::MetaData::read_from_file(path, false).expect("readable").headers;
    (headers[0].layer_size.x() as u32, headers[0].layer_size.y() as u32)
}

#[test]
fn convert_keeps_light_or_says_how_much_it_loses() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    // Dim light, and a lamp too bright for half floats.
    write_panorama(&folder.join("in.exr"), 32, |d| [3e-9, 1.0, if d.x > 0.95 { 1e5 } else { 0.3 }]);
    let convert = |file: &str, more: &[&str]| {
        let args = ["convert", "in.exr", "-o", file, "--layout", "cube", "--size", "8"];
        done(folder, &[&args[..], more].concat()).err
    };
    let read = |file: &str| {
        let read = io::read(&folder.join(file), &ReadOptions::default()).expect("readable");
        read.environment.texels().to_vec()
    };
    let words = convert("float.exr", &[]);
    assert!(words.contains("f32") && !words.contains("warning"), "{words}");
    let kept = read("float.exr");
    assert!(kept.iter().all(|texel| (texel[0] / 3e-9 - 1.0).abs() < 1e-6), "{:?}", kept[0]);
    let words = convert("half.exr", &["--pixel", "f16"]);
    let lamps = kept.iter().filter(|texel| texel[2] > 65504.0).count();
    assert!(lamps > 0, "a lamp");
    for warning in [
        format!("warning: half.exr: {lamps} texels exceed the f16 maximum of 6.55e4 and were clamped"),
        "warning: half.exr: 384 texels have a channel of at most 3.0e-8 that became 0".to_owned(),
        "--pixel f32 keeps them".to_owned(),
    ] {
        assert!(words.contains(&warning), "{words} lacks {warning}");
    }
    let halves = read("half.exr");
    assert!(halves.iter().all(|texel| texel[0] == 0.0 && texel[2] <= 65504.0));
    // RGBE holds both, but no subnormal numbers, and not twice 1e38.
    assert!(!convert("both.hdr", &[]).contains("warning"));
    let words = convert("bright.hdr", &["--scale", "3e33"]);
    assert!(words.contains("texels exceed the rgbe maximum of 1.69e38"), "{words}");
    let words = convert("dim.hdr", &["--scale", "1e-31"]);
    assert!(words.contains("384 texels have a channel of at most 1.2e-38 that became 0 in rgbe"), "{words}");
}

#[test]
fn convert_names_what_it_cannot_do() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    write_panorama(&folder.join("in.exr"), 16, |_| [1.0; 3]);
    let convert = |more: &[&str], words: &str, code: i32| {
        fails(folder, &[&["convert", "in.exr", "-o", "out.exr"], more].concat(), code, words);
    };
    convert(&["--layout", "globe"], "globe", 2);
    convert(&["--layout", "cube", "--size", "0"], "--size", 2);
    convert(&["--layout", "cube", "--size", "4", "--border", "5"], "--border 5", 2);
    convert(&["--layout", "cube", "--from", "healpix"], "16x8 does not fit healpix, which is 4:3", 1);
    convert(&["--layout", "cube", "--pixel", "bc6h"], "--pixel bc6h is for ktx2 and dds", 2);
    let hdr = ["convert", "in.exr", "-o", "out.hdr", "--layout", "cube", "--pixel", "f16"];
    fails(folder, &hdr, 2, "--pixel cannot be combined with hdr");
    // Refused before it is allocated; the size named fits.
    convert(
        &["--layout", "rhombic-dodecahedron", "--size", "8192"],
        "--size 2432 is the largest that fits",
        1,
    );
    convert(&["--layout", "cube", "--size", "8192", "--border", "8192"], "is the largest that fits", 1);
    fails(folder, &["convert", "in.exr", "-o", "out.png", "--layout", "cube"], 2, ".exr or .hdr");
    fails(folder, &["convert", "in.exr", "-o", "in.exr", "--layout", "cube", "--force"], 2, "is an input");
    assert_eq!(names(folder), ["in.exr"]);
}
