//! Light over the whole range of float32 on every adapter, compared with the CPU.

use crate::pyramid;
use crate::transfer::bake_one;
use octagloss_core::bake::BakeSettings;
use octagloss_core::cpu::reflector::Reflector as CpuReflector;
use octagloss_core::light::environment::{Environment, Layout, Rgb};
use octagloss_core::lobe::filter::{Answer, Filter};
use octagloss_core::lobe::{LOBES, Lobe};
use octagloss_fixtures::adapters::{wait, with_passes};
use octagloss_fixtures::bounds::luminance;
use octagloss_fixtures::common::{Random, environment};
use octagloss_fixtures::scenes::lights::Light;
use octagloss_gpu::engine::GpuReflector;

/// Error of the GPU's gathering and of boxes in single precision, relative to the greatest radiance nearby.
const RELATIVE: f64 = 1e-3;

/// Cascades of a pyramid over 32 texels.
const LEVELS: f64 = 2.0;

/// Returns whether answers `a` and `b` agree within `allowed` of luminance.
fn agree(a: &Answer, b: &Answer, allowed: f64) -> bool {
    let value = |answer: &Answer| luminance(answer.radiance.map(f64::from));
    (value(a) - value(b)).abs() <= allowed
}

#[test]
fn answers_over_all_light_match_the_cpu() {
    with_passes("light over the whole range", |context, passes| {
        let mut random = Random::new(77);
        let (mut compared, mut differing) = (0, 0);
        for _ in 0..40 {
            let mut light = Light::new(&mut random);
            light.inner = 32;
            let settings = light.settings();
            let on_cpu = CpuReflector::new(&light.environment, &settings).expect("a small OEM");
            let on_gpu = GpuReflector::new(passes, &light.environment, &settings).expect("a small OEM");
            assert_eq!(on_cpu.light_exponent(), on_gpu.light_exponent());
            let greatest = f64::from(light.greatest());
            let directions: Vec<_> = (0..4).map(|_| random.direction()).collect();
            let lobe = LOBES[random.below(5) as usize];
            let roughness = random.between(0.05, 1.0);
            for filter in [Filter::Adaptive(0.01), Filter::Box, Filter::Pyramid] {
                let lobe = if filter.check(lobe, Some(32)).is_ok() { lobe } else { Lobe::Ggx };
                // The query fails where a radiance or bound is not finite.
                let found = wait(context, on_gpu.query(&directions, lobe, roughness, filter));
                for (direction, answer) in directions.iter().zip(&found) {
                    let expected =
                        on_cpu.query(*direction, roughness, lobe, filter).expect("a finite answer");
                    let bounds = [answer.bound, expected.bound].into_iter().flatten();
                    let bounds = bounds.map(|bound| f64::from(bound.luminance)).sum::<f64>();
                    let value = luminance(expected.radiance.map(f64::from));
                    let allowed = match filter {
                        Filter::Adaptive(_) => bounds + 1e-4 * value,
                        Filter::Pyramid => pyramid::allowed(LEVELS, greatest),
                        _ => RELATIVE * greatest,
                    };
                    let case = format!("{light} {filter:?} {lobe:?} {roughness} on {}", context.describe());
                    assert!(
                        agree(answer, &expected, allowed),
                        "{answer:?} for {expected:?} +- {allowed:e}: {case}"
                    );
                    let wrong = Answer { radiance: answer.radiance.map(|c| 0.5 * c), ..*answer };
                    differing += u32::from(!agree(&wrong, &expected, allowed));
                    compared += 1;
                }
            }
        }
        assert_eq!(compared, 480);
        assert!(differing > 100, "halved light was detected only {differing} times");
    });
}

#[test]
fn bakes_of_extreme_light_match_ordinary_light() {
    let layout = Layout::Panorama { width: 16, height: 8 };
    let mut random = Random::new(78);
    let texels: Vec<Rgb> = (0..16 * 8).map(|_| [0; 3].map(|_| random.between(0.1, 1.0) as f32)).collect();
    let settings = BakeSettings { size: 8, levels: Some(3), oem_size: Some(32), ..BakeSettings::default() };
    with_passes("bakes at both ends", |context, passes| {
        let baked = |source: &Environment| wait(context, bake_one(passes, source, &settings));
        let ordinary = baked(&environment(layout, texels.clone()));
        for scale in [1e-42_f64, 1e-36, 3.4e38] {
            let scaled = texels.iter().map(|t| t.map(|c| (f64::from(c) * scale) as f32)).collect();
            let extreme = baked(&environment(layout, scaled));
            let coarse = f64::from(f32::from_bits(1)) / scale;
            for (a, b) in ordinary
                .levels()
                .flat_map(|level| level.texels.as_flattened())
                .zip(extreme.levels().flat_map(|level| level.texels.as_flattened()))
            {
                let (a, b) = (f64::from(*a), f64::from(*b) / scale);
                assert!((a - b).abs() <= 1e-3 + 4.0 * coarse, "{b} at {scale:e}, {a} for ordinary light");
            }
        }
    });
}
