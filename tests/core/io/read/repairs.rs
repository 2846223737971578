//! NaN, Inf and negative radiance; PNG and JPEG.

use super::{assert_texels, error_of, read, read_with};
use exr::prelude::Compression;
use octagloss_core::files::io::{self, ReadOptions};
use octagloss_fixtures::files::inputs::{Rgb, Sample, deep_png, exr_rgb, ldr, numbered};
use std::fs;

fn exr(pixels: &[Rgb]) -> Vec<u8> {
    exr_rgb((8, 4), Sample::Float, Compression::ZIP16, pixels)
}

fn sanitize() -> ReadOptions {
    ReadOptions { sanitize: true, ..ReadOptions::default() }
}

fn strict() -> ReadOptions {
    ReadOptions { strict: true, ..ReadOptions::default() }
}

#[test]
fn non_finite_values_are_named() {
    for (value, shown) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")] {
        let mut pixels = numbered(8, 4);
        pixels[2 * 8 + 5][1] = value;
        assert_eq!(
            error_of(read("a.exr", &exr(&pixels))),
            format!("a.exr: pixel (5, 2) channel G is {shown}; `sanitize` repairs NaN and Inf")
        );
    }
}

#[test]
fn sanitize_repairs_and_counts() {
    let mut pixels = numbered(8, 4);
    pixels[9][0] = f32::NAN;
    pixels[9][2] = f32::NAN;
    pixels[20][1] = f32::INFINITY;
    let loaded = read_with("a.exr", &exr(&pixels), &sanitize()).unwrap();
    let mut wanted = numbered(8, 4);
    wanted[9] = [0.0, 2.0, 0.0];
    // The greatest of the row below.
    wanted[20][1] = 4.0;
    assert_texels(loaded.environment.texels(), &wanted);
    assert_eq!((loaded.repaired.nan, loaded.repaired.infinite, loaded.repaired.negative), (2, 1, 0));
    assert_eq!(loaded.warnings, ["2 NaN values, 1 infinite values, repaired"]);
}

#[test]
fn infinity_without_finite_values_is_refused() {
    let mut pixels = vec![[1.0, f32::INFINITY, 1.0]; 32];
    let message = "a.exr: its channel G has Inf and no finite value to repair it with; render it again";
    assert_eq!(error_of(read_with("a.exr", &exr(&pixels), &sanitize())), message);
    pixels[3][1] = f32::NAN;
    assert_eq!(error_of(read_with("a.exr", &exr(&pixels), &sanitize())), message, "NaN is not finite");
    pixels[31][1] = 7.0;
    let loaded = read_with("a.exr", &exr(&pixels), &sanitize()).unwrap();
    let green: Vec<f32> = loaded.environment.texels().iter().map(|texel| texel[1]).collect();
    assert!(
        green.iter().enumerate().all(|(at, value)| *value == if at == 3 { 0.0 } else { 7.0 }),
        "{green:?}"
    );
}

#[test]
fn non_finite_faces_are_named_by_their_file() {
    let folder = tempfile::tempdir().unwrap();
    let paths: Vec<_> = (0..6).map(|k| folder.path().join(format!("{k}.exr"))).collect();
    for (k, path) in paths.iter().enumerate() {
        let mut pixels = numbered(4, 4);
        if k == 4 {
            pixels[7][0] = f32::NAN;
        }
        fs::write(path, exr_rgb((4, 4), Sample::Half, Compression::ZIP16, &pixels)).unwrap();
    }
    assert_eq!(
        error_of(io::read_faces(&paths, &ReadOptions::default())),
        format!("{}: pixel (3, 1) channel R is NaN; `sanitize` repairs NaN and Inf", paths[4].display())
    );
    assert_eq!(io::read_faces(&paths, &sanitize()).unwrap().repaired.nan, 1, "repaired");
}

/// One negative texel on the equator of a grey panorama: its share is its solid angle times its depth.
#[test]
fn negative_values_are_zeroed_counted_and_weighed() {
    let mut pixels = vec![[1.0; 3]; 32];
    pixels[8 + 3] = [-0.5; 3];
    let loaded = read("a.exr", &exr(&pixels)).unwrap();
    assert_eq!(loaded.environment.texels()[11], [0.0; 3], "set to 0");
    assert_eq!(loaded.repaired.negative, 3, "three channels");
    // Of four rows, one next to the equator: each of its texels is sin(45 degrees)/8 of the half sphere.
    let texel = std::f64::consts::FRAC_1_SQRT_2 / 16.0;
    let wanted = 0.5 * texel / (1.0 - texel);
    let share = loaded.repaired.negative_energy_share;
    assert!((share - wanted).abs() < 1e-6, "{share} for {wanted}");
    assert_eq!(loaded.warnings, ["3 negative values (2.31 % of the energy), set to 0"]);
}

