//! Environment to OEM: each source texel's energy arrives completely and in the right place.

use glam::{DVec2, DVec3};
use octagloss_core::cpu::reparameterise::oem_from_environment;
use octagloss_core::geometry::footprints::footprints_over;
use octagloss_core::light::environment::{Environment, Layout, Rgb};
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::sphere::{cube, equirect, octahedral};
use octagloss_fixtures::common::{Look, Random, environment, landmarks, sweep, texels};
use std::f64::consts::PI;

const SUN: f32 = 1e6;

/// Greatest relative error of total energy, per channel.
const ENERGY: f64 = 1e-4;

fn oem_of(environment: &Environment, inner: u32, border: u32) -> Oem {
    oem_from_environment(environment, OemSize { inner, border }).expect("an OEM of moderate size")
}

/// Returns the texel of `layout` that contains `direction`.
fn texel_towards(layout: Layout, direction: DVec3) -> usize {
    let place = |t: f64, n: u32| ((t * f64::from(n)) as usize).min(n as usize - 1);
    match layout {
        Layout::Panorama { width, height } => {
            let (u, v) = equirect::equirect_from_direction(direction);
            place(v, height) * width as usize + place(u, width)
        }
        Layout::Cube { size } => {
            let (face, s, t) = cube::cube_from_direction(direction);
            let n = size as usize;
            (face.index() * n + place((t + 1.0) / 2.0, size)) * n + place((s + 1.0) / 2.0, size)
        }
        Layout::Octahedral { size } => {
            let uv = (octahedral::oct_from_direction(direction) + 1.0) / 2.0;
            place(uv.y, size) * size as usize + place(uv.x, size)
        }
    }
}

fn solid_angle(layout: Layout, texel: usize) -> f64 {
    let texel = texel as u32;
    match layout {
        Layout::Panorama { width, height } => equirect::texel_solid_angle(width, height, texel / width),
        Layout::Cube { size } => cube::texel_solid_angle(size, texel % size, texel / size % size),
        Layout::Octahedral { size } => octahedral::texel_solid_angle(size, texel % size, texel / size),
    }
}

/// Returns every texel that touches a pole, edge midpoint, fold edge, face centre or corner, and some on
/// folds in between.
fn places_of_interest(layout: Layout) -> Vec<usize> {
    let mut places = Vec::new();
    let fold =
        |t: f64| [DVec3::new(t, 0.0, 1.0 - t), DVec3::new(t, t - 1.0, 0.0), DVec3::new(0.0, 1.0 - t, -t)];
    for place in landmarks().into_iter().chain([0.1, 0.37, 0.81].into_iter().flat_map(fold)) {
        for nudge in [DVec3::ZERO, DVec3::new(1e-4, 2e-4, -3e-4), DVec3::new(-3e-4, -1e-4, 2e-4)] {
            places.push(texel_towards(layout, (place + nudge).normalize()));
        }
    }
    places.sort_unstable();
    places.dedup();
    places
}

/// Returns a black environment with a sun in each channel.
fn three_suns(layout: Layout, suns: [usize; 3]) -> Environment {
    let mut texels = vec![[0.0; 3]; layout.texel_count()];
    for (channel, sun) in suns.into_iter().enumerate() {
        texels[sun][channel] = SUN;
    }
    environment(layout, texels)
}

/// Returns the greatest relative error of a channel's energy.
fn energy_error(totals: [f64; 3], layout: Layout, suns: [usize; 3]) -> f64 {
    (0..3)
        .map(|c| (totals[c] / (f64::from(SUN) * solid_angle(layout, suns[c])) - 1.0).abs())
        .fold(0.0, f64::max)
}

/// Calls `check` with triples that cover all of `places`.
fn for_each_triple(places: &[usize], mut check: impl FnMut([usize; 3])) {
    assert!(!places.is_empty(), "places to put suns");
    for triple in places.chunks(3) {
        check(std::array::from_fn(|k| triple[k % triple.len()]));
    }
}

fn rgb_totals(oem: &Oem) -> [f64; 3] {
    let [r, g, b, _] = oem.totals();
    [r, g, b]
}

