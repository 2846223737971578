//! The pyramid on cubes: reads of its levels, seams, suns near them, and its files.

use super::{map_of, under_gaussian};
use glam::DVec3;
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::bake::bake;
use octagloss_core::files::export::files::files;
use octagloss_core::files::io::read_chain_from_memory;
use octagloss_core::files::recipe::Recipe;
use octagloss_core::files::target::{PyramidMap, Target};
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::lobe::Lobe;
use octagloss_core::pyramid::{Levels, Pyramid};
use octagloss_fixtures::common::{Look, Random, environment, landmarks, oem, texels};
use octagloss_shaders::reader;

/// A direction within `angle` of `around`.
fn beside(random: &mut Random, around: DVec3, angle: f64) -> DVec3 {
    let away = angle * random.unit();
    around * away.cos() + around.cross(random.direction()).normalize() * away.sin()
}

/// The light of `oem` that the levels have: without its suns.
fn rest_of(oem: &Oem, clamp: f32) -> Oem {
    let kept = |[r, g, b, w]: &[f32; 4]| {
        let kept = (clamp / (r.max(*g).max(*b) / w)).min(1.0);
        [r * kept, g * kept, b * kept, *w]
    };
    Oem::from_square(oem.size(), oem.square().map(kept).collect())
}

/// A read widens a Gaussian by up to a quarter of a texel's square and by as little as nothing, a sixth in
/// the mean: 1.4 texels a deviation are 4 % more and 8 % less. The sharp one ends at three deviations.
#[test]
fn reads_of_levels_are_gaussians_also_at_edges_and_corners() {
    let (_, oem) = map_of(128, 3, Look::Noise);
    let pyramid = Pyramid::of_oem(&oem).expect("a size");
    let rest = rest_of(&oem, pyramid.suns().clamp);
    let (cubes, levels) = (pyramid.on_cubes(), Levels::over(128).expect("a size").on_cubes());
    let widths = (1..levels.count()).map(|map| levels.width(map));
    let scale = f64::from(pyramid.exponent()).exp2();
    let mut random = Random::new(4);
    let everywhere: Vec<DVec3> = (0..200).map(|_| random.direction()).collect();
    let seams: Vec<DVec3> = landmarks()
        .into_iter()
        .flat_map(|d| [d, beside(&mut random, d, 0.05), beside(&mut random, d, 0.2)])
        .collect();
    for (width, map) in widths.zip(&cubes.maps()[1..]) {
        for directions in [&everywhere, &seams] {
            let (mut error, mut square) = (0.0, 0.0);
            for direction in directions {
                let truth = under_gaussian(&rest, width, *direction);
                let found = map.around(*direction).as_dvec3() * scale;
                error += (found - truth).length_squared();
                square += truth.length_squared();
            }
            let relative = (error / square).sqrt();
            assert!(relative < 0.012, "a Gaussian of {width}: off by {relative}");
        }
    }
}

/// Light is continuous across edges and around corners.
#[test]
fn faces_have_no_seams() {
    let (_, oem) = map_of(64, 5, Look::Smooth);
    let cubes = Pyramid::of_oem(&oem).expect("a size").on_cubes();
    let mut random = Random::new(6);
    for seam in landmarks() {
        let [a, b] = [0, 1].map(|_| beside(&mut random, seam, 1e-5));
        for map in cubes.maps() {
            let (own, other) = (map.around(a), map.around(b));
            assert!((own - other).length() < 1e-3 * own.length(), "{seam}: {own} beside {other}");
        }
    }
}

/// The texel of an octahedral map of `size` around `direction`.
fn texel_at(size: u32, direction: DVec3) -> usize {
    let layout = Layout::Octahedral { size };
    let near = |k: &u32| layout.direction_from_texel(0, k % size, k / size).distance(direction);
    (0..size * size).min_by(|a, b| near(a).total_cmp(&near(b))).expect("texels") as usize
}

