//! Complete bakes of the synthetic environments, compared with the CPU's.

use crate::transfer::bake_one;
use octagloss_core::bake::{Bake, BakeSettings, Processor, bake};
use octagloss_core::light::chain::{ChainKind, Level};
use octagloss_core::light::environment::{Environment, Layout, Map};
use octagloss_core::light::synth::synth;
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter;
use octagloss_core::lobe::kernel::leaf_share;
use octagloss_fixtures::adapters::{UNIT, exceeds, wait, with_passes};
use octagloss_fixtures::bounds::luminance;
use octagloss_fixtures::common::{Look, Random, environment, sweep, texels};

const ERROR: f64 = 0.005;

fn settings(filter: Filter) -> BakeSettings {
    BakeSettings {
        size: 16,
        levels: Some(4),
        filter,
        oem_size: Some(64),
        bounds: true,
        irradiance: Some(4),
        ..BakeSettings::default()
    }
}

/// So fine that every texel has one direction: those of several the CPU evaluates together.
fn fine(error: f64) -> BakeSettings {
    BakeSettings { size: 64, ..settings(Filter::Adaptive(error)) }
}

fn environments() -> Vec<(&'static str, Environment)> {
    let names = ["sky", "studio", "labelled", "labelled-cube", "furnace"];
    names.map(|name| (name, synth(name).expect("a recipe").rotated_y(30.0).expect("an angle"))).into()
}

/// Coarse texels, which Charlie lobes integrate in a fraction of the time.
fn small_sky() -> Environment {
    let layout = Layout::Panorama { width: 32, height: 16 };
    environment(layout, texels(&mut Random::new(21), Look::Suns, layout)).rotated_y(40.0).expect("an angle")
}

fn on_the_cpu(environment: &Environment, settings: &BakeSettings) -> Bake {
    bake(environment, settings).expect("a small bake")
}

/// Returns the levels of a bake, the irradiance cube last.
fn levels(bake: &Bake) -> Vec<&[[f32; 3]]> {
    let levels = bake.chain.levels.iter().chain(&bake.irradiance);
    levels.map(|level| &level.texels[..]).collect()
}

/// Compares a bake with the CPU's and with CPU bakes whose E is slightly smaller or greater or whose source
/// is turned by the rounding of directions. Where these agree in a texel, no decision lies within rounding of
/// a threshold: neither of the tolerance nor of a case of the rule, such as a cell touching the horizon.
struct Judge {
    expected: Bake,
    others: Vec<Bake>,
    /// Relative bound of level 0.
    mirror: f64,
    /// Greatest change from one leaf's decision.
    leaf: f64,
}

/// Exceeds the relative difference of the engines' expected errors: OEMs differ by some dozens times 2^-24
/// (see the OEM's test), kernels by (10/alpha + 160) 2^-24 with alpha at least 1/9, and intervals of a 64th
/// of a kernel by 64 times that; together about 1e-3.
const MARGIN: f64 = 1e-3;

/// Degrees that turn directions by some units of 2^-24.
const TURN: f64 = 3e-5;

impl Judge {
    fn new(environment: &Environment) -> Self {
        let with =
            |error, turn| on_the_cpu(&environment.clone().rotated_y(turn).expect("an angle"), &fine(error));
        let expected = with(ERROR, 0.0);
        let others = vec![
            with(ERROR * (1.0 - MARGIN), 0.0),
            with(ERROR * (1.0 + MARGIN), 0.0),
            with(ERROR, TURN),
            with(ERROR, -TURN),
        ];
        // Footprints: the bound of the OEM's test.
        let sources = environment.layout().texel_count() as f64;
        let mirror = (8.0 + 2.0 * (64.0_f64.min(sources) + sources / 64.0)) * UNIT;
        let leaf = leaf_share(ERROR) * luminance(expected.oem_energy) / (4.0 * std::f64::consts::PI);
        Self { expected, others, mirror, leaf }
    }

