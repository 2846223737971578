//! Borders of converted maps, and texels outside of domains.

use super::resample::grid;
use glam::{DMat3, DVec2, DVec3};
use octagloss_core::geometry::bordered::bordered_picture;
use octagloss_core::geometry::light::Light;
use octagloss_core::geometry::resample::{Continuation, resample};
use octagloss_core::light::environment::Rgb;
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::map::Texel;
use octagloss_core::sphere::registry::MAPS;
use octagloss_fixtures::common::{Random, texel_from_direction};

/// A map converted from a fine panorama, with its border.
struct Bordered {
    grid: Grid,
    border: u32,
    picture: Vec<Rgb>,
}

impl Bordered {
    /// The map called `name` of `size` with `border` under `light`.
    fn new(light: &Light<'_>, name: &str, size: u32, border: u32) -> Self {
        let grid = grid(name, size);
        let texels = resample(light, &grid);
        let picture = bordered_picture(&grid, &texels, border, &Continuation::new(light, &grid));
        Self { grid, border, picture }
    }

    /// The texel in column `x`, row `y` of `component`, also in its border.
    fn at(&self, component: u32, x: i64, y: i64) -> Rgb {
        let [left, top] = self.grid.picture_origin(component, self.border).map(i64::from);
        let [width, _] = self.grid.picture_sides(self.border).map(i64::from);
        self.picture[((top + y) * width + left + x) as usize]
    }

    /// Bilinear look-up of the red channel at `at`, in texels, of `component`.
    fn bilinear(&self, component: u32, at: DVec2) -> f64 {
        let from = (at - 0.5).floor();
        let share = at - 0.5 - from;
        let value =
            |dx: i64, dy: i64| f64::from(self.at(component, from.x as i64 + dx, from.y as i64 + dy)[0]);
        let row = |dy: i64| value(0, dy) * (1.0 - share.x) + value(1, dy) * share.x;
        row(0) * (1.0 - share.y) + row(1) * share.y
    }
}

/// Returns sparse bright texels, whose means over footprints of many texels differ little, and samples much.
fn stars(grid: &Grid) -> Vec<Rgb> {
    let mut random = Random::new(17);
    (0..grid.texel_count()).map(|_| [if random.unit() < 0.05 { 20.0 } else { 0.0 }; 3]).collect()
}

/// Returns the mean of `light` over the footprint of the texel in column `x`, row `y` of `component` of
/// `grid` by `samples` x `samples` points, each weighted by the solid angle between its neighbours;
/// `None` if that is a single direction.
fn sampled(light: &Light<'_>, grid: &Grid, component: u32, x: i64, y: i64, samples: u32) -> Option<f64> {
    let direction = |k: f64, l: f64| {
        let side = f64::from(samples);
        let uv = grid.uv(component, x as f64 + k / side, y as f64 + l / side);
        light.world_from_source.transpose() * grid.map().direction(component, uv)
    };
    let (mut sum, mut total) = (0.0, 0.0);
    for l in 0..samples {
        for k in 0..samples {
            let [k, l] = [k, l].map(f64::from);
            let (a, b) = (direction(k, l), direction(k + 1.0, l));
            let (c, d) = (direction(k + 1.0, l + 1.0), direction(k, l + 1.0));
            let weight = (c - a).cross(d - b).length();
            let texel = texel_from_direction(&light.grid, direction(k + 0.5, l + 0.5));
            sum += weight * f64::from(light.texels[light.grid.index(texel)][0]);
            total += weight;
        }
    }
    (total > 1e-9).then(|| sum / total)
}

#[test]
fn borders_are_means_over_their_own_footprints() {
    let source = grid("equirect", 128);
    let texels = stars(&source);
    let mut compared = 0;
    for turn in [DMat3::IDENTITY, DMat3::from_rotation_x(0.6)] {
        let light = Light { grid: source, texels: &texels, world_from_source: turn };
        for entry in &MAPS {
            let (name, map) = (&entry.name, &entry.map());
            let target = grid(name, 8);
            // HEALPix continues with tears at the poles, which samples cannot weigh.
            if map.wrap_texel(8, 0, -1, -1).is_some() || ["sphere-map", "healpix"].contains(name) {
                continue;
            }
            let converted = Bordered::new(&light, name, 8, 2);
            let (mut apart, mut all, mut count) = (0.0, 0.0, 0);
            for component in 0..map.components() {
                let [width, height] = target.sides(component).map(i64::from);
                let edges = [(-1, 3), (width, 2), (3, -2), (5, height + 1), (-1, -1), (-2, height)];
                for (x, y) in edges {
                    if map.wrap_texel(8, component, x, y).is_some() {
                        continue;
                    }
                    let Some(expected) = sampled(&light, &target, component, x, y, 96) else { continue };
                    apart += (f64::from(converted.at(component, x, y)[0]) - expected).powi(2);
                    all += expected * expected;
                    count += 1;
                }
            }
            // A footprint has some 100 texels of the source, around whose edges of 30 texels the samples,
            // 1/96 of a footprint apart, miss about 1/20 of each: 1 % of the noise's mean.
            let off = (apart / all).sqrt();
            assert!(off < 0.03, "{name}: borders are {off} off");
            compared += count;
        }
    }
    assert!(compared > 200, "{compared} texels");
    // A single sample is not the mean.
    let light = Light { grid: source, texels: &texels, world_from_source: DMat3::IDENTITY };
    let cube = grid("cube", 8);
    let places = [3, 4, 5, 6, 7].map(|y| (-1, y));
    let all = |samples| places.map(|(x, y)| sampled(&light, &cube, 0, x, y, samples).expect("a footprint"));
    let apart: f64 = all(1).iter().zip(all(96)).map(|(one, mean)| (one - mean).powi(2)).sum();
    assert!((apart / 5.0).sqrt() > 0.3, "{apart}");
}