/// Suns of one texel on edges, on corners and beside them, and lamps too wide to be suns. A sun that fills a
/// texel counts as a point: at roughness 0.3 it is wider than that by 1.6 % of the lobe's covariance.
#[test]
fn suns_near_edges_are_as_they_are_elsewhere() {
    let size = 128;
    let places = [
        DVec3::new(1.0, 1.0, 0.0),
        DVec3::new(1.0, 0.02, 0.98),
        DVec3::ONE,
        DVec3::new(-1.0, -0.97, 0.95),
        DVec3::new(0.3, 0.9, -0.2),
    ];
    for at in places.map(DVec3::normalize) {
        for lamp in [false, true] {
            let mut light = vec![[0.2, 0.3, 0.4]; (size * size) as usize];
            let layout = Layout::Octahedral { size };
            if lamp {
                for (k, texel) in (0..).zip(&mut light) {
                    let near = layout.direction_from_texel(0, k % size, k / size).distance(at) < 0.15;
                    *texel = if near { [30.0, 20.0, 10.0] } else { *texel };
                }
            } else {
                light[texel_at(size, at)] = [5e4, 4e4, 3e4];
            }
            let environment = environment(layout, light.clone());
            let oracle = Oracle::new(&environment);
            let pyramid = Pyramid::of_oem(&oem(OemSize { inner: size, border: 0 }, &light)).expect("a size");
            let pyramids = [pyramid.on_cubes(), pyramid];
            let mut random = Random::new(9);
            for roughness in [0.3, 0.45, 0.7] {
                let directions: Vec<DVec3> =
                    (0..30).map(|_| beside(&mut random, at, 4.0 * roughness * roughness)).collect();
                let truth: Vec<DVec3> = directions
                    .iter()
                    .map(|d| oracle.reflect(Lobe::Ggx, roughness, *d).expect("valid").into())
                    .collect();
                let [cubes, squares] = [0, 1].map(|k| {
                    let lobes = pyramids[k].lobes(roughness as f32);
                    let found =
                        directions.iter().map(|d| DVec3::from_array(lobes.radiance(*d).map(f64::from)));
                    // The worst channel.
                    let (mut error, mut square) = (DVec3::ZERO, DVec3::ZERO);
                    for (found, truth) in found.zip(&truth) {
                        error += (found - truth).powf(2.0);
                        square += truth.powf(2.0);
                    }
                    (error / square).max_element().sqrt()
                });
                assert!(cubes < 0.015, "light at {at}, roughness {roughness}: {cubes}, on squares {squares}");
            }
        }
    }
}

/// The shape of the file, and what its look-ups answer.
#[test]
fn files_have_one_cube_that_comes_back() {
    let size = 64;
    let layout = Layout::Panorama { width: 128, height: 64 };
    let light = texels(&mut Random::new(11), Look::Suns, layout);
    let environment = Environment::new(layout, light).expect("light");
    let target = Target::named("pyramid").expect("a target");
    let recipe = |pixel: &str| Recipe {
        size: Some(size),
        map: Some(PyramidMap::Cube),
        pixel: Some(pixel.parse().expect("a format")),
        ..Recipe::default()
    };
    let pyramid = Pyramid::build(&environment, size).expect("a size").on_cubes();
    let baked =
        bake(&environment, &recipe("f16").targeted(target).expect("a plan").settings).expect("a bake");
    for (pixel, format, allowed) in [
        ("f16", ktx2::Format::R16G16B16A16_SFLOAT, 1e-3),
        ("rgb9e5", ktx2::Format::E5B9G9R9_UFLOAT_PACK32, 4e-3),
        ("bc6h", ktx2::Format::BC6H_UFLOAT_BLOCK, 0.05),
    ] {
        let plan = recipe(pixel).targeted(target).expect("a plan");
        let made = files(&plan.plan, "sky", &baked, &[], reader).expect("files");
        let names: Vec<&str> = made.iter().map(|file| file.path.as_str()).collect();
        assert_eq!(names[..3], ["sky_pyramid.ktx2", "sky_pyramid.json", "pyramid_cube_tables.ktx2"]);
        assert!(names[3..].iter().all(|name| name.starts_with("pyramid_cube.")), "{names:?}");
        let header = ktx2::Reader::new(&made[0].bytes).expect("a KTX2 file").header();
        assert_eq!(header.format, Some(format));
        let shape = [header.pixel_width, header.pixel_height, header.layer_count, header.face_count];
        assert_eq!((shape, header.level_count), ([size, size, 0, 6], 4));
        let chain =
            read_chain_from_memory("sky_pyramid.ktx2".as_ref(), &made[0].bytes, 1 << 30).expect("a pyramid");
        // A block of BC6H that holds a sun in the mirror has little precision left for the rest.
        for level in chain.levels.iter().filter(|level| pixel != "bc6h" || level.roughness > 0.3) {
            let lobes = pyramid.lobes(level.roughness as f32);
            let (mut error, mut square) = (0.0, 0.0);
            for k in (0..level.texels.len()).step_by(7) {
                let (n, k) = (level.size() as usize, k as u32);
                let (face, at) = (k as usize / (n * n), k % level.size().pow(2));
                let direction =
                    level.layout.direction_from_texel(face as u32, at % level.size(), at / level.size());
                let expected = DVec3::from_array(lobes.radiance(direction).map(f64::from));
                let found = DVec3::from_array(level.texels[k as usize].map(f64::from));
                error += found.distance_squared(expected);
                square += expected.length_squared();
            }
            let relative = (error / square).sqrt();
            assert!(relative < allowed, "{pixel}, roughness {}: off by {relative}", level.roughness);
        }
    }
}
