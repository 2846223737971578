//! The reads of a reflection: where, at which level, and their weights, over roughness and n.v.
//!
//! As slopes of the half vector over alpha, GGX is round and the same for every view; a Gaussian of light is
//! as long across the plane of incidence as 1 / n.v. So reads stand in that plane, at places and of widths
//! that were found by descent ([`super::places`]). Levels are fractional (a trilinear read), so that places
//! and levels vary smoothly, and only weights are solved for: for 1 and for (1 - v.h)^5, with 15 harmonics
//! that are symmetric about the plane, and where lobes are wide the clamped cosine in place of the last read.

use super::Levels;
use super::brdf::Brdf;
use super::fit::{gaussian, held_at, smooth};
use super::places::{READS, places};
use crate::common::frame::LEAST_COSINE;
use crate::common::once::Once;
use crate::common::parallel;
use crate::lobe::{legendre, reflectance};
use glam::{DVec2, DVec3};
use half::f16;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Directions in the plane of incidence around which harmonics are zonal, as angles from the normal towards
/// the viewer. Those of order l stand around the first l + 1.
pub const AROUND: [f64; 5] = [0.0, 0.4 * PI, 0.8 * PI, 0.2 * PI, 0.6 * PI];

/// Harmonics: pairs of a direction and an order of at least its place.
pub const HARMONICS: usize = 15;

/// Texels of a node: the reads' slope, level and two weights; two weights of every harmonic, and of the
/// cosine.
pub const LAYERS: usize = 18;

const _: () = assert!(LAYERS == READS + (HARMONICS + 1).div_ceil(2), "pairs of harmonics");

/// A node of the table. First weights are for f0, second for f90.
pub type Node = [[f32; 4]; LAYERS];

/// Nodes over roughness, evenly in log(1 + 10 r), and over n.v, evenly in the fourth root of 1 less the sine
/// of the view's angle: dense at grazing views, and even in that angle around the normal.
pub const NODES: [usize; 2] = [46, 26];

/// Functions of the fit: reads, cosine, harmonics.
const FUNCTIONS: usize = READS + 1 + HARMONICS;

/// Ridge of reads, and of harmonics; roughness over which those come into use.
pub(super) const RIDGE: [f64; 2] = [1e-3, 5e-3];
pub(super) const HARMONICS_FROM: [f64; 2] = [0.02, 0.15];

/// Roughness over which the last read fades out, and the cosine in.
const LAST_READ: [f64; 2] = [0.42, 0.36];
const COSINE: [f64; 2] = [0.45, 0.51];

/// Use of a function that has faded out: its weights are 0 as half floats.
const LEAST_USE: f64 = 1e-9;

/// Roughness from which on look-ups read the cosine level in place of the last read: between two nodes that
/// have neither.
pub const COSINE_FROM: f32 = 0.435;

/// What errors of a fit count, beside [`PEAK`].
#[derive(Clone, Copy, Debug)]
struct Counts {
    /// Over the lobe, as errors show in the dark.
    dark: f64,
    /// Integrals over cells of the sphere.
    coherent: f64,
}

/// What counts for weights. Radiance is alike over degrees: between directions .03 apart six of nine
/// panoramas keep half of their variance, and more. So what cancels within a cell hardly shows, and what does
/// not shows at once.
const FOR_WEIGHTS: Counts = Counts { dark: 0.1, coherent: 12.0 };

/// What counts for places: those that were found by cells, too, were up to twice as far off.
const FOR_PLACES: Counts = Counts { dark: 1.0, coherent: 0.0 };

/// Weight of the error over the lobe's square, which counts around lights.
const PEAK: f64 = 3.0;

/// Edges of the cells, in units of the sphere's radius.
const CELLS: [f64; 2] = [0.08, 0.32];

/// The radiance of a lobe far away, in units of the mean, below which errors there count as much as here.
const FLOOR: f64 = 1.0;

/// Exponent from which on a Gaussian is dark: 1e-13 of its peak.
const DARK: f64 = 30.0;

