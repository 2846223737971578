//! Light at the limits of float32: no NaN, no infinity, no useless bound.

use crate::cli::{done, json_file, write_panorama};
use octagloss::{Error, Layout, Rgb};
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::bake::{BakeSettings, bake};
use octagloss_core::cpu::reflector::{Reflector, ReflectorSettings, check_answers};
use octagloss_core::lobe::filter::{Answer, Bound, Filter};
use octagloss_core::lobe::{LOBES, Lobe};
use octagloss_fixtures::bounds::luminance;
use octagloss_fixtures::common::{Random, environment, landmarks, sweep};
use octagloss_fixtures::scenes::lights::{Light, Tally, examine, examine_unbounded};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Fails if the tally has recorded errors.
fn sound(tally: &Tally) -> Result<(), TestCaseError> {
    let case: Vec<&str> = tally.not_finite.iter().chain(&tally.violations).map(String::as_str).collect();
    prop_assert!(tally.is_sound(), "{}", case.join("\n"));
    Ok(())
}

/// Runs the same `count` cases every time, so that no unrelated change fails by a new random case.
/// `examples/random_bounds.rs` searches for new ones.
fn cases(count: u32) -> ProptestConfig {
    ProptestConfig {
        cases: count,
        max_shrink_iters: 0,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(cases(sweep(12, 24)))]

    #[test]
    fn bounds_hold_over_all_light(seed in any::<u64>()) {
        sound(&examine(seed, 0, 4, &|answer| answer))?;
    }
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn other_filters_stay_within_all_light(seed in any::<u64>()) {
        sound(&examine_unbounded(seed, 0))?;
    }
}

proptest! {
    #![proptest_config(cases(sweep(4, 24)))]

    #[test]
    fn bakes_of_all_light_are_finite(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let light = Light::new(&mut random);
        let greatest = light.greatest();
        for filter in [Filter::Adaptive(0.01), Filter::Box, Filter::Pyramid] {
            let lobe = LOBES[random.below(LOBES.len() as u32) as usize];
            let lobe = if filter.check(lobe, Some(32)).is_ok() { lobe } else { Lobe::Ggx };
            let settings = BakeSettings {
                size: 4,
                levels: Some(if lobe == Lobe::Cosine { 1 } else { 3 }),
                lobe,
                filter,
                oem_size: Some(32),
                bounds: true,
                sh_order: 4,
                ..BakeSettings::default()
            };
            // A bake that is not finite returns an error.
            let baked = bake(&light.environment, &settings).expect("a finite bake");
            let texels = baked.levels().flat_map(|level| level.texels.as_flattened());
            let most = texels.copied().fold(0.0, f32::max);
            prop_assert!(f64::from(most) <= 1.5 * f64::from(greatest), "{most} of {greatest}: {light}");
            for stats in &baked.stats {
                prop_assert!(stats.error_bound_max.is_none_or(f64::is_finite), "{:?}: {light}", stats);
            }
        }
    }
}

#[test]
fn a_wrong_answer_is_detected_everywhere() {
    let (mut wrong, mut lost) = (Tally::default(), Tally::default());
    for seed in 0..12 {
        // 1.5 times the truth plus three bounds, and a NaN.
        let too_bright = |answer: Answer| Answer {
            radiance: answer
                .radiance
                .map(|c| (c + 3.0 * answer.bound.unwrap_or_default().luminance).min(f32::MAX)),
            ..answer
        };
        wrong = wrong.join(examine(seed, 0, 1, &too_bright));
        if seed < sweep(3, 12) {
            let not_a_number = |answer| Answer { radiance: [0.0, f32::NAN, 0.0], ..answer };
            lost = lost.join(examine(seed, 0, 1, &not_a_number));
        }
    }
    // Answers of 3.4e38 cannot be exceeded, and black has no bound.
    let share = wrong.violations.len() as f64 / wrong.compared as f64;
    assert!(wrong.compared > 100 && share > 0.7, "{share} of {} were found", wrong.compared);
    assert!(
        lost.not_finite.len() >= sweep(12, 48) && lost.compared + lost.unbounded == 0,
        "every NaN must be detected"
    );
}

