//! Reflections of the true BRDF out of pyramids on the GPU against the CPU's.

use super::pyramid::built;
use super::{exceeds, wait, with_passes};
use crate::support::common::{Look, Random, landmarks, oem, texels};
use glam::DVec3;
use octagloss::Layout;
use octagloss::internals::frame::Frame;
use octagloss::internals::gpu::reflection::{Query, reflect};
use octagloss::internals::oem::OemSize;
use octagloss::internals::pyramid::Pyramid;

#[test]
fn reflections_match_the_cpu() {
    let cases = [(32, Look::Noise, 1.0), (64, Look::Smooth, 1e-5), (128, Look::Suns, 1.0)];
    with_passes("reflections", |context, _| {
        for (size, look, scale) in cases {
            let mut random = Random::new(31);
            let light = texels(&mut random, look, Layout::Octahedral { size });
            let light: Vec<_> = light.iter().map(|texel| texel.map(|value| value * scale)).collect();
            let oem = oem(OemSize { inner: size, border: 0 }, &light);
            let (pyramid, maps) = (Pyramid::of_oem(&oem).expect("a size"), built(context, &oem));
            let mut normals = landmarks();
            normals.extend((0..100).map(|_| random.direction()));
            for roughness in [0.0, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0] {
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
                let queries: Vec<Query> = asked
                    .iter()
                    .map(|(normal, view)| Query::new(*normal, *view, roughness, f0, f90))
                    .collect();
                let found = wait(context, reflect(context, &maps, &queries));
                let mut peak = 0.0_f64;
                let (mut off, mut worst) = (0.0_f64, None);
                for ((normal, view), found) in asked.iter().zip(&found) {
                    let frame = Frame::new(*normal, *view, DVec3::ZERO).expect("a frame");
                    let expected = pyramid.reflect(&frame, roughness, f0, f90);
                    for (expected, found) in expected.into_iter().zip(found) {
                        peak = peak.max(f64::from(expected));
                        let own = f64::from((expected - found).abs());
                        if own > off {
                            (off, worst) = (own, Some((frame, expected, *found)));
                        }
                    }
                    let [albedo, _] = pyramid.albedo(frame.view.z as f32, roughness);
                    assert!((albedo - found[3]).abs() < 2e-3, "albedo {albedo}, not {}", found[3]);
                }
                let most = 0.01 * peak;
                let name = format!("{look:?} {size} at {roughness} on {}", context.describe());
                assert!(!exceeds(off, most), "{name}: off by {off:e} of {peak:e}: {worst:?}");
            }
        }
    });
}
