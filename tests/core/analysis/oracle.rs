//! Compares the oracle with values derived by hand and by brute force.

use glam::{DVec2, DVec3};
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::analysis::oracle::integrate::over_texel;
use octagloss_core::analysis::oracle::kernel::Kernel;
use octagloss_core::geometry::exact::ExactTexels;
use octagloss_core::geometry::exact::patch::Accuracy;
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::light::oem::{Oem, OemSize, bilinear_share};
use octagloss_core::light::sh;
use octagloss_core::lobe::{LOBES, Lobe, kernel, kernel_integral};
use octagloss_core::sphere::{cube, equirect, octahedral};
use octagloss_fixtures::common::{Look, Random, environment, landmarks, oem, sweep, texels};
use octagloss_fixtures::oracles::oem::{OemOracle, integral, reflect_oem};
use std::f64::consts::PI;

const LAYOUTS: [Layout; 5] = [
    Layout::Panorama { width: 32, height: 16 },
    Layout::Cube { size: 8 },
    Layout::Octahedral { size: 16 },
    Layout::Octahedral { size: 5 },
    Layout::Panorama { width: 3, height: 1 },
];

/// Returns the greatest relative difference of three channels.
fn difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).abs() / b[c].abs().max(1e-300)).fold(0.0, f64::max)
}

#[test]
fn a_constant_stays_one() {
    for layout in LAYOUTS {
        let constant = environment(layout, vec![[0.25, 2.0, 3e4]; layout.texel_count()]);
        let mut spotted = constant.texels().to_vec();
        spotted[0][0] = 100.0;
        let spotted = environment(layout, spotted);
        let (oracle, other) = (Oracle::new(&constant), Oracle::new(&spotted));
        let mut spots = 0;
        for lobe in LOBES {
            for roughness in sweep(&[0.0, 0.1, 0.5, 1.0][..], &[0.0, 0.1, 0.35, 0.7, 1.0]).iter().copied() {
                for direction in landmarks().into_iter().step_by(sweep(7, 3)) {
                    // The sums over L K and over K take the same terms: rounding of some 500 of them.
                    let value = oracle.reflect(lobe, roughness, direction).expect("valid");
                    let off = difference(value, [0.25, 2.0, 3e4]);
                    assert!(off < 1e-12, "{layout:?} {lobe:?} {roughness} {direction}: {value:?}");
                    if roughness < 0.5 {
                        continue;
                    }
                    let value = other.reflect(lobe, roughness, direction).expect("valid");
                    spots += usize::from(difference(value, [0.25, 2.0, 3e4]) > 1e-12);
                }
            }
        }
        assert!(spots > sweep(4, 30), "{layout:?}: one brighter texel was detected in {spots} lobes");
    }
}

/// Returns a texel's means of `integrand` by midpoints of the map, and the texel's solid angle.
fn brute_texel<const N: usize>(
    layout: Layout,
    index: usize,
    integrand: impl Fn(DVec3) -> [f64; N],
) -> ([f64; N], f64) {
    let index = index as u32;
    let count = if layout.texel_count() < 50 { 512 } else { 64 };
    let (mut sums, mut area) = ([0.0; N], 0.0);
    for k in 0..count * count {
        let (a, b) = (
            (f64::from(k % count) + 0.5) / f64::from(count),
            (f64::from(k / count) + 0.5) / f64::from(count),
        );
        let signed = |i: u32, a: f64, n: u32| (f64::from(i) + a) / f64::from(n) * 2.0 - 1.0;
        let (direction, weight) = match layout {
            Layout::Panorama { width, height } => {
                let (i, j) = (index % width, index / width);
                let v = (f64::from(j) + b) / f64::from(height);
                let direction = equirect::direction_from_equirect((f64::from(i) + a) / f64::from(width), v);
                (direction, (v * PI).sin())
            }
            Layout::Cube { size } => {
                let face = cube::Face::ALL[(index / (size * size)) as usize];
                let (i, j) = (index % size, index / size % size);
                let point = cube::cube_point(face, signed(i, a, size), signed(j, b, size));
                (point.normalize(), point.length().powi(-3))
            }
            Layout::Octahedral { size } => {
                let uv = DVec2::new(signed(index % size, a, size), signed(index / size, b, size));
                (octahedral::direction_from_oct(uv), octahedral::solid_angle_density(uv))
            }
        };
        for (sum, value) in sums.iter_mut().zip(integrand(direction)) {
            *sum += value * weight;
        }
        area += weight;
    }
    let solid_angle = match layout {
        Layout::Panorama { width, height } => equirect::texel_solid_angle(width, height, index / width),
        Layout::Cube { size } => cube::texel_solid_angle(size, index % size, index / size % size),
        Layout::Octahedral { size } => octahedral::texel_solid_angle(size, index % size, index / size),
    };
    (sums.map(|sum| sum / area), solid_angle)
}

