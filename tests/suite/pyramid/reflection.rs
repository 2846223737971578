//! The true reflection: its kernel, its oracle, its table and its look-up.

use crate::support::common::{Look, Random, environment, texels};
use glam::DVec3;
use octagloss::internals::analysis::oracle::Oracle;
use octagloss::internals::analysis::oracle::reflection::reflection;
use octagloss::internals::frame::{Frame, LEAST_COSINE};
use octagloss::internals::pyramid::brdf::Brdf;
use octagloss::internals::pyramid::reads::{NODES, node_at, table};
use octagloss::internals::pyramid::{Octaves, Pyramid};
use octagloss::{Environment, Layout};
use std::f64::consts::PI;

const PANORAMA: Layout = Layout::Panorama { width: 32, height: 16 };

fn white() -> Environment {
    Environment::new(PANORAMA, vec![[1.0; 3]; 512]).expect("a panorama")
}

fn random_world(random: &mut Random, look: Look) -> Environment {
    let layout = Layout::Panorama { width: 64, height: 32 };
    environment(layout, texels(random, look, layout))
}

/// A frame of n.v.
fn frame(random: &mut Random, nv: f64) -> Frame {
    let (normal, aside) = (random.direction(), random.direction());
    let across = (aside - normal * normal.dot(aside)).normalize();
    Frame::new(normal, normal * nv + across * (1.0 - nv * nv).sqrt(), random.direction()).expect("a frame")
}

#[test]
fn frames_have_answers_for_every_view_and_tangent() {
    let up = |view, tangent| Frame::new(DVec3::Y * 3.0, view, tangent);
    let seen = up(DVec3::new(2.0, 2.0, 0.0), DVec3::new(5.0, 1.0, 0.0)).expect("a frame");
    assert!((seen.view - DVec3::new(0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt())).length() < 1e-12, "{seen:?}");
    for (view, tangent) in [(-DVec3::Y, DVec3::ZERO), (DVec3::new(0.0, -1.0, 2.0), DVec3::Y)] {
        let below = up(view, tangent).expect("a frame");
        assert_eq!(below.view.z, LEAST_COSINE);
        assert!((below.view.length() - 1.0).abs() < 1e-12 && below.axes.z_axis == DVec3::Y, "{below:?}");
        assert!((below.axes.determinant() - 1.0).abs() < 1e-12, "{below:?}");
    }
    assert_eq!(up(DVec3::ZERO, DVec3::X), None);
    assert_eq!(up(DVec3::X, DVec3::NAN), None);
}

#[test]
fn the_kernel_is_reciprocal_and_the_anisotropic_one_contains_the_isotropic() {
    let mut random = Random::new(5);
    for _ in 0..200 {
        let upper = |random: &mut Random| {
            let d = random.direction();
            d.with_z(d.z.abs())
        };
        let (view, light) = (upper(&mut random), upper(&mut random));
        let (roughness, anisotropy) = (random.between(0.1, 1.0), random.between(0.0, 1.0));
        let there = Brdf::new(view, roughness, anisotropy).at(light).0 / light.z;
        let back = Brdf::new(light, roughness, anisotropy).at(view).0 / view.z;
        assert!((there / back - 1.0).abs() < 1e-9, "{there} and {back}");
        let turned = |d: DVec3| DVec3::new(-d.y, d.x, d.z);
        let isotropic = Brdf::new(view, roughness, 0.0).at(light).0;
        let other = Brdf::new(turned(view), roughness, 0.0).at(turned(light)).0;
        assert!((isotropic / other - 1.0).abs() < 1e-9, "{isotropic} and {other}");
    }
}

/// The integral of the reflection over lights, by half vectors: a quadrature that shares nothing with either.
fn albedo(view: DVec3, roughness: f64, anisotropy: f64) -> [f64; 2] {
    let brdf = Brdf::new(view, roughness, anisotropy);
    let mut sums = [0.0; 2];
    const SIDE: u32 = 700;
    for k in 0..SIDE * SIDE {
        // GGX's own distribution of slopes, denser far away.
        let [x, y] = [k % SIDE, k / SIDE].map(|k| (f64::from(k) + 0.5) / f64::from(SIDE));
        let alpha = [roughness.powi(2) + (1.0 - roughness.powi(2)) * anisotropy.powi(2), roughness.powi(2)];
        let far = (1.0 - x).powi(2);
        let radius = (1.0 / far - 1.0).sqrt();
        let (sine, cosine) = (2.0 * PI * y).sin_cos();
        let slopes = [radius * cosine * alpha[0], radius * sine * alpha[1]];
        let half = DVec3::new(slopes[0], slopes[1], 1.0).normalize();
        let density = far.powi(2) / (2.0 * (1.0 - x) * PI * alpha[0] * alpha[1] * half.z.powi(3));
        let towards = view.dot(half);
        if towards > 0.0 {
            let (value, fresnel) = brdf.at(half * (2.0 * towards) - view);
            let share = value * 4.0 * towards / density / f64::from(SIDE * SIDE);
            sums[0] += share;
            sums[1] += share * fresnel;
        }
    }
    sums
}

