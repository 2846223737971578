//! The weights of the levels in a lobe of GGX, fitted over roughness.
//!
//! A lobe of any roughness is a weighted sum of Gaussians, of the clamped cosine and of zonal harmonics. At
//! each node the weights solve a linear least-squares problem. A ridge keeps them small: without it, the
//! widest levels and the harmonics are nearly the same functions, and weights of 10 and more would multiply
//! the error of interpolation. At most [`READS`] levels are in use: when one more is needed, the finest goes.
//! In between the weights are those of the fits with a level and without it, mixed, so that none jumps.

use super::{Levels, MOST_MAPS, suns};
use crate::common::once::Known;
use crate::common::parallel;
use crate::lobe::{self, Lobe, legendre};
use std::f64::consts::PI;

/// Intervals of the table.
pub const INTERVALS: u32 = 860;

/// Weights at a node: the mirror, Gaussians from fine to coarse, as many as the largest map has, cosine,
/// harmonics of order 0 to 4; 1 over the integral of GGX, for suns; the rest of the last texel.
pub const WEIGHTS: usize = 20;

/// Place of the cosine's weight.
pub(crate) const COSINE: usize = MOST_MAPS;

/// Place of the weight of the harmonics of order 0.
pub const ORDERS: usize = COSINE + 1;

/// Place of 1 over the integral of GGX.
pub const LOBE: usize = ORDERS + 5;

/// Most levels with a weight at one roughness: the bilinear reads of a look-up.
pub const READS: usize = 5;

/// Nodes lie evenly in the logarithm of roughness, and evenly in roughness far below 1 over this.
pub(crate) const SPREAD: f64 = 30.0;

/// Standard deviation of a level over the alpha at which it comes into use, on squares and on cubes. GGX is a
/// mixture of Gaussians from half of alpha up.
const WIDE: [f64; 2] = [9.6, 12.0];

/// Alpha at which the cosine comes into use.
const COSINE_FROM: f64 = 0.12;

/// Alpha over the standard deviation of a level at which it has gone at the latest, slowly.
const NARROW: f64 = 5.0;

/// Octaves of alpha over which a level comes into use, over which the finest goes for it, and between those.
const ENTERS: f64 = 0.26;
const LEAVES: f64 = 0.15;
const APART: f64 = 0.02;

/// Octaves of alpha over which a level goes by itself.
const FADES: f64 = 1.4;

/// Roughness over which harmonics come into use.
const HARMONICS: [f64; 2] = [0.02, 0.15];

/// Ridge of what is in use, in units of the lobe's own norm; how fast it rises where harmonics come into use
/// and where a level goes by itself; and over which share of itself it counts as infinite.
const RIDGE: f64 = 5e-4;
const RISE: f64 = 5.0;
const NONE: f64 = 1e-8;

/// Weight of the error over the lobe's square, which counts around suns, against that over the lobe.
const PEAK: f64 = 3.0;

/// Radiance of a lobe far away, in units of the mean, below which errors there count as much as here.
const FLOOR: f64 = 0.015;

/// Weights of `levels` at [`INTERVALS`] + 1 nodes over roughness.
pub fn table(levels: Levels) -> Vec<[f32; WEIGHTS]> {
    parallel::map(0..=INTERVALS, |index| node(levels, index))
}

/// Those at one node, fitted at the first call.
fn node(levels: Levels, index: u32) -> [f32; WEIGHTS] {
    static FITTED: [Known<[f32; WEIGHTS]>; Levels::ALL] =
        [const { Known::new(INTERVALS as usize + 1) }; Levels::ALL];
    let fitted = || fitted(levels, roughness_of(f64::from(index)));
    *FITTED[levels.index()].get_or_init(index as usize, fitted)
}

/// Weights at `roughness` in [0, 1], between the two nodes of [`table`] around it.
pub fn weights_at(levels: Levels, roughness: f32) -> [f32; WEIGHTS] {
    let place =
        (1.0 + SPREAD as f32 * roughness).log2() * ((INTERVALS as f32) / (1.0 + SPREAD as f32).log2());
    let index = (place as u32).min(INTERVALS - 1);
    let share = place - index as f32;
    let [low, high] = [index, index + 1].map(|index| node(levels, index));
    std::array::from_fn(|k| low[k] + share * (high[k] - low[k]))
}