/// Returns an environment that is black except texel `index`.
fn lone(layout: Layout, index: usize, value: f32) -> Environment {
    let mut texels = vec![[0.0; 3]; layout.texel_count()];
    texels[index] = [value, 2.0 * value, 0.0];
    environment(layout, texels)
}

/// Error of a mean over 64 x 64 midpoints of a texel. A smooth kernel is off by (h/64)^2/24 of its curvature;
/// a kernel cut by the horizon or by a fold by about (1/64)^1.5 of its value at the edge.
const MIDPOINTS: f64 = 2e-4;

#[test]
fn a_lone_texel_is_its_kernel_times_its_solid_angle() {
    let mut random = Random::new(3);
    let (mut compared, mut seen) = (0, 0);
    for layout in LAYOUTS {
        for _ in 0..sweep(12, 40) {
            let index = random.below(layout.texel_count() as u32) as usize;
            let environment = lone(layout, index, 1e6);
            let direction = random.direction();
            for lobe in [Lobe::Ggx, Lobe::Phong, Lobe::Cosine, Lobe::Charlie] {
                // Wide enough for midpoints to resolve over texels of up to 2 radians. Excludes Phong lobes
                // that end at the horizon more steeply than linearly.
                let wide = layout.texel_count() < 50 || lobe == Lobe::Phong;
                let least = if wide { 0.6 } else { 0.35 };
                // The Charlie lobe's band must not end more steeply either.
                let roughness = random.between(if lobe == Lobe::Charlie { 0.75 } else { least }, 0.84);
                let at =
                    |l: DVec3| [kernel(lobe, roughness * roughness, l.distance_squared(direction) / 4.0)];
                let ([mean], solid_angle) = brute_texel(layout, index, at);
                let integral = kernel_integral(lobe, roughness * roughness);
                let expected = 1e6 * mean * solid_angle / integral;
                let [value, twice, nothing] =
                    Oracle::new(&environment).reflect(lobe, roughness, direction).expect("valid");
                // At the very end of the lobe, compare with a tenth of the mean lobe.
                let scale = expected.max(1e6 * 0.1 * solid_angle / (4.0 * PI));
                let off = (value - expected).abs() / scale;
                // Midpoints converge one power more slowly at Charlie's point around R and at its steep end.
                let midpoints = if lobe == Lobe::Charlie { 4.0 * MIDPOINTS } else { MIDPOINTS };
                assert!(
                    off < midpoints,
                    "{layout:?} {index} {lobe:?} {roughness} {direction}: {value} {expected}"
                );
                assert!(
                    (twice - 2.0 * value).abs() <= 1e-12 * twice && nothing == 0.0,
                    "channels must be independent"
                );
                compared += 1;
                seen += usize::from(
                    value > 0.0 && (value * (1.0 + 3.0 * MIDPOINTS) - expected).abs() / scale > MIDPOINTS,
                );
            }
        }
    }
    assert_eq!(compared, 20 * sweep(12, 40));
    assert!(seen * 8 > compared, "a texel brighter by three tolerances was detected in {seen} lobes");
}

#[test]
fn a_cone_takes_the_share_that_it_covers() {
    // White within 60 degrees of +Y and black outside. A cone of half-angle h around +Y sees
    // (1 - cos min(h, 60)) / (1 - cos h) of white. In a panorama of 12 rows, 60 degrees is a row's edge.
    let layout = Layout::Panorama { width: 24, height: 12 };
    let texels = (0..layout.texel_count()).map(|k| if k / 24 < 4 { [1.0; 3] } else { [0.0; 3] }).collect();
    let environment = environment(layout, texels);
    for roughness in [0.05, 0.3, 0.6, 0.7, 0.9, 1.0] {
        let half: f64 = roughness * PI / 2.0;
        let expected = (1.0 - half.min(PI / 3.0).cos()) / (1.0 - half.cos());
        let [value, ..] = Oracle::new(&environment).reflect(Lobe::Cone, roughness, DVec3::Y).expect("valid");
        // The texels on the edge are halved ten times: 2^-15 of their share.
        assert!((value - expected).abs() < 1e-4, "{roughness}: {value} against {expected}");
        assert!((value + 2e-4 - expected).abs() > 1e-4, "{roughness}: a difference must be detected");
    }
}