#[test]
fn white_worlds_give_the_albedo() {
    let (world, mut random) = (white(), Random::new(8));
    let oracle = Oracle::new(&world);
    for (roughness, nv, anisotropy) in
        [(0.1, 0.5, 0.0), (0.3, 0.1, 0.0), (0.5, 0.7, 0.5), (0.7, 0.3, 0.0), (1.0, 1.0, 0.0), (0.3, 0.3, 0.7)]
    {
        let frame = frame(&mut random, nv);
        let [all, grazing] = reflection(&oracle, &frame, roughness, anisotropy);
        let expected = albedo(frame.view, roughness, anisotropy);
        for (found, expected) in [all[0], grazing[0]].into_iter().zip(expected) {
            assert!((found - expected).abs() < 2e-4, "r {roughness} n.v {nv}: {found}, not {expected}");
        }
    }
    for size in [32, 512] {
        let octaves = Octaves::over(size).expect("a size");
        for _ in 0..60 {
            let (roughness, nv) = (random.between(0.1, 1.0), random.between(0.02, 1.0));
            let [.., a, b] = node_at(octaves, roughness as f32, nv as f32)[9];
            let view = DVec3::new((1.0 - nv * nv).sqrt(), 0.0, nv);
            let [all, grazing] = albedo(view, roughness, 0.0);
            let off = [f64::from(a) - (all - grazing), f64::from(b) - grazing];
            assert!(off.iter().all(|off| off.abs() < 1.5e-3), "r {roughness} n.v {nv}: off by {off:?}");
        }
    }
}

#[test]
fn look_ups_of_a_white_world_are_the_albedo_and_turn_nowhere() {
    let pyramid = Pyramid::build(&white(), 64).expect("a size");
    let mut random = Random::new(9);
    for roughness in [0.0, 0.1, 0.3, 0.5, 0.8, 1.0] {
        for nv in [0.01, 0.1, 0.4, 0.8, 1.0] {
            let frame = frame(&mut random, nv);
            let [a, b] = pyramid.albedo(nv as f32, roughness, 0.0);
            let expected = [1.0, 0.5, 0.0].map(|f0| f0 * a + 0.9 * b);
            let found = pyramid.reflect(&frame, roughness, 0.0, [1.0, 0.5, 0.0], 0.9);
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 2e-3, "r {roughness} n.v {nv}: {found}, not {expected}");
            }
        }
    }
    // Around a sphere's centre the plane of incidence turns, and the answer does not.
    let world = random_world(&mut random, Look::Suns);
    let pyramid = Pyramid::build(&world, 128).expect("a size");
    for roughness in [0.2, 0.4, 0.7] {
        let normal = DVec3::new(0.3, 0.5, -0.4).normalize();
        let (x, y) = normal.any_orthonormal_pair();
        let around: Vec<f32> = (0..8)
            .map(|k| {
                let (sine, cosine) = (f64::from(k) * PI / 4.0).sin_cos();
                let frame = Frame::new(normal, normal + 1e-4 * (x * cosine + y * sine), DVec3::ZERO);
                pyramid.reflect(&frame.expect("a frame"), roughness, 0.0, [1.0; 3], 1.0)[1]
            })
            .collect();
        let off = around.iter().map(|light| (light / around[0] - 1.0).abs()).fold(0.0, f32::max);
        assert!(off < 2e-3, "r {roughness}: {around:?}");
    }
}