/// Returns texels of radiance one, except one texel.
fn spotted(texel: f32) -> Vec<Rgb> {
    let mut texels = vec![[1.0; 3]; 16 * 8];
    texels[37] = [texel; 3];
    texels
}

/// Returns the relative error of the answers over `texels`, and the greatest bound over the mean.
fn error_and_bound(texels: Vec<Rgb>, lobe: Lobe) -> (f64, f64) {
    let source = environment(Layout::Panorama { width: 16, height: 8 }, texels);
    let settings = ReflectorSettings { oem_size: Some(64), ..ReflectorSettings::default() };
    let reflector = Reflector::new(&source, &settings).expect("a small OEM");
    let oracle = Oracle::new(&source);
    let (mut squares, mut total, mut bound) = (0.0, 0.0, 0.0_f64);
    let directions: Vec<_> = landmarks().into_iter().step_by(sweep(4, 1)).collect();
    for direction in directions.iter().copied() {
        let answer = reflector.query(direction, 0.5, lobe, Filter::Adaptive(0.003)).expect("a finite answer");
        let truth = luminance(oracle.reflect(lobe, 0.5, direction).expect("valid"));
        squares += (luminance(answer.radiance.map(f64::from)) - truth).powi(2);
        total += truth;
        bound = bound.max(f64::from(answer.bound.expect("a bound").luminance));
    }
    let count = directions.len() as f64;
    ((squares / count).sqrt() / (total / count), bound / (total / count))
}

#[test]
fn dim_texels_do_not_reduce_accuracy() {
    for lobe in LOBES {
        let texels = [1e-31, 1e-38, f32::from_bits(1), 1e-33, 1e-40];
        for texel in texels.into_iter().take(sweep(3, 5)) {
            let (error, bound) = error_and_bound(spotted(texel), lobe);
            assert!(
                error < 0.02 && bound < 0.5,
                "{lobe:?} next to {texel:e}: off by {error:e}, bound {bound:e}"
            );
        }
    }
}

#[test]
fn light_at_both_ends_is_as_exact_as_ordinary_light() {
    let mut random = Random::new(8);
    let texels: Vec<Rgb> = (0..16 * 8).map(|_| [0; 3].map(|_| random.between(0.1, 1.0) as f32)).collect();
    for lobe in LOBES {
        let (ordinary, ordinary_bound) = error_and_bound(texels.clone(), lobe);
        let scales = [1e-44_f64, 1e-36, 3.4e38, 1e-40, 1e-30, 1e25];
        for scale in scales.into_iter().take(sweep(3, 6)) {
            let scaled = texels.iter().map(|t| t.map(|c| (f64::from(c) * scale) as f32)).collect();
            let (error, bound) = error_and_bound(scaled, lobe);
            // Subnormal numbers have coarser steps.
            let coarse = f64::from(f32::from_bits(1)) / scale;
            assert!(
                error <= 1.2 * ordinary + 4.0 * coarse && bound <= 1.2 * ordinary_bound + 8.0 * coarse + 1e-6,
                "{lobe:?} at {scale:e}: off by {error:e} for {ordinary:e}, bound {bound:e} for \
                 {ordinary_bound:e}"
            );
        }
    }
}

#[test]
fn dim_halves_next_to_bright_ones_are_resolved() {
    // The cone lies entirely in the dim half.
    let texels = (0..32 * 16).map(|k| if k < 32 * 8 { [1.0; 3] } else { [1e-38; 3] }).collect();
    let source = environment(Layout::Panorama { width: 32, height: 16 }, texels);
    let settings = ReflectorSettings { oem_size: Some(64), ..ReflectorSettings::default() };
    let reflector = Reflector::new(&source, &settings).expect("a small OEM");
    let answer =
        reflector.query(-glam::DVec3::Y, 0.5, Lobe::Cone, Filter::Adaptive(0.01)).expect("a finite answer");
    assert!((answer.radiance[0] / 1e-38 - 1.0).abs() < 1e-3, "{answer:?}");
    assert!(answer.bound.is_some_and(|bound| bound.luminance < 1e-38), "{answer:?}");
}