#[test]
fn a_hemisphere_has_its_share_of_each_lobe() {
    for layout in [
        Layout::Panorama { width: 64, height: 32 },
        Layout::Cube { size: 16 },
        Layout::Octahedral { size: 32 },
    ] {
        let blank = environment(layout, vec![[0.0; 3]; layout.texel_count()]);
        let mut texels = Vec::new();
        blank.for_each_texel(|direction, _, _| texels.push([f32::from(u8::from(direction.y > 0.0)); 3]));
        // In an octahedral square and a cube the horizon y = 0 runs along texel edges or diagonals. A texel
        // that it halves gets the value one half, which keeps the expected values exact.
        let on_fold = |k: usize| match layout {
            Layout::Octahedral { size } => {
                let (x, y) = (k as u32 % size, k as u32 / size);
                octahedral::texel_centre(size, x, y).abs().element_sum() == 1.0
            }
            _ => false,
        };
        for (k, texel) in texels.iter_mut().enumerate() {
            if on_fold(k) {
                *texel = [0.5; 3];
            }
        }
        let environment = environment(layout, texels);
        let oracle = Oracle::new(&environment);
        for lobe in LOBES {
            for roughness in [0.2, 0.5, 0.9] {
                let along = |d: DVec3| oracle.reflect(lobe, roughness, d).expect("valid")[0];
                // By symmetry, to the accuracy promised, also at edges of the support.
                assert!((along(DVec3::X) - 0.5).abs() < 1e-5, "{layout:?} {lobe:?} {roughness} +X");
                let (up, down) = (along(DVec3::Y), along(DVec3::NEG_Y));
                assert!((up + down - 1.0).abs() < 1e-5, "{layout:?} {lobe:?} {roughness} +-Y: {up} {down}");
                let tilted = DVec3::new(0.6, 0.0, 0.8) * 0.9 + DVec3::Y * 0.19_f64.sqrt();
                let sum = along(tilted) + along(-tilted);
                assert!((sum - 1.0).abs() < 1e-4, "{layout:?} {lobe:?} {roughness} tilted: {sum}");
            }
        }
        if !matches!(layout, Layout::Octahedral { .. }) {
            // Irradiance over pi under a white hemisphere is (1 + cos t)/2.
            for step in 0..=12 {
                let (sin, cos) = (f64::from(step) / 12.0 * PI).sin_cos();
                let [value, ..] = oracle
                    .reflect(Lobe::Cosine, 1.0, DVec3::new(sin, cos, 0.0))
                    .expect("valid")
                    .map(|channel| PI * channel);
                let expected = PI * (1.0 + cos) / 2.0;
                assert!(
                    (value - expected).abs() < 1e-5,
                    "{layout:?} step {step}: {value} against {expected}"
                );
            }
        }
    }
}

#[test]
fn a_mirror_shows_the_texel_looked_at() {
    let mut random = Random::new(5);
    for layout in LAYOUTS {
        let environment = environment(layout, texels(&mut random, Look::Noise, layout))
            .rotated_y(90.0)
            .expect("an angle")
            .mirrored();
        let oracle = Oracle::new(&environment);
        let mut compared = 0;
        environment.for_each_texel(|direction, _, rgb| {
            let expected = rgb.map(f64::from);
            assert_eq!(
                oracle.reflect(Lobe::Ggx, 0.0, direction).expect("valid"),
                expected,
                "{layout:?} {direction}"
            );
            compared += 1;
            if compared % sweep(4, 1) > 0 {
                return;
            }
            // Of a lobe, alpha^2/s lies beyond s = sin^2(theta/2): 1e-12 over 2e-5 at the narrowest texel's
            // edge, and neighbours are up to 1e4 times brighter.
            let near = oracle.reflect(Lobe::Ggx, 0.001, direction).expect("valid");
            assert!(
                difference(near, expected) < 5e-4,
                "{layout:?} {direction}: {near:?} against {expected:?}"
            );
        });
        assert_eq!(compared, layout.texel_count());
    }
}

