//! Reflections of the true BRDF out of pyramids on the GPU against the CPU's.

use crate::look;
use crate::pyramid::{built, lit};
use glam::DVec3;
use octagloss_core::common::frame::Frame;
use octagloss_core::pyramid::Pyramid;
use octagloss_fixtures::adapters::{exceeds, with_passes};
use octagloss_fixtures::common::{Look, Random, landmarks};
use octagloss_gpu::Context;
use octagloss_gpu::live::LiveEnvironment;
use octagloss_gpu::stages::pyramid::PyramidMaps;
use octagloss_gpu::stages::reflection::{Surfaces, bind_group};

/// What a reflection is asked for: normal and roughness, view and f90, f0 and anisotropy, and the tangent.
type Query = [[f32; 4]; 4];

/// For each of `queries` the radiance, and the share of f0 in the albedo along its tangent.
fn reflect(context: &Context, maps: &PyramidMaps, queries: &[Query]) -> Vec<[f32; 4]> {
    let source = LiveEnvironment::reflect_wgsl(0) + include_str!("reflect_query.wgsl");
    let bind = |layout: &_| bind_group(context, maps, false, Surfaces::Any, layout);
    look::answers_in_groups(context, &source, bind, queries)
}

/// Compares reflections of random maps (texels along an edge, look, scale of the light) with the CPU's.
pub(super) fn reflections(context: &Context, cases: &[(u32, Look, f32)], roughness: &[f32]) {
    for &(size, look, scale) in cases {
        let mut random = Random::new(31);
        let oem = lit(&mut random, (size, look, scale));
        let (pyramid, maps) = (Pyramid::of_oem(&oem).expect("a size"), built(context, &oem));
        let mut normals = landmarks();
        normals.extend((0..100).map(|_| random.direction()));
        for &roughness in roughness {
            let (f0, f90) = ([1.0, 0.5, 0.04], 0.9);
            let asked: Vec<_> = normals
                .iter()
                .zip(0..)
                // Along the normal, from behind, and from anywhere.
                .map(|(normal, k)| match k % 5 {
                    0 => (*normal, *normal),
                    1 => (*normal, random.direction() - 2.0 * *normal),
                    _ => (*normal, random.direction() + 1.01 * *normal),
                })
                .collect();
            // Isotropic, of any anisotropy, and without a tangent.
            let brushed: Vec<_> = (0..asked.len())
                .map(|k| {
                    let anisotropy = [0.0, 1.0, 0.5, 0.05, 0.3][k % 5] as f32;
                    (anisotropy, if k % 7 == 0 { DVec3::ZERO } else { random.direction() })
                })
                .collect();
            let queries: Vec<Query> = asked
                .iter()
                .zip(&brushed)
                .map(|((normal, view), (anisotropy, tangent))| {
                    let with = |v: DVec3, w: f32| v.as_vec3().extend(w).to_array();
                    let [r, g, b] = f0;
                    let surface = [with(*normal, roughness), with(*view, f90)];
                    [surface[0], surface[1], [r, g, b, *anisotropy], with(*tangent, 0.0)]
                })
                .collect();
            let mut found = reflect(context, &maps, &queries);
            let frames: Vec<_> = asked
                .iter()
                .zip(&brushed)
                .map(|((normal, view), (_, tangent))| Frame::new(*normal, *view, *tangent).expect("a frame"))
                .collect();
            let expected: Vec<_> = frames
                .iter()
                .zip(&brushed)
                .map(|(frame, (anisotropy, _))| pyramid.reflect(frame, roughness, *anisotropy, f0, f90))
                .collect();
            let peak = f64::from(expected.iter().flatten().copied().fold(0.0, f32::max));
            let most = 0.01 * peak;
            // The first answer farther off than that.
            let wrong = |found: &[[f32; 4]]| {
                let far = |expected: &[f32; 3], found: &[f32; 4]| {
                    expected.iter().zip(found).any(|(e, f)| exceeds(f64::from((e - f).abs()), most))
                };
                (0..found.len()).find(|k| far(&expected[*k], &found[*k])).map(|k| (frames[k], found[k]))
            };
            let name = format!("{look:?} {size} at {roughness} on {}", context.describe());
            assert_eq!(wrong(&found).map(|wrong| format!("{wrong:?}")), None, "{name}, peak {peak:e}");
            for ((frame, found), (anisotropy, tangent)) in frames.iter().zip(&found).zip(&brushed) {
                let cosine = frame.view.z as f32;
                let [albedo, _] = if *tangent == DVec3::ZERO {
                    pyramid.albedo(cosine, roughness, *anisotropy)
                } else {
                    pyramid.albedo_along(cosine, frame.view.x as f32, roughness, *anisotropy)
                };
                assert!((albedo - found[3]).abs() < 2e-4, "albedo {albedo}, not {}: {frame:?}", found[3]);
            }
            found[7][1] += 2.0 * most as f32;
            assert!(wrong(&found).is_some(), "{name}: one wrong answer is not detected");
        }
    }
}

#[test]
fn reflections_match_the_cpu() {
    let cases = [(32, Look::Noise, 1.0), (64, Look::Smooth, 1e-5), (128, Look::Suns, 1.0)];
    let roughness = [0.0, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0];
    with_passes("reflections", |context, _| reflections(context, &cases, &roughness));
}