#[test]
fn borders_by_index_repeat_texels() {
    let source = grid("equirect", 64);
    let texels = stars(&source);
    let light = Light { grid: source, texels: &texels, world_from_source: DMat3::IDENTITY };
    for (name, expected) in [("octahedral", 192), ("octahedral-rectangular", 256), ("equirect", 256)] {
        let converted = Bordered::new(&light, name, 8, 4);
        let [width, height] = converted.grid.sides(0).map(i64::from);
        let mut count = 0;
        for (x, y) in (-4..height + 4).flat_map(|y| (-4..width + 4).map(move |x| (x, y))) {
            let Texel { x: across, y: down, .. } =
                converted.grid.map().wrap_texel(8, 0, x, y).expect("texels onto texels");
            assert_eq!(
                converted.at(0, x, y),
                converted.at(0, across.into(), down.into()),
                "{name} ({x}, {y})"
            );
            count += usize::from(!(0..width).contains(&x) || !(0..height).contains(&y));
        }
        assert_eq!(count, expected, "{name}");
    }
}

/// Returns the RMS difference of bilinear look-ups of a cube on both sides of its edges, and of neighbouring
/// texels inside its faces.
fn jumps(light: &Light<'_>) -> [f64; 2] {
    let size = 16;
    let cube = Bordered::new(light, "cube", size, 2);
    let (mut across, mut inside, mut count) = (0.0, 0.0, 0.0);
    for component in 0..6 {
        for k in 1..size {
            // On the right edge of the face, seen from it and from its neighbour.
            let at = DVec2::new(f64::from(size), f64::from(k));
            let own = cube.bilinear(component, at);
            let direction = cube.grid.map().direction(component, cube.grid.uv(component, at.x, at.y));
            let beyond = cube.grid.uv(component, at.x + 1e-9, at.y);
            let place = cube.grid.map().locate(cube.grid.map().direction(component, beyond));
            assert!(place.component != component && direction.is_normalized(), "an edge");
            let rectangle = cube.grid.map().component(place.component);
            let there = (place.uv - rectangle.low) / cube.grid.step(&rectangle);
            across += (own - cube.bilinear(place.component, there)).powi(2);
            let [x, y] = [i64::from(size / 2), i64::from(k)];
            let neighbours = [cube.at(component, x, y), cube.at(component, x - 1, y)];
            inside += f64::from(neighbours[0][0] - neighbours[1][0]).powi(2);
            count += 1.0;
        }
    }
    [across, inside].map(|sum: f64| (sum / count).sqrt())
}

#[test]
fn seams_of_a_downsampled_map_do_not_show() {
    let source = grid("equirect", 512);
    let texels = stars(&source);
    let light = Light { grid: source, texels: &texels, world_from_source: DMat3::IDENTITY };
    let [across, inside] = jumps(&light);
    // Samples instead of means would differ by the noise itself, four times the mean.
    assert!(across < inside, "{across} across edges, {inside} inside");
}

#[test]
fn a_single_direction_around_the_sphere_map_has_a_mean_too() {
    let source = grid("equirect", 256);
    let mut texels = stars(&source);
    let light = Light { grid: source, texels: &texels, world_from_source: DMat3::IDENTITY };
    let mean: f64 = texels.iter().map(|texel| f64::from(texel[0])).sum::<f64>() / texels.len() as f64;
    let corner = |light: &Light<'_>| f64::from(Bordered::new(light, "sphere-map", 8, 1).at(0, -1, -1)[0]);
    // A 64th of the sphere has 2000 texels, with 5 % stars: a standard deviation of 10 % of the mean.
    let around = corner(&light);
    assert!((around / mean - 1.0).abs() < 0.4, "{around}, mean {mean}");
    // It is -Z's: light elsewhere does not change it.
    for texel in source.texels() {
        if source.direction_from_texel(texel).dot(DVec3::NEG_Z) < 0.8 {
            texels[source.index(texel)] = [1e6; 3];
        }
    }
    let light = Light { grid: source, texels: &texels, world_from_source: DMat3::IDENTITY };
    assert_eq!(corner(&light), around);
}

#[test]
fn borders_show_what_lies_across_the_edge() {
    let light = |d: DVec3| [(2.0 + d.x) as f32, (2.0 + d.y) as f32, (2.0 + d.z) as f32];
    let source = grid("cube", 64);
    let texels: Vec<Rgb> = source.texels().map(|texel| light(source.direction_from_texel(texel))).collect();
    let smooth = Light { grid: source, texels: &texels, world_from_source: DMat3::IDENTITY };
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        let converted = Bordered::new(&smooth, name, 16, 2);
        let mut compared = 0;
        for component in 0..map.components() {
            let [columns, rows] = converted.grid.sides(component).map(i64::from);
            for (x, y) in (-2..rows + 2).flat_map(|y| (-2..columns + 2).map(move |x| (x, y))) {
                let uv = converted.grid.uv(component, x as f64 + 0.5, y as f64 + 0.5);
                let expected = light(map.direction(component, uv));
                let found = converted.at(component, x, y);
                let off = (0..3).map(|c| (found[c] - expected[c]).abs()).fold(0.0, f32::max);
                // A texel is at most 0.4 long; of one across a rim the part inside counts. Texels at the
                // sphere map's rim are stretched.
                let is_long = ["healpix", "sphere-map"].contains(name);
                assert!(off < 0.2 || is_long, "{name}: ({x}, {y}) of {component} is {off} off");
                compared += 1;
            }
        }
        assert!(compared >= 400, "{name}: {compared} texels");
    }
}