#[test]
fn look_ups_are_near_the_oracle() {
    let mut random = Random::new(3);
    let world = random_world(&mut random, Look::Smooth);
    let (oracle, pyramid) = (Oracle::new(&world), Pyramid::build(&world, 128).expect("a size"));
    let cells = [
        (0.3, 0.8, 0.0, 0.02),
        (0.5, 0.4, 0.0, 0.02),
        (0.7, 0.2, 0.0, 0.03),
        (0.2, 0.5, 0.0, 0.04),
        (0.3, 0.7, 0.5, 0.03),
        (0.5, 0.3, 0.5, 0.03),
        (0.2, 0.5, 0.3, 0.04),
    ];
    for (roughness, nv, anisotropy, most) in cells {
        let (mut error, mut mean) = (0.0, 0.0);
        for _ in 0..20 {
            let frame = frame(&mut random, nv);
            let [all, grazing] = reflection(&oracle, &frame, f64::from(roughness as f32), anisotropy);
            let found = pyramid.reflect(&frame, roughness as f32, anisotropy as f32, [0.2; 3], 1.0);
            for c in 0..3 {
                let expected = 0.2 * all[c] + 0.8 * grazing[c];
                error += (f64::from(found[c]) - expected).powi(2) / 60.0;
                mean += expected / 60.0;
            }
        }
        let off = error.sqrt() / mean;
        assert!(off < most, "r {roughness} n.v {nv} anisotropy {anisotropy}: {off}");
    }
}

#[test]
fn anisotropic_albedos_are_those_of_the_lobes() {
    let (pyramid, mut random) = (Pyramid::build(&white(), 64).expect("a size"), Random::new(12));
    for _ in 0..20 {
        let (roughness, anisotropy) = (random.between(0.1, 0.9), random.between(0.0, 0.9));
        let (nv, azimuth) = (random.between(0.05, 1.0), random.between(0.0, 0.5 * PI));
        let sine = (1.0 - nv * nv).sqrt();
        let view = DVec3::new(sine * azimuth.cos(), sine * azimuth.sin(), nv);
        let [all, grazing] = albedo(view, roughness, anisotropy);
        let [a, b] = pyramid.albedo_along(nv as f32, view.x as f32, roughness as f32, anisotropy as f32);
        let off = [f64::from(a) - (all - grazing), f64::from(b) - grazing];
        assert!(
            off.iter().all(|off| off.abs() < 6e-3),
            "r {roughness} n.v {nv} anisotropy {anisotropy}: off by {off:?}"
        );
        let frame = Frame { axes: glam::DMat3::IDENTITY, view, has_tangent: true };
        let found = pyramid.reflect(&frame, roughness as f32, anisotropy as f32, [1.0; 3], 1.0);
        assert!((found[0] - a - b).abs() < 4e-3, "a white world: {found:?}, not {}", a + b);
    }
}

#[test]
fn tangents_have_no_sign_and_fade_out_with_anisotropy() {
    let mut random = Random::new(13);
    let world = random_world(&mut random, Look::Noise);
    let pyramid = Pyramid::build(&world, 64).expect("a size");
    for nv in [0.05, 0.3, 0.9, 1.0] {
        let own = frame(&mut random, nv);
        let [x, y, z] = [own.axes.x_axis, own.axes.y_axis, own.axes.z_axis];
        let turned = Frame::new(z, own.axes * own.view, -x).expect("a frame");
        let none = Frame::new(z, own.axes * own.view, z).expect("a frame");
        assert!(own.has_tangent && !none.has_tangent && (turned.axes.y_axis + y).length() < 1e-12);
        let of = |frame: &Frame, anisotropy| pyramid.reflect(frame, 0.4, anisotropy, [1.0; 3], 1.0)[1];
        let (sharp, back) = (of(&own, 0.6), of(&turned, 0.6));
        assert!((sharp / back - 1.0).abs() < 1e-3, "n.v {nv}: {sharp} and {back}");
        let (plain, bare) = (of(&own, 0.0), of(&none, 0.6));
        assert!((bare / plain - 1.0).abs() < 1e-5, "n.v {nv}: {bare} without a tangent, not {plain}");
        let hardly = of(&own, 0.01);
        assert!(
            (hardly / plain - 1.0).abs() < 2e-3,
            "n.v {nv}: {hardly} by next to no anisotropy, not {plain}"
        );
    }
}

#[test]
fn tables_are_smooth_and_small() {
    for size in [32, 512, 2048] {
        let octaves = Octaves::over(size).expect("a size");
        let nodes = table(octaves);
        assert_eq!(nodes.len(), NODES[0] * NODES[1]);
        for (k, node) in nodes.iter().enumerate() {
            for [slope, level, a, b] in &node[..9] {
                assert!(a.abs() < 6.0 && b.abs() < 6.0, "node {k}: weights {a}, {b}");
                assert!((0.0..=octaves.count() as f32 + 1.0).contains(level) && slope.abs() < 30.0, "{k}");
            }
        }
    }
}