#[test]
fn rotation_carries_plus_z_to_plus_x() {
    let layout = Layout::Panorama { width: 64, height: 32 };
    let towards_z = 16 * 64 + 48;
    let still = lone(layout, towards_z, 1.0);
    let turned = still.clone().rotated_y(90.0).expect("an angle");
    let bright = |e: &Environment, d: DVec3| Oracle::new(e).reflect(Lobe::Ggx, 0.2, d).expect("valid")[0];
    assert!(bright(&still, DVec3::Z) > 100.0 * bright(&still, DVec3::X), "the texel is at +Z");
    assert!(bright(&turned, DVec3::X) > 100.0 * bright(&turned, DVec3::Z), "and at +X once turned");
    let mut random = Random::new(6);
    let free = still.clone().rotated_y(33.0).expect("an angle");
    let turn = glam::DMat3::from_rotation_y(33_f64.to_radians());
    for _ in 0..20 {
        let direction = random.direction();
        let (a, b) = (bright(&still, direction), bright(&free, turn * direction));
        assert!((a - b).abs() <= 1e-12 * a, "{direction}: {a} against {b}");
    }
}

#[test]
fn harmonics_of_known_fields_match() {
    for layout in [
        Layout::Panorama { width: 128, height: 64 },
        Layout::Cube { size: 48 },
        Layout::Octahedral { size: 64 },
    ] {
        let constant = environment(layout, vec![[2.0, 1.0, 0.0]; layout.texel_count()]);
        let sh = sh::spherical_harmonics(&constant, 4).expect("an order");
        // Sums of 10^4 exact integrals.
        assert!((sh[0][0] - 2.0 * (4.0 * PI).sqrt()).abs() < 1e-11, "{layout:?} L0 {}", sh[0][0]);
        for (k, [red, ..]) in sh.iter().enumerate().skip(1) {
            assert!(red.abs() < 1e-11, "{layout:?} {k}: {red}");
        }
        for band in 1..25 {
            // 4 + Y_k: c_0 = 4 sqrt(4 pi); c_k = 1 - O(h^2), as texels are constant.
            let mut texels = Vec::new();
            constant.for_each_texel(|d, _, _| texels.push([(4.0 + sh::basis(d)[band]) as f32; 3]));
            let sh =
                sh::spherical_harmonics(&environment(layout, texels).rotated_y(0.0).expect("an angle"), 4)
                    .expect("an order");
            for (k, [red, ..]) in sh.iter().enumerate() {
                let expected = if k == 0 { 4.0 * (4.0 * PI).sqrt() } else { f64::from(u8::from(k == band)) };
                assert!((red - expected).abs() < 5e-3, "{layout:?} Y{band} in {k}: {red}");
            }
        }
    }
    // Check the basis itself against the usual formulas in one direction.
    let d = DVec3::new(0.48, 0.6, 0.64);
    let expected = [
        0.282_094_791_773_878_14,
        0.488_602_511_902_919_9 * d.y,
        0.488_602_511_902_919_9 * d.z,
        0.488_602_511_902_919_9 * d.x,
        1.092_548_430_592_079_2 * d.x * d.y,
        1.092_548_430_592_079_2 * d.y * d.z,
        0.315_391_565_252_520_05 * (3.0 * d.z * d.z - 1.0),
        1.092_548_430_592_079_2 * d.z * d.x,
        0.546_274_215_296_039_6 * (d.x * d.x - d.y * d.y),
        0.590_043_589_926_643_5 * d.y * (3.0 * d.x * d.x - d.y * d.y),
        2.890_611_442_640_554 * d.x * d.y * d.z,
        0.457_045_799_464_465_7 * d.y * (5.0 * d.z * d.z - 1.0),
        0.373_176_332_590_115_4 * d.z * (5.0 * d.z * d.z - 3.0),
        0.457_045_799_464_465_7 * d.x * (5.0 * d.z * d.z - 1.0),
        1.445_305_721_320_277 * d.z * (d.x * d.x - d.y * d.y),
        0.590_043_589_926_643_5 * d.x * (d.x * d.x - 3.0 * d.y * d.y),
        2.503_342_941_796_704_6 * d.x * d.y * (d.x * d.x - d.y * d.y),
        1.770_130_769_779_930_5 * d.y * d.z * (3.0 * d.x * d.x - d.y * d.y),
        0.946_174_695_757_56 * d.x * d.y * (7.0 * d.z * d.z - 1.0),
        0.669_046_543_557_289_2 * d.y * d.z * (7.0 * d.z * d.z - 3.0),
        0.105_785_546_915_204_3 * (35.0 * d.z.powi(4) - 30.0 * d.z * d.z + 3.0),
        0.669_046_543_557_289_2 * d.x * d.z * (7.0 * d.z * d.z - 3.0),
        0.473_087_347_878_78 * (d.x * d.x - d.y * d.y) * (7.0 * d.z * d.z - 1.0),
        1.770_130_769_779_930_5 * d.x * d.z * (d.x * d.x - 3.0 * d.y * d.y),
        0.625_835_735_449_176_1 * (d.x.powi(4) - 6.0 * d.x * d.x * d.y * d.y + d.y.powi(4)),
    ];
    for (k, (value, expected)) in sh::basis(d).into_iter().zip(expected).enumerate() {
        assert!((value - expected).abs() < 1e-14, "Y{k}: {value} against {expected}");
    }
}