/// The share is the same in every layout: everything negative on one sixth of the sphere.
#[test]
fn shares_of_cubes_and_octahedra_are_weighed_by_solid_angle() {
    let mut cube = vec![[1.0; 3]; 6 * 64];
    cube[64..128].fill([-1.0; 3]);
    let loaded = read("a.exr", &exr_rgb((8, 48), Sample::Half, Compression::ZIP16, &cube)).unwrap();
    assert!((loaded.repaired.negative_energy_share - 0.2).abs() < 1e-9, "one face of six is negative");
    // Outside the square's diamond, |u| + |v| > 1: the lower half of the sphere.
    let n = 64i32;
    let square: Vec<Rgb> = (0..n * n)
        .map(|at| {
            let (u, v) = (2 * (at % n) + 1 - n, 2 * (at / n) + 1 - n);
            if u.abs() + v.abs() > n { [-1.0; 3] } else { [1.0; 3] }
        })
        .collect();
    let loaded = read("a.exr", &exr_rgb((64, 64), Sample::Half, Compression::ZIP16, &square)).unwrap();
    let share = loaded.repaired.negative_energy_share;
    assert!((share - 1.0).abs() < 0.1, "half the sphere except the diagonal's texels: {share}");
}

#[test]
fn strict_refuses_every_repair() {
    let mut pixels = numbered(8, 4);
    assert!(read_with("a.exr", &exr(&pixels), &strict()).is_ok(), "nothing to repair");
    pixels[0][0] = -1.0;
    let text = error_of(read_with("a.exr", &exr(&pixels), &strict()));
    assert!(text.starts_with("a.exr: 1 negative values (0.0"), "{text}");
    assert!(text.ends_with("; `strict` forbids repairs, omit it to repair them"), "{text}");
    pixels[0][0] = f32::NAN;
    let both = ReadOptions { sanitize: true, ..strict() };
    assert_eq!(
        error_of(read_with("a.exr", &exr(&pixels), &both)),
        "a.exr: 1 NaN values; `strict` forbids repairs, omit it to repair them"
    );
}

/// sRGB at black, in the linear part, in the middle and at white.
const SRGB: [(u8, f32); 4] = [(0, 0.0), (10, 0.003_035_27), (128, 0.215_860_5), (255, 1.0)];

#[test]
fn png_and_jpeg_are_linearised_with_a_warning() {
    for (encoded, linear) in SRGB {
        let pixels = vec![[encoded; 3]; 128];
        for (format, name) in [(image::ImageFormat::Png, "PNG"), (image::ImageFormat::Jpeg, "JPEG")] {
            let extension = name.to_ascii_lowercase();
            let loaded = read(&format!("a.{extension}"), &ldr(16, 8, format, &pixels)).unwrap();
            let texel = loaded.environment.texels()[5];
            assert!(texel.iter().all(|value| (value - linear).abs() < 1e-6), "{name} {encoded}: {texel:?}");
            assert_eq!(
                loaded.warnings,
                [format!("a {name} is not HDR: radiance above its white is clipped")]
            );
            assert_eq!(loaded.format, format!("{name}, 8 bits a channel, sRGB"));
        }
    }
}

#[test]
fn sixteen_bit_png_keeps_its_depth_and_drops_its_alpha() {
    // 0x8080 is exactly 128/255; the next value lies between two 8-bit values.
    let pixels = [[0x8080, 0x8081, 0xffff, 0], [0x8080, 0x8081, 0xffff, 0x1234]];
    let loaded = read("a.png", &deep_png(2, 1, &pixels)).unwrap();
    let texels = loaded.environment.texels();
    assert_eq!(texels[0], texels[1], "alpha is ignored");
    assert!((texels[0][0] - SRGB[2].1).abs() < 1e-6, "{:?}", texels[0]);
    assert!(texels[0][1] > texels[0][0], "16 bits are kept");
    assert_eq!(loaded.format, "PNG, 16 bits a channel, sRGB");
}
