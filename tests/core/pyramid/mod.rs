//! The pyramid: the table's invariants, levels against exhaustive Gaussians, and look-ups against the oracle.

mod cube;
mod reflection;

use glam::{DMat2, DVec2, DVec3};
use octagloss_core::analysis::oracle;
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::lobe::{self, Lobe};
use octagloss_core::pyramid::fit::{
    INTERVALS, LOBE, ORDERS, READS, WEIGHTS, fitted, functions, roughness_of, table, weights_at,
};
use octagloss_core::pyramid::levels::{Between, taps};
use octagloss_core::pyramid::suns::{COUNT, Sun};
use octagloss_core::pyramid::{LEVEL_OCTAVES, Levels, MOST_MAPS, Pyramid};
use octagloss_core::sphere::equirect::direction_from_equirect;
use octagloss_core::sphere::octahedral::{direction_from_oct, oct_from_direction, texel_centre};
use octagloss_fixtures::common::{Look, Random, environment, landmarks, oem, texels};
use std::f64::consts::PI;

/// Squares, and cubes.
fn ladders() -> impl Iterator<Item = Levels> {
    let squares = [32, 128, 512, 1024, 2048].map(|size| Levels::over(size).expect("a size"));
    let cubes = [64, 512, 2048].map(|size| Levels::over(size).expect("a size").on_cubes());
    squares.into_iter().chain(cubes)
}

/// The lobe of `weights` at 1 - cos(theta) = `c`.
fn lobe_of(levels: Levels, weights: [f32; WEIGHTS], c: f64) -> f64 {
    functions(levels, c).into_iter().zip(weights).take(LOBE).map(|(f, w)| f * f64::from(w)).sum()
}

/// Values of 1 - cos(theta), dense where lobes bend.
fn rings(levels: Levels) -> Vec<f64> {
    let least = levels.width(0) / 30.0;
    let angles = (0..300).map(|k| least * (PI / least).powf(f64::from(k) / 299.0));
    std::iter::once(0.0).chain(angles.map(|angle| 1.0 - angle.cos())).collect()
}

#[test]
fn lobes_keep_energy_read_little_and_are_never_dark() {
    for levels in ladders() {
        let nodes = table(levels);
        assert_eq!(nodes.len(), INTERVALS as usize + 1, "nodes");
        for pair in nodes.windows(2) {
            let reads = (0..ORDERS).filter(|k| pair.iter().any(|weights| weights[*k] != 0.0)).count();
            assert!((1..=READS).contains(&reads), "{reads} reads");
        }
        for (node, weights) in (0_u32..).zip(&nodes) {
            let sum: f32 = weights[..=ORDERS].iter().sum();
            assert!((sum - 1.0).abs() < 1e-5, "node {node}: weights sum to {sum}");
            let most = weights[..LOBE].iter().fold(0.0_f32, |most, weight| most.max(weight.abs()));
            assert!(most < 1.2, "node {node}: a weight of {most}");
            let least = rings(levels).into_iter().map(|c| lobe_of(levels, *weights, c));
            let least = 4.0 * PI * least.fold(f64::INFINITY, f64::min);
            assert!(least >= -0.01, "{}, node {node}: {least} of the mean", levels.inner());
        }
        let mut mirror = [0.0; WEIGHTS];
        mirror[0] = 1.0;
        assert_eq!(weights_at(levels, 0.0)[..LOBE], mirror[..LOBE], "roughness 0 is the mirror");
        // The last node is reached, to the rounding of a logarithm.
        let last = nodes[INTERVALS as usize];
        let off = weights_at(levels, 1.0).iter().zip(last).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-4, "roughness 1 is off by {off}");
    }
}

