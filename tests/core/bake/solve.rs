//! Solved chains: what they keep, what they must not show, and that look-ups of them are nearer lobes.

use glam::DVec3;
use octagloss_core::analysis::delivered::{
    DIRECTIONS, DeliveredError, default_roughnesses, delivered_errors, even_directions,
};
use octagloss_core::bake::{BakeSettings, bake};
use octagloss_core::common::error::Error;
use octagloss_core::cpu::reflector::{Reflector, ReflectorSettings};
use octagloss_core::light::chain::{Chain, ChainKind, Level};
use octagloss_core::light::chain_lookup::ChainLookup;
use octagloss_core::light::environment::{Environment, Layout, Map, Rgb};
use octagloss_core::light::synth::synth;
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter;
use octagloss_core::lobe::ladder::Ladder;
use octagloss_fixtures::common::sweep;
use std::f64::consts::{PI, TAU};

fn settings(chain: ChainKind, ladder: Ladder, levels: u32) -> BakeSettings {
    BakeSettings { size: 64, levels: Some(levels), ladder, chain: Some(chain), ..BakeSettings::default() }
}

fn chain(environment: &Environment, kind: ChainKind, ladder: Ladder, levels: u32) -> Chain {
    bake(environment, &settings(kind, ladder, levels)).expect("a small bake").chain
}

fn panorama(width: u32, texels: Vec<Rgb>) -> Environment {
    Environment::new(Layout::Panorama { width, height: width / 2 }, texels).expect("as many texels")
}