/// Roughness of a place in the table, a node where it is integral.
pub fn roughness_of(place: f64) -> f64 {
    (((1.0 + SPREAD).ln() * place / f64::from(INTERVALS)).exp() - 1.0) / SPREAD
}

/// 0 below 0, 1 above 1, smooth between.
pub(super) fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A normalised Gaussian lobe of standard deviation `width` at 1 - cos(theta) = `c`.
pub fn gaussian(width: f64, c: f64) -> f64 {
    let square = width * width;
    (-c / square).exp() / (2.0 * PI * square * (1.0 - (-2.0 / square).exp()))
}

/// What the weights multiply, at 1 - cos(theta) = `c`.
pub fn functions(levels: Levels, c: f64) -> [f64; WEIGHTS] {
    let mut values = [0.0; WEIGHTS];
    for (value, map) in values.iter_mut().zip(0..levels.count()) {
        *value = gaussian(levels.width(map), c);
    }
    values[COSINE] = (1.0 - c).max(0.0) / PI;
    for ((value, legendre), order) in values[ORDERS..LOBE].iter_mut().zip(legendre(1.0 - c)).zip(0..) {
        *value = f64::from(2 * order + 1) / (4.0 * PI) * legendre;
    }
    values
}

/// Which levels and the cosine are in use at `alpha`: 1 where one is, 0 where it is not. At most one of
/// [`READS`] + 1 in turn is partly so.
fn in_use(levels: Levels, alpha: f64) -> [f64; COSINE + 1] {
    let wide = WIDE[usize::from(levels.is_cube())];
    let from: Vec<(usize, f64)> = (0..levels.count())
        .map(|map| (map as usize, if map == 0 { 0.0 } else { levels.width(map) / wide }))
        .chain([(COSINE, COSINE_FROM)])
        .collect();
    let mut shares = [0.0; COSINE + 1];
    for (k, (place, own)) in from.iter().enumerate() {
        let next = from.get(k + READS).map_or(f64::INFINITY, |(_, next)| *next);
        let entered = if *own == 0.0 { 1.0 } else { smooth((alpha / own).log2() / ENTERS) };
        shares[*place] = entered * smooth(((next / alpha).log2() - APART) / LEAVES);
    }
    shares
}

/// The ridge of each function.
fn ridges(levels: Levels, roughness: f64) -> [f64; LOBE] {
    let share = |t: f64| {
        let share = (-RISE * (1.0 - t.min(1.0)) / t.max(0.0)).exp();
        if share > NONE { share } else { 0.0 }
    };
    let mut shares = [1.0; LOBE];
    for (map, own) in (0..levels.count()).zip(&mut shares) {
        *own = share((NARROW * levels.width(map) / roughness.powi(2)).log2() / FADES);
    }
    let [from, to] = HARMONICS;
    shares[ORDERS..].fill(share((roughness - from) / (to - from)));
    shares.map(|share| RIDGE / share)
}