/// Rings and spokes of half vectors.
const FIT_GRID: [u32; 2] = [40, 16];

/// The map of `width`: 0 the mirror, then Gaussians from fine to coarse; whole numbers are maps, between them
/// the logarithm counts.
pub(super) fn level_of(levels: Levels, width: f64) -> f64 {
    let (mirror, sharp) = (levels.width(0), levels.width(1));
    let finer = (width / mirror).ln() / (sharp / mirror).ln();
    if finer < 1.0 {
        return finer.max(0.0);
    }
    (1.0 + (width / sharp).log2() / levels.octaves()).min(f64::from(levels.count() - 1))
}

/// The nodes over `levels`, fitted at the first call: those of the least roughness first.
pub fn table(levels: Levels) -> &'static [Node] {
    static FITTED: [Once<Vec<Node>>; Levels::ALL] = [const { Once::new() }; Levels::ALL];
    FITTED[levels.index()].get_or_make(|| {
        let [across, _] = NODES;
        let nodes = 0..across * NODES[1];
        parallel::map(nodes, |k| fitted(levels, roughness_of(k % across), cosine_of(k / across)))
    })
}

/// Roughness of a node.
fn roughness_of(node: usize) -> f64 {
    ((11_f64.ln() * node as f64 / (NODES[0] - 1) as f64).exp() - 1.0) / 10.0
}

/// n.v at which the last node is fitted: along the normal itself all reads have one direction, and weights
/// that part for a little gain there are not near those of the views beside it.
const ALONG_NORMAL: f64 = 0.999;

/// n.v of a node.
fn cosine_of(node: usize) -> f64 {
    let sine = 1.0 - (node as f64 / (NODES[1] - 1) as f64).powi(4);
    (1.0 - sine * sine).sqrt().clamp(LEAST_COSINE, ALONG_NORMAL)
}

/// The place of n.v between the first node and the last.
fn view_place(cosine: f32) -> f32 {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    // 1 less the sine without cancellation.
    (cosine / (1.0 + sine).sqrt()).sqrt()
}

/// The node at `roughness` in [0, 1] and n.v of `cosine`, between those of [`table`].
pub fn node_at(levels: Levels, roughness: f32, cosine: f32) -> Node {
    let table = table(levels);
    let places = [(1.0 + 10.0 * roughness).log2() / 11_f32.log2(), view_place(cosine)];
    let [(x, right), (y, up)] = [0, 1].map(|axis| {
        let place = places[axis] * (NODES[axis] - 1) as f32;
        let node = (place as usize).min(NODES[axis] - 2);
        (node, place - node as f32)
    });
    let mix = |a: f32, b: f32, share: f32| a + share * (b - a);
    std::array::from_fn(|layer| {
        std::array::from_fn(|c| {
            let row = |y: usize| {
                let first = y * NODES[0] + x;
                mix(table[first][layer][c], table[first + 1][layer][c], right)
            };
            mix(row(y), row(y + 1), up)
        })
    })
}

/// A piece of the sphere of lights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) light: DVec3,
    pub(super) area: f64,
    /// The reflection, without and with the factor of f90.
    pub(super) lobe: [f64; 2],
}

/// Pieces of one half of the sphere, dense around the lobe, which is symmetric about the plane of incidence:
/// rings and spokes of half vectors. Areas are those of both halves.
fn points(alpha: f64, view: DVec3, brdf: &Brdf) -> impl Iterator<Item = Point> {
    half_vectors(alpha, FIT_GRID, PI).filter_map(move |(half, area)| Point::new(half, 2.0 * area, view, brdf))
}