#[test]
fn a_sun_arrives_whole_wherever_it_stands() {
    let layouts = [
        (Layout::Panorama { width: 512, height: 256 }, 512),
        (Layout::Cube { size: 128 }, 256),
        (Layout::Octahedral { size: 128 }, 192),
    ];
    for (layout, inner) in layouts {
        for_each_triple(&places_of_interest(layout), |suns| {
            let totals = rgb_totals(&oem_of(&three_suns(layout, suns), inner, 0));
            let error = energy_error(totals, layout, suns);
            assert!(error <= ENERGY, "{layout:?} {suns:?}: off by {error:e}");
        });
    }
}

#[test]
fn a_sun_arrives_whole_in_odd_and_tiny_squares() {
    let layouts = [
        Layout::Panorama { width: 32, height: 16 },
        Layout::Panorama { width: 7, height: 3 },
        Layout::Cube { size: 8 },
        Layout::Cube { size: 5 },
        Layout::Octahedral { size: 16 },
        Layout::Octahedral { size: 9 },
    ];
    // Two dozen positions, at a stride prime to the rows.
    let everywhere =
        |layout: Layout| (0..layout.texel_count()).step_by(1 + layout.texel_count() / 24).collect::<Vec<_>>();
    let fine = Layout::Panorama { width: 512, height: 256 };
    let cases = layouts
        .map(|layout| (layout, everywhere(layout)))
        .into_iter()
        .chain([(fine, places_of_interest(fine))]);
    for (layout, places) in cases {
        let few = layout == fine && sweep(true, false);
        for inner in [1, 2, 3, 5, 17].into_iter().step_by(if few { 4 } else { 1 }) {
            for_each_triple(&places, |suns| {
                let totals = rgb_totals(&oem_of(&three_suns(layout, suns), inner, 0));
                let error = energy_error(totals, layout, suns);
                assert!(error <= ENERGY, "{layout:?} to {inner}, {suns:?}: off by {error:e}");
            });
        }
    }
}

#[test]
fn a_sun_of_an_8k_panorama_arrives_whole() {
    let layout = Layout::Panorama { width: 8192, height: 4096 };
    // Two poles, an edge midpoint, a fold edge, a face centre, and next to the seam.
    let suns = [
        [DVec3::Y, DVec3::NEG_Y, DVec3::X],
        [DVec3::new(0.3, 0.0, -0.7), DVec3::ONE, DVec3::new(-1.0, 0.0, 1e-5)],
    ];
    for directions in suns {
        let suns = directions.map(|d| texel_towards(layout, d.normalize()));
        let environment = three_suns(layout, suns);
        let error = energy_error(rgb_totals(&oem_of(&environment, 512, 0)), layout, suns);
        assert!(error <= ENERGY, "{suns:?}: off by {error:e}");
        // Level 0 of the bake, within 1e-3.
        let size = 256;
        let cube = footprints_over(&environment, Layout::Cube { size }).expect("a cube of moderate size");
        let error = energy_error(cube_totals(&cube, size), layout, suns);
        assert!(error <= 1e-3, "level 0, {suns:?}: off by {error:e}");
    }
}

fn cube_totals(cube: &[Rgb], size: u32) -> [f64; 3] {
    assert_eq!(cube.len(), 6 * (size * size) as usize);
    let mut totals = [0.0; 3];
    for (k, texel) in cube.iter().enumerate() {
        let k = k as u32;
        let w = cube::texel_solid_angle(size, k % size, k / size % size);
        for (total, value) in totals.iter_mut().zip(texel) {
            *total += w * f64::from(*value);
        }
    }
    totals
}

#[test]
fn a_missing_share_of_a_sun_is_detected() {
    let layout = Layout::Panorama { width: 512, height: 256 };
    let suns = [texel_towards(layout, DVec3::X); 3];
    let totals = rgb_totals(&oem_of(&three_suns(layout, suns), 64, 0));
    let mut short = totals;
    short[1] *= 1.0 - 2.0 * ENERGY;
    assert!(energy_error(totals, layout, suns) <= ENERGY && energy_error(short, layout, suns) > ENERGY);
}

