//! The contact sheet is oriented correctly and seamless; the error picture marks the wrong texel.

use crate::support::common::Random;
use crate::support::written::chain;
use glam::DVec3;
use octagloss::Layout;
use octagloss::internals::chain::{Chain, Level};
use octagloss::internals::chain_lookup::SeamlessLevel;
use octagloss::internals::environment::Rgb;
use octagloss::internals::image::exposure::Exposure;
use octagloss::internals::image::preview::{contact_sheet, error_picture};
use octagloss::internals::sphere::cube::{self, Face};

fn level_of(size: u32, roughness: f64, radiance: impl Fn(Face, DVec3) -> Rgb) -> Level {
    let mut texels = Vec::new();
    for face in Face::ALL {
        for j in 0..size {
            for i in 0..size {
                texels.push(radiance(face, cube::direction_from_texel(face, size, i, j)));
            }
        }
    }
    Level::cube(size, roughness, texels)
}

// Seamless look-up

#[test]
fn a_texel_centre_gives_its_texel() {
    for size in [1, 2, 5, 16] {
        let level = &chain(size, 1, false).levels[0];
        let seamless = SeamlessLevel::new(level);
        for face in Face::ALL {
            for j in 0..size {
                for i in 0..size {
                    let found = seamless.radiance(cube::direction_from_texel(face, size, i, j) * 3.0);
                    let expected = level.face(face)[(j * size + i) as usize].map(f64::from);
                    for c in 0..3 {
                        assert!((found[c] - expected[c]).abs() < 1e-5 * 32.0, "{found:?} {expected:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn texel_centres_of_other_maps_give_their_texels_and_folds_are_continuous() {
    let mut random = Random::new(3);
    for layout in [Layout::Panorama { width: 12, height: 6 }, Layout::Octahedral { size: 7 }] {
        let texels: Vec<Rgb> = (0..layout.texel_count()).map(|k| [k as f32, 1.0, (k * k) as f32]).collect();
        let level = Level { layout, roughness: 0.5, texels, bounds: None };
        let seamless = SeamlessLevel::new(&level);
        let (width, height) = layout.sides();
        for (i, j) in (0..height).flat_map(|j| (0..width).map(move |i| (i, j))) {
            let found = seamless.radiance(layout.direction_from_texel(0, i, j) * 0.5);
            let expected = level.texels[(j * width + i) as usize].map(f64::from);
            assert!(
                (0..3).all(|c| (found[c] - expected[c]).abs() < 1e-6),
                "{layout:?} ({i}, {j}): {found:?}"
            );
        }
        // Steps of 1e-7 across the folds y = 0 and -y, and across the seam of a panorama at -x.
        for _ in 0..2000 {
            // Away from the poles, where a small step turns far.
            let a = random.between(0.2, 1.0);
            let b = random.between(0.2, 1.0) * if random.unit() < 0.5 { -1.0 } else { 1.0 };
            for (inside, outside) in [
                (DVec3::new(b, -a, 1e-7), DVec3::new(b, -a, -1e-7)),
                (DVec3::new(1e-7, -a, b), DVec3::new(-1e-7, -a, b)),
                (DVec3::new(-a, b, 1e-7), DVec3::new(-a, b, -1e-7)),
                (DVec3::new(b, 1e-7, a), DVec3::new(b, -1e-7, a)),
            ] {
                let jump = |c: usize| (seamless.radiance(inside)[c] - seamless.radiance(outside)[c]).abs();
                let far = (0..3).map(jump).fold(0.0, f64::max);
                assert!(far < 0.05, "{layout:?} {inside}: {far}");
            }
        }
    }
}

#[test]
fn look_up_is_continuous_across_every_edge_and_corner() {
    // Random texels: any wrong neighbour causes a jump.
    for size in [1, 2, 3, 8] {
        let chain = chain(size, 1, false);
        let seamless = SeamlessLevel::new(&chain.levels[0]);
        let mut compared = 0;
        for face in Face::ALL {
            for k in 0..=200 {
                let along = f64::from(k) / 100.0 - 1.0;
                for (s, t) in [(1.0, along), (-1.0, along), (along, 1.0), (along, -1.0)] {
                    let edge = cube::cube_point(face, s, t);
                    let inside = cube::cube_point(face, s * (1.0 - 1e-7), t * (1.0 - 1e-7));
                    let outside = edge + (edge - inside);
                    let (a, b) = (seamless.radiance(inside), seamless.radiance(outside));
                    for c in 0..3 {
                        assert!((a[c] - b[c]).abs() < 1e-3, "{face:?} {s} {t}: {a:?} {b:?}");
                    }
                    compared += 1;
                }
            }
        }
        assert_eq!(compared, 6 * 4 * 201);
    }
}

// Contact sheet

/// Position and edge of the first sphere's tile, in pixels.
const TILE_AT: (u32, u32) = (10, 36);
const TILE: u32 = 240;

/// Returns a world with one colour per face.
fn coloured() -> Chain {
    let colour = |face: Face| {
        [
            [1.0, 0.05, 0.05],
            [0.05, 1.0, 1.0],
            [0.05, 1.0, 0.05],
            [1.0, 0.05, 1.0],
            [0.05, 0.05, 1.0],
            [1.0, 1.0, 0.05],
        ][face.index()]
    };
    Chain { levels: (0..3).map(|l| level_of(8 >> l, f64::from(l) / 2.0, |face, _| colour(face))).collect() }
}

/// Returns which channels of the pixel at `x`, `y` in [-1, 1] of the first tile are bright.
fn channels(sheet: &image::RgbImage, x: f64, y: f64) -> [bool; 3] {
    let at = |origin: u32, v: f64| origin + ((v + 1.0) / 2.0 * f64::from(TILE)) as u32;
    sheet.get_pixel(at(TILE_AT.0, x), at(TILE_AT.1, y)).0.map(|c| c > 128)
}

#[test]
fn the_sphere_reflects_what_is_behind_the_camera_and_to_its_sides() {
    let sheet = contact_sheet(&coloured(), Exposure::Auto).unwrap();
    // The camera looks along +X with +Z to its right: the backdrop is +X, the middle of the ball -X.
    assert_eq!(channels(&sheet, -0.95, -0.95), [true, false, false], "+X behind the sphere");
    assert_eq!(channels(&sheet, 0.0, 0.0), [false, true, true], "-X in its middle");
    assert_eq!(channels(&sheet, 0.55, 0.0), [false, false, true], "+Z to the right");
    assert_eq!(channels(&sheet, -0.55, 0.0), [true, true, false], "-Z to the left");
    assert_eq!(channels(&sheet, 0.0, -0.55), [false, true, false], "+Y above");
    assert_eq!(channels(&sheet, 0.0, 0.55), [true, false, true], "-Y below");
}

#[test]
fn swapped_faces_are_visible_in_the_sheet() {
    let mut chain = coloured();
    let area = 64;
    let (before, after) = chain.levels[0].texels.split_at_mut(5 * area);
    before[4 * area..].swap_with_slice(&mut after[..area]);
    let sheet = contact_sheet(&chain, Exposure::Auto).unwrap();
    assert_eq!(channels(&sheet, 0.55, 0.0), [true, true, false], "-Z where +Z was");
}

#[test]
fn a_smooth_world_has_no_seams_in_the_sphere() {
    let smooth = |_, d: DVec3| {
        let value = |axis: DVec3| (1.0 + 0.8 * d.dot(axis)) as f32;
        [value(DVec3::X), value(DVec3::Y), value(DVec3::Z)]
    };
    let chain = Chain { levels: vec![level_of(32, 0.0, smooth)] };
    let sheet = contact_sheet(&chain, Exposure::Auto).unwrap();
    // Within 0.8 of the ball's radius, neighbours differ by no more than the reflection's slope.
    let mut compared = 0;
    for y in 0..TILE - 1 {
        for x in 0..TILE - 1 {
            let (dx, dy) = (f64::from(x) - 119.5, f64::from(y) - 119.5);
            if dx.hypot(dy) < 0.8 * 95.0 {
                let at = |x: u32, y: u32| sheet.get_pixel(TILE_AT.0 + x, TILE_AT.1 + y).0;
                for next in [at(x + 1, y), at(x, y + 1)] {
                    for c in 0..3 {
                        let step = i32::from(next[c]) - i32::from(at(x, y)[c]);
                        assert!(step.abs() <= 6, "a step of {step} at {x}, {y}");
                    }
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 10_000);
}

#[test]
fn the_sheet_is_the_same_whatever_the_thread_count_and_has_room_for_every_level() {
    let chain = chain(64, 7, false);
    let drawn = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| contact_sheet(&chain, Exposure::Auto)).unwrap()
    };
    let one = drawn(1);
    assert_eq!((one.width(), one.height()), (5 * 250 + 10, 2 * 466 + 10));
    assert!(drawn(3) == one);
    assert!(contact_sheet(&Chain { levels: vec![] }, Exposure::Auto).is_err());
}

#[test]
fn black_and_extreme_worlds_can_be_drawn() {
    for radiance in [0.0, 1e-30, f32::MAX] {
        let chain = Chain { levels: vec![level_of(4, 0.0, |_, _| [radiance; 3])] };
        contact_sheet(&chain, Exposure::Auto).unwrap();
        error_picture(&chain.levels[0], &chain.levels[0]).unwrap();
    }
}

// Error picture

#[test]
fn the_error_picture_shows_one_wrong_texel_where_it_is() {
    let reference = &chain(8, 1, false).levels[0];
    let black = |level: &Level| {
        let picture = error_picture(level, reference).unwrap();
        // Faces of 96 pixels from (10, 10) on; +Z is at column 1, row 1.
        let at = |x: u32, y: u32| picture.get_pixel(10 + 96 + x * 12 + 6, 10 + 96 + y * 12 + 6).0 == [0; 3];
        (0..64).filter(|k| !at(k % 8, k / 8)).collect::<Vec<_>>()
    };
    assert!(black(reference).is_empty(), "without errors, no pixel is black");
    let mut wrong = reference.clone();
    wrong.texels[4 * 64 + 19][1] *= 1.5;
    assert_eq!(black(&wrong), [19]);
    assert!(error_picture(reference, &chain(4, 1, false).levels[0]).is_err());
}

#[test]
fn larger_errors_are_lighter() {
    let reference = level_of(1, 0.0, |_, _| [1.0; 3]);
    let lightness = |error: f32| {
        let level = level_of(1, 0.0, |_, _| [1.0 + error; 3]);
        let picture = error_picture(&level, &reference).unwrap();
        let [r, g, b] = picture.get_pixel(150, 150).0.map(|c| f64::from(c).powf(2.2));
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let steps: Vec<f64> = [0.0, 2e-4, 1e-3, 5e-3, 2e-2, 0.1, 0.3, 0.9].map(lightness).to_vec();
    assert!(steps.windows(2).all(|pair| pair[1] > pair[0]), "{steps:?}");
}

#[test]
fn exposure_is_automatic_or_a_number() {
    let chain = chain(4, 1, false);
    let automatic = octagloss::internals::image::exposure::of_level(&chain.levels[0]);
    let sheet = |exposure| contact_sheet(&chain, exposure).expect("a picture");
    assert_eq!(sheet(Exposure::Auto), sheet(Exposure::Ev(automatic)));
    assert_ne!(sheet(Exposure::Auto), sheet(Exposure::Ev(automatic - 2.0)));
}
