//! Conversion of environments: the energy of every channel.

use super::resample::{energy, grid};
use glam::DMat3;
use octagloss_core::geometry::conversion::Source;
use octagloss_core::light::environment::{Environment, Layout, Rgb};
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::registry::{MAPS, NamedMap};
use octagloss_fixtures::common::sweep;

/// Returns the greatest share of a channel's energy that `source` loses or gains in `map` of `size`.
fn off(source: &Source, map: &NamedMap, size: u32) -> f64 {
    let sent = energy(source.grid(), source.light().texels);
    let held =
        energy(&Grid::new(map.map(), size).expect("a size"), &source.converted(map, size).expect("fits"));
    (0..3).map(|c| (held[c] / sent[c] - 1.0).abs()).fold(0.0, f64::max)
}

/// Returns a panorama with a lamp in one channel, one very bright texel in another, and a constant.
fn panorama(width: u32, lamp: [u32; 2], brightest: [u32; 2]) -> Environment {
    let mut texels: Vec<Rgb> = vec![[0.0, 1.0, 0.3]; (width * width / 2) as usize];
    texels[(lamp[1] * width + lamp[0]) as usize][0] = 1e5;
    texels[(brightest[1] * width + brightest[0]) as usize][1] = 3e38;
    Environment::new(Layout::Panorama { width, height: width / 2 }, texels).expect("a panorama")
}

/// The requirement of conversion.
const LOST: f64 = 1e-6;

#[test]
fn single_bright_texels_keep_their_energy_in_every_map() {
    let mut compared = 0;
    // The panorama of 1024 x 512 is fine enough to be swept.
    for (width, lamp, brightest, size) in
        [(16, [12, 4], [5, 3], 8), (256, [200, 70], [3, 1], 32), (1024, [800, 280], [511, 255], 32)]
    {
        for degrees in [0.0, 31.0] {
            let environment = panorama(width, lamp, brightest).rotated_y(degrees).expect("an angle");
            let source = Source::from_environment(environment).expect("2:1");
            // Of the finest, every map one way.
            let share = if width > 1000 { sweep(2, 1) } else { 1 };
            for map in MAPS.iter().skip(usize::from(degrees > 0.0) % share).step_by(share) {
                let off = off(&source, map, size);
                assert!(off < LOST, "{width} to {} turned by {degrees}: {off:e}", map.name);
                compared += 1;
            }
        }
    }
    assert_eq!(compared, sweep(5, 6) * MAPS.len());
}

#[test]
fn pictures_of_maps_keep_their_energy() {
    let cube = grid("cube", 6);
    let texels: Vec<_> = (0..216).map(|k| if k == 77 { [1e5, 3e38, 0.5] } else { [0.0, 0.0, 0.5] }).collect();
    for degrees in [0.0_f64, 31.0] {
        let turn = DMat3::from_rotation_y(degrees.to_radians());
        let source = Source::from_texels(cube, texels.clone(), turn);
        for map in &MAPS {
            let off = off(&source, map, 5);
            assert!(off < LOST, "a cube to {} turned by {degrees}: {off:e}", map.name);
        }
    }
}

#[test]
fn the_greatest_radiance_stays_finite() {
    let texels = vec![[f32::MAX; 3]; 512];
    let environment = Environment::new(Layout::Panorama { width: 32, height: 16 }, texels).expect("valid");
    let source = Source::from_environment(environment).expect("2:1");
    for map in &MAPS {
        let means = source.converted(map, 7).expect("fits");
        assert!(means.as_flattened().iter().all(|value| value.is_finite()), "{}", map.name);
    }
}

#[test]
fn lost_energy_is_detected() {
    let source = Source::from_environment(panorama(16, [12, 4], [5, 3])).expect("2:1");
    let map = MAPS.iter().find(|map| map.name == "cube").expect("a map");
    let sent = energy(source.grid(), source.light().texels);
    let mut means = source.converted(map, 8).expect("fits");
    means.iter_mut().for_each(|mean| mean[0] *= 1.0 + 2e-6);
    let held = energy(&grid("cube", 8), &means);
    assert!((held[0] / sent[0] - 1.0).abs() > LOST);
}