    /// Returns the first texel beyond its bound, and the numbers of glossy texels held to 1e-5 and of all.
    fn difference(&self, found: &Bake) -> (Option<String>, [usize; 2]) {
        let (mut wrong, mut counts) = (None, [0; 2]);
        let [expected, found] = [&self.expected, found].map(levels);
        let others: Vec<_> = self.others.iter().map(levels).collect();
        assert_eq!(expected.len(), found.len(), "levels");
        for level in 0..expected.len() {
            assert_eq!(expected[level].len(), found[level].len(), "texels of level {level}");
            for (k, (e, f)) in expected[level].iter().zip(found[level]).enumerate() {
                let open = others.iter().any(|other| {
                    let other = other[level][k];
                    (0..3).any(|c| (f64::from(other[c]) / f64::from(e[c]) - 1.0).abs() > 5e-6)
                });
                let (relative, absolute) = match (level, open) {
                    (0, _) => (self.mirror, 0.0),
                    // A decision that neither E nor a turn shifts: which of two rules estimates an error.
                    (_, false) => (1e-5, self.leaf),
                    // One decision per packet, plus one.
                    (_, true) => (1e-5, 2.0 * self.leaf),
                };
                let beyond = |relative: f64, absolute: f64| {
                    let far = |e: f64, f: f64| exceeds((e - f).abs(), relative * e + absolute);
                    (0..3).any(|c| far(f64::from(e[c]), f64::from(f[c])))
                };
                if level > 0 {
                    counts[0] += usize::from(!open && !beyond(1e-5, 0.0));
                    counts[1] += 1;
                }
                let far = beyond(relative, absolute);
                if far && wrong.is_none() {
                    wrong = Some(format!("texel {k} of level {level}, open {open}: {f:?}, not {e:?}"));
                }
            }
        }
        (wrong, counts)
    }
}

#[test]
fn bakes_match_the_cpu() {
    let cases: Vec<(&str, Environment, Judge)> = environments()
        .into_iter()
        .take(sweep(1, 5))
        .map(|(name, environment)| {
            let judge = Judge::new(&environment);
            (name, environment, judge)
        })
        .collect();
    with_passes("bakes", |context, passes| {
        for (name, environment, judge) in &cases {
            let run = || wait(context, bake_one(passes, environment, &fine(ERROR)));
            let found = run();
            let (difference, [strict, all]) = judge.difference(&found);
            assert_eq!(difference, None, "{name} on {}", context.describe());
            println!("{name}: {strict} of {all} glossy texels held to 1e-5");
            if *name == "sky" {
                assert!(strict * 10 > 9 * all, "{name}: only {strict} of {all} texels have no open decision");
            }

            // The same input gives the same bytes.
            let again = run();
            assert_eq!(levels(&again), levels(&found), "{name} twice on {}", context.describe());
            let bounds = |bake: &Bake| bake.chain.levels.iter().map(|l| l.bounds.clone()).collect::<Vec<_>>();
            assert_eq!(bounds(&again), bounds(&found), "{name}: bounds twice");

            // Energy is conserved as on the CPU.
            for c in 0..3 {
                let (source, oem) = (found.source_energy[c], found.oem_energy[c]);
                assert!((oem / source - 1.0).abs() <= 1e-4, "{name}: energy {oem} of {source}");
            }
        }
    });
}

#[test]
fn faults_in_bakes_are_detected() {
    let (_, environment) = environments().swap_remove(3);
    let judge = Judge::new(&environment);
    let seen = |bake: &Bake| judge.difference(bake).0.is_some();
    assert!(!seen(&judge.expected), "the correct bake passes");
    for level in 0..4 {
        let size = judge.expected.chain.levels[level].size() as usize;
        let mut one = judge.expected.clone();
        let brightest = (0..6 * size * size)
            .max_by(|a, b| {
                let at = |k: usize| judge.expected.chain.levels[level].texels[k][1];
                at(*a).total_cmp(&at(*b))
            })
            .expect("texels");
        one.chain.levels[level].texels[brightest][1] *= 1.02;
        assert!(seen(&one), "one wrong texel of level {level}");

        let mut swapped = judge.expected.clone();
        let texels = &mut swapped.chain.levels[level].texels;
        for k in 0..size * size {
            texels.swap(k, 4 * size * size + k);
        }
        assert!(seen(&swapped), "swapped faces of level {level}");

        let mut shifted = judge.expected.clone();
        shifted.chain.levels[level].texels.rotate_left(1);
        assert!(seen(&shifted), "texels of level {level} off by one");
    }
}

