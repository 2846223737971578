//! Tiles of neighbouring texels whose directions share packets, and the footprints of texels.

use crate::common::smoothstep::smoothstep;
use crate::light::chain::LevelSpec;
use crate::light::environment::Layout;
use crate::light::light_scale::rounded_up;
use crate::lobe::filter::{Answer, Bound};
use crate::lobe::{self, Lobe};
use crate::sphere::cube::{self, Face, direction_from_cube};
use crate::sphere::equirect::direction_from_equirect;
use crate::sphere::octahedral::{self, direction_from_oct, solid_angle_density};
use crate::sphere::quadrature::gauss_legendre;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Texels along an edge of a tile: sixteen directions, one packet, if each texel has one.
pub(crate) const TILE: u32 = 4;

/// Texel width, over the lobe's full width at half maximum, from which the footprint is averaged.
const FOOTPRINT_FROM: f64 = 1.0 / 3.0;

/// Texel width from which the whole footprint is averaged.
const FOOTPRINT_WHOLE: f64 = 1.0 / 2.0;

/// Smaller footprints, as a share of a texel's edge, change a lobe by less than a thousandth.
const NEGLIGIBLE_EXTENT: f64 = 0.1;

/// Share of a texel's edge over which its lobe is averaged; `share` is the texel's width over the lobe's.
fn extent(share: f64) -> f64 {
    smoothstep((share - FOOTPRINT_FROM) / (FOOTPRINT_WHOLE - FOOTPRINT_FROM))
}

/// Grouping of a level's texels into tiles of neighbours, whose directions fill packets.
pub struct Tiling {
    pub(crate) layout: Layout,
    /// Columns and rows of an image; for a cube, of a face.
    pub(crate) sides: (u32, u32),
    tiles: u32,
    /// Full width at half maximum of the lobe smoothed by an OEM texel.
    lobe_width: f64,
    /// Places and weights of footprints, over which the texels' lobes are averaged: over a square of edge 1
    /// around 0, by rules of rising order.
    rules: Vec<Vec<(f64, f64, f64)>>,
}

/// The texels of one tile.
#[derive(Default)]
pub struct Tile {
    /// Position in the row of tiles, and the number of directions, of each texel.
    pub(crate) texels: Vec<(usize, usize)>,
    /// Directions and weights, texel by texel.
    pub directions: Vec<DVec3>,
    weights: Vec<f32>,
}

impl Tiling {
    /// The tiles of `spec` for `lobe` over an OEM of `oem` texels.
    pub fn new(oem: u32, spec: LevelSpec, lobe: Lobe) -> Self {
        let sides = spec.layout.sides();
        let alpha = spec.roughness * spec.roughness;
        // An OEM texel is at least 2/n wide.
        let lobe_width = lobe::full_width_at_half_maximum(lobe, alpha).max(2.0 / f64::from(oem));
        let most = order(longest_edge(spec.layout) / lobe_width);
        let (tiles, rules) = (sides.1.div_ceil(TILE), (1..=most).map(rule).collect());
        Self { layout: spec.layout, sides, tiles, lobe_width, rules }
    }

    /// Rows of tiles, of all images.
    pub const fn rows(&self) -> u32 {
        match self.layout {
            Layout::Cube { .. } => 6 * self.tiles,
            Layout::Panorama { .. } | Layout::Octahedral { .. } => self.tiles,
        }
    }

    /// Allocates the answers for row `row` of tiles, row-major.
    pub fn line(&self, row: u32) -> Vec<Answer> {
        let (top, bottom) = span(row % self.tiles, self.sides.1);
        vec![Answer { radiance: [0.0; 3], bound: None }; (self.sides.0 * (bottom - top)) as usize]
    }

    /// Calls `visit` with every tile of row `row`, in `tile`.
    pub fn for_each_tile(&self, row: u32, tile: &mut Tile, visit: impl FnMut(&Tile)) {
        self.for_each_tile_at(row, tile, |_| true, visit);
    }

    /// Calls `visit` with every tile of row `row` whose first column is `wanted`, in `tile`.
    pub(crate) fn for_each_tile_at(
        &self,
        row: u32,
        tile: &mut Tile,
        wanted: impl Fn(u32) -> bool,
        mut visit: impl FnMut(&Tile),
    ) {
        let (columns, rows) = self.sides;
        let (top, bottom) = span(row % self.tiles, rows);
        for column in 0..columns.div_ceil(TILE) {
            let (left, right) = span(column, columns);
            if !wanted(left) {
                continue;
            }
            tile.texels.clear();
            tile.directions.clear();
            tile.weights.clear();
            for (i, j) in (0..TILE * TILE).map(|k| (left + interleaved(k), top + interleaved(k >> 1))) {
                if i >= right || j >= bottom {
                    continue;
                }
                let before = tile.directions.len();
                self.for_each_place(i, j, |x, y, weight| {
                    let (direction, density) = at(self.layout, row / self.tiles, x, y);
                    tile.directions.push(direction);
                    tile.weights.push((weight * density) as f32);
                });
                tile.texels.push((((j - top) * columns + i) as usize, tile.directions.len() - before));
            }
            visit(tile);
        }
    }