/// Cones inside one large texel, which samples of the texel miss: its radiance, be it black or as bright as
/// can be, whatever the others'.
#[test]
fn a_narrow_cone_shows_the_texel_it_lies_in() {
    let mut random = Random::new(41);
    let mut compared = 0;
    for layout in [
        Layout::Octahedral { size: 2 },
        Layout::Cube { size: 1 },
        Layout::Panorama { width: 2, height: 1 },
        Layout::Octahedral { size: 5 },
    ] {
        let light = |k: usize| [[0.0; 3], [3e38; 3], [1e-45; 3], [1.0; 3]][k % 4];
        let environment = environment(layout, (0..layout.texel_count()).map(light).collect());
        let oracle = Oracle::new(&environment);
        for roughness in [4e-5, 1e-3, 0.018, 0.03] {
            let spread = roughness * PI / 2.0;
            for _ in 0..40 {
                let direction = random.direction();
                let seen = oracle.reflect(Lobe::Cone, 0.0, direction).expect("valid");
                // Whole cones only: around the rim all must look at one texel.
                let (x, y) = direction.any_orthonormal_pair();
                let within = (0..64).map(|k| f64::from(k) / 32.0 * PI).all(|angle| {
                    let rim = direction + (x * angle.cos() + y * angle.sin()) * (1.1 * spread.tan());
                    oracle.reflect(Lobe::Cone, 0.0, rim).expect("valid") == seen
                });
                if within {
                    let value = oracle.reflect(Lobe::Cone, roughness, direction).expect("valid");
                    assert!(difference(value, seen) < 1e-12, "{layout:?} {roughness} {direction}: {value:?}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 500, "{compared} cones lay inside a texel");
}

#[test]
fn harmonics_of_a_lone_texel_are_its_integrals() {
    let mut random = Random::new(7);
    for layout in LAYOUTS {
        for _ in 0..sweep(4, 10) {
            let index = random.below(layout.texel_count() as u32) as usize;
            let turn = random.between(-180.0, 180.0);
            let environment = lone(layout, index, 3.0).rotated_y(turn).expect("an angle");
            let world_from_source = environment.source_from_world().transpose();
            let sh = sh::spherical_harmonics(&environment, 4).expect("an order");
            // Bands up to L2 do not depend on the number of bands.
            for (few, all) in sh::spherical_harmonics(&environment, 2).expect("an order").iter().zip(&sh) {
                assert!((few[1] - all[1]).abs() < 1e-13 * sh[0][1], "{layout:?} {index}: {few:?} {all:?}");
            }
            let (means, solid_angle) = brute_texel(layout, index, |d| sh::basis(world_from_source * d));
            for (k, mean) in means.into_iter().enumerate() {
                let expected = 3.0 * mean * solid_angle;
                // (h/64)^2/24 of a second derivative of at most 20, with h up to 3; folds are off by 1/64 h.
                let tolerance = 3.0 * solid_angle * if layout.texel_count() < 50 { 5e-3 } else { 1e-4 };
                let off = (sh[k][0] - expected).abs();
                assert!(off < tolerance, "{layout:?} {index} Y{k}: {} against {expected}", sh[k][0]);
            }
        }
    }
}

/// Computes the served lobe by its definition and by brute force: every texel's tent and square over
/// midpoints of the unfolded plane, 0.005 of a unit of (u, v) apart.
fn brute_oem(oem: &Oem, lobe: Lobe, roughness: f64, direction: DVec3) -> [f64; 3] {
    let n = oem.size().inner;
    let h = 2.0 / f64::from(n);
    let alpha = roughness * roughness;
    let count = 4 * (200 / n);
    let share = bilinear_share(lobe, alpha, n);
    let mut least = [f64::INFINITY; 3];
    for k in 0..n * n {
        let [energy @ .., w] = oem.texel(k % n, k / n).map(f64::from);
        least = std::array::from_fn(|c| least[c].min(energy[c] / w));
    }
    let mut sum = [0.0; 3];
    for k in 0..n * n {
        let (x, y) = (k % n, k / n);
        let centre = octahedral::texel_centre(n, x, y);
        let mut mean = 0.0;
        for p in 0..count * count {
            let a = (f64::from(p % count) + 0.5) / f64::from(count) * 2.0 - 1.0;
            let b = (f64::from(p / count) + 0.5) / f64::from(count) * 2.0 - 1.0;
            let tent = (1.0 - a.abs()) * (1.0 - b.abs());
            let square = f64::from(u8::from(a.abs() < 0.5 && b.abs() < 0.5));
            let weight = (share * tent + (1.0 - share) * square) * (2.0 / f64::from(count)).powi(2);
            let l = octahedral::direction_from_oct(octahedral::wrap_oct(centre + DVec2::new(a, b) * h));
            mean += weight * kernel(lobe, alpha, l.distance_squared(direction) / 4.0);
        }
        let [energy @ .., w] = oem.texel(x, y).map(f64::from);
        for c in 0..3 {
            sum[c] += mean * (energy[c] - least[c] * w);
        }
    }
    let integral = kernel_integral(lobe, alpha);
    std::array::from_fn(|c| least[c] + sum[c] / integral)
}

#[test]
fn the_served_lobe_is_its_definition() {
    let mut random = Random::new(8);
    let (mut compared, mut seen) = (0, 0);
    for n in sweep(&[1, 2, 5, 16][..], &[1, 2, 3, 5, 8, 16]).iter().copied() {
        for look in Look::ALL {
            let layout = Layout::Octahedral { size: n };
            let size = OemSize { inner: n, border: random.below(n + 1) };
            let radiance = texels(&mut random, look, layout);
            let oem = oem(size, &radiance);
            let oracle = OemOracle::new(&oem);
            for lobe in LOBES.into_iter().filter(|lobe| *lobe != Lobe::Charlie) {
                let roughness = random.between(0.4, 1.0);
                let direction = random.direction();
                let expected = brute_oem(&oem, lobe, roughness, direction);
                let value = oracle.reflect(lobe, roughness, direction);
                // Midpoints: 0.005^2/24 of the curvature, below 300 in (u, v). Jumps of a cone and of a Phong
                // lobe of a small exponent are found to 40^-1.5 of a texel's share.
                let smooth = matches!(lobe, Lobe::Ggx | Lobe::Cosine);
                let tolerance = if smooth { 1e-3 } else { 1e-2 };
                let off = difference(value, expected);
                assert!(off < tolerance, "{n} {look:?} {lobe:?} {roughness}: {value:?} against {expected:?}");
                compared += 1;
                if smooth {
                    // Brighten one texel of the OEM by half: the comparison must detect it unless it is
                    // outside the lobe.
                    let mut other = radiance.clone();
                    let k = random.below(n * n) as usize;
                    other[k] = other[k].map(|c| 1.5 * c + 0.5);
                    let other = reflect_oem(&self::oem(size, &other), lobe, roughness, direction);
                    seen += usize::from(difference(other, expected) > tolerance);
                }
            }
        }
    }
    assert_eq!(compared, sweep(80, 120));
    assert!(seen * 5 > compared, "a wrong texel was detected {seen} times in {}", compared / 2);
}

#[test]
fn the_served_mirror_is_the_limit_of_lobes() {
    let mut random = Random::new(9);
    let mut compared = 0;
    for n in [2, 3, sweep(9, 17)] {
        for look in [Look::Split, Look::Smooth] {
            let radiance = texels(&mut random, look, Layout::Octahedral { size: n });
            let oem = oem(OemSize { inner: n, border: 0 }, &radiance);
            let oracle = OemOracle::new(&oem);
            let places = (0..4).map(|_| random.direction()).chain(landmarks());
            for direction in places.step_by(sweep(10, 1)) {
                let mirror = oracle.reflect(Lobe::Ggx, 0.0, direction);
                let sharp = oracle.reflect(Lobe::Cone, 1e-3, direction);
                // A cone of 1.6e-3 reaches n/2 * 1.6e-3 of a texel, or sqrt(3) times that; neighbouring
                // energies differ up to fivefold.
                let off = difference(sharp, mirror);
                assert!(off < 1.6e-3 * f64::from(n) * 5.0, "{n} {look:?} {direction}: {off:e}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 6 * sweep(3, 30));
}

#[test]
fn source_and_oem_agree_on_a_smooth_sky() {
    let mut random = Random::new(10);
    let n = 64;
    let layout = Layout::Octahedral { size: n };
    let radiance = texels(&mut random, Look::Smooth, layout);
    let oem = oem(OemSize { inner: n, border: 3 }, &radiance);
    let environment = environment(layout, radiance);
    for lobe in LOBES {
        for roughness in [0.4, 0.7, 1.0] {
            let direction = random.direction();
            let source = Oracle::new(&environment).reflect(lobe, roughness, direction).expect("valid");
            let served = reflect_oem(&oem, lobe, roughness, direction);
            // The tent blurs by h^2/12 of the energy's Laplacian in (u, v), h = 1/32: below 50 of the mean,
            // mostly due to the density.
            assert!(difference(served, source) < 4e-3, "{lobe:?} {roughness}: {served:?} against {source:?}");
        }
    }
}

#[test]
fn kernels_over_all_texels_sum_to_their_integral() {
    let layouts = [
        Layout::Panorama { width: 24, height: 12 },
        Layout::Cube { size: 6 },
        Layout::Octahedral { size: 8 },
        Layout::Octahedral { size: 3 },
    ];
    let accuracy = Accuracy::new(1e-9);
    for layout in layouts {
        let texels = ExactTexels::new(layout);
        for lobe in LOBES {
            for roughness in [0.03, 0.2, 0.6, 1.0] {
                let kernel = Kernel::new(lobe, roughness, DVec3::new(0.3, -0.5, 0.7).normalize());
                let frames: Vec<DVec3> = texels.frames().iter().map(|f| *f * kernel.direction).collect();
                let mut sum = 0.0;
                texels.for_each(|_, block, frame| {
                    sum += over_texel(layout, block, &kernel.around(frames[frame]), &accuracy, 8);
                });
                // A cone's edge, where pieces are halved eight times and not cut, is the worst.
                let tolerance = if lobe == Lobe::Cone { 2e-3 / roughness } else { 2e-5 };
                let off = (sum / integral(&kernel) - 1.0).abs();
                assert!(off < tolerance, "{layout:?} {lobe:?} {roughness}: off by {off:e}");
            }
        }
    }
}

#[test]
fn a_hemisphere_takes_what_coarse_texels_have_in_it() {
    let layout = Layout::Panorama { width: 15, height: 3 };
    let direction = DVec3::new(-0.955, 0.036, 0.294).normalize();
    // Northern texels wholly inside, 2 pi/15 (1 - cos 60 degrees) of the 2 pi; a few others reach over the
    // horizon by less than a thousandth.
    for inside in [0, 13, 14] {
        let share =
            Oracle::new(&lone(layout, inside, 1.0)).reflect(Lobe::Phong, 1.0, direction).expect("valid")[0];
        assert!((30.0 * share - 1.0).abs() < 1e-7, "texel {inside}: {share}");
    }
}

#[test]
fn a_cosine_takes_its_share_of_texels_that_the_horizon_touches() {
    let layout = Layout::Panorama { width: 3, height: 6 };
    let direction = DVec3::new(0.0, 1.0, 1.0).normalize();
    // By a product of midpoint rules. The horizon touches the middle of the texel's own middle.
    for (texel, share) in [(0, 0.043_633_79), (3, 0.037_867_43), (4, 0.118_602_67), (13, 0.000_751_54)] {
        let found =
            Oracle::new(&lone(layout, texel, 1.0)).reflect(Lobe::Cosine, 1.0, direction).expect("valid")[0];
        assert!((found - share).abs() < 3e-8, "texel {texel}: {found}");
    }
}