/// The weights that fit GGX at `roughness`, as they are at a node.
pub fn fitted(levels: Levels, roughness: f64) -> [f32; WEIGHTS] {
    // Sharper lobes than the mirror's are served by the mirror.
    let alpha = (roughness.powi(8) + (0.5 * levels.width(0)).powi(4)).powf(0.25);
    let points = lobe_points(alpha, levels.width(0));
    let square: f64 = points.iter().map(|point| point.area * point.lobe * point.lobe).sum();
    // Products of functions, and with the lobe.
    let mut products = [[0.0; LOBE + 1]; LOBE];
    for point in &points {
        let weight = point.area * (1.0 / (FLOOR / (4.0 * PI) + point.lobe) + PEAK / square);
        let mut values = functions(levels, point.c);
        values[LOBE] = point.lobe;
        for (row, own) in products.iter_mut().zip(values) {
            for (product, value) in row.iter_mut().zip(values) {
                *product += weight * own * value;
            }
        }
    }
    let ridges = ridges(levels, roughness);
    for (k, (row, ridge)) in products.iter_mut().zip(ridges).enumerate() {
        row[k] += ridge;
    }
    // Sets of functions in use, and their shares.
    let harmonics = (ORDERS..LOBE).filter(|k| ridges[*k].is_finite()).collect();
    let mut sets: Vec<(f64, Vec<usize>)> = vec![(1.0, harmonics)];
    for (k, share) in in_use(levels, roughness * roughness).into_iter().enumerate() {
        if share > 0.0 && ridges[k].is_finite() {
            let with = |(all, set): &(f64, Vec<usize>)| (all * share, [&[k], &set[..]].concat());
            let without = |(all, set): &(f64, Vec<usize>)| (all * (1.0 - share), set.clone());
            let both = sets.iter().flat_map(|set| [with(set), without(set)]);
            sets = both.filter(|(share, _)| *share > 0.0).collect();
        }
    }
    let mut weights = [0.0; WEIGHTS];
    for (share, set) in sets {
        let product = |j: usize, k: usize| products[set[j]][set[k]];
        let fitted = held_at(1.0, set.len(), product, |j| products[set[j]][LOBE], |j| set[j] <= ORDERS);
        for (k, weight) in set.iter().zip(fitted) {
            weights[*k] += (share * weight) as f32;
        }
    }
    weights[LOBE] = suns::lobe_share(levels, roughness) as f32;
    weights
}

/// The weights that solve normal equations of `count` functions, whose products are `product(j, k)` and with
/// what they fit `right(j)`: of those that have an integral it is held at `total` by a multiplier.
pub(super) fn held_at(
    total: f64,
    count: usize,
    product: impl Fn(usize, usize) -> f64,
    right: impl Fn(usize) -> f64,
    has_integral: impl Fn(usize) -> bool,
) -> Vec<f64> {
    let mut system = vec![vec![0.0; count + 2]; count + 1];
    for j in 0..count {
        for k in 0..count {
            system[j][k] = product(j, k);
        }
        let integral = f64::from(u8::from(has_integral(j)));
        system[j][count] = integral;
        system[count][j] = integral;
        system[j][count + 1] = right(j);
    }
    system[count][count + 1] = total;
    solved(system)
}

/// A ring of the sphere around a lobe.
struct LobePoint {
    /// 1 - cos(theta).
    c: f64,
    /// Solid angle.
    area: f64,
    /// The normalised lobe.
    lobe: f64,
}

/// Rings around a lobe of `alpha`, their widths proportional to their angle, down to the scale of `finest`.
fn lobe_points(alpha: f64, finest: f64) -> Vec<LobePoint> {
    const COUNT: u32 = 200;
    let least = 0.02 * alpha.max(finest);
    let step = (PI / least).ln() / f64::from(COUNT);
    let edge = |k: u32| 2.0 * (least * (f64::from(k) * step).exp() / 2.0).min(PI / 2.0).sin().powi(2);
    let kernel = |c: f64| lobe::kernel(Lobe::Ggx, alpha, c / 2.0);
    let mut points: Vec<_> = std::iter::once([0.0, edge(0)])
        .chain((0..COUNT).map(|k| [edge(k), edge(k + 1)]))
        .map(|[from, to]| {
            let c = f64::midpoint(from, to);
            LobePoint { c, area: 2.0 * PI * (to - from), lobe: kernel(c) }
        })
        .collect();
    let integral: f64 = points.iter().map(|point| point.area * point.lobe).sum();
    points.iter_mut().for_each(|point| point.lobe /= integral.max(f64::MIN_POSITIVE));
    points
}

/// The solution of linear equations, the right sides in the last column, by elimination with pivots.
pub(super) fn solved(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let count = rows.len();
    for k in 0..count {
        let pivot = (k..count).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs()));
        rows.swap(k, pivot.expect("rows from k on"));
        let own = rows[k].clone();
        for (other, row) in rows.iter_mut().enumerate() {
            if other != k {
                let factor = row[k] / own[k];
                row.iter_mut().zip(&own).for_each(|(value, own)| *value -= factor * own);
            }
        }
    }
    rows.iter().enumerate().map(|(k, row)| row[count] / row[k]).collect()
}