/// Root mean square of `errors` over the roughnesses from `first` to 1.
fn over_roughness(errors: &[DeliveredError], first: f64) -> f64 {
    let squares: Vec<f64> = errors
        .iter()
        .filter(|error| error.roughness >= first)
        .map(|error| error.rmse.luminance.powi(2))
        .collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

#[test]
fn a_furnace_stays_one_and_level_0_a_mirror() {
    let furnace = panorama(32, vec![[2.0, 0.5, 1e-3]; 512]);
    for ladder in Ladder::ALL {
        let levels = if ladder == Ladder::Babylon { 7 } else { 5 };
        let solved = bake(&furnace, &settings(ChainKind::Solved, ladder, levels)).expect("a furnace");
        for texel in solved.chain.levels.iter().flat_map(|level| &level.texels) {
            for (value, wanted) in texel.iter().zip([2.0, 0.5, 1e-3]) {
                assert!((value / wanted - 1.0).abs() < 1e-6, "{ladder:?}: {texel:?}");
            }
        }
    }
    let sky = synth("sky").expect("a recipe");
    let [sampled, solved] =
        [ChainKind::Sampled, ChainKind::Solved].map(|kind| chain(&sky, kind, Ladder::Linear, 5));
    assert_eq!(sampled.levels[0], solved.levels[0]);
    assert_ne!(sampled.levels[1], solved.levels[1]);
    assert_eq!(chain(&sky, ChainKind::Solved, Ladder::Linear, 5), solved, "always the same");
    assert!(solved.levels.iter().flat_map(|level| level.texels.as_flattened()).all(|value| *value >= 0.0));
}

#[test]
fn levels_that_no_look_up_reads_keep_their_lobes() {
    let sky = synth("studio").expect("a recipe");
    // Of seven levels from 64 texels roughness 1 looks up the fifth: 0.8 log2(64) = 4.8.
    let [sampled, solved] =
        [ChainKind::Sampled, ChainKind::Solved].map(|kind| chain(&sky, kind, Ladder::Babylon, 7));
    assert!((Ladder::Babylon.lod(1.0, 7, 64) - 4.8).abs() < 1e-12);
    assert_eq!(sampled.levels[6], solved.levels[6]);
    assert_ne!(sampled.levels[5], solved.levels[5]);
}

#[test]
fn mixed_chains_keep_sharp_levels_and_solve_the_others() {
    let sky = synth("studio").expect("a recipe");
    // Roughness 0, 1/5, 2/5, 3/5, 4/5 and 1: solved from the third level on.
    let [sampled, mixed] =
        [ChainKind::Sampled, ChainKind::Mixed].map(|kind| chain(&sky, kind, Ladder::Linear, 6));
    assert_eq!(mixed.levels[..2], sampled.levels[..2]);
    for level in 2..6 {
        assert_ne!(mixed.levels[level].texels, sampled.levels[level].texels, "level {level}");
    }
    // Look-ups up to the last sampled level are those of the sampled chain, rougher ones nearer the lobes.
    let [before, after] = [&sampled, &mixed].map(|chain| errors(&sky, chain, Ladder::Linear));
    let over = |errors: &[(f64, f64)]| {
        let rough = errors.iter().filter(|(roughness, _)| *roughness > 0.2);
        rough.map(|(_, error)| error * error).sum::<f64>().sqrt()
    };
    assert!(1.05 * over(&after) < over(&before), "{after:?} for {before:?}");
    // Few levels have only sharp steps.
    let first = |kind: ChainKind, roughness: &[f64]| kind.first_solved(roughness.iter().copied());
    assert_eq!(first(ChainKind::Mixed, &[0.0, 1.0]), 2);
    assert_eq!(first(ChainKind::Mixed, &[0.0, 0.5, 1.0]), 2);
    assert_eq!(first(ChainKind::Mixed, &[0.0, 1.0 / 6.0, f64::from(1.0_f32 / 3.0), 0.5]), 3);
    assert_eq!(first(ChainKind::Solved, &[0.0, 0.5, 1.0]), 1);
    assert_eq!(first(ChainKind::Sampled, &[0.0, 0.5, 1.0]), 3);
    assert_eq!(
        chain(&sky, ChainKind::Mixed, Ladder::Linear, 2),
        chain(&sky, ChainKind::Sampled, Ladder::Linear, 2)
    );
}

#[test]
fn mixed_chains_are_the_default_of_linear_cubes_of_ggx() {
    let default = BakeSettings::default();
    assert_eq!(default.chain(), ChainKind::Mixed);
    for settings in [
        BakeSettings { map: Map::Panorama, ..default.clone() },
        BakeSettings { lobe: Lobe::Phong, ..default.clone() },
        BakeSettings { ladder: Ladder::Filament, ..default.clone() },
        BakeSettings { filter: Filter::Reference, ..default.clone() },
        BakeSettings { bounds: true, ..default.clone() },
        BakeSettings { chain: Some(ChainKind::Sampled), ..default.clone() },
    ] {
        assert_eq!(settings.chain(), ChainKind::Sampled, "{settings:?}");
    }
}

#[test]
fn what_cannot_be_solved_is_refused() {
    let furnace = panorama(4, vec![[1.0; 3]; 8]);
    let solved = settings(ChainKind::Solved, Ladder::Linear, 3);
    for settings in [
        BakeSettings { lobe: Lobe::Phong, ..solved.clone() },
        BakeSettings { map: Map::Panorama, ..solved.clone() },
        BakeSettings { bounds: true, ..solved.clone() },
    ] {
        assert!(matches!(bake(&furnace, &settings), Err(Error::Parameter(_))), "{settings:?}");
    }
    // Chains too short to have anything between their levels are as they were.
    for levels in [1, 2] {
        let [sampled, solved] =
            [ChainKind::Sampled, ChainKind::Solved].map(|kind| chain(&furnace, kind, Ladder::Linear, levels));
        assert_eq!(sampled, solved);
    }
}

#[test]
fn a_lit_texel_has_no_rings() {
    let mut texels = vec![[0.0; 3]; 256 * 128];
    texels[60 * 256 + 150] = [1e4; 3];
    let lit = panorama(256, texels);
    let peak = lit.layout().direction_from_texel(0, 150, 60);
    let (u, v) = peak.any_orthonormal_pair();
    for (ladder, levels) in [(Ladder::Linear, 5), (Ladder::Filament, 4)] {
        let solved = chain(&lit, ChainKind::Solved, ladder, levels);
        let lookup = ChainLookup::new(&solved.levels);
        for step in 4..=4 * (levels - 1) {
            let lod = f64::from(step) / 4.0;
            for circle in 0..16 {
                let (sin, cos) = (f64::from(circle) * PI / 16.0).sin_cos();
                let along = u * cos + v * sin;
                let profile: Vec<f64> = (0..1500)
                    .map(|k| {
                        let (sin, cos) = (f64::from(k) / 1500.0 * TAU - PI).sin_cos();
                        lookup.read(peak * cos + along * sin, lod)[1]
                    })
                    .collect();
                let top = profile.iter().copied().fold(0.0, f64::max);
                let at = profile.iter().position(|value| *value == top).expect("a maximum");
                let rise = |values: &mut dyn Iterator<Item = &f64>| {
                    let mut least = top;
                    values.fold(0.0_f64, |most, value| {
                        least = least.min(*value);
                        most.max(value - least)
                    })
                };
                let most = rise(&mut profile[at..].iter()).max(rise(&mut profile[..at].iter().rev()));
                assert!(most <= 0.01 * top, "{ladder:?} lod {lod}, circle {circle}: {most} of {top}");
            }
        }
    }
}

/// Delivered errors by lobes of the reflector, at three roughnesses between each two levels; at last, as of
/// roughness 0, over all.
fn errors(environment: &Environment, chain: &Chain, ladder: Ladder) -> Vec<(f64, f64)> {
    let reflector =
        Reflector::new(environment, &ReflectorSettings { sharpest: 0.2, ..ReflectorSettings::default() })
            .expect("an OEM");
    let levels: Vec<f64> = chain.levels.iter().map(|level| level.roughness).collect();
    let between = |pair: &[f64], k: u32| pair[0] + (pair[1] - pair[0]) * (f64::from(k) + 0.5) / 3.0;
    let roughnesses: Vec<f64> =
        levels[1..].windows(2).flat_map(|pair| (0..3).map(move |k| between(pair, k))).collect();
    assert!(
        roughnesses.iter().zip(default_roughnesses(chain)).all(|(own, other)| (own - other).abs() < 1e-9)
    );
    let truth = |roughness: f64, directions: &[DVec3]| {
        let answers = reflector.query_all(directions, roughness, Lobe::Ggx, Filter::Adaptive(0.01))?;
        Ok(answers.into_iter().map(|answer| answer.radiance).collect())
    };
    let errors = delivered_errors(chain, ladder, &roughnesses, None, &truth).expect("lobes");
    assert!(errors.iter().all(|error| error.max_error >= error.rmse.luminance));
    let whole = over_roughness(&errors, 0.0);
    errors.into_iter().map(|error| (error.roughness, error.rmse.luminance)).chain([(0.0, whole)]).collect()
}

#[test]
fn look_ups_of_solved_chains_are_nearer_and_worse_chains_are_told() {
    for name in ["studio", "sky"].into_iter().take(sweep(1, 2)) {
        let environment = synth(name).expect("a recipe");
        let of = |kind| chain(&environment, kind, Ladder::Linear, 5);
        let whole = |chain: &Chain| errors(&environment, chain, Ladder::Linear).last().expect("the whole").1;
        let (sampled, solved) = (of(ChainKind::Sampled), of(ChainKind::Solved));
        let (before, after) = (whole(&sampled), whole(&solved));
        assert!(1.2 * after < before, "{name}: {after} for {before}");
        // The comparator detects a worse chain, and one of another ladder.
        let mut wrong = solved.clone();
        for texel in &mut wrong.levels[2].texels {
            *texel = texel.map(|value| value * 2.0);
        }
        assert!(whole(&wrong) > 1.5 * after, "{name}: {} for {after}", whole(&wrong));
        let other = errors(&environment, &sampled, Ladder::Filament).last().expect("the whole").1;
        assert!(other > 1.5 * before, "{name}: {other} for {before}");
    }
}

/// A seamless bilinear look-up of its own: the four texels around, those beyond an edge found by folding the
/// plane of the face over, a corner's as the mean of the other three.
fn look_up(level: &Level, d: DVec3) -> [f64; 3] {
    let n = level.size() as usize;
    let fold = |p: DVec3| -> (usize, f64, f64) {
        let a = p.abs();
        let (axis, m) = if a.x >= a.y && a.x >= a.z {
            (0, a.x)
        } else if a.y >= a.z {
            (1, a.y)
        } else {
            (2, a.z)
        };
        let face = 2 * axis + usize::from(p[axis] < 0.0);
        let (s, t) = [(-p.z, -p.y), (p.z, -p.y), (p.x, p.z), (p.x, -p.z), (p.x, -p.y), (-p.x, -p.y)][face];
        (face, s / m, t / m)
    };
    let unfold = |face: usize, s: f64, t: f64| {
        [
            DVec3::new(1.0, -t, -s),
            DVec3::new(-1.0, -t, s),
            DVec3::new(s, 1.0, t),
            DVec3::new(s, -1.0, -t),
            DVec3::new(s, -t, 1.0),
            DVec3::new(-s, -t, -1.0),
        ][face]
    };
    let (face, s, t) = fold(d);
    let place = |x: f64| (x + 1.0) / 2.0 * n as f64 - 0.5;
    let (i, j) = (place(s).floor(), place(t).floor());
    let (a, b) = (place(s) - i, place(t) - j);
    let outside = |k: f64| k < 0.0 || k >= n as f64;
    let texel = |i: f64, j: f64| -> Option<[f64; 3]> {
        if outside(i) && outside(j) {
            return None;
        }
        // A place beyond an edge is next to it, in the neighbour's outermost row.
        let near =
            |k: f64| if outside(k) { k.signum() * (1.0 + 1e-7) } else { (k + 0.5) / n as f64 * 2.0 - 1.0 };
        let (face, s, t) = fold(unfold(face, near(i), near(j)));
        let line = |x: f64| (((x + 1.0) / 2.0 * n as f64).floor() as usize).min(n - 1);
        Some(level.texels[(face * n + line(t)) * n + line(s)].map(f64::from))
    };
    let corners = [(i, j), (i + 1.0, j), (i, j + 1.0), (i + 1.0, j + 1.0)].map(|(i, j)| texel(i, j));
    let known: Vec<[f64; 3]> = corners.iter().flatten().copied().collect();
    let mean: [f64; 3] =
        std::array::from_fn(|c| known.iter().map(|k| k[c]).sum::<f64>() / known.len() as f64);
    let [p, q, r, s] = corners.map(|corner| corner.unwrap_or(mean));
    std::array::from_fn(|c| (p[c] * (1.0 - a) + q[c] * a) * (1.0 - b) + (r[c] * (1.0 - a) + s[c] * a) * b)
}

#[test]
fn look_ups_and_their_errors_are_those_of_another_look_up() {
    let value = |k: usize| ((k * 7919 % 101) as f32) / 50.0;
    let level = |size: u32, roughness: f64| {
        let texels =
            (0..6 * (size * size) as usize).map(|k| [value(k), value(k + 13), value(3 * k)]).collect();
        Level::cube(size, roughness, texels)
    };
    let chain =
        Chain { levels: vec![level(8, 0.0), level(4, 1.0 / 3.0), level(2, 2.0 / 3.0), level(1, 1.0)] };
    let lookup = ChainLookup::new(&chain.levels);
    let mut directions = even_directions(3000);
    directions.extend([DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0001), DVec3::new(1.0, -1.0, 0.3), DVec3::X]);
    for (index, level) in chain.levels.iter().enumerate() {
        for direction in &directions {
            let (ours, other) = (lookup.read(*direction, index as f64), look_up(level, *direction));
            for c in 0..3 {
                assert!((ours[c] - other[c]).abs() < 1e-6, "level {index} {direction}: {ours:?} {other:?}");
            }
        }
    }
    let wanted: Rgb = [0.9, 1.0, 1.1];
    let truth = |_: f64, directions: &[DVec3]| Ok(vec![wanted; directions.len()]);
    let luminance = |rgb: [f64; 3]| 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    for (ladder, roughness, lod) in [
        (Ladder::Linear, 0.5, 1.5),
        (Ladder::Filament, 0.5, 2.25),
        (Ladder::Unity, 0.5, 2.025),
        (Ladder::Babylon, 0.6, 0.8 * 2.88_f64.log2()),
    ] {
        let found = delivered_errors(&chain, ladder, &[roughness], None, &truth).expect("constants")[0];
        let (low, share) = (lod as usize, lod - lod.floor());
        let goal = luminance(wanted.map(f64::from));
        let errors: Vec<f64> = even_directions(DIRECTIONS)
            .into_iter()
            .map(|d| {
                let (a, b) = (look_up(&chain.levels[low], d), look_up(&chain.levels[low + 1], d));
                (luminance(a) * (1.0 - share) + luminance(b) * share - goal).abs()
            })
            .collect();
        let rmse = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt() / goal;
        let most = errors.iter().copied().fold(0.0, f64::max) / goal;
        assert!((found.lod - lod).abs() < 1e-6, "{found:?}");
        assert!((found.rmse.luminance / rmse - 1.0).abs() < 1e-5, "{ladder:?}: {found:?} for {rmse}");
        assert!((found.max_error / most - 1.0).abs() < 1e-5, "{ladder:?}: {found:?} for {most}");
    }
}

#[test]
fn levels_of_detail_are_the_inverse_of_the_ladders() {
    for (ladder, levels) in
        [(Ladder::Linear, 7), (Ladder::Filament, 6), (Ladder::Unity, 7), (Ladder::Babylon, 7)]
    {
        for level in 1..levels {
            let lod = ladder.lod(ladder.roughness(level, levels, 256), levels, 256);
            let known = if ladder == Ladder::Babylon { f64::from(level).min(6.4) } else { f64::from(level) };
            assert!((lod - known).abs() < 1e-6, "{ladder:?} {level}: {lod}");
        }
        assert_eq!(ladder.lod(0.0, levels, 256), 0.0);
        assert_eq!(Ladder::named(ladder.name()), Some(ladder));
    }
}