/// Half vectors and their areas: rings, and spokes over an angle of `around`, dense at the scale of `alpha`.
pub(super) fn half_vectors(
    alpha: f64,
    [rings, spokes]: [u32; 2],
    around: f64,
) -> impl Iterator<Item = (DVec3, f64)> {
    let scale = 0.5 * alpha;
    let step = (PI / scale).asinh() / f64::from(rings);
    let edge = move |ring: u32| (scale * (step * f64::from(ring)).sinh()).min(PI);
    let spoke = |spoke: u32| DVec2::from_angle(around * (f64::from(spoke) + 0.5) / f64::from(spokes));
    let directions: Vec<DVec2> = (0..spokes).map(spoke).collect();
    (0..rings).flat_map(move |ring| {
        let (from, to) = (edge(ring), edge(ring + 1));
        let (sine, cosine) = f64::midpoint(from, to).sin_cos();
        let area = (from.cos() - to.cos()) * around / f64::from(spokes);
        directions.clone().into_iter().map(move |d| ((sine * d).extend(cosine), area))
    })
}

impl Point {
    /// The piece of lights whose half vectors are a piece of `area` around `half`.
    pub(super) fn new(half: DVec3, area: f64, view: DVec3, brdf: &Brdf) -> Option<Self> {
        let towards = view.dot(half);
        (towards > 0.0).then(|| {
            let light = half * (2.0 * towards) - view;
            let (value, fresnel) = brdf.at(light);
            Self { light, area: 4.0 * towards * area, lobe: [value, value * fresnel] }
        })
    }

    /// Its cells, one of each size.
    fn cells(&self) -> [(usize, [i64; 3]); CELLS.len()] {
        let place = |edge: f64| (self.light / edge).floor().to_array().map(|place| place as i64);
        std::array::from_fn(|size| (size, place(CELLS[size])))
    }
}

/// A lobe in pieces of the sphere, and what errors of a fit to it count.
#[derive(Clone, Debug)]
pub(super) struct Lobe {
    pieces: Vec<(Point, [usize; CELLS.len()])>,
    /// Cells of all sizes.
    cells: usize,
    /// Its integral, and that of its square.
    pub(super) mean: f64,
    square: f64,
    counts: Counts,
}

impl Lobe {
    pub(super) fn new(points: impl Iterator<Item = Point>) -> Self {
        let mut numbers = BTreeMap::new();
        let mut number = |cell| {
            let next = numbers.len();
            *numbers.entry(cell).or_insert(next)
        };
        let pieces: Vec<_> = points.map(|point| (point, point.cells().map(&mut number))).collect();
        let integral = |power| pieces.iter().map(|(point, _)| point.area * point.lobe[0].powi(power)).sum();
        Self { mean: integral(1), square: integral(2), cells: numbers.len(), pieces, counts: FOR_WEIGHTS }
    }

    /// The same, with what counts for places.
    pub(super) fn for_places(self) -> Self {
        Self { counts: FOR_PLACES, ..self }
    }

    /// Calls `count` for everything whose square counts, with how much it does: `at` gives the `width`
    /// numbers of a piece; those of a cell are their integrals over it.
    pub(super) fn each(
        &self,
        width: usize,
        at: impl Fn(&Point, &mut [f64]),
        mut count: impl FnMut(f64, &[f64]),
    ) {
        let counts = self.counts;
        let mut cells = vec![0.0; self.cells * width];
        let mut values = vec![0.0; width];
        for (point, own) in &self.pieces {
            at(point, &mut values);
            for cell in own {
                let sums = &mut cells[cell * width..(cell + 1) * width];
                sums.iter_mut().zip(&values).for_each(|(sum, value)| *sum += point.area * value);
            }
            let dark = counts.dark / (FLOOR / (4.0 * PI) + point.lobe[0] / self.mean);
            count(point.area * (dark + PEAK * self.mean * self.mean / self.square), &values);
        }
        cells.chunks_exact(width).for_each(|values| count(counts.coherent, values));
    }
}

/// A trilinear read of the levels: two Gaussians around a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Read {
    direction: DVec3,
    /// Inverse square width and share over the integral of each.
    gaussians: [[f64; 2]; 2],
}

impl Read {
    pub(super) fn new(levels: Levels, direction: DVec3, level: f64) -> Self {
        let (whole, share) = (level.floor() as u32, level.fract());
        let of = |level: u32, share: f64| {
            if share == 0.0 {
                return [1.0, 0.0];
            }
            let width = levels.width(level);
            [width.powi(-2), share * gaussian(width, 0.0)]
        };
        Self { direction, gaussians: [of(whole, 1.0 - share), of(whole + 1, share)] }
    }

