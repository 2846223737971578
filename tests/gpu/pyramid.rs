//! Pyramids on the GPU against those of the CPU, which run the same algorithm.

use crate::transfer::Upload;
use glam::{DVec2, DVec3};
use octagloss_core::light::environment::Layout;
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::pyramid::Pyramid;
use octagloss_core::sphere::octahedral::{direction_from_oct, oct_from_direction, texel_centre, wrap_oct};
use octagloss_fixtures::adapters::{exceeds, wait, with_passes};
use octagloss_fixtures::common::{Look, Random, landmarks, oem, texels};
use octagloss_gpu::stages::build_pyramid;
use octagloss_gpu::stages::pyramid::{self, PyramidMaps};
use octagloss_gpu::{Context, OemPlanes};

/// A half's rounding, for each of the maps that a level passed through and for its own; and positions of
/// reads, in 256ths of a texel, once in each cascade and once in the look-up. Neighbours differ by less than
/// the peak of a level over the texels of its Gaussian. `levels` are those made by cascades.
pub(super) fn allowed(levels: f64, peak: f64) -> f64 {
    let half = 1.0 / 2048.0;
    let position = 2.0 / 512.0 / 2.0;
    (levels + 1.0) * (half + position) * peak
}

pub(super) fn built(context: &Context, oem: &Oem) -> PyramidMaps {
    let planes = OemPlanes::upload(context, oem).expect("small planes");
    let maps = PyramidMaps::new(context, oem.size().inner).expect("small maps");
    let stage = build_pyramid::stage(context, &planes, &maps);
    context.submit(|encoder| stage.record(encoder));
    maps
}

/// A random map: texels along an edge, look, scale of the light.
pub(super) fn lit(random: &mut Random, (size, look, scale): (u32, Look, f32)) -> Oem {
    let light = texels(random, look, Layout::Octahedral { size });
    let light: Vec<_> = light.iter().map(|texel| texel.map(|value| value * scale)).collect();
    oem(OemSize { inner: size, border: 0 }, &light)
}

/// Compares look-ups of random maps (texels along an edge, look, scale of the light) with the CPU's.
pub(super) fn look_ups(context: &Context, cases: &[(u32, Look, f32)], roughness: &[f64]) {
    for &(size, look, scale) in cases {
        let mut random = Random::new(31);
        let oem = lit(&mut random, (size, look, scale));
        let (expected, maps) = (Pyramid::of_oem(&oem).expect("a size"), built(context, &oem));
        let mut directions = landmarks();
        directions.extend((0..200).map(|_| random.direction()));
        for &roughness in roughness {
            let queries: Vec<(DVec3, f64)> = directions.iter().map(|d| (*d, roughness)).collect();
            let mut found = wait(context, pyramid::radiance(context, &maps, &queries));
            let lobes = expected.lobes(roughness as f32);
            let truth: Vec<_> = directions.iter().map(|d| lobes.radiance(*d)).collect();
            let peak = f64::from(truth.iter().flatten().copied().fold(0.0, f32::max));
            let levels = f64::from(maps.levels().count() - 2);
            let farthest = |found: &[[f32; 3]]| {
                let pairs = truth.as_flattened().iter().zip(found.as_flattened());
                pairs.map(|(e, f)| f64::from((e - f).abs())).fold(0.0, f64::max)
            };
            let name = format!("{look:?} {size} at {roughness} on {}", context.describe());
            let (off, most) = (farthest(&found), allowed(levels, peak));
            assert!(!exceeds(off, most), "{name}: off by {off:e} of {peak:e}");
            let [mut error, mut mean] = [0.0; 2];
            for (e, f) in truth.as_flattened().iter().zip(found.as_flattened()) {
                error += f64::from(e - f).powi(2);
                mean += f64::from(*e);
            }
            let count = (3 * truth.len()) as f64;
            let relative = (error / count).sqrt() / (mean / count);
            // And what positions of reads in 256ths of a texel change: half of one along each axis.
            let nudged = |axis: DVec2| {
                let nudge = axis * (2.0 / f64::from(size) / 512.0);
                let off = directions.iter().zip(&truth).map(|(direction, here)| {
                    let near = direction_from_oct(wrap_oct(oct_from_direction(*direction) + nudge));
                    let there = lobes.radiance(near);
                    here.iter().zip(there).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>()
                });
                (off.sum::<f64>() / count).sqrt() / (mean / count)
            };
            let most_relative = 0.003 + nudged(DVec2::X) + nudged(DVec2::Y);
            assert!(relative <= most_relative, "{name}: relRMSE {relative} above {most_relative}");
            found[7][1] += 2.0 * most as f32;
            assert!(farthest(&found) > most, "{name}: one wrong answer is not detected");
        }
    }
}

#[test]
fn look_ups_match_the_cpu() {
    let cases = [
        (32, Look::Noise, 1.0),
        (64, Look::Smooth, 1e-5),
        (256, Look::Suns, 1.0),
        (512, Look::Suns, 0.1),
        (128, Look::Noise, 1e9),
    ];
    let roughness = [0.0, 0.07, 0.15, 0.3, 0.5, 0.8, 1.0];
    with_passes("pyramids", |context, _| look_ups(context, &cases, &roughness));
}

/// A texel's light on a map's axes and folds, seen in exactly its direction: a sun without any width.
#[test]
fn suns_of_one_texel_are_finite_in_their_own_direction() {
    with_passes("suns of one texel", |context, _| {
        for (size, x, y) in [(64, 32, 31), (64, 0, 0), (128, 17, 90), (256, 128, 0)] {
            let mut light = vec![[0.1, 0.2, 0.05]; (size * size) as usize];
            light[(y * size + x) as usize] = [60_000.0, 0.0, 11_000.0];
            let oem = oem(OemSize { inner: size, border: 0 }, &light);
            let (expected, maps) = (Pyramid::of_oem(&oem).expect("a size"), built(context, &oem));
            let direction = direction_from_oct(texel_centre(size, x, y));
            let roughness = [0.0, 1e-9, 1e-5, 1e-3, 0.02, 0.1, 0.5];
            let queries = roughness.map(|roughness| (direction, roughness));
            let mut found = wait(context, pyramid::radiance(context, &maps, &queries));
            let levels = f64::from(maps.levels().count() - 2);
            let wrong = |found: &[[f32; 3]]| {
                roughness.iter().zip(found).find_map(|(roughness, found)| {
                    let truth = expected.lobes(*roughness as f32).radiance(direction);
                    let most = allowed(levels, f64::from(truth.into_iter().fold(0.0, f32::max)));
                    let is_off = |(f, t): (&f32, f32)| exceeds(f64::from((f - t).abs()), most);
                    found.iter().zip(truth).any(is_off).then_some((*roughness, *found, truth))
                })
            };
            assert_eq!(wrong(&found), None, "{size}: roughness, found, expected");
            found[3][1] = f32::NAN;
            assert!(wrong(&found).is_some(), "what is not a number is not detected");
        }
    });
}
