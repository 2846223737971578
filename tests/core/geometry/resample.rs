//! Conversion between all maps: constants, energy, and directions of light.

use glam::{DMat3, DVec3};
use octagloss_core::geometry::light::Light;
use octagloss_core::geometry::resample;
use octagloss_core::light::environment::Rgb;
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::registry::{MAPS, NamedMap, named};
use octagloss_fixtures::common::{Random, sweep};
use std::f64::consts::PI;

pub(super) fn grid(name: &str, size: u32) -> Grid {
    Grid::new(named(name).expect("a map").map(), size).expect("a size")
}

/// Resamples `texels` of `grid`, turned by `world_from_source`, to `target`.
fn resample(grid: &Grid, texels: &[Rgb], world_from_source: DMat3, target: &Grid) -> Vec<Rgb> {
    resample::resample(&Light { grid: *grid, texels, world_from_source }, target)
}

/// Returns the energy of each channel over the texels' exact solid angles.
pub(super) fn energy(grid: &Grid, texels: &[Rgb]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for texel in grid.texels() {
        let solid_angle = grid.solid_angle(texel);
        for (sum, value) in sums.iter_mut().zip(texels[grid.index(texel)]) {
            *sum += solid_angle * f64::from(value);
        }
    }
    sums
}

/// Returns noise, a constant, and black with a few suns, one per channel.
fn noise(grid: &Grid, seed: u64) -> Vec<Rgb> {
    let mut random = Random::new(seed);
    let count = grid.texel_count();
    (0..count).map(|k| [random.unit() as f32, 1.0, if k % 11 == 5 { 1e4 } else { 0.0 }]).collect()
}

/// Rounding of shares, sums and results, each by half a unit in the last place of single precision.
const ROUNDING: f64 = 4.0 / (1_u64 << 24) as f64;

#[test]
fn energy_and_constants_survive_from_every_map_to_every_map() {
    let share = sweep(3, 1);
    // At 20 mirrors run through blocks of texels; at 33 and 47 rims cut slivers of texels.
    for (k, (from, to)) in [(20, 16), (5, 47), (33, 8)].into_iter().enumerate() {
        for (i, entry) in MAPS.iter().enumerate() {
            let (name, map) = (&entry.name, &entry.map());
            let source = Grid::new(*map, from).expect("a size");
            let texels = noise(&source, 7);
            let sent = energy(&source, &texels);
            // Every two maps at one pair of sizes.
            for entry in MAPS.iter().skip((i + k) % share).step_by(share) {
                let (other, map) = (&entry.name, &entry.map());
                let case = format!("{name} {from} to {other} {to}");
                let target = Grid::new(*map, to).expect("a size");
                let result = resample(&source, &texels, DMat3::IDENTITY, &target);
                for (c, arrived) in energy(&target, &result).into_iter().enumerate() {
                    let off = (arrived / sent[c] - 1.0).abs();
                    assert!(off <= ROUNDING, "{case}, channel {c}: {off:e} of the energy");
                }
                let off = result.iter().map(|texel| (f64::from(texel[1]) - 1.0).abs()).fold(0.0, f64::max);
                assert!(off <= ROUNDING, "{case}: a constant is off by {off:e}");
            }
        }
    }
}

/// Returns the relative RMS difference of a channel between two results, over the domain.
fn apart(grid: &Grid, some: &[Rgb], others: &[Rgb]) -> f64 {
    let (mut apart, mut all) = (0.0, 0.0);
    for texel in grid.texels() {
        let (solid_angle, k) = (grid.solid_angle(texel), grid.index(texel));
        apart += solid_angle * f64::from(some[k][0] - others[k][0]).powi(2);
        all += solid_angle * f64::from(others[k][0]).powi(2);
    }
    // Rounding may leave a sliver less than nothing.
    (apart.max(0.0) / all).sqrt()
}

/// Too small a turn to be seen, but no identity: without mirrors.
fn unmirrored() -> DMat3 {
    DMat3::from_axis_angle(DVec3::Y, 1e-13)
}