    /// What it makes of light from `light`.
    pub(super) fn at(&self, light: DVec3) -> f64 {
        let c = 1.0 - self.direction.dot(light);
        let of = |[sharp, share]: [f64; 2]| if c * sharp < DARK { share * (-c * sharp).exp() } else { 0.0 };
        of(self.gaussians[0]) + of(self.gaussians[1])
    }
}

/// The clamped cosine, and harmonics around each direction of `around`, of orders from its place up.
pub(super) fn wide_functions(values: &mut [f64], around: &[DVec3; 5], light: DVec3) {
    values[0] = light.z.max(0.0) / PI;
    let zonal = around
        .iter()
        .enumerate()
        .flat_map(|(k, direction)| legendre(direction.dot(light)).into_iter().zip(0..).skip(k));
    for (value, (zonal, order)) in values[1..].iter_mut().zip(zonal) {
        *value = f64::from(2 * order + 1) / (4.0 * PI) * zonal;
    }
}

/// The weights for f0 and f90 of the first `used` functions that fit `lobe`, under their `ridge`. Its
/// integral is held at `albedo`, scale and bias of f0. `functions` are `reads` of integral 1, a cosine and
/// harmonics.
pub(super) fn weights<const N: usize>(
    lobe: &Lobe,
    reads: usize,
    used: usize,
    ridge: &[f64; N],
    albedo: [f64; 2],
    functions: impl Fn(DVec3) -> [f64; N],
) -> Vec<[f32; 2]> {
    let mean = lobe.mean;
    // The normal equations, and a multiplier that holds the lobe's integral at the albedo.
    let mut products = [[0.0; N]; N];
    let mut right = vec![[0.0; 2]; used];
    let at = |point: &Point, values: &mut [f64]| {
        values[..N].copy_from_slice(&functions(point.light));
        values[N..].copy_from_slice(&point.lobe.map(|value| value / mean));
    };
    lobe.each(N + 2, at, |weight, values| {
        let (values, lobe) = values.split_at(N);
        for j in 0..used {
            let own = weight * values[j];
            for (product, value) in products[j][..=j].iter_mut().zip(values) {
                *product += own * value;
            }
            for (sum, lobe) in right[j].iter_mut().zip(lobe) {
                *sum += own * lobe;
            }
        }
    });
    let product = |j: usize, k: usize| products[j.max(k)][j.min(k)] + if j == k { ridge[j] } else { 0.0 };
    // Harmonics of order 0 have an integral, the others none.
    let has_integral = |j: usize| j <= reads + 1;
    let [scale, bias] = albedo;
    let [all, grazing] = [(0, scale + bias), (1, bias)]
        .map(|(side, total)| held_at(total / mean, used, product, |j| right[j][side], has_integral));
    let pair = |k: usize| [(all[k] - grazing[k]) * mean, grazing[k] * mean].map(|weight| weight as f32);
    (0..used).map(pair).collect()
}

/// A reflection that is fitted.
#[derive(Clone, Debug)]
pub struct Fit {
    levels: Levels,
    alpha: f64,
    view: DVec3,
    pub(super) lobe: Lobe,
    /// Scale and bias of f0.
    albedo: [f64; 2],
    /// Functions in use, and the ridge of each.
    used: usize,
    pub(super) ridge: [f64; FUNCTIONS],
}