#[test]
fn bakes_by_boxes_match_the_cpu() {
    let (_, environment) = environments().swap_remove(1);
    let expected = on_the_cpu(&environment, &settings(Filter::Box));
    // The spread of the studio's radiance. Rounding moves each of the four edges by 24 * 64 units of a texel,
    // and texels are up to 5.2 times heavier than others (see the boxes' test).
    let brightest = environment.texels().iter().flatten().copied().fold(0.0, f32::max);
    let allowed = f64::from(brightest) * 4.0 * 5.2 * 24.0 * 64.0 * UNIT;
    with_passes("bakes by boxes", |context, passes| {
        let settings = settings(Filter::Box);
        let found = wait(context, bake_one(passes, &environment, &settings));
        let mut worst = 0.0_f64;
        for (expected, found) in levels(&expected).iter().zip(levels(&found)) {
            for (e, f) in expected.iter().flatten().zip(found.iter().flatten()) {
                worst = worst.max((f64::from(*e) - f64::from(*f)).abs());
            }
        }
        assert!(worst <= allowed, "off by {worst:e}, {allowed:e} allowed, on {}", context.describe());
    });
}

#[test]
fn every_lobe_bakes_within_its_bounds() {
    let environment = small_sky();
    with_passes("bakes of every lobe", |context, passes| {
        for lobe in [Lobe::Ggx, Lobe::Phong, Lobe::Cone, Lobe::Charlie] {
            let settings = BakeSettings {
                lobe,
                size: sweep(8, 16),
                levels: Some(3),
                irradiance: None,
                ..settings(Filter::Adaptive(sweep(0.1, 0.02)))
            };
            let expected = bake(&environment, &settings).expect("a small bake");
            let found = wait(context, bake_one(passes, &environment, &settings));
            let on_gpu = found.stats.iter().all(|level| level.processor == Processor::Gpu);
            assert!(on_gpu, "{lobe:?}: {:?}", found.stats);
            for (e, f) in expected.chain.levels.iter().zip(&found.chain.levels) {
                let (Some(own), Some(other)) = (&e.bounds, &f.bounds) else { continue };
                for k in 0..e.texels.len() {
                    let [e, f] = [e, f].map(|level| luminance(level.texels[k].map(f64::from)));
                    // Both bounds certify the distance from the same truth; the OEMs' energies differ by a
                    // few 2^-22.
                    let allowed = f64::from(own[k]) + f64::from(other[k]) + 1e-6 * e;
                    let off = (e - f).abs();
                    assert!(off <= allowed, "{lobe:?} texel {k}: {f}, not {e}, on {}", context.describe());
                }
            }
        }
    });
}

/// The root mean square of the difference of two levels, relative to `expected`.
fn relative_difference(found: &Level, expected: &Level) -> f64 {
    assert_eq!(found.layout, expected.layout);
    let pairs = || found.texels.as_flattened().iter().zip(expected.texels.as_flattened());
    let squares: f64 = pairs().map(|(found, expected)| f64::from(found - expected).powi(2)).sum();
    let power: f64 = pairs().map(|(_, expected)| f64::from(*expected).powi(2)).sum();
    (squares / power).sqrt()
}

/// Greatest relative difference of levels of a bake to 0.005: the engines decide alike except at thresholds.
const LEVELS_ALIKE: f64 = 0.002;

#[test]
fn levels_one_half_percent_brighter_differ() {
    let (_, environment) = environments().swap_remove(1);
    let expected = on_the_cpu(&environment, &fine(ERROR));
    for level in &expected.chain.levels {
        let mut brighter = level.clone();
        brighter.texels.as_flattened_mut().iter_mut().for_each(|value| *value *= 1.005);
        assert_eq!(relative_difference(level, level), 0.0);
        assert!(exceeds(relative_difference(&brighter, level), LEVELS_ALIKE));
    }
}