#[test]
fn maps_of_a_few_texels_keep_energy_and_constants_with_and_without_mirrors() {
    // A panorama of size 1 is 2 x 1. Mirrors cut texels from corner to corner, or in halves that have no
    // corner behind the mirror.
    let (mut compared, share) = (0, sweep(2, 1));
    let sizes = [(1, 1), (1, 2), (1, 3), (2, 1), (2, 3), (3, 1), (3, 2)];
    for (k, (from, to)) in sizes.into_iter().enumerate() {
        for (i, entry) in MAPS.iter().enumerate() {
            let (name, map) = (&entry.name, &entry.map());
            let source = Grid::new(*map, from).expect("a size");
            let texels = noise(&source, 5);
            let sent = energy(&source, &texels);
            // The constant is the energy of the sphere.
            assert!((sent[1] / (4.0 * PI) - 1.0).abs() < 1e-12, "{name} {from}: {}", sent[1]);
            for entry in MAPS.iter().skip((i + k) % share).step_by(share) {
                let (other, map) = (&entry.name, &entry.map());
                let case = format!("{name} {from} to {other} {to}");
                let target = Grid::new(*map, to).expect("a size");
                let result = resample(&source, &texels, DMat3::IDENTITY, &target);
                for (channel, arrived) in energy(&target, &result).into_iter().enumerate().take(2) {
                    let off = (arrived / sent[channel] - 1.0).abs();
                    assert!(off <= ROUNDING, "{case}, channel {channel}: {off:e} of the energy");
                }
                let off = result.iter().map(|texel| (f64::from(texel[1]) - 1.0).abs()).fold(0.0, f64::max);
                assert!(off <= ROUNDING, "{case}: a constant is off by {off:e}");
                let without = resample(&source, &texels, unmirrored(), &target);
                // Along seams both assign parts of 1/32 of a texel's edge by their centres: 1/64 of the texel
                // on each of four sides.
                let off = apart(&target, &result, &without);
                assert!(off <= 1.0 / 16.0, "{case}: {off:e} apart from the result without mirrors");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, sizes.len() * MAPS.len() * MAPS.len() / share);
    // One wrong texel shows.
    let target = grid("cube", 2);
    let right = noise(&target, 9);
    let mut wrong = right.clone();
    wrong[7][0] += 1.0;
    assert!(apart(&target, &wrong, &right) > 1.0 / 16.0);
}

/// Returns the relative RMS difference over the sphere between an environment converted by its mirrors and
/// without them, by a rotation of `angle` about `axis`.
fn apart_without_mirrors(from: &Grid, to: &Grid, axis: DVec3, angle: f64) -> f64 {
    let (source, target) = (*from, *to);
    let mut random = Random::new(3);
    let texels: Vec<Rgb> = (0..source.texel_count()).map(|_| [random.unit() as f32; 3]).collect();
    let turn = DMat3::from_axis_angle(axis, angle);
    let by_mirrors = resample(&source, &texels, DMat3::IDENTITY, &target);
    apart(&target, &by_mirrors, &resample(&source, &texels, turn, &target))
}

#[test]
fn mirrors_change_no_mean() {
    // At kinks and seams parts of 1/32 of a texel's edge are assigned by their centres: up to 1/64 of a texel
    // there, for either way. Corners interpolated in other blocks are off by a thousandth of a texel.
    // At 20 they run through blocks of texels.
    let share = sweep(2, 1);
    for (i, NamedMap { name, .. }) in MAPS.iter().enumerate() {
        for NamedMap { name: from, .. } in MAPS.iter().skip(i % share).step_by(share) {
            let apart = apart_without_mirrors(&grid(from, 20), &grid(name, 16), DVec3::Y, 1e-13);
            assert!(apart <= 1.0 / 64.0, "{from} to {name}: {apart:e}");
        }
    }
    assert!(
        apart_without_mirrors(&grid("equirect", 20), &grid("cube", 16), DVec3::X, 0.04) > 1.0 / 64.0,
        "a turn must be detected"
    );
}

#[test]
fn a_lamp_on_a_rim_leaves_the_rest_of_the_picture_alone() {
    // Texels far from the lamp are corrected by 1e-6 of what the lamp's are, the ratio of the radiances. Even
    // ten times the lamp's radiance is then 1e-5. One factor for all would be up to 1e-2.
    let mut moved = 0;
    for (from, to) in
        [("equirect", "polar-capped-conformal"), ("healpix", "tennis-ball"), ("cube", "sphere-map")]
    {
        let (source, target) = (grid(from, 16), grid(to, 15));
        for lamp in (0..source.texel_count()).step_by(sweep(61, 29)) {
            let mut texels = vec![[0.01_f32; 3]; source.texel_count()];
            texels[lamp] = [1e4; 3];
            let result = resample(&source, &texels, DMat3::IDENTITY, &target);
            let off = |value: f32| (f64::from(value) / f64::from(0.01_f32) - 1.0).abs();
            let dim: Vec<f32> = result.iter().map(|texel| texel[0]).filter(|value| *value < 0.0101).collect();
            assert!(dim.len() > target.texel_count() / 2, "{from} to {to}: {} texels are dim", dim.len());
            let near = dim.iter().filter(|value| off(**value) > 1e-5).count();
            // Slivers of the lamp in a few texels next to it.
            assert!(near <= 16, "{from} to {to}, lamp {lamp}: {near} texels next to it changed");
            moved += dim.len();
        }
    }
    assert!(moved > sweep(2_000, 5_000), "{moved} texels");
}

/// Returns the greatest difference between converted texels and the function sampled directly. The function
/// is turned by `turn` at the source.
fn worst_of_smooth(from: &str, to: &str, turn: DMat3) -> f64 {
    worst_between(from, to, turn, turn)
}

/// [`worst_of_smooth`] with the conversion turned by another rotation than the function.
fn worst_between(from: &str, to: &str, turn: DMat3, applied: DMat3) -> f64 {
    let light = |d: DVec3| 1.0 + 0.5 * d.x + 0.3 * d.y * d.z + 0.2 * d.z;
    let (source, target) = (grid(from, 32), grid(to, 16));
    let texels: Vec<Rgb> =
        source.texels().map(|texel| [light(turn * source.direction_from_texel(texel)) as f32; 3]).collect();
    let result = resample(&source, &texels, applied, &target);
    let mut worst: f64 = 0.0;
    for texel in target.texels() {
        let middle = target.uv(texel.component, f64::from(texel.x) + 0.5, f64::from(texel.y) + 0.5);
        if target.map().contains(texel.component, middle) {
            let expected = light(target.map().direction(texel.component, middle));
            worst = worst.max((f64::from(result[target.index(texel)][0]) - expected).abs());
        }
    }
    worst
}

#[test]
fn light_arrives_where_it_comes_from() {
    // The function's slope is below 1.2. A texel of 16 is at most pi/16 long, stretched by at most 3 where a
    // rim cuts it, which moves its mean by a fraction of that.
    let bound = 0.16;
    let turn = DMat3::from_rotation_y(0.7);
    for NamedMap { name, .. } in &MAPS {
        for (from, to) in [("equirect", *name), (*name, "octahedral")] {
            let off = worst_of_smooth(from, to, turn);
            assert!(off <= bound, "{from} to {to}, turned: {off}");
        }
    }
    let off = worst_of_smooth("cube", "tennis-ball", DMat3::IDENTITY);
    assert!(off <= bound, "not turned: {off}");
    let wrong = worst_between("cube", "tennis-ball", turn, DMat3::IDENTITY);
    assert!(wrong > 2.0 * bound, "a missing rotation is not detected: {wrong}");
}

#[test]
fn a_map_onto_itself_is_the_same() {
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        let source = Grid::new(*map, 16).expect("a size");
        let texels = noise(&source, 3);
        let same = resample(&source, &texels, DMat3::IDENTITY, &source);
        let (mut changed, mut inside) = (0, 0);
        for texel in source.texels() {
            if source.solid_angle(texel) > 0.0 {
                inside += 1;
                let (a, b) = (texels[source.index(texel)][0], same[source.index(texel)][0]);
                changed += usize::from((a - b).abs() > 1e-3);
            }
        }
        // Texels on folds and rims exchange a little with neighbours where corners belong to another
        // component.
        assert!(changed * 3 <= inside, "{name}: {changed} of {inside} texels changed");
    }
}
