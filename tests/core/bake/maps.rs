//! Levels of panoramas and octahedral squares: footprints by area, lobes against the oracle.

use glam::DVec3;
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::bake::{BakeSettings, bake};
use octagloss_core::geometry::footprints::footprints_over;
use octagloss_core::light::environment::{Environment, Layout, Map, Rgb};
use octagloss_core::lobe::Lobe;
use octagloss_core::sphere::equirect::direction_from_equirect;
use octagloss_core::sphere::{equirect, octahedral};
use octagloss_fixtures::common::{Look, Random, environment, texels};

fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

/// Returns the direction of a texel's centre, by the maps' formulas.
fn centre(layout: Layout, index: u32) -> DVec3 {
    match layout {
        Layout::Panorama { width, height } => {
            let (i, j) = (f64::from(index % width) + 0.5, f64::from(index / width) + 0.5);
            direction_from_equirect(i / f64::from(width), j / f64::from(height))
        }
        Layout::Octahedral { size } => {
            octahedral::direction_from_oct(octahedral::texel_centre(size, index % size, index / size))
        }
        Layout::Cube { .. } => panic!("not among the layouts"),
    }
}

fn solid_angle(layout: Layout, index: u32) -> f64 {
    match layout {
        Layout::Panorama { width, height } => equirect::texel_solid_angle(width, height, index / width),
        Layout::Octahedral { size } => octahedral::texel_solid_angle(size, index % size, index / size),
        Layout::Cube { .. } => panic!("not among the layouts"),
    }
}

fn energy(layout: Layout, texels: &[Rgb]) -> f64 {
    (0..).zip(texels).map(|(index, texel)| f64::from(texel[0]) * solid_angle(layout, index)).sum()
}

const SOURCES: [Layout; 4] = [
    Layout::Panorama { width: 30, height: 15 },
    Layout::Panorama { width: 16, height: 8 },
    Layout::Cube { size: 7 },
    Layout::Octahedral { size: 12 },
];

const TARGETS: [Layout; 4] = [
    Layout::Panorama { width: 1, height: 1 },
    Layout::Panorama { width: 22, height: 11 },
    Layout::Octahedral { size: 1 },
    Layout::Octahedral { size: 14 },
];

#[test]
fn footprints_keep_energy_and_constants_however_the_source_is_turned() {
    let mut random = Random::new(11);
    for source in SOURCES {
        for turn in [0.0, 90.0, 33.0] {
            for mirrored in [false, true] {
                let turned = |texels: Vec<Rgb>| {
                    let plain = environment(source, texels).rotated_y(turn).expect("an angle");
                    if mirrored { plain.mirrored() } else { plain }
                };
                let suns = turned(texels(&mut random, Look::Suns, source));
                let constant = turned(vec![[0.7; 3]; source.texel_count()]);
                let mut exact = 0.0;
                suns.for_each_texel(|_, w, radiance| exact += w * f64::from(radiance[0]));
                for target in TARGETS {
                    let made = footprints_over(&suns, target).unwrap();
                    assert_eq!(made.len(), target.texel_count());
                    let off = energy(target, &made) / exact - 1.0;
                    // Parallels are chorded: light of a texel beyond the chord goes to its neighbour.
                    assert!(off.abs() < 1e-4, "{source:?} {turn} {mirrored} {target:?}: {off:e}");
                    let flat = footprints_over(&constant, target).unwrap();
                    assert!(flat.iter().flatten().all(|c| (c - 0.7).abs() < 1e-6), "{source:?} {target:?}");
                }
            }
        }
    }
}

