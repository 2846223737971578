//! Tiles of neighbouring texels whose directions share packets, and the footprints of texels.

use crate::chain::LevelSpec;
use crate::environment::Layout;
use crate::filter::Answer;
use crate::light_scale::rounded_up;
use crate::lobe::{self, Lobe};
use crate::sphere::cube::{self, Face, direction_from_cube};
use crate::sphere::equirect::direction_from_equirect;
use crate::sphere::octahedral::{self, direction_from_oct, solid_angle_density};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Texels along an edge of a tile: sixteen directions, one packet.
const TILE: u32 = 4;

/// Texel width, over the lobe's full width at half maximum, from which the footprint is averaged.
const FOOTPRINT_FROM: f64 = 1.0 / 3.0;

/// Texel width from which the whole footprint is averaged.
const FOOTPRINT_WHOLE: f64 = 1.0 / 2.0;

/// Smaller footprints, as a share of a texel's edge, change a lobe by less than a thousandth.
const NEGLIGIBLE_EXTENT: f64 = 0.1;

/// Share of a texel's edge over which its lobe is averaged; `share` is the texel's width over the lobe's.
fn extent(share: f64) -> f64 {
    let fade = ((share - FOOTPRINT_FROM) / (FOOTPRINT_WHOLE - FOOTPRINT_FROM)).clamp(0.0, 1.0);
    fade * fade * (3.0 - 2.0 * fade)
}

/// Grouping of a level's texels into tiles of neighbours, whose directions fill packets.
pub(crate) struct Tiling {
    pub(crate) layout: Layout,
    /// Columns and rows of an image; for a cube, of a face.
    pub(crate) sides: (u32, u32),
    footprint: Footprint,
    /// Texels along an edge of a tile.
    pub(crate) tile: u32,
    tiles: u32,
}

/// The texels of one tile: positions in their row of tiles, directions and weights.
#[derive(Default)]
pub(crate) struct Tile {
    pub(crate) places: Vec<usize>,
    pub(crate) directions: Vec<DVec3>,
    weights: Vec<f32>,
}

impl Tiling {
    /// The tiles of `spec` for `lobe` over an OEM of `oem` texels.
    pub(crate) fn new(oem: u32, spec: LevelSpec, lobe: Lobe) -> Self {
        let footprint = Footprint::new(oem, spec, lobe);
        let tile = (TILE / footprint.divisions).max(1);
        let sides = spec.layout.sides();
        Self { layout: spec.layout, sides, footprint, tile, tiles: sides.1.div_ceil(tile) }
    }

    /// Rows of tiles, of all images.
    pub(crate) const fn rows(&self) -> u32 {
        match self.layout {
            Layout::Cube { .. } => 6 * self.tiles,
            Layout::Panorama { .. } | Layout::Octahedral { .. } => self.tiles,
        }
    }

    /// Directions per texel.
    pub(crate) const fn samples(&self) -> usize {
        self.footprint.samples()
    }

    /// Allocates the answers for row `row` of tiles, row-major.
    pub(crate) fn line(&self, row: u32) -> Vec<Answer> {
        let (top, bottom) = self.span(row % self.tiles, self.sides.1);
        vec![Answer { radiance: [0.0; 3], bound: None }; (self.sides.0 * (bottom - top)) as usize]
    }

    fn span(&self, tile: u32, side: u32) -> (u32, u32) {
        (tile * self.tile, ((tile + 1) * self.tile).min(side))
    }

    /// Calls `visit` with every tile of row `row`, in `tile`.
    pub(crate) fn for_each_tile(&self, row: u32, tile: &mut Tile, mut visit: impl FnMut(&Tile)) {
        let (columns, rows) = self.sides;
        let (top, bottom) = self.span(row % self.tiles, rows);
        for column in 0..columns.div_ceil(self.tile) {
            let (left, right) = self.span(column, columns);
            tile.places.clear();
            tile.directions.clear();
            tile.weights.clear();
            for (i, j) in (top..bottom).flat_map(|j| (left..right).map(move |i| (i, j))) {
                tile.places.push(((j - top) * columns + i) as usize);
                self.footprint.for_each_place(i, j, |x, y| {
                    let (direction, density) = at(self.layout, row / self.tiles, x, y);
                    tile.directions.push(direction);
                    tile.weights.push(density as f32);
                });
            }
            visit(tile);
        }
    }
}

/// Direction at (`x`, `y`), in texels, of image `image`, and the relative solid angle per unit area there.
pub(crate) fn at(layout: Layout, image: u32, x: f64, y: f64) -> (DVec3, f64) {
    match layout {
        Layout::Cube { size } => {
            let scale = 2.0 / f64::from(size);
            let (s, t) = (x * scale - 1.0, y * scale - 1.0);
            (direction_from_cube(Face::ALL[image as usize], s, t), (1.0 + s * s + t * t).powf(-1.5))
        }
        Layout::Panorama { width, height } => {
            let (u, v) = (x / f64::from(width), y / f64::from(height));
            (direction_from_equirect(u, v), (v * PI).sin())
        }
        Layout::Octahedral { size } => {
            let uv = DVec2::new(x, y) * (2.0 / f64::from(size)) - 1.0;
            (direction_from_oct(uv), solid_angle_density(uv))
        }
    }
}

