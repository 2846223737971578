//! `octagloss view --screenshot`: pictures without a window, and refusals.

use crate::cli::{done, fails, names, octagloss, with_sky};
use clap::ValueEnum;
use image::RgbImage;
use octagloss_fixtures::files::gltf::triangle;
use octagloss_gpu::direct::Method;
use octagloss_view::scene::Proxy;
use octagloss_view::{Object, Tone};
use std::fmt::{Debug, Display};
use std::fs;
use std::path::Path;
use std::str::FromStr;
use std::sync::LazyLock;

/// A quick picture: one sample per pixel over a coarse map, by the filter that compiles fastest.
const QUICK: [&str; 10] =
    ["--size", "48x32", "--samples", "1", "--oem-size", "64", "--filter", "box", "--quiet", "--roughness"];

fn view(folder: &Path, more: &[&str]) -> crate::cli::Ran {
    octagloss(folder, &[&["view", "sky.exr", "--screenshot"], more].concat())
}

#[test]
fn a_picture_is_written_whole_and_only_once() {
    let folder = with_sky();
    let folder = folder.path();
    let picture = |name: &str, roughness: &str| {
        done(folder, &[&["view", "sky.exr", "--screenshot", name], &QUICK[..], &[roughness]].concat());
        image::open(folder.join(name)).expect("a picture").to_rgb8()
    };
    let first = picture("a.png", "0.4");
    assert_eq!(first.dimensions(), (48, 32));
    assert_ne!(first, picture("b.png", "0.6"));
    let before = fs::read(folder.join("a.png")).expect("readable");
    let again = view(folder, &[&["a.png"], &QUICK[..], &["0.9"]].concat());
    assert_eq!(again.code, 1);
    assert!(again.err.contains("--force"), "{}", again.err);
    assert_eq!(fs::read(folder.join("a.png")).expect("readable"), before);
}

/// The debug view `show` of the sky in a picture of `size`.
fn debug_view(show: &str, size: &str) -> RgbImage {
    let folder = with_sky();
    let args = ["view", "sky.exr", "--show", show, "--exposure", "0", "--screenshot", "a.png"];
    let quick = QUICK.map(|word| if word == "48x32" { size } else { word });
    done(folder.path(), &[&args[..], &quick, &["0"]].concat());
    image::open(folder.path().join("a.png")).expect("a picture").to_rgb8()
}

/// Map and table, large enough for a legend.
static MAP_AND_TABLE: LazyLock<[RgbImage; 2]> =
    LazyLock::new(|| ["oem", "sat"].map(|show| debug_view(show, "480x270")));

/// The table's first texel is that of the map, and its last the mean of all.
#[test]
fn map_and_table_are_shown() {
    let [oem, sat] = &*MAP_AND_TABLE;
    // The square as high as the picture, in its middle.
    let at = |picture: &RgbImage, x: u32, y: u32| picture.get_pixel(x, y).0.map(i32::from);
    assert_eq!((at(oem, 440, 27), at(sat, 440, 27)), ([0; 3], [0; 3]));
    let off = |a: [i32; 3], b: [i32; 3]| (0..3).map(|c| (a[c] - b[c]).abs()).max();
    assert!(off(at(oem, 105, 0), at(sat, 105, 0)) <= Some(1), "the first texel");
    assert!(off(at(sat, 374, 269), at(oem, 374, 269)) > Some(10), "the last is no texel");
    assert_ne!(oem, sat);
}

/// A plate of the legend's paper in the lower left corner of a debug view, if there is room.
#[test]
fn debug_views_have_a_legend() {
    // Inside the plate's outline, 12 pixels from both edges.
    let corner = |picture: &RgbImage| picture.get_pixel(12 + 5, picture.height() - 12 - 5).0;
    assert_eq!(MAP_AND_TABLE.each_ref().map(corner), [[255; 3]; 2]);
    assert_ne!(corner(&debug_view("oem", "479x270")), [255; 3]);
}

