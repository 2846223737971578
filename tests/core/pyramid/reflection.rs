//! The true reflection: its kernel, its oracle, its table and its look-up.

use glam::DVec3;
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::analysis::oracle::reflection::reflection;
use octagloss_core::common::frame::{Frame, LEAST_COSINE};
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::pyramid::albedo::albedo_at;
use octagloss_core::pyramid::anisotropic;
use octagloss_core::pyramid::brdf::{Brdf, alphas};
use octagloss_core::pyramid::places::READS;
use octagloss_core::pyramid::reads::{LAYERS, NODES, node_at, table};
use octagloss_core::pyramid::{Levels, Pyramid};
use octagloss_fixtures::common::{Look, Random, environment, texels};
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

/// Mean of the reflection over a disc, and of what is left of it for f90: by rings and spokes.
fn over_disc(brdf: &Brdf, light: DVec3, spread: f64) -> [f64; 2] {
    const RINGS: u32 = 60;
    let (x, y) = light.any_orthonormal_pair();
    let mut sums = [0.0; 2];
    for (ring, spoke) in (0..RINGS).flat_map(|ring| (0..2 * RINGS).map(move |spoke| (ring, spoke))) {
        let cosine = 1.0 - spread * (f64::from(ring) + 0.5) / f64::from(RINGS);
        let (up, right) = (PI * (f64::from(spoke) + 0.5) / f64::from(RINGS)).sin_cos();
        let (value, fresnel) =
            brdf.at(light * cosine + (x * right + y * up) * (1.0 - cosine * cosine).sqrt());
        sums = [sums[0] + value, sums[1] + value * fresnel];
    }
    sums.map(|sum| sum / f64::from(2 * RINGS * RINGS))
}

#[test]
fn suns_are_discs() {
    let (mut random, mut as_points, mut count) = (Random::new(17), 0.0_f64, 0);
    for _ in 0..400 {
        let (roughness, anisotropy) = (random.between(0.2, 1.0), random.between(-0.8, 0.8).max(0.0));
        let (nv, radius) = (random.between(0.15, 1.0), random.between(0.0, 0.03));
        let turn = random.between(0.0, 2.0 * PI);
        let view = ((1.0 - nv * nv).sqrt() * glam::DVec2::from_angle(turn)).extend(nv);
        let brdf = Brdf::new(view, roughness, anisotropy);
        // Within the lobe.
        let slopes = glam::DVec2::from_angle(random.between(0.0, 2.0 * PI)) * random.between(0.0, 3.0);
        let half = (alphas(roughness, anisotropy) * slopes).extend(1.0).normalize();
        let light = half * (2.0 * view.dot(half)) - view;
        if light.z < 2.0 * radius {
            continue;
        }
        let spread = 0.5 * radius * radius;
        let [expected, grazing] = over_disc(&brdf, light, spread);
        let (found, fresnel) = brdf.around(light, spread);
        let name = format!("r {roughness} anisotropy {anisotropy} n.v {nv}, {radius} around {light}");
        assert!((found / expected - 1.0).abs() < 0.02, "{name}: {found}, not {expected}");
        assert!((fresnel - grazing / expected).abs() < 0.02, "{name}: {fresnel}, not {}", grazing / expected);
        as_points = as_points.max((brdf.at(light).0 / expected - 1.0).abs());
        count += 1;
    }
    assert!(count > 200 && as_points > 0.1, "{count} suns, as points off by {as_points}");
    // Points have none.
    let (view, light) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.8, 0.0, 0.6));
    let brdf = Brdf::new(view, 0.4, 0.3);
    assert!((brdf.around(light, 0.0).0 / brdf.at(light).0 - 1.0).abs() < 1e-12);
}

#[test]
fn suns_set() {
    let radius = 0.03_f64;
    let spread = 0.5 * radius * radius;
    for (nv, roughness, anisotropy) in [(0.15, 0.3, 0.0), (0.3, 0.5, 0.5), (0.6, 0.8, 0.0), (0.02, 0.6, 0.0)]
    {
        let view = DVec3::new((1.0_f64 - nv * nv).sqrt(), 0.0, nv);
        let brdf = Brdf::new(view, roughness, anisotropy);
        let heights = (-40..=80).map(|k| 1e-3 * f64::from(k));
        let seen: Vec<[f64; 2]> = heights
            .map(|z| {
                let light = DVec3::new(-(1.0 - z * z).sqrt(), 0.0, z);
                let found = brdf.around(light, spread).0;
                assert_eq!(z <= -radius, found == 0.0, "n.v {nv}, height {z}: {found}");
                [found, over_disc(&brdf, light, spread)[0]]
            })
            .collect();
        let peak = seen.iter().map(|seen| seen[1]).fold(0.0, f64::max);
        for pair in seen.windows(2) {
            let ([before, _], [found, expected]) = (pair[0], pair[1]);
            assert!((found - before).abs() < 0.05 * peak, "n.v {nv}: from {before} to {found} of {peak}");
            assert!((found - expected).abs() < 0.08 * peak, "n.v {nv}: {found}, not {expected} of {peak}");
        }
    }
}