    /// Calls `visit` with the place, in texels, and the weight of every direction of texel (`i`, `j`).
    fn for_each_place(&self, i: u32, j: u32, mut visit: impl FnMut(f64, f64, f64)) {
        if self.rules.len() == 1 {
            return visit(f64::from(i) + 0.5, f64::from(j) + 0.5, 1.0);
        }
        let share = edge(self.layout, i, j) / self.lobe_width;
        let rule = &self.rules[(order(share) as usize).min(self.rules.len()) - 1];
        let extent = extent(share);
        let place = |k: u32, offset: f64| f64::from(k) + 0.5 + extent * offset;
        for (x, y, weight) in rule {
            visit(place(i, *x), place(j, *y), *weight);
        }
    }
}

/// First texel of tile `tile` along an edge of `side` texels, and the first behind it.
fn span(tile: u32, side: u32) -> (u32, u32) {
    (tile * TILE, ((tile + 1) * TILE).min(side))
}

/// Every other bit of `k`, three in all: columns, and from the next bit rows, in Morton's order, so that
/// packets stay compact where a texel has several directions.
pub(crate) const fn interleaved(k: u32) -> u32 {
    (k & 1) | ((k >> 1) & 2) | ((k >> 2) & 4)
}

/// Direction at (`x`, `y`), in texels, of image `image`, and the relative solid angle per unit area there.
pub(crate) fn at(layout: Layout, image: u32, x: f64, y: f64) -> (DVec3, f64) {
    match layout {
        Layout::Cube { size } => {
            let scale = 2.0 / f64::from(size);
            let (s, t) = (x * scale - 1.0, y * scale - 1.0);
            let squared = 1.0 + s * s + t * t;
            (direction_from_cube(Face::ALL[image as usize], s, t), 1.0 / (squared * squared.sqrt()))
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
pub(crate) fn edge(layout: Layout, i: u32, j: u32) -> f64 {
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
    /// Of each texel, its own of what each of the tile's directions has, and their weights.
    pub(crate) fn footprints<'a, T>(
        &'a self,
        of_directions: &'a [T],
    ) -> impl Iterator<Item = (&'a [T], &'a [f32])> {
        let mut first = 0;
        self.texels.iter().map(move |(_, count)| {
            let own = first..first + count;
            first += count;
            (&of_directions[own.clone()], &self.weights[own])
        })
    }

    /// Averages the answers of each texel's directions into `line`.
    pub fn resolve(&self, answers: &[Answer], line: &mut [Answer]) {
        for ((place, _), (own, weights)) in self.texels.iter().zip(self.footprints(answers)) {
            line[*place] = mean(own, weights);
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
    let bounds = samples.iter().filter_map(|sample| sample.bound).flat_map(Bound::values);
    let greatest = samples.iter().flat_map(|sample| sample.radiance).chain(bounds).fold(0.0, f32::max);
    if greatest > 0.0 && !(MIN_ORDINARY..GREATEST_ORDINARY).contains(&greatest) {
        return extreme_mean(samples, weights);
    }
    let mut mean = Answer { radiance: [0.0; 3], bound: samples[0].bound.map(|_| Bound::default()) };
    for (sample, weight) in samples.iter().zip(weights) {
        let share = weight / total;
        for (sum, value) in mean.radiance.iter_mut().zip(sample.radiance) {
            *sum += value * share;
        }
        mean.bound = mean.bound.zip(sample.bound).map(|(sum, bound)| sum + bound.map(|bound| bound * share));
    }
    mean
}

/// Between 2^-100 and 2^100, weighted samples are normal numbers and sums finite in single precision.
const MIN_ORDINARY: f32 = 1.0 / (1_u128 << 100) as f32;

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
    let [luminance, red, green, blue] = std::array::from_fn(|k| {
        // With a possible rounding of the radiance.
        let bound = mean(&|sample| sample.bound.unwrap_or_default().values()[k]);
        rounded_up(bound + f64::from(f32::from_bits(1)))
    });
    let bound = samples[0].bound.map(|_| Bound { channels: [red, green, blue], luminance });
    Answer { radiance, bound }
}

/// Order of the [`rule`] for a texel `share` lobes wide: 1 for its centre alone.
///
/// GGX, near its axis (1 + q x^2)^-2 with half maxima 1.287/sqrt(q) apart, is within 0.0022 of its peak from
/// its mean over squares of edges up to 0.4, 0.72, 1.04 and 1.36 lobes by the rules of order 2, 3, 4 and 5,
/// wherever the light is; it demands fewer nodes for each further lobe.
fn order(share: f64) -> u32 {
    let extent = extent(share);
    if extent < NEGLIGIBLE_EXTENT {
        return 1;
    }
    2 + ((extent * share - 0.4) / 0.32).ceil().clamp(0.0, 62.0) as u32
}

/// Places and weights of means over a square of edge 1 around 0, exact for polynomials of degree 2 `order` -
/// 1.
///
/// Products of Gauss's rules, but for orders 3 and 4 those of Radon (7 nodes; Stroud 1971, "Approximate
/// Calculation of Multiple Integrals", C2 5-1) and Tyler (12 nodes; C2 7-1), the fewest that there are.
fn rule(order: u32) -> Vec<(f64, f64, f64)> {
    let both = |x: f64| if x == 0.0 { vec![x] } else { vec![x, -x] };
    // A node, in half edges, and its mirror images.
    let mirrored = |(x, y, weight): (f64, f64, f64)| {
        let column = move |x: f64| both(y / 2.0).into_iter().map(move |y| (x, y, weight));
        both(x / 2.0).into_iter().flat_map(column)
    };
    match order {
        3 => [
            (0.0, 0.0, 2.0 / 7.0),
            (0.0, (14.0_f64 / 15.0).sqrt(), 5.0 / 63.0),
            (0.6_f64.sqrt(), (1.0_f64 / 3.0).sqrt(), 5.0 / 36.0),
        ]
        .into_iter()
        .flat_map(mirrored)
        .collect(),
        4 => {
            let root = 583.0_f64.sqrt();
            let axis = (6.0_f64 / 7.0).sqrt();
            let diagonal = |sign: f64| {
                let place = ((114.0 + sign * 3.0 * root) / 287.0).sqrt();
                (place, place, (178_981.0 - sign * 2769.0 * root) / 1_888_920.0)
            };
            [(axis, 0.0, 49.0 / 810.0), (0.0, axis, 49.0 / 810.0), diagonal(-1.0), diagonal(1.0)]
                .into_iter()
                .flat_map(mirrored)
                .collect()
        }
        _ => {
            let line = gauss_legendre(order);
            let row = |(y, weight_y): &(f64, f64)| {
                let at = |(x, weight): &(f64, f64)| (x - 0.5, y - 0.5, weight * weight_y);
                line.iter().map(at).collect::<Vec<_>>()
            };
            line.iter().flat_map(row).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// GGX around a point light at (`x`, `y`), in lobes: its mean over a square of edge `extent`.
    fn mean_of((x, y): (f64, f64), extent: f64, rule: &[(f64, f64, f64)]) -> f64 {
        let value = |dx: f64, dy: f64| (1.0 + 1.287_f64.powi(2) * (dx * dx + dy * dy)).powi(-2);
        rule.iter().map(|(dx, dy, weight)| weight * value(x - dx * extent, y - dy * extent)).sum()
    }

    #[test]
    fn footprints_are_means_over_their_texels() {
        // Gauss's rule of order 40 is exact here.
        let fine = rule(40);
        let off = |share: f64, order: u32| {
            let rule = rule(order);
            let extent = extent(share) * share;
            // Around the light and in the directions of edges, corners and between.
            let places = (0..40).flat_map(|k| {
                let apart = 0.1 * f64::from(k) * share.max(1.0);
                [(1.0, 0.0), (0.0, 1.0), (0.7, 0.7), (0.9, 0.4), (0.4, 0.9)]
                    .map(|(x, y)| (apart * x, apart * y))
            });
            places
                .map(|at| (mean_of(at, extent, &rule) - mean_of(at, extent, &fine)).abs())
                .fold(0.0, f64::max)
        };
        let shares = [0.35, 0.4, 0.45, 0.5, 0.6, 0.719, 0.75, 0.9, 1.039, 1.1, 1.35, 1.5, 2.0, 4.0, 8.0];
        for share in shares {
            let error = off(share, order(share));
            assert!(error < 0.0022, "{share} lobes by order {}: off by {error}", order(share));
        }
        assert!(off(0.75, 2) > 0.01, "too few directions are seen");
    }

    #[test]
    fn rules_are_exact_for_polynomials_of_their_degree() {
        let moment =
            |power: i32| if power % 2 == 0 { 0.5_f64.powi(power) / f64::from(power + 1) } else { 0.0 };
        for n in 1..8 {
            let rule = rule(n);
            for (i, j) in (0..2 * n as i32).flat_map(|i| (0..2 * n as i32 - i).map(move |j| (i, j))) {
                let found: f64 = rule.iter().map(|(x, y, weight)| weight * x.powi(i) * y.powi(j)).sum();
                assert!((found - moment(i) * moment(j)).abs() < 1e-14, "order {n}: x^{i} y^{j} is {found}");
            }
        }
    }
}