/// Edge length of texel (`i`, `j`) in radians; for a panorama the longer edge.
fn edge(layout: Layout, i: u32, j: u32) -> f64 {
    match layout {
        Layout::Cube { size } => cube::texel_solid_angle(size, i, j).sqrt(),
        Layout::Panorama { height, .. } => PI / f64::from(height),
        Layout::Octahedral { size } => {
            let density = solid_angle_density(octahedral::texel_centre(size, i, j));
            2.0 / f64::from(size) * density.sqrt()
        }
    }
}

/// The longest [`edge`] of all.
fn longest_edge(layout: Layout) -> f64 {
    match layout {
        Layout::Cube { size } => edge(layout, size / 2, size / 2),
        Layout::Panorama { .. } => edge(layout, 0, 0),
        // The density is greatest, 3^1.5, at the centres of the octahedron's faces.
        Layout::Octahedral { size } => 2.0 / f64::from(size) * 3.0_f64.powf(0.75),
    }
}

impl Tile {
    /// Averages the answers of each texel's directions into `line`.
    pub(crate) fn resolve(&self, answers: &[Answer], line: &mut [Answer]) {
        let samples = self.directions.len() / self.places.len();
        let groups = answers.chunks_exact(samples).zip(self.weights.chunks_exact(samples));
        for (place, (answers, weights)) in self.places.iter().zip(groups) {
            line[*place] = mean(answers, weights);
        }
    }
}

/// Weighted mean of a texel's samples; bounds are averaged like values.
pub(crate) fn mean(samples: &[Answer], weights: &[f32]) -> Answer {
    if let [only] = samples {
        return *only;
    }
    let total: f32 = weights.iter().sum();
    // Bounds of light flushed to 0 are too small for shares, too.
    let bounds = samples.iter().filter_map(|sample| sample.bound);
    let greatest = samples.iter().flat_map(|sample| sample.radiance).chain(bounds).fold(0.0, f32::max);
    if greatest > 0.0 && !(LEAST_ORDINARY..GREATEST_ORDINARY).contains(&greatest) {
        return extreme_mean(samples, weights);
    }
    let mut mean = Answer { radiance: [0.0; 3], bound: samples[0].bound.map(|_| 0.0) };
    for (sample, weight) in samples.iter().zip(weights) {
        let share = weight / total;
        for (sum, value) in mean.radiance.iter_mut().zip(sample.radiance) {
            *sum += value * share;
        }
        mean.bound = mean.bound.zip(sample.bound).map(|(sum, bound)| sum + bound * share);
    }
    mean
}

/// Between 2^-100 and 2^100, weighted samples are normal numbers and sums finite in single precision.
const LEAST_ORDINARY: f32 = 1.0 / (1_u128 << 100) as f32;

const GREATEST_ORDINARY: f32 = (1_u128 << 100) as f32;

/// [`mean`] in double precision.
fn extreme_mean(samples: &[Answer], weights: &[f32]) -> Answer {
    let total: f64 = weights.iter().map(|weight| f64::from(*weight)).sum();
    let mean = |value: &dyn Fn(&Answer) -> f32| {
        let products =
            samples.iter().zip(weights).map(|(s, weight)| f64::from(value(s)) * f64::from(*weight));
        products.sum::<f64>() / total
    };
    let radiance = std::array::from_fn(|c| (mean(&|sample| sample.radiance[c]) as f32).min(f32::MAX));
    // Possible rounding of the radiance.
    let rounded = f64::from(f32::from_bits(1));
    let bound = samples[0].bound.map(|_| rounded_up(mean(&|sample| sample.bound.unwrap_or(0.0)) + rounded));
    Answer { radiance, bound }
}

/// Footprint over which a texel's lobe is averaged.
struct Footprint {
    pub(crate) layout: Layout,
    /// Full width at half maximum of the lobe smoothed by an OEM texel.
    width: f64,
    /// Directions along an edge of a texel.
    divisions: u32,
}

impl Footprint {
    pub(crate) fn new(oem: u32, spec: LevelSpec, lobe: Lobe) -> Self {
        let alpha = spec.roughness * spec.roughness;
        // An OEM texel is at least 2/n wide.
        let width = lobe::full_width_at_half_maximum(lobe, alpha).max(2.0 / f64::from(oem));
        let share = longest_edge(spec.layout) / width;
        let divisions = if extent(share) < NEGLIGIBLE_EXTENT {
            1
        } else {
            // Samples at most a quarter of a lobe apart.
            ((4.0 * share).ceil() as u32).next_power_of_two().clamp(2, 64)
        };
        Self { layout: spec.layout, width, divisions }
    }

    pub(crate) const fn samples(&self) -> usize {
        (self.divisions * self.divisions) as usize
    }

    /// Calls `visit` with the place, in texels, of every direction of texel (`i`, `j`).
    fn for_each_place(&self, i: u32, j: u32, mut visit: impl FnMut(f64, f64)) {
        let place = |k: u32, offset: f64| f64::from(k) + 0.5 + offset;
        if self.divisions == 1 {
            return visit(place(i, 0.0), place(j, 0.0));
        }
        let extent = extent(edge(self.layout, i, j) / self.width);
        let count = f64::from(self.divisions);
        // Midpoints, spread to match the variance of the extent.
        let spacing = extent / (count * count - 1.0).sqrt();
        let offset = |k: u32| (f64::from(k) - (count - 1.0) / 2.0) * spacing;
        for b in 0..self.divisions {
            for a in 0..self.divisions {
                visit(place(i, offset(a)), place(j, offset(b)));
            }
        }
    }
}