#[test]
fn what_is_not_finite_is_an_error() {
    let fine = Answer { radiance: [1.0; 3], bound: Some(Bound::default()) };
    let directions = [glam::DVec3::X, glam::DVec3::Y];
    assert!(check_answers(&directions, &[fine, fine]).is_ok());
    for wrong in [
        Answer { radiance: [1.0, f32::NAN, 1.0], bound: None },
        Answer { radiance: [f32::INFINITY; 3], bound: None },
        Answer { radiance: [-1.0; 3], bound: None },
        Answer { radiance: [1.0; 3], bound: Some(Bound { luminance: f32::NAN, ..Bound::default() }) },
        Answer {
            radiance: [1.0; 3],
            bound: Some(Bound { channels: [0.0, f32::INFINITY, 0.0], luminance: 0.0 }),
        },
    ] {
        let error = check_answers(&directions, &[fine, wrong]).expect_err("it is not finite");
        assert!(matches!(error, Error::NonFiniteResult { .. }), "{error}");
        assert!(error.to_string().starts_with("direction 0, 1, 0: the result is"), "{error}");
    }
}

#[test]
fn a_bake_rounded_to_black_warns() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write_panorama(&folder.path().join("dim.exr"), 16, |d| [(1e-40 * (1.5 + d.y)) as f32; 3]);
    let small = ["bake", "dim.exr", "--size", "8", "--chain", "sampled", "--engine", "cpu", "-o"];
    for pixel in ["f16", "rgb9e5", "r11g11b10f", "bc6h"] {
        let file = format!("{pixel}.ktx2");
        let ran = done(folder.path(), &[&small[..], &[&file, "--pixel", pixel]].concat());
        assert!(ran.err.contains(&format!("all light is below {pixel}")), "{}", ran.err);
        let report = json_file(&folder.path().join(format!("{file}.report.json")));
        assert!(report["warnings"].to_string().contains("the output is black"), "{report}");
    }
    // Automatic pixel formats choose f32.
    for layout in ["faces", "cross"] {
        let ran =
            done(folder.path(), &[&small[..], &[layout, "--format", "exr", "--out-layout", layout]].concat());
        assert!(!ran.err.contains("all light is below"), "{}", ran.err);
        let report = json_file(&folder.path().join(layout).join("report.json"));
        let pixels = report["levels"].as_array().expect("levels").iter().map(|level| &level["pixel"]);
        assert!(pixels.clone().all(|pixel| pixel == "f32") && pixels.count() > 1, "{report}");
    }
    let ran = done(folder.path(), &[&small[..], &["half", "--format", "exr", "--pixel", "f16"]].concat());
    assert!(ran.err.contains("all light is below f16"), "{}", ran.err);
    let ran = done(folder.path(), &[&small[..], &["f32.ktx2", "--pixel", "f32"]].concat());
    assert!(!ran.err.contains("all light is below"), "{}", ran.err);
    let report = json_file(&folder.path().join("f32.ktx2.report.json"));
    for level in report["levels"].as_array().expect("levels").iter().skip(1) {
        let bound = level["error_bound_max"].as_f64().expect("a bound");
        assert!(bound > 0.0 && bound < 1e-40, "{level}");
    }
    assert!(report["energy"]["relative_difference"].as_f64().is_some_and(|part| part < 1e-3), "{report}");
}

#[test]
fn the_brightest_light_is_clamped_and_counted() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write_panorama(&folder.path().join("bright.exr"), 16, |d| [if d.y > 0.0 { 3e38 } else { 0.0 }; 3]);
    for (name, format, told) in [
        ("hdr", "hdr", "texels exceed the RGBE maximum of 1.7e38 and were clamped"),
        ("half.ktx2", "ktx2", "texels exceed the range of f16 and were clamped"),
    ] {
        let args = ["bake", "bright.exr", "--size", "8", "--engine", "cpu", "--format", format, "-o", name];
        assert!(done(folder.path(), &args).err.contains(told), "{name}");
        let report =
            if format == "hdr" { "hdr/report.json".to_owned() } else { format!("{name}.report.json") };
        let report = json_file(&folder.path().join(report));
        assert!(report["clamped"].as_u64().is_some_and(|clamped| clamped > 100), "{report}");
    }
}
