//! Continuity of the filters: across folds and packets, and in roughness.

use super::adaptive::{ask, luminance, reflector, served};
use glam::DVec3;
use octagloss_core::bake::{BakeSettings, bake};
use octagloss_core::light::environment::Layout;
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter;
use octagloss_core::sphere::cube;
use octagloss_fixtures::bounds::{ServedOracle, with_luminance};
use octagloss_fixtures::common::{Look, Random, environment, landmarks, sweep, texels};
use rayon::prelude::*;

/// Returns directions on every crease of the map, each with a way across: the three coordinate planes, which
/// contain the fold, the axes and the square's edges, and the vertices.
fn creases(random: &mut Random) -> Vec<(DVec3, DVec3)> {
    let mut all = Vec::new();
    for (normal, along) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::Z, DVec3::X)] {
        let other = normal.cross(along);
        for k in 0..64 {
            // On the vertices, near them, and anywhere.
            let angle = match k % 4 {
                0 => f64::from(k) / 32.0 * std::f64::consts::PI,
                1 => f64::from(k / 16) * std::f64::consts::FRAC_PI_2 + 1e-9 * random.between(-1.0, 1.0),
                _ => random.between(0.0, std::f64::consts::TAU),
            };
            all.push((along * angle.cos() + other * angle.sin(), normal));
        }
    }
    all
}

#[test]
fn boxes_are_continuous_across_every_fold() {
    let mut random = Random::new(34);
    let mut compared = 0;
    for n in [8, 17, 32] {
        let layout = Layout::Octahedral { size: n };
        let environment = environment(layout, texels(&mut random, Look::Noise, layout));
        let reflector = reflector(&environment, n);
        let brightest = environment.texels().iter().flatten().copied().fold(0.0, f32::max);
        for lobe in [Lobe::Ggx, Lobe::Cone] {
            for roughness in [0.0, 0.05, 0.2, 0.4, 0.7, 1.0] {
                for (at, across) in creases(&mut random) {
                    let step = 1e-7;
                    let pair = [(at - across * step).normalize(), (at + across * step).normalize()];
                    let answers = ask(&reflector, lobe, roughness, Filter::Box, &pair);
                    for c in 0..3 {
                        // The box has at least one texel's weight. A direction's step moves it by 3 sqrt(3)
                        // times as much in (u, v) and the density resizes it by as much again. It exchanges
                        // at most 4 sides' worth of texels that are up to 5.2 times heavier.
                        let allowed =
                            f64::from(brightest) * 2.0 * step * 5.2 * f64::from(n) / 2.0 * 8.0 * 5.2;
                        let change = (answers[0][c] - answers[1][c]).abs();
                        assert!(
                            change <= allowed + 2e-7 * answers[0][c],
                            "{n} {lobe:?} {roughness} {at}: a step of {change:e}, {allowed:e} allowed"
                        );
                        compared += 1;
                    }
                }
            }
        }
    }
    assert_eq!(compared, 3 * 2 * 6 * 192 * 3);
}