#[test]
fn reflections_of_a_sun_are_near_the_oracle() {
    // Three texels at the panorama's seam.
    let layout = Layout::Panorama { width: 256, height: 128 };
    let mut texels = vec![[0.0; 3]; 256 * 128];
    for k in [0, 1, 255] {
        texels[40 * 256 + k] = [1e4; 3];
    }
    let world = Environment::new(layout, texels).expect("a panorama");
    let (oracle, pyramid) = (Oracle::new(&world), Pyramid::build(&world, 256).expect("a size"));
    let sun = layout.direction_from_texel(0, 0, 40);
    let mut random = Random::new(6);
    for (roughness, anisotropy, nv) in
        [(0.2, 0.0, 0.5), (0.3, 0.0, 0.15), (0.3, 0.5, 0.3), (0.5, 0.0, 0.3), (0.7, 0.0, 0.15)]
    {
        let (mut error, mut square) = (0.0, 0.0);
        for _ in 0..20 {
            let reflected = (sun + 3.0 * roughness * roughness * random.direction()).normalize();
            let aside = random.direction();
            let aside = (aside - reflected * aside.dot(reflected)).normalize();
            let normal = reflected * nv + aside * (1.0 - nv * nv).sqrt();
            let frame = Frame::new(normal, normal * (2.0 * nv) - reflected, random.direction());
            let frame = frame.expect("a frame");
            let expected = reflection(&oracle, &frame, f64::from(roughness as f32), anisotropy)[0][0];
            let found = pyramid.reflect(&frame, roughness as f32, anisotropy as f32, [1.0; 3], 1.0)[0];
            error += (f64::from(found) - expected).powi(2);
            square += expected * expected;
        }
        let epsilon = (error / square).sqrt();
        assert!(epsilon < 0.05, "r {roughness} anisotropy {anisotropy} n.v {nv}: {epsilon}");
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
    for (roughness, nv, anisotropy) in [
        (0.1, 0.5, 0.0),
        (0.3, 0.1, 0.0),
        (0.5, 0.7, 0.5),
        (0.7, 0.3, 0.0),
        (1.0, 1.0, 0.0),
        (0.3, 0.3, 0.7),
        (0.03, 0.5, 0.8),
    ] {
        let frame = frame(&mut random, nv);
        let [all, grazing] = reflection(&oracle, &frame, roughness, anisotropy);
        let expected = albedo(frame.view, roughness, anisotropy);
        for (found, expected) in [all[0], grazing[0]].into_iter().zip(expected) {
            assert!((found - expected).abs() < 2e-4, "r {roughness} n.v {nv}: {found}, not {expected}");
        }
    }
    for size in [32, 512] {
        let levels = Levels::over(size).expect("a size");
        for _ in 0..60 {
            let (roughness, nv) = (random.between(0.1, 1.0), random.between(0.02, 1.0));
            let view = DVec3::new((1.0 - nv * nv).sqrt(), 0.0, nv);
            let [all, grazing] = albedo(view, roughness, 0.0);
            let expected = [all - grazing, grazing];
            let found = albedo_at(roughness as f32, nv as f32).map(f64::from);
            let off = [0, 1].map(|k| (found[k] - expected[k]).abs());
            assert!(off.iter().all(|off| *off < 9e-4), "r {roughness} n.v {nv}: off by {off:?}");
            // The weights of reads, of the first harmonic and of the cosine sum to it nearly.
            let node = node_at(levels, roughness as f32, nv as f32);
            let reads = node[..READS].iter().map(|[.., a, b]| [*a, *b]);
            let ([mean, grazing, ..], [.., a, b]) = (node[READS], node[LAYERS - 1]);
            let all = reads.chain([[mean, grazing], [a, b]]);
            let sums = all.fold([0.0; 2], |sums, own| [0, 1].map(|k| sums[k] + f64::from(own[k])));
            let off = [0, 1].map(|k| (sums[k] - expected[k]).abs());
            assert!(off.iter().all(|off| *off < 3e-3), "r {roughness} n.v {nv}: weights off by {off:?}");
        }
    }
}

#[test]
fn look_ups_of_a_white_world_are_the_albedo_and_turn_nowhere() {
    let pyramid = Pyramid::build(&white(), 64).expect("a size");
    let mut random = Random::new(9);
    for roughness in [0.0, 0.02, 0.1, 0.17, 0.3, 0.44, 0.5, 0.8, 1.0] {
        for nv in [0.01, 0.013, 0.05, 0.1, 0.4, 0.8, 0.97, 1.0] {
            let frame = frame(&mut random, nv);
            let [a, b] = pyramid.albedo(nv as f32, roughness, 0.0);
            let expected = [1.0, 0.5, 0.0].map(|f0| f0 * a + 0.9 * b);
            let found = pyramid.reflect(&frame, roughness, 0.0, [1.0, 0.5, 0.0], 0.9);
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-3, "r {roughness} n.v {nv}: {found}, not {expected}");
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
    for (roughness, anisotropy, nv, most) in [
        (0.3, 0.0, 0.8, 0.02),
        (0.5, 0.0, 0.4, 0.02),
        (0.7, 0.0, 0.2, 0.03),
        (0.2, 0.0, 0.5, 0.04),
        (0.3, 0.5, 0.7, 0.05),
        (0.3, 0.5, 0.3, 0.05),
        (0.5, 0.5, 0.7, 0.05),
        (0.5, 0.5, 0.3, 0.05),
        (0.4, 0.15, 0.6, 0.05),
    ] {
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
        assert!(off < most, "r {roughness} anisotropy {anisotropy} n.v {nv}: {off}");
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
            off.iter().all(|off| off.abs() < 1e-3),
            "r {roughness} n.v {nv} anisotropy {anisotropy}: off by {off:?}"
        );
        let frame = Frame { axes: glam::DMat3::IDENTITY, view, has_tangent: true };
        let found = pyramid.reflect(&frame, roughness as f32, anisotropy as f32, [1.0; 3], 1.0);
        assert!((found[0] - a - b).abs() < 1e-3, "a white world: {found:?}, not {}", a + b);
    }
}

#[test]
fn a_turned_white_world_changes_nothing() {
    // Narrow lobes at grazing views take much from wide functions with one sign or the other.
    let mut random = Random::new(13);
    for size in [64, 512] {
        let pyramid = Pyramid::build(&white(), size).expect("a size");
        for _ in 0..150 {
            let [roughness, anisotropy] = [0, 1].map(|_| random.between(0.0, 1.0) as f32);
            let nv = random.between(0.1, 1.0).powi(2);
            let frame = frame(&mut random, nv);
            let (cosine, along) = (frame.view.z as f32, frame.view.x as f32);
            let [a, b] = pyramid.albedo_along(cosine, along, roughness, anisotropy);
            for (f0, f90, expected) in [(1.0, 1.0, a + b), (0.0, 1.0, b)] {
                let light = pyramid.reflect(&frame, roughness, anisotropy, [f0; 3], f90)[0];
                let name = format!("{size}: r {roughness} anisotropy {anisotropy} {frame:?}");
                assert!((light - expected).abs() < 7e-4, "{name}: {light}, not {expected}");
            }
        }
    }
}

#[test]
fn brushed_surfaces_in_a_white_world_reflect_their_albedo() {
    let pyramid = Pyramid::build(&white(), 64).expect("a size");
    let mut random = Random::new(10);
    for (roughness, anisotropy) in [(0.2, 0.3), (0.3, 0.05), (0.3, 0.5), (0.5, 0.5), (0.6, 0.8), (1.0, 0.5)] {
        for nv in [0.15, 0.3, 0.6, 0.9, 1.0] {
            let frame = frame(&mut random, nv);
            let [all, grazing] = albedo(frame.view, roughness, anisotropy);
            let (r, a) = (roughness as f32, anisotropy as f32);
            let found = pyramid.albedo_along(frame.view.z as f32, frame.view.x as f32, r, a);
            let off = [f64::from(found[0]) - (all - grazing), f64::from(found[1]) - grazing];
            let name = format!("r {roughness} anisotropy {anisotropy} n.v {nv}");
            assert!(off.iter().all(|off| off.abs() < 1e-3), "{name}: off by {off:?}");
            let light = pyramid.reflect(&frame, r, a, [0.7; 3], 0.9)[0];
            let expected = 0.7 * found[0] + 0.9 * found[1];
            assert!((light - expected).abs() < 1e-3, "{name}: {light}, not {expected}");
        }
    }
    // The mean over directions of the tangent.
    for (roughness, anisotropy, nv) in [(0.3, 0.5, 0.3), (0.5, 0.7, 0.6)] {
        let mut mean = [0.0; 2];
        for k in 0..16 {
            let (sine, cosine) = (PI / 2.0 * (f64::from(k) + 0.5) / 16.0).sin_cos();
            let level = (1.0_f64 - nv * nv).sqrt();
            let [all, grazing] = albedo(DVec3::new(level * cosine, level * sine, nv), roughness, anisotropy);
            mean = [mean[0] + (all - grazing) / 16.0, mean[1] + grazing / 16.0];
        }
        let found = pyramid.albedo(nv as f32, roughness as f32, anisotropy as f32);
        let off = [0, 1].map(|k| (f64::from(found[k]) - mean[k]).abs());
        assert!(off.iter().all(|off| *off < 1e-3), "r {roughness}: {found:?}, not {mean:?}");
    }
}

#[test]
fn tangents_count_by_their_line_and_look_ups_turn_nowhere() {
    let mut random = Random::new(12);
    let world = random_world(&mut random, Look::Smooth);
    let pyramid = Pyramid::build(&world, 64).expect("a size");
    let look = |normal, view, tangent, roughness, anisotropy| {
        let frame = Frame::new(normal, view, tangent).expect("a frame");
        pyramid.reflect(&frame, roughness, anisotropy, [1.0; 3], 1.0)[1]
    };
    let near =
        |a: f32, b: f32, most: f32, what: &str| assert!((a / b - 1.0).abs() < most, "{what}: {a}, {b}");
    for (roughness, anisotropy) in [(0.2, 0.3), (0.3, 0.5), (0.5, 0.5), (0.7, 0.7)] {
        for _ in 0..6 {
            let normal = random.direction();
            let (x, y) = normal.any_orthonormal_pair();
            let view = normal + random.direction();
            let tangent = random.direction();
            let own = look(normal, view, tangent, roughness, anisotropy);
            // Places of reads in single precision.
            near(look(normal, view, -3.0 * tangent, roughness, anisotropy), own, 1e-5, "the other sign");
            let turned = look(normal, view, tangent + 1e-3 * x, roughness, anisotropy);
            near(turned, own, 0.02, "a tangent beside");
            assert!((turned - own).abs() > 0.0, "a turned tangent changes nothing");
            // Without tangent, or with one along the normal, and without anisotropy.
            let isotropic = look(normal, view, tangent, roughness, 0.0);
            for none in [DVec3::ZERO, 2.0 * normal] {
                assert_eq!(look(normal, view, none, roughness, anisotropy), isotropic);
            }
            // Albedos along a tangent have a table of their own.
            near(look(normal, view, tangent, roughness, 1e-4), isotropic, 1e-3, "almost isotropic");
            // A view along the normal has no plane of incidence, and one at right angles to the tangent has
            // two directions along the row: nothing jumps there. The kernel itself changes by 1e-4 over its
            // width; the table's harmonics turn in steps of 18 degrees at most.
            let above = look(normal, normal, x, roughness, anisotropy);
            for k in 0..12 {
                let (sine, cosine) = (f64::from(k) * PI / 6.0 + 0.1).sin_cos();
                let aside = normal + 1e-4 * (x * cosine + y * sine);
                near(look(normal, aside, x, roughness, anisotropy), above, 0.02, "along the normal");
            }
            for nv in [0.1, 0.3, 0.6, 0.9_f64] {
                let view = normal * nv + x * (1.0 - nv * nv).sqrt();
                let [left, right] =
                    [-1e-5, 1e-5].map(|aside| look(normal, view, y + aside * x, roughness, anisotropy));
                near(left, right, 0.01, "across the plane of incidence");
            }
        }
    }
}

#[test]
fn rows_contain_the_isotropic_ones_and_run_along_the_light() {
    // Without anisotropy, the row lies in the plane of incidence, as long as alpha times its sine.
    let row = anisotropic::Row::new(alphas(0.5, 0.0), glam::DVec2::new(0.6, 0.8), 0.5);
    assert!((row.axis - glam::DVec2::new(0.25 * 0.75_f64.sqrt(), 0.0)).length() < 1e-12, "{row:?}");
    // Seen along the normal, along the tangent; at right angles to it, across the plane.
    let alpha = alphas(0.5, 0.5);
    let long = (alpha.x * alpha.x - alpha.y * alpha.y).sqrt();
    let tangent = glam::DVec2::new(0.6, 0.8);
    let row = anisotropic::Row::new(alpha, tangent, 1.0);
    assert!((row.axis - long * tangent).length() < 1e-12, "{row:?}");
    let row = anisotropic::Row::new(alpha, glam::DVec2::Y, 0.9);
    assert!(row.axis.x.abs() < 1e-12 && row.axis.y > 0.0 && row.skew == 0.0, "{row:?}");
}

#[test]
fn tables_are_smooth_and_small() {
    for size in [32, 512, 2048] {
        let levels = Levels::over(size).expect("a size");
        let nodes = table(levels);
        assert_eq!(nodes.len(), NODES[0] * NODES[1]);
        for (k, node) in nodes.iter().enumerate() {
            for [slope, level, a, b] in &node[..9] {
                assert!(a.abs() < 6.0 && b.abs() < 6.0, "node {k}: weights {a}, {b}");
                assert!((0.0..=levels.count() as f32 - 1.0).contains(level) && slope.abs() < 30.0, "{k}");
            }
        }
    }
}