#[test]
fn the_table_interpolates_and_its_weights_do_not_jump() {
    for levels in ladders() {
        let mut worst = (0.0, 0.0);
        for place in (0..INTERVALS).map(|node| f64::from(node) + 0.5) {
            let roughness = roughness_of(place);
            let (own, between) = (fitted(levels, roughness), weights_at(levels, roughness as f32));
            let peak = lobe_of(levels, own, 0.0);
            for c in rings(levels) {
                let off = (lobe_of(levels, own, c) - lobe_of(levels, between, c)).abs() / peak;
                if off > worst.0 {
                    worst = (off, roughness);
                }
            }
        }
        let inner = levels.inner();
        assert!(worst.0 <= 1e-3, "{inner}: off by {} of the peak at roughness {}", worst.0, worst.1);
        for (node, pair) in table(levels).windows(2).enumerate() {
            let step = pair[0].iter().zip(pair[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(step < 0.06, "{inner}, node {node}: a weight jumps by {step}");
        }
    }
}

/// The shaders find the widest level by a formula of their own.
#[test]
fn all_sizes_have_as_many_levels_as_shaders_read() {
    for size in Levels::sizes() {
        let levels = Levels::over(size).expect("a size");
        let last = 1.0 + ((size.ilog2() as f32 - 3.237_039) / LEVEL_OCTAVES as f32).floor();
        assert_eq!(f64::from(last), f64::from(levels.count() - 1), "{size}");
        assert!(levels.count() as usize <= MOST_MAPS && levels.on_cubes().count() as usize <= MOST_MAPS);
        let mips = (0..levels.count()).map(|map| levels.square_of(map));
        assert!(mips.clone().all(|square| square.mip < levels.mips()), "{size}");
        assert!(mips.clone().all(|square| square != levels.square_of_cosine()), "{size}");
        assert!(0.35 / levels.width(levels.count() - 1) == 1.0 && levels.width(1) * f64::from(size) > 3.3);
    }
    let squares = octagloss_shaders::FILES.iter().find(|(path, _)| *path == "common/pyramid_squares.wgsl");
    assert!(squares.is_some_and(|(_, text)| text.contains("- 3.23703914)")), "the formula above");
}

/// Without the bend, the second mean of the widest level is off by .0015.
#[test]
fn reads_make_the_means_of_the_next_gaussian() {
    let levels = Levels::over(512).expect("a size");
    let means = |width: f64| {
        let square = width * width;
        let first = 1.0 / square.recip().tanh() - square;
        [first, 1.0 - 3.0 * square * first]
    };
    for map in 2..levels.count() {
        let (own, finer) = (means(levels.width(map)), means(levels.width(map - 1)));
        let between = Between::new(levels.width(map), levels.width(map - 1));
        let off = |bend: f64| {
            let (mut first, mut second) = (0.0, 0.0);
            for (place, weight) in taps() {
                let half = 0.5 * between.variance * f64::from(place.length_squared());
                let cosine = 1.0 - half * (1.0 + bend * half);
                first += f64::from(weight) * cosine;
                second += f64::from(weight) * (1.5 * cosine * cosine - 0.5);
            }
            (first * finer[0] - own[0]).abs().max((second * finer[1] - own[1]).abs())
        };
        assert!(off(between.bend) < 6e-4, "map {map}: off by {}", off(between.bend));
        assert!(map + 1 < levels.count() || off(0.0) > 1e-3, "without the bend {}", off(0.0));
    }
}

#[test]
fn lobes_are_those_of_ggx() {
    let levels = Levels::over(512).expect("a size");
    // At .5 the ladder has no level between .192 and .35.
    for (roughness, allowed) in
        [(0.12, 0.02), (0.15, 0.01), (0.2, 0.01), (0.3, 0.006), (0.4, 0.005), (0.5, 0.007), (1.0, 0.002)]
    {
        let weights = weights_at(levels, roughness);
        let alpha = f64::from(roughness * roughness);
        let (mut error, mut square) = (0.0, 0.0);
        for pair in rings(levels).windows(2) {
            let (c, area) = (f64::midpoint(pair[0], pair[1]), pair[1] - pair[0]);
            if c < 1.0 - (6.0 * alpha).min(PI).cos() {
                let truth = lobe::kernel(Lobe::Ggx, alpha, c / 2.0) / lobe::kernel_integral(Lobe::Ggx, alpha);
                error += area * (lobe_of(levels, weights, c) - truth).powi(2);
                square += area * truth * truth;
            }
        }
        let epsilon = (error / square).sqrt();
        assert!(epsilon < allowed, "roughness {roughness}: epsilon {epsilon}");
    }
}

#[test]
fn reads_have_the_moments_of_a_gaussian() {
    let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        taps().iter().map(|(at, weight)| f64::from(*weight) * f(f64::from(at.x), f64::from(at.y))).sum()
    };
    assert!((sum(&|_, _| 1.0) - 1.0).abs() < 1e-6, "all of the light");
    assert!(sum(&|x, _| x).abs() < 1e-6 && sum(&|_, y| y).abs() < 1e-6, "no shift");
    assert!((sum(&|x, _| x * x) - 1.0).abs() < 0.02, "a variance of 1");
    assert!((sum(&|x, y| x * x - y * y)).abs() < 1e-6 && sum(&|x, y| x * y).abs() < 1e-6, "round");
}

fn map_of(size: u32, seed: u64, look: Look) -> (Environment, Oem) {
    let layout = Layout::Octahedral { size };
    let texels = texels(&mut Random::new(seed), look, layout);
    (environment(layout, texels.clone()), oem(OemSize { inner: size, border: 0 }, &texels))
}

/// Exhaustive sums of `oem` under a Gaussian lobe. Its texels' light lies at their centres, which widens it
/// by a twelfth of a texel's square.
fn under_gaussian(oem: &Oem, width: f64, direction: DVec3) -> DVec3 {
    let inner = oem.size().inner;
    let (t, b) = direction.any_orthonormal_pair();
    let in_plane = |v: DVec3| DVec2::new(v.dot(t), v.dot(b));
    let uv = oct_from_direction(direction);
    let mut covariance = DMat2::from_diagonal(DVec2::splat(width * width));
    for step in [DVec2::X, DVec2::Y].map(|axis| axis / f64::from(inner)) {
        let texel = in_plane(direction_from_oct(uv - step.copysign(uv)) - direction_from_oct(uv)) * 2.0;
        covariance -= DMat2::from_cols(texel * texel.x, texel * texel.y) * (1.0 / 12.0);
    }
    let inverse = covariance.inverse();
    let (mut sum, mut total) = (DVec3::ZERO, 0.0);
    for (k, [r, g, b, w]) in (0..).zip(oem.square()) {
        let to = direction_from_oct(texel_centre(inner, k % inner, k / inner));
        // As far away as on the sphere.
        let offset = in_plane(to).normalize_or_zero() * to.distance(direction);
        let weight = (-0.5 * offset.dot(inverse * offset)).exp();
        sum += weight * DVec3::new(f64::from(*r), f64::from(*g), f64::from(*b));
        total += weight * f64::from(*w);
    }
    sum / total
}

#[test]
fn reads_around_no_direction_are_no_numbers() {
    let (_, oem) = map_of(32, 3, Look::Noise);
    let pyramid = Pyramid::of_oem(&oem).expect("a size");
    assert!(on_both_maps(pyramid).iter().flat_map(Pyramid::maps).all(|map| map.around(DVec3::NAN).is_nan()));
}

#[test]
fn reads_of_levels_are_gaussians() {
    let (_, oem) = map_of(128, 3, Look::Noise);
    let pyramid = Pyramid::of_oem(&oem).expect("a size");
    // Noise over four decades, clamped below the suns: compare with the same clamp.
    let clamp = pyramid.suns().clamp;
    let rest: Vec<_> = oem
        .square()
        .map(|[r, g, b, w]| {
            let kept = (clamp / (r.max(*g).max(*b) / w)).min(1.0);
            [r * kept, g * kept, b * kept, *w]
        })
        .collect();
    let rest = Oem::from_square(oem.size(), rest);
    let levels = Levels::over(128).expect("a size");
    let scale = f64::from(pyramid.exponent()).exp2();
    let mut random = Random::new(4);
    for (width, map) in (2..levels.count()).map(|map| levels.width(map)).zip(&pyramid.maps()[2..]) {
        let (mut error, mut square) = (0.0, 0.0);
        for _ in 0..200 {
            let direction = random.direction();
            let truth = under_gaussian(&rest, width, direction);
            let found = map.around(direction).as_dvec3() * scale;
            error += (found - truth).length_squared();
            square += truth.length_squared();
        }
        let relative = (error / square).sqrt();
        assert!(relative < 0.012, "a Gaussian of {width}: off by {relative}");
    }
}

/// Light that grows along x has hardly a slope across z = 0, where the octahedron's faces meet. Reads that
/// bend with the faces have one of .2 and more.
#[test]
fn reads_across_the_octahedrons_edges_do_not_bend() {
    let size = 128;
    let texel = |k: u32| [1.0 + 0.9 * direction_from_oct(texel_centre(size, k % size, k / size)).x as f32; 3];
    let texels = (0..size * size).map(texel).collect();
    let environment = Environment::new(Layout::Octahedral { size }, texels).expect("an environment");
    let pyramid = Pyramid::build(&environment, size).expect("a pyramid");
    let scale = (pyramid.exponent() as f32).exp2();
    for map in &pyramid.maps()[1..] {
        for beside in (0..32).map(|k| DVec2::from_angle(2.0 * PI * (f64::from(k) + 0.5) / 32.0)) {
            // Half a texel to either side.
            let step = 0.1 / f64::from(map.inner());
            let read = |k: i32| map.around(beside.extend(f64::from(k) * step).normalize()).x;
            let slopes = (-10..10).map(|k| scale * (read(k + 1) - read(k)).abs() / step as f32);
            let most = slopes.fold(0.0, f32::max);
            assert!(most < 0.1, "{} texels, around {beside}: {most}", map.inner());
        }
    }
}

/// On octahedral squares, and on cubes as files of `--map cube` hold it.
fn on_both_maps(pyramid: Pyramid) -> [Pyramid; 2] {
    let cubes = pyramid.on_cubes();
    [pyramid, cubes]
}

fn energy_of(sun: &Sun) -> f32 {
    sun.channels.iter().map(|channel| channel.energy).sum()
}

#[test]
fn a_constant_sky_is_constant_and_has_no_suns() {
    for brightness in [1e-30_f32, 1e-5, 1.0, 6e4, 1e30] {
        let texels = vec![[brightness, 0.5 * brightness, 0.0]; 64 * 64];
        let pyramid = Pyramid::of_oem(&oem(OemSize { inner: 64, border: 0 }, &texels)).expect("a size");
        // Rounding leaves differences between texels that are equal.
        let energy: f32 = pyramid.suns().suns.iter().map(energy_of).sum();
        assert!(energy <= 1e-5 * brightness, "{energy} in suns of {brightness}");
        let mut random = Random::new(5);
        for pyramid in on_both_maps(pyramid) {
            for _ in 0..100 {
                let direction = random.direction();
                for roughness in [0.0, 0.1, 0.3, 0.7, 1.0] {
                    let radiance = pyramid.lobes(roughness).radiance(direction);
                    let [r, g, b] = radiance.map(|value| value / brightness);
                    let off = (r - 1.0).abs().max((g - 0.5).abs()).max(b.abs());
                    assert!(off < 2e-3, "{brightness} at {roughness}: {r} {g} {b}");
                }
                let [r, ..] = pyramid.irradiance(direction);
                assert!((r / brightness - 1.0).abs() < 2e-3, "irradiance {r} of {brightness}");
            }
        }
    }
}

#[test]
fn look_ups_are_near_the_oracle() {
    for (look, seed) in [(Look::Smooth, 6), (Look::Suns, 7)] {
        let (environment, oem) = map_of(256, seed, look);
        let pyramids = on_both_maps(Pyramid::of_oem(&oem).expect("a size"));
        let oracle = oracle::Oracle::new(&environment);
        let mut random = Random::new(8);
        // The last ones are the edges and corners of a cube.
        let directions: Vec<DVec3> = (0..40).map(|_| random.direction()).chain(landmarks()).collect();
        for (roughness, allowed) in [(0.25, 0.03), (0.3, 0.03), (0.5, 0.03), (0.8, 0.02), (1.0, 0.02)] {
            let truth: Vec<DVec3> = directions
                .iter()
                .map(|d| oracle.reflect(Lobe::Ggx, roughness, *d).expect("valid").into())
                .collect();
            for (pyramid, map) in pyramids.iter().zip(["squares", "cubes"]) {
                let lobes = pyramid.lobes(roughness as f32);
                for (directions, truth) in
                    [(&directions[..40], &truth[..40]), (&directions[40..], &truth[40..])]
                {
                    let found =
                        directions.iter().map(|d| DVec3::from_array(lobes.radiance(*d).map(f64::from)));
                    let error: f64 =
                        found.zip(truth).map(|(found, truth)| found.distance_squared(*truth)).sum();
                    let square: f64 = truth.iter().map(|truth| truth.length_squared()).sum();
                    let relative = (error / square).sqrt();
                    assert!(relative < allowed, "{look:?} on {map} at {roughness}: {relative}");
                }
            }
        }
        for normal in &directions[..20] {
            let truth = DVec3::from_array(oracle.reflect(Lobe::Cosine, 1.0, *normal).expect("valid"));
            for (pyramid, map) in pyramids.iter().zip(["squares", "cubes"]) {
                let found = DVec3::from_array(pyramid.irradiance(*normal).map(f64::from));
                let off = (found - truth).length() / truth.length();
                assert!(off < 0.02, "{look:?} on {map}: irradiance off by {off}");
            }
        }
    }
}

/// A sun of one texel at the corners of the octahedron, where maps fold, and elsewhere.
#[test]
fn suns_are_exact_around_themselves_at_every_fold() {
    let size = 256;
    for [x, y] in [[0, 128], [128, 128], [255, 255], [127, 0], [60, 90], [200, 250]] {
        let mut light = vec![[0.2, 0.3, 0.4]; (size * size) as usize];
        light[(y * size + x) as usize] = [5e4, 4e4, 3e4];
        let environment = environment(Layout::Octahedral { size }, light.clone());
        let pyramid = Pyramid::of_oem(&oem(OemSize { inner: size, border: 0 }, &light)).expect("a size");
        let given = pyramid.suns().suns.iter().filter(|sun| energy_of(sun) > 1e-3).count();
        assert!((1..=COUNT).contains(&given), "one sun, not {given}");
        let oracle = oracle::Oracle::new(&environment);
        let sun = direction_from_oct(texel_centre(size, x, y));
        let mut random = Random::new(9);
        for roughness in [0.2, 0.3, 0.6] {
            let (mut error, mut square) = (0.0, 0.0);
            for _ in 0..30 {
                let away = random.unit() * 6.0 * roughness * roughness;
                let direction = sun * away.cos() + sun.cross(random.direction()).normalize() * away.sin();
                let truth =
                    DVec3::from_array(oracle.reflect(Lobe::Ggx, roughness, direction).expect("valid"));
                let found = pyramid.lobes(roughness as f32).radiance(direction).map(f64::from);
                error += (DVec3::from_array(found) - truth).length_squared();
                square += truth.length_squared();
            }
            let epsilon = (error / square).sqrt();
            assert!(epsilon < 0.03, "sun at ({x}, {y}), roughness {roughness}: epsilon {epsilon}");
        }
    }
}

/// Suns of three texels of a panorama, which are strips: at folds, at a pole, and elsewhere.
#[test]
fn suns_are_as_long_as_they_are() {
    let (width, height) = (256, 128);
    for [x, y] in [[50, 35], [127, 63], [191, 30], [20, 3], [254, 100]] {
        let mut light = vec![[0.0; 3]; (width * height) as usize];
        // All black but for these, so that the suns have all light.
        let texels = [0, 1, 2].map(|k| [(x + k) % width, y]);
        for [x, y] in texels {
            light[(y * width + x) as usize] = [5e4, 4e4, 3e4];
        }
        let pyramid = Pyramid::build(&environment(Layout::Panorama { width, height }, light), 256);
        let pyramid = pyramid.expect("a size");
        // Points of the texels: directions and solid angles.
        let step = PI / f64::from(height);
        let points = texels.into_iter().flat_map(|[x, y]| {
            (0..64).map(move |k| {
                let place = |at: u32, k: u32| f64::from(at) + (f64::from(k) + 0.5) / 8.0;
                let [u, v] = [place(x, k % 8) / f64::from(width), place(y, k / 8) / f64::from(height)];
                (direction_from_equirect(u, v), step * step * (PI * v).sin() / 64.0)
            })
        });
        let points: Vec<_> = points.collect();
        let sun = points.iter().map(|(to, area)| *to * *area).sum::<DVec3>().normalize();
        let mut random = Random::new(3);
        for roughness in [0.2, 0.3] {
            let alpha: f64 = roughness * roughness;
            let kernel = |c: f64| lobe::kernel(Lobe::Ggx, alpha, (1.0 - c) / 2.0);
            let (mut error, mut square) = (0.0, 0.0);
            for _ in 0..200 {
                let away = random.unit() * 4.0 * alpha;
                let direction = sun * away.cos() + sun.cross(random.direction()).normalize() * away.sin();
                let lit: f64 = points.iter().map(|(to, area)| area * kernel(to.dot(direction))).sum();
                let truth = 5e4 * lit / lobe::kernel_integral(Lobe::Ggx, alpha);
                let found = f64::from(pyramid.lobes(roughness as f32).radiance(direction)[0]);
                error += (found - truth).powi(2);
                square += truth.powi(2);
            }
            let epsilon = (error / square).sqrt();
            assert!(epsilon < 0.01, "sun at ({x}, {y}), roughness {roughness}: epsilon {epsilon}");
        }
    }
}

/// Suns of four texels, at folds and at corners of the blocks that are searched: each would take four.
#[test]
fn eight_suns_fit_wherever_they_lie() {
    for size in [256, 512] {
        let (edge, half) = (size - 1, size / 2);
        // A corner of the sun; others are beside and above it, or where the map folds.
        let inside = |x: u32, y: u32| [[x - 1, y - 1], [x, y - 1], [x - 1, y], [x, y]];
        let fold = |y: u32| [[0, y], [1, y], [0, edge - y], [1, edge - y]];
        let suns = [
            fold(size / 5),
            inside(half, half),
            inside(half, size / 4),
            inside(size / 4, half),
            inside(size / 4, size / 4),
            inside(3 * size / 4, size / 4),
            inside(3 * size / 4, 3 * size / 4),
            [[0, 0], [edge, 0], [0, edge], [edge, edge]],
        ];
        let mut light = vec![[0.2, 0.3, 0.4]; (size * size) as usize];
        // Dimmer ones around the first.
        for [x, y] in [[30, size / 5], [30, size / 5 + 9], [8, size / 5 + 16], [9, size / 5 - 16]] {
            light[(y * size + x) as usize] = [2.0, 1.0, 1.0];
        }
        for (k, [x, y]) in (0..).zip(suns.as_flattened()) {
            light[(y * size + x) as usize] = [5e4 - k as f32, 4e4, 3e4];
        }
        let oem = oem(OemSize { inner: size, border: 0 }, &light);
        let pyramid = Pyramid::of_oem(&oem).expect("a size");
        let found = pyramid.suns();
        assert!(found.clamp < 3.0, "{size}: clamped to {}", found.clamp);
        for sun in suns {
            let centre: DVec3 = sun.iter().map(|[x, y]| direction_from_oct(texel_centre(size, *x, *y))).sum();
            let power: f32 = sun.iter().map(|[x, y]| oem.texel(*x, *y)[1]).sum();
            let near = |own: &&Sun| {
                own.channels[1].direction.as_dvec3().distance(centre.normalize()) < 0.5 / f64::from(size)
            };
            let found = found.suns.iter().find(near).unwrap_or_else(|| panic!("{size}: no sun at {sun:?}"));
            let energy = found.channels[1].energy;
            assert!((energy / power - 1.0).abs() < 1e-3, "{size}, {sun:?}: {energy} of {power}");
        }
    }
}

/// A half float's least is 5e11 times smaller than what the brightest light is scaled to.
#[test]
fn a_sky_far_below_its_sun_is_kept() {
    let size = 64;
    for brightness in [1e6_f32, 1e9, 1e12, 1e15] {
        let mut light = vec![[1.0, 0.7, 0.5]; (size * size) as usize];
        light[(20 * size + 40) as usize] = [brightness; 3];
        let pyramid = Pyramid::of_oem(&oem(OemSize { inner: size, border: 0 }, &light)).expect("a size");
        let away = -direction_from_oct(texel_centre(size, 40, 20));
        let finite = pyramid.maps().iter().all(|map| map.around(-away).is_finite());
        assert!(finite, "the mirror overflows for {brightness}");
        let rough = [0.0, 0.1, 0.3, 0.8].map(|roughness| pyramid.lobes(roughness).radiance(away));
        for [r, g, b] in rough.into_iter().chain([pyramid.irradiance(away)]) {
            let off = (r - 1.0).abs().max((g - 0.7).abs()).max((b - 0.5).abs());
            assert!(off < 0.01, "{brightness}: {r} {g} {b}");
        }
    }
}

#[test]
fn other_sizes_are_errors() {
    for size in [0, 16, 48, 4096] {
        let error = Levels::over(size).expect_err("no pyramid").to_string();
        assert!(error.contains("power of two from 32 to 2048"), "{error}");
    }
}