#[test]
fn footprints_are_where_the_world_has_them() {
    // Every source texel holds its own direction: footprints in a finer or equal map hold directions near
    // their centres.
    for source in [Layout::Panorama { width: 128, height: 64 }, Layout::Cube { size: 48 }] {
        let blank = environment(source, vec![[0.0; 3]; source.texel_count()]);
        let mut own = Vec::new();
        blank.for_each_texel(|d, _, _| own.push((d * 0.5 + 0.5).as_vec3().to_array()));
        for turn in [0.0, 90.0, 250.0] {
            let world = environment(source, own.clone()).rotated_y(turn).expect("an angle").mirrored();
            for target in [Layout::Panorama { width: 40, height: 20 }, Layout::Octahedral { size: 24 }] {
                let made = footprints_over(&world, target).unwrap();
                for (index, texel) in (0..).zip(&made) {
                    let shown = DVec3::from_array(texel.map(f64::from)) * 2.0 - 1.0;
                    let expected = world.source_from_world() * centre(target, index);
                    assert!(shown.distance(expected) < 0.06, "{source:?} {turn} {target:?} {index}: {shown}");
                    // The check detects a source turned the other way.
                    let other = world.source_from_world().transpose() * centre(target, index);
                    if turn == 250.0 && expected.distance(other) > 0.2 {
                        assert!(shown.distance(other) > 0.06);
                    }
                }
            }
        }
    }
}

#[test]
fn a_panorama_of_the_same_size_is_the_source_itself() {
    let layout = Layout::Panorama { width: 24, height: 12 };
    let source = texels(&mut Random::new(3), Look::Noise, layout);
    let plain = environment(layout, source.clone());
    assert_eq!(footprints_over(&plain, layout).unwrap(), source);
    // A quarter turn shifts columns.
    let turned = footprints_over(&plain.rotated_y(90.0).expect("an angle"), layout).unwrap();
    for (k, texel) in turned.iter().enumerate() {
        assert_eq!(*texel, source[k / 24 * 24 + (k % 24 + 6) % 24], "texel {k}");
    }
}

/// Returns the relative RMS error of level `index` of a bake of `map` over `size`, at its texels' centres.
fn error(world: &Environment, map: Map, index: usize, shift: u32) -> f64 {
    let settings = BakeSettings { map, size: 32, levels: Some(3), ..BakeSettings::default() };
    let baked = bake(world, &settings).unwrap();
    assert!(baked.chain.levels.len() == 3 && baked.stats.len() == 3);
    let level = &baked.chain.levels[index];
    assert_eq!(level.layout, map.layout(32, index as u32));
    let oracle = Oracle::new(world);
    let count = level.texels.len() as u32;
    let (mut off, mut power) = (0.0, 0.0);
    for at in (0..count).step_by(7) {
        let exact =
            luminance(oracle.reflect(Lobe::Ggx, level.roughness, centre(level.layout, at)).expect("valid"));
        let texel = level.texels[((at + shift) % count) as usize].map(f64::from);
        off += (luminance(texel) - exact).powi(2);
        power += exact * exact;
    }
    (off / power).sqrt()
}

#[test]
fn levels_are_true_lobes_at_every_texel_of_their_map() {
    let layout = Layout::Panorama { width: 64, height: 32 };
    let world = environment(layout, texels(&mut Random::new(5), Look::Suns, layout))
        .rotated_y(25.0)
        .expect("an angle");
    for map in [Map::Panorama, Map::Octahedral] {
        for index in [1, 2] {
            let off = error(&world, map, index, 0);
            println!("{map:?} level {index}: {off:.5}");
            assert!(off < 0.01, "{map:?} level {index}: {off}");
        }
        assert!(error(&world, map, 1, 1) > 0.03, "{map:?}: texels shifted by one must be detected");
    }
}

#[test]
fn a_level_of_one_texel_holds_the_mean_of_its_lobe() {
    let layout = Layout::Cube { size: 16 };
    let world = environment(layout, texels(&mut Random::new(8), Look::Smooth, layout));
    for map in [Map::Panorama, Map::Octahedral] {
        let settings = BakeSettings { map, size: 4, levels: None, ..BakeSettings::default() };
        let baked = bake(&world, &settings).unwrap();
        let last = baked.chain.levels.last().unwrap();
        assert_eq!((last.texels.len(), last.roughness), (1, 1.0), "{map:?}");
        // The mean of a symmetric lobe over all directions is the environment's mean.
        let mut sum = 0.0;
        world.for_each_texel(|_, w, radiance| sum += w * f64::from(radiance[0]));
        let mean = sum / (4.0 * std::f64::consts::PI);
        assert!(
            (f64::from(last.texels[0][0]) / mean - 1.0).abs() < 0.02,
            "{map:?}: {:?} of {mean}",
            last.texels
        );
    }
}