#[test]
fn what_cannot_be_shown_is_a_usage_error_and_bad_files_are_named() {
    let folder = with_sky();
    let folder = folder.path();
    fs::write(folder.join("bad.obj"), "v 0 0 0\n").expect("writable");
    fs::write(folder.join("bad.hdr"), "no picture").expect("writable");
    let usage: [(&[&str], &str); 15] = [
        (&["--exposure", "bright"], "auto or a number"),
        (&["--exposure", "41"], "from -40 to 40 EV"),
        (&["--mesh-root", "."], "--mesh"),
        (&["--paint", "gold", "--mesh", "bad.obj"], "file or plain"),
        (&["--roughness", "1.5"], "between 0 and 1"),
        (&["--filter", "fitted:4"], "use pyramid"),
        (&["--anisotropy", "0.5", "--filter", "pyramid"], "are for --filter reflect"),
        (&["--clearcoat", "1.5"], "1.5"),
        (&["--direction", "30"], "--anisotropy"),
        (&["--filter", "reference"], "box, pyramid, reflect, levels or adaptive"),
        (&["--metal", "1,2"], "three numbers"),
        (&["--size", "0x10"], "WxH"),
        (&["--distance", "0.5"], "--distance"),
        (&["--oem-size", "100"], "power of two"),
        (&["--object", "row", "--mesh", "bad.obj"], "cannot be used with"),
    ];
    for (args, words) in usage {
        fails(folder, &[&["view", "sky.exr", "--screenshot", "x.png"], args].concat(), 2, words);
    }
    fails(folder, &["view", "bad.hdr", "--screenshot", "x.png"], 1, "bad.hdr");
    fails(folder, &["view", "none.exr", "--screenshot", "x.png"], 1, "none.exr");
    fails(folder, &["view", "sky.exr", "--screenshot", "x.png", "--mesh", "bad.obj"], 1, "bad.obj");
    fails(folder, &["view", "sky.exr", "--screenshot", "x.png", "--adapter", "no such"], 1, "no such");
    assert!(!names(folder).contains(&"x.png".to_owned()));
}

#[test]
fn a_mesh_that_names_other_files_is_refused_before_anything_is_drawn() {
    let folder = with_sky();
    let folder = folder.path();
    let mut json = triangle(&[0; 42]);
    for (uri, words) in [("../b.bin", "--mesh-root"), ("/dev/zero", "absolute"), ("none.bin", "none.bin")] {
        json["buffers"][0]["uri"] = uri.into();
        fs::write(folder.join("bad.gltf"), json.to_string()).expect("writable");
        fails(folder, &["view", "sky.exr", "--screenshot", "x.png", "--mesh", "bad.gltf"], 1, words);
    }
    let below = ["view", "sky.exr", "--screenshot", "x.png", "--mesh", "bad.gltf", "--mesh-root", "none"];
    fails(folder, &below, 1, "none");
    assert!(!names(folder).contains(&"x.png".to_owned()));
}

#[test]
fn a_bake_is_shown_by_its_own_levels() {
    let folder = with_sky();
    let folder = folder.path();
    let base =
        ["bake", "sky.exr", "--size", "16", "--levels", "3", "--engine", "cpu", "--quiet", "-o", "b.ktx2"];
    done(folder, &base);
    let picture = |name: &str, input: &str, more: &[&str]| {
        let common =
            ["--size", "24x16", "--samples", "1", "--oem-size", "64", "--quiet", "--roughness", "0.5"];
        done(folder, &[&["view", input, "--screenshot", name], &common[..], more].concat());
        image::open(folder.join(name)).expect("a picture").to_rgb8()
    };
    let own = picture("own.png", "b.ktx2", &[]);
    assert_eq!(own, picture("levels.png", "b.ktx2", &["--filter", "levels"]), "the default");
    // Level 0 alone is an environment, which another filter blurs.
    assert_ne!(own, picture("box.png", "b.ktx2", &["--filter", "box"]));
}

#[test]
fn names_are_those_of_the_options() {
    fn check<T: ValueEnum + Display + FromStr<Err = String> + PartialEq + Debug>() {
        for value in T::value_variants() {
            let option = value.to_possible_value().expect("not skipped");
            assert_eq!(option.get_name(), value.to_string());
            assert_eq!(option.get_name().parse::<T>().as_ref(), Ok(value));
        }
    }
    check::<Method>();
    check::<Object>();
    check::<Proxy>();
    check::<Tone>();
    assert_eq!("cone".parse::<Proxy>(), Err("must be none, box or sphere".to_owned()));
}