const SMALL_LAYOUTS: [Layout; 7] = [
    Layout::Panorama { width: 64, height: 32 },
    Layout::Panorama { width: 5, height: 3 },
    Layout::Cube { size: 1 },
    Layout::Cube { size: 7 },
    Layout::Cube { size: 16 },
    Layout::Octahedral { size: 3 },
    Layout::Octahedral { size: 32 },
];

/// Returns whether every texel's radiance is `constant`, within the rounding of two float32 divisions and a
/// product.
fn is_constant(oem: &Oem, constant: Rgb) -> bool {
    let n = oem.size().inner;
    (0..n * n).all(|k| {
        let radiance = oem.radiance(k % n, k / n);
        (0..3).all(|c| (radiance[c] / constant[c] - 1.0).abs() <= 4.0 * f32::EPSILON)
    })
}

#[test]
fn a_constant_stays_one() {
    let constant = [0.1, 1.0, 3e4];
    for layout in SMALL_LAYOUTS {
        let environment = environment(layout, vec![constant; layout.texel_count()]);
        for inner in [1, 2, 3, 5, 17, 32, 64, 100] {
            let oem = oem_of(&environment, inner, 0);
            assert!(is_constant(&oem, constant), "{layout:?} to {inner}");
            let whole = oem.totals()[3];
            // Float32 weights, each rounded by 2^-24 of itself.
            assert!((whole / (4.0 * PI) - 1.0).abs() < 1e-7, "{layout:?} to {inner}: {whole}");
        }
    }
    let mut square = oem_of(&environment(SMALL_LAYOUTS[0], vec![constant; 2048]), 8, 0).texels().to_vec();
    square[9][1] *= 1.0 + 8.0 * f32::EPSILON;
    let wrong = Oem::from_square(OemSize { inner: 8, border: 0 }, square);
    assert!(!is_constant(&wrong, constant), "a wrong texel must be detected");
}

#[test]
fn weights_are_the_exact_solid_angles() {
    let environment = environment(Layout::Cube { size: 2 }, vec![[1.0; 3]; 24]);
    // Sizes on both sides of every change of rule.
    for n in [1, 2, 3, 17, 64, 255, 256, 258, 1024] {
        let oem = oem_of(&environment, n, 0);
        for k in 0..n * n {
            let (x, y) = (k % n, k / n);
            let exact = octahedral::texel_solid_angle(n, x, y);
            let off = (f64::from(oem.texel(x, y)[3]) / exact - 1.0).abs();
            // One rounding to float32, 2^-24, and the quadrature's error.
            assert!(off <= 6.2e-8, "{n} ({x}, {y}): off by {off:e}");
        }
    }
}

#[test]
fn borders_are_the_wrapped_interior() {
    let mut random = Random::new(11);
    let layout = Layout::Panorama { width: 24, height: 12 };
    let environment = environment(layout, texels(&mut random, Look::Noise, layout));
    for n in [1_u32, 2, 3, 5, 16, 17] {
        let bare = oem_of(&environment, n, 0);
        for border in [0, 1, 7, n / 2, n] {
            let oem = oem_of(&environment, n, border);
            let side = n + 2 * border;
            assert_eq!(oem.size().bordered(), side);
            assert_eq!(oem.texels().len(), (side * side) as usize);
            for (k, texel) in oem.texels().iter().enumerate() {
                let k = k as u32;
                let at = |t: u32| (f64::from(t) - f64::from(border) + 0.5) * 2.0 / f64::from(n) - 1.0;
                let inside = octahedral::wrap_oct(DVec2::new(at(k % side), at(k / side)));
                let place = (inside + 1.0) / 2.0 * f64::from(n);
                let expected = bare.texel(place.x as u32, place.y as u32);
                assert_eq!(*texel, expected, "n {n} border {border}, entry ({}, {})", k % side, k / side);
            }
        }
    }
}