#[test]
fn sheen_matches_the_cpu() {
    let environment = small_sky();
    let settings = BakeSettings {
        sheen: true,
        size: sweep(8, 16),
        irradiance: None,
        ..settings(Filter::Adaptive(4.0 * ERROR))
    };
    let cpu = bake(&environment, &settings).expect("a small bake").sheen.expect("sheen");
    with_passes("sheen", |context, passes| {
        let bake = wait(context, bake_one(passes, &environment, &settings));
        let on_gpu = bake.sheen_stats.iter().filter(|level| level.processor == Processor::Gpu).count();
        let gpu = bake.sheen.expect("sheen");
        assert_eq!((gpu.levels.len(), on_gpu), (4, 4), "levels, and those on the GPU");
        for (level, (gpu, cpu)) in gpu.levels.iter().zip(&cpu.levels).enumerate() {
            let error = relative_difference(gpu, cpu);
            println!("sheen level {level}: {error:e}");
            assert!(!exceeds(error, LEVELS_ALIKE), "level {level}: {error} on {}", context.describe());
        }
    });
}

#[test]
fn interpolated_sheen_matches_the_cpu() {
    let environment = small_sky();
    let settings = BakeSettings {
        lobe: Lobe::Charlie,
        size: 128,
        levels: Some(1),
        bounds: false,
        irradiance: None,
        ..settings(Filter::Adaptive(4.0 * ERROR))
    };
    let cpu = bake(&environment, &settings).expect("a small bake");
    with_passes("interpolated sheen", |context, passes| {
        let gpu = wait(context, bake_one(passes, &environment, &settings));
        assert_eq!(gpu.stats[0].processor, Processor::Gpu);
        assert!(gpu.stats[0].error_bound_max.is_none(), "interpolated levels have no bounds");
        let error = relative_difference(&gpu.chain.levels[0], &cpu.chain.levels[0]);
        println!("interpolated sheen: {error:e}");
        assert!(!exceeds(error, LEVELS_ALIKE), "{error} on {}", context.describe());
    });
}

#[test]
fn bakes_of_other_maps_match_the_cpu() {
    let sky = small_sky();
    with_passes("maps", |context, engine| {
        for map in [Map::Panorama, Map::Octahedral] {
            let settings = BakeSettings { map, size: 16, levels: Some(3), ..BakeSettings::default() };
            let on_gpu = wait(context, bake_one(engine, &sky, &settings));
            let on_cpu = bake(&sky, &settings).expect("a small bake");
            assert_eq!(on_gpu.chain.levels[0], on_cpu.chain.levels[0], "the mirror levels differ");
            for (level, (gpu, cpu)) in
                on_gpu.chain.levels.iter().zip(&on_cpu.chain.levels).enumerate().skip(1)
            {
                let error = relative_difference(gpu, cpu);
                let alike = !exceeds(error, LEVELS_ALIKE);
                assert!(alike, "{map:?} level {level}: {error} on {}", context.describe());
            }
        }
    });
}

/// RMS difference of each level's values, relative to their RMS.
fn relative_rmse(found: &Bake, expected: &Bake) -> Vec<f64> {
    let pairs = found.chain.levels.iter().zip(&expected.chain.levels);
    pairs.map(|(found, expected)| relative_difference(found, expected)).collect()
}

#[test]
fn solved_chains_match_the_cpu() {
    let solved = BakeSettings {
        size: 32,
        levels: Some(5),
        chain: Some(ChainKind::Solved),
        oem_size: Some(128),
        ..BakeSettings::default()
    };
    for name in ["sky", "studio"].into_iter().take(sweep(1, 2)) {
        let environment = synth(name).expect("a recipe").rotated_y(30.0).expect("an angle");
        let cpu = bake(&environment, &solved).expect("a small bake");
        // The comparator detects one changed texel.
        for level in 0..5 {
            let mut wrong = cpu.clone();
            let brightest = wrong.chain.levels[level].texels.iter_mut().max_by(|a, b| a[1].total_cmp(&b[1]));
            brightest.expect("texels")[1] *= 1.02;
            assert!(exceeds(relative_rmse(&wrong, &cpu)[level], 1e-4), "{name} level {level}");
        }
        with_passes("solved chains", |context, passes| {
            let gpu = wait(context, bake_one(passes, &environment, &solved));
            let errors = relative_rmse(&gpu, &cpu);
            // Engines decide alike except at thresholds, and solving adds no thresholds of its own.
            let far = errors.iter().any(|error| exceeds(*error, 1e-4));
            assert!(!far, "{name}: {errors:?} on {}", context.describe());
        });
    }
}