#[test]
fn boxes_are_continuous_in_roughness_down_to_the_mirror() {
    let mut random = Random::new(35);
    let n = 32;
    let layout = Layout::Octahedral { size: n };
    let environment = environment(layout, texels(&mut random, Look::Noise, layout));
    let reflector = reflector(&environment, n);
    let brightest = environment.texels().iter().flatten().copied().fold(0.0, f32::max);
    let directions: Vec<DVec3> = landmarks().into_iter().chain((0..30).map(|_| random.direction())).collect();
    let step = 1e-6;
    let mut compared = 0;
    for lobe in [Lobe::Ggx, Lobe::Phong, Lobe::Cone] {
        let starts = [0.0, 1e-5, 1e-4, 1e-3, 0.01, 0.05, 0.2].into_iter();
        for roughness in starts.chain((0..20).map(|k| f64::from(k) / 20.0)) {
            let before = ask(&reflector, lobe, roughness, Filter::Box, &directions);
            let after = ask(&reflector, lobe, roughness + step, Filter::Box, &directions);
            for (before, after) in before.iter().zip(&after) {
                for c in 0..3 {
                    // A side grows by at most 2 n per unit of roughness; the rim has 4 sides, of texels up to
                    // 5.2 times heavier, over a box of at least one texel.
                    let allowed = f64::from(brightest) * 4.0 * 2.0 * f64::from(n) * 5.2 * step;
                    let change = (before[c] - after[c]).abs();
                    assert!(
                        change <= allowed + 2e-7 * before[c],
                        "{lobe:?} {roughness}: a step of {change:e}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 3 * 27 * 56 * 3);
}

#[test]
fn adaptive_is_continuous_in_roughness_down_to_the_mirror() {
    let mut random = Random::new(36);
    let n = 64;
    let layout = Layout::Octahedral { size: n };
    let directions: Vec<DVec3> = landmarks().into_iter().chain((0..20).map(|_| random.direction())).collect();
    let mut compared = 0;
    for look in [Look::Noise, Look::Smooth, Look::Suns] {
        let environment = environment(layout, texels(&mut random, look, layout));
        let reflector = reflector(&environment, n);
        let totals = reflector.oem().totals();
        let mean = luminance([totals[0], totals[1], totals[2]]) / (4.0 * std::f64::consts::PI);
        let error = 0.001;
        let filter = Filter::Adaptive(error);
        let mirror = ask(&reflector, Lobe::Ggx, 0.0, filter, &directions);
        for roughness in [1e-5, 2e-4, 3e-4, 1e-3] {
            let sharp = ask(&reflector, Lobe::Ggx, roughness, filter, &directions);
            for ((mirror, sharp), direction) in mirror.iter().zip(&sharp).zip(&directions) {
                // A lobe of alpha up to 1e-6 is a mirror except for the interpolation's slope over a few
                // alpha. The difference is the adaptive filter's error, a few E of the mean for lobes this
                // sharp. Without interpolation it would be up to a texel's contrast.
                let (mirror, sharp) = (luminance(*mirror), luminance(*sharp));
                let allowed = 20.0 * error * mean + 1e-4 * mirror;
                assert!(
                    (mirror - sharp).abs() <= allowed,
                    "{look:?} roughness {roughness} {direction}: {mirror} against {sharp}"
                );
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 3 * 4 * 46);
}

/// Returns root mean squares of the steps of `values` between neighbours: inside packets, between packets,
/// across the map's creases, and across the edges of faces.
fn steps(size: u32, values: &[f64]) -> [f64; 4] {
    let n = size as usize;
    let mut sums = [(0.0, 0.0); 4];
    for (k, value) in values.iter().enumerate() {
        let (face, i, j) = (cube::Face::ALL[k / (n * n)], k as u32 % size, k as u32 / size % size);
        let at = |i: i64, j: i64| {
            let place = |k: i64| (k as f64 + 0.5) / f64::from(size) * 2.0 - 1.0;
            cube::cube_point(face, place(i), place(j))
        };
        let here = at(i64::from(i), i64::from(j));
        for (di, dj) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
            let there = at(i64::from(i) + di, i64::from(j) + dj);
            let (other_face, s, t) = cube::cube_from_direction(there);
            let place = |t: f64| (((t + 1.0) / 2.0 * f64::from(size)) as usize).min(n - 1);
            let other = (other_face.index() * n + place(t)) * n + place(s);
            let crossed = (0..3).any(|axis| here[axis] * there[axis] < 0.0);
            let side =
                |k: u32, d: i64| (k / PACKET) as i64 != (i64::from(k) + d).div_euclid(i64::from(PACKET));
            let kind = if other_face != face {
                3
            } else if crossed {
                2
            } else {
                usize::from(side(i, di) || side(j, dj))
            };
            sums[kind].0 += (value - values[other]).powi(2);
            sums[kind].1 += 1.0;
        }
    }
    assert!(sums.iter().all(|(_, count)| *count > 100.0), "steps of every kind: {sums:?}");
    sums.map(|(sum, count): (f64, f64)| (sum / count).sqrt())
}

/// Texels along an edge of a bake's packets.
const PACKET: u32 = 4;

#[test]
fn steps_of_a_bake_are_no_larger_at_edges_than_inside() {
    let mut random = Random::new(38);
    let layout = Layout::Panorama { width: 64, height: 32 };
    let environment = environment(layout, texels(&mut random, Look::Smooth, layout));
    let settings = BakeSettings {
        size: 64,
        levels: Some(3),
        filter: Filter::Adaptive(0.005),
        oem_size: Some(64),
        ..BakeSettings::default()
    };
    let bake = bake(&environment, &settings).expect("a small bake");
    let oracle = served(&environment, &reflector(&environment, 64));
    let level = &bake.chain.levels[1];
    let size = level.size();
    assert_eq!((size, level.roughness), (32, 0.5));
    let baked: Vec<f64> = level.texels.iter().map(|rgb| luminance(rgb.map(f64::from))).collect();
    let truth: Vec<f64> = (0..6 * size * size)
        .into_par_iter()
        .map(|k| {
            let face = cube::Face::ALL[(k / (size * size)) as usize];
            let direction = cube::direction_from_texel(face, size, k % size, k / size % size);
            luminance(oracle.reflect(Lobe::Ggx, 0.5, direction))
        })
        .collect();
    let (served_steps, true_steps) = (steps(size, &baked), steps(size, &truth));
    let ratios: [f64; 4] = std::array::from_fn(|kind| served_steps[kind] / true_steps[kind]);
    println!("steps over the oracle's: inside, packets, creases, faces {ratios:.4?}");
    for (ratio, kind) in ratios[1..].iter().zip(["packets", "creases", "faces"]) {
        assert!(*ratio <= 1.05 * ratios[0], "{kind}: {ratio} of the oracle's steps, {} inside", ratios[0]);
    }
    // Steps of E of the mean between packets must be detected.
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    let n = size as usize;
    let mut torn = baked.clone();
    for (k, value) in torn.iter_mut().enumerate() {
        let (i, j) = (k % n / PACKET as usize, k / n / PACKET as usize);
        *value += if (i + j) % 2 == 0 { 0.01 * mean } else { 0.0 };
    }
    let torn = steps(size, &torn);
    assert!(
        torn[1] / true_steps[1] > 1.05 * torn[0] / true_steps[0],
        "torn packets are not detected: {torn:?}"
    );
}

#[test]
fn adaptive_steps_little_beyond_the_oracle_s_own_step() {
    let scenes = sweep(30_u64, 60);
    let outcome: Vec<(f64, String)> = (0..scenes)
        .into_par_iter()
        .flat_map_iter(|seed| {
            let mut random = Random::new(4000 + seed);
            let look = Look::ALL[seed as usize % 5];
            let n = 24 + random.below(20);
            let layout = Layout::Octahedral { size: n };
            let environment = environment(layout, texels(&mut random, look, layout));
            let reflector = reflector(&environment, n);
            let oracle = served(&environment, &reflector);
            let totals = reflector.oem().totals();
            let mean = with_luminance([0, 1, 2].map(|c| totals[c] / (4.0 * std::f64::consts::PI)));
            let creases = creases(&mut random);
            (0..40)
                .map(|k| {
                    let (at, across) = if k % 2 == 0 {
                        creases[random.below(creases.len() as u32) as usize]
                    } else {
                        (random.direction(), random.direction())
                    };
                    let step = 10_f64.powf(random.between(-6.0, -1.5));
                    let pair = [(at - across * step).normalize(), (at + across * step).normalize()];
                    let roughness = random.between(0.1, 1.0);
                    let error = 10_f64.powf(random.between(-3.0, -1.5));
                    let answers = ask(&reflector, Lobe::Ggx, roughness, Filter::Adaptive(error), &pair);
                    let truth = pair.map(|d| with_luminance(oracle.reflect(Lobe::Ggx, roughness, d)));
                    let [before, after] = [0, 1].map(|k| with_luminance(answers[k]));
                    // Of the luminance and of every channel, over its mean.
                    let excess = (0..4).map(|c| {
                        let doubt = ServedOracle::accuracy(Lobe::Ggx) * (truth[0][c] + truth[1][c]);
                        let beyond = ((after[c] - before[c]) - (truth[1][c] - truth[0][c])).abs() - doubt;
                        beyond / (error * mean[c].max(mean[0] / 100.0))
                    });
                    (
                        excess.fold(f64::NEG_INFINITY, f64::max),
                        format!("{look:?} {n}^2 roughness {roughness} E {error} {pair:?}"),
                    )
                })
                .collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(outcome.len() as u64, 40 * scenes, "steps were compared");
    let mut sorted: Vec<f64> = outcome.iter().map(|(excess, _)| *excess).collect();
    sorted.sort_by(f64::total_cmp);
    println!(
        "excess step over E of the mean: median {:.4}, 99 % {:.3}, greatest {:.3}",
        sorted[sorted.len() / 2],
        sorted[sorted.len() * 99 / 100],
        sorted[sorted.len() - 1]
    );
    let (excess, case) = outcome.iter().max_by(|a, b| a.0.total_cmp(&b.0)).expect("steps");
    assert!(*excess <= 1.0, "a step of {excess} times E of the mean beyond the oracle's: {case}");
}