/// Returns the mean radiance over a target texel by `count`^2 jittered points, uniform in the map and
/// weighted to solid angle.
fn brute_mean(environment: &Environment, count: u32, at: impl Fn(f64, f64) -> (DVec3, f64)) -> [f64; 3] {
    let (mut sum, mut area) = ([0.0; 3], 0.0);
    let mut random = Random::new(u64::from(count));
    for k in 0..count * count {
        let mut part = |k: u32| (f64::from(k) + random.unit()) / f64::from(count);
        let (direction, weight) = at(part(k % count), part(k / count));
        let texel = environment.texels()[texel_towards(environment.layout(), direction)];
        for (sum, value) in sum.iter_mut().zip(texel) {
            *sum += weight * f64::from(value);
        }
        area += weight;
    }
    sum.map(|sum| sum / area)
}

/// An edge through a texel makes `count` of its points uncertain, each independent and 1/count^2 of the
/// texel: sqrt(count) * count^-2. With texels differing tenfold, a few edges and four standard deviations:
/// 10 * 4 * 200^-1.5.
const JITTERED: f64 = 1.5e-2;

#[test]
fn every_texel_is_the_mean_over_what_it_covers() {
    let mut random = Random::new(12);
    let (mut compared, mut worst) = (0, 0.0_f64);
    for layout in SMALL_LAYOUTS {
        let tenfold = |t: f32| 1.0 + 9.0 * t.fract();
        let radiance = texels(&mut random, Look::Noise, layout).into_iter().map(|t| t.map(tenfold)).collect();
        let environment = environment(layout, radiance);
        for n in [1, 2, 3, 5, 8] {
            let oem = oem_of(&environment, n, 0);
            for k in 0..n * n {
                let (x, y) = (k % n, k / n);
                let expected = brute_mean(&environment, 200, |a, b| {
                    let uv = (DVec2::new(f64::from(x) + a, f64::from(y) + b)) * 2.0 / f64::from(n) - 1.0;
                    (octahedral::direction_from_oct(uv), octahedral::solid_angle_density(uv))
                });
                let radiance = oem.radiance(x, y);
                for c in 0..3 {
                    let off = (f64::from(radiance[c]) / expected[c] - 1.0).abs();
                    assert!(off < JITTERED, "{layout:?} to {n} ({x}, {y}): {radiance:?} {expected:?}");
                    worst = worst.max(off);
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 7 * 3 * (1 + 4 + 9 + 25 + 64));
    // A neighbouring or mirrored texel would be off by far more.
    assert!(worst > 1e-6, "something was compared: {worst:e}");
}

#[test]
fn level_0_is_the_mean_over_each_texel_in_the_world() {
    let mut random = Random::new(13);
    let mut compared = 0;
    for layout in SMALL_LAYOUTS {
        let tenfold = |t: f32| 1.0 + 9.0 * t.fract();
        let radiance: Vec<Rgb> =
            texels(&mut random, Look::Noise, layout).into_iter().map(|t| t.map(tenfold)).collect();
        for degrees in [0.0, 90.0, 37.0] {
            let turned = environment(layout, radiance.clone()).rotated_y(degrees).expect("an angle");
            for (environment, size) in [(turned.clone(), 4), (turned.mirrored(), 3)] {
                let cube = footprints_over(&environment, Layout::Cube { size }).expect("a small cube");
                for (k, texel) in cube.iter().enumerate().step_by(sweep(5, 1)) {
                    let k = k as u32;
                    let face = cube::Face::ALL[(k / (size * size)) as usize];
                    let expected = brute_mean(&environment, 100, |a, b| {
                        let at = |k: u32, a: f64| (f64::from(k) + a) / f64::from(size) * 2.0 - 1.0;
                        let point = cube::cube_point(face, at(k % size, a), at(k / size % size, b));
                        (environment.source_from_world() * point.normalize(), point.length().powi(-3))
                    });
                    for c in 0..3 {
                        let off = (f64::from(texel[c]) / expected[c] - 1.0).abs();
                        // Half as many points per side: 2^1.5 times the error.
                        assert!(
                            off < 2.9 * JITTERED,
                            "{layout:?} turned {degrees} texel {k}: {texel:?} {expected:?}"
                        );
                        compared += 1;
                    }
                }
            }
        }
    }
    assert_eq!(compared, 7 * 3 * 3 * sweep(20 + 11, 6 * (16 + 9)));
}