impl Fit {
    /// The reflection at `roughness` and n.v of `cosine`.
    pub fn new(levels: Levels, roughness: f64, cosine: f64) -> Self {
        let view = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        // Sharper lobes than the mirror's are served by the mirror.
        let served = (roughness.powi(8) + (0.5 * levels.width(0)).powi(4)).powf(0.125);
        let faded = |[from, to]: [f64; 2]| smooth((roughness - from) / (to - from));
        let use_harmonics = faded(HARMONICS_FROM);
        // Lobes narrower than the mirror's texels are served by equal reads of it.
        let narrow = levels.width(0) / (2.0 * cosine * roughness.max(1e-3).powi(2));
        let mut ridge = [RIDGE[1] / use_harmonics; FUNCTIONS];
        ridge[..READS].fill(RIDGE[0] * (1.0 + narrow.powi(4)));
        ridge[READS - 1] /= faded(LAST_READ).max(LEAST_USE);
        ridge[READS] = RIDGE[1] / faded(COSINE).max(LEAST_USE);
        Self {
            levels,
            alpha: roughness * roughness,
            view,
            lobe: Lobe::new(points(served * served, view, &Brdf::new(view, served, 0.0))),
            albedo: reflectance::ggx_albedo(cosine, roughness),
            used: if use_harmonics > 0.0 { FUNCTIONS } else { READS },
            ridge,
        }
    }

    /// The same, with what counts for places.
    pub fn for_places(self) -> Self {
        Self { lobe: self.lobe.for_places(), ..self }
    }

    /// A read at the slope and of the width of `place`, both over alpha; its slope and level.
    pub(super) fn read(&self, [slope, width]: [f64; 2]) -> (Read, [f64; 2]) {
        let slope = slope * self.alpha;
        let half = (DVec3::Z + slope * self.view.with_z(0.0)).normalize();
        let level = level_of(self.levels, width * self.alpha);
        let direction = half * (2.0 * self.view.dot(half)) - self.view;
        (Read::new(self.levels, direction, level), [slope, level])
    }

    /// What the weights multiply, of light from the unit vector `light`: reads, the clamped cosine,
    /// harmonics.
    pub(super) fn functions(reads: &[Read; READS], light: DVec3) -> [f64; FUNCTIONS] {
        let around = AROUND.map(|angle| DVec3::new(angle.sin(), 0.0, angle.cos()));
        let mut values = [0.0; FUNCTIONS];
        for (value, read) in values.iter_mut().zip(reads) {
            *value = read.at(light);
        }
        wide_functions(&mut values[READS..], &around, light);
        values
    }

    /// The weights for f0 and f90 with these `reads`.
    pub(super) fn weights(&self, reads: &[Read; READS]) -> Vec<[f32; 2]> {
        let functions = |light| Self::functions(reads, light);
        weights(&self.lobe, READS, self.used, &self.ridge, self.albedo, functions)
    }
}

/// The node that fits the reflection at `roughness` and n.v of `cosine`.
pub fn fitted(levels: Levels, roughness: f64, cosine: f64) -> Node {
    let fit = Fit::new(levels, roughness, cosine);
    let mut node = [[0.0; 4]; LAYERS];
    let reads = places(roughness, cosine).map(|place| fit.read(place));
    for (layer, (_, [slope, level])) in node.iter_mut().zip(&reads) {
        *layer = [*slope as f32, *level as f32, 0.0, 0.0];
    }
    for (k, pair) in fit.weights(&reads.map(|(read, _)| read)).into_iter().enumerate() {
        let (layer, at) = match k {
            _ if k < READS => (k, 2),
            READS => (LAYERS - 1, 2),
            _ => (READS + (k - READS - 1) / 2, 2 * ((k - READS - 1) % 2)),
        };
        node[layer][at..at + 2].copy_from_slice(&pair);
    }
    node.map(|texel| texel.map(|value| f16::from_f32(value).to_f32()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::reflectance::ALBEDO_NODES;
    use crate::sphere::quadrature::gauss_legendre;

    #[test]
    fn more_nodes_do_not_change_the_albedo() {
        let [few, many] = [ALBEDO_NODES, 2 * ALBEDO_NODES].map(gauss_legendre);
        for (x, y) in (0..NODES[0]).flat_map(|x| (0..NODES[1]).map(move |y| (x, y))) {
            let (roughness, cosine) = (roughness_of(x), cosine_of(y));
            let [found, expected] = [&few, &many].map(|rule| reflectance::ggx(cosine, roughness, rule));
            let off = (0..2).map(|k| (found[k] - expected[k]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-4, "roughness {roughness}, n.v {cosine}: off by {off}");
        }
    }
}
