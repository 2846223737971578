//! The weights of the levels in a lobe of GGX, fitted over roughness.
//!
//! A lobe of any roughness is a weighted sum of Gaussians, of the clamped cosine and of zonal harmonics. At
//! each node the weights solve a linear least-squares problem. A ridge keeps them small: without it, the
//! widest levels and the harmonics are nearly the same functions, and weights of 10 and more would multiply
//! the error of interpolation. It rises smoothly to infinity where a level comes into use and where it goes,
//! so that no weight jumps: at most [`READS`] are in use, and when one more is needed, the finest goes.

use super::{Octaves, WIDEST, suns};
use crate::common::parallel;
use crate::lobe::{self, Lobe, legendre};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Intervals of the table.
pub const INTERVALS: u32 = 860;

/// Weights at a node: mirror, sharp level, seven levels from fine to coarse, two middle levels, cosine,
/// harmonics of order 0 to 4; 1 over the integral of GGX, for suns; the rest of the last texel.
pub const WEIGHTS: usize = 20;

/// Place of the weight of the finer middle level.
pub(super) const MIDDLE: usize = 9;

/// Place of the cosine's weight.
pub(crate) const COSINE: usize = 11;

/// Place of the weight of the harmonics of order 0.
pub const ORDERS: usize = 12;

/// Place of 1 over the integral of GGX.
pub const LOBE: usize = 17;

/// Most levels with a weight at one roughness: the bilinear reads of a look-up.
pub const READS: usize = 5;

/// Nodes lie evenly in the logarithm of roughness, and evenly in roughness far below 1 over this.
pub(crate) const SPREAD: f64 = 30.0;

/// Standard deviation of a level over the alpha at which it comes into use. GGX is a mixture of Gaussians
/// from half of alpha up.
const WIDE: f64 = 12.3;

/// Alpha over the standard deviation of a level at which it has gone at the latest, slowly.
const NARROW: f64 = 5.0;

/// Alphas at which the widest level comes into use, the middle levels, from the coarser on, and the cosine,
/// without middle levels and with them: where the fit is best without the level that goes.
const WIDEST_FROM: f64 = 0.0321;
const MIDDLES_FROM: [f64; 2] = [0.113, 0.072];
const COSINE_FROM: [f64; 2] = [0.088, 0.17];

/// Octaves of alpha over which a level comes into use, or goes: below [`LONG`], and above.
const FADES: [f64; 2] = [1.4, 0.5];
const LONG: f64 = 0.006;

/// Roughness over which harmonics come into use.
const HARMONICS: [f64; 2] = [0.02, 0.15];

/// Ridge of what is in use, in units of the lobe's own norm; how fast it rises where that comes into use; and
/// over which share of itself it counts as infinite.
const RIDGE: f64 = 5e-4;
const RISE: f64 = 5.0;
const NONE: f64 = 1e-8;

/// Weight of the error over the lobe's square, which counts around suns, against that over the lobe.
const PEAK: f64 = 3.0;

/// Radiance of a lobe far away, in units of the mean, below which errors there count as much as here.
const FLOOR: f64 = 0.015;

/// Weights of the levels of `octaves` at [`INTERVALS`] + 1 nodes over roughness.
pub fn table(octaves: Octaves) -> Vec<[f32; WEIGHTS]> {
    parallel::map(0..=INTERVALS, |index| node(octaves, index))
}

/// Those at one node, fitted at the first call.
fn node(octaves: Octaves, index: u32) -> [f32; WEIGHTS] {
    type Nodes = [OnceLock<[f32; WEIGHTS]>; INTERVALS as usize + 1];
    // With middle levels, and without.
    static FITTED: [[Nodes; 2]; Octaves::MOST as usize] =
        [const { [const { [const { OnceLock::new() }; INTERVALS as usize + 1] }; 2] };
            Octaves::MOST as usize];
    let fitted = || fitted(octaves, roughness_of(f64::from(index)));
    let of_size = &FITTED[octaves.count() as usize - 1];
    *of_size[usize::from(octaves.middles() == 0)][index as usize].get_or_init(fitted)
}

/// Weights at `roughness` in [0, 1], between the two nodes of [`table`] around it.
pub fn weights_at(octaves: Octaves, roughness: f32) -> [f32; WEIGHTS] {
    let place =
        (1.0 + SPREAD as f32 * roughness).log2() * ((INTERVALS as f32) / (1.0 + SPREAD as f32).log2());
    let index = (place as u32).min(INTERVALS - 1);
    let share = place - index as f32;
    let [low, high] = [index, index + 1].map(|index| node(octaves, index));
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

/// Places of the weights of Gaussians, and their standard deviations.
fn gaussians(octaves: Octaves) -> impl Iterator<Item = (usize, f64)> {
    let levels = (0..octaves.count()).map(move |level| octaves.width(level));
    let middles = (0..octaves.middles()).map(move |middle| octaves.middle_width(middle));
    let sharp = [octaves.mirror_width(), octaves.sharp_width()];
    (0..).zip(sharp.into_iter().chain(levels)).chain((MIDDLE..).zip(middles))
}

/// What the weights multiply, at 1 - cos(theta) = `c`.
pub fn functions(octaves: Octaves, c: f64) -> [f64; WEIGHTS] {
    let mut values = [0.0; WEIGHTS];
    for (place, width) in gaussians(octaves) {
        values[place] = gaussian(width, c);
    }
    values[COSINE] = (1.0 - c).max(0.0) / PI;
    for ((value, legendre), order) in values[ORDERS..LOBE].iter_mut().zip(legendre(1.0 - c)).zip(0..) {
        *value = f64::from(2 * order + 1) / (4.0 * PI) * legendre;
    }
    values
}

/// The alphas between which each level is in use, by place: the mirror from the start.
fn ranges(octaves: Octaves) -> [[f64; 2]; WEIGHTS] {
    let middles = octaves.middles() as usize;
    let mut entries: Vec<(f64, f64, usize)> = gaussians(octaves)
        .map(|(place, width)| {
            let from = match place {
                0 => 0.0,
                MIDDLE.. => MIDDLES_FROM[middles - 1 - (place - MIDDLE)],
                _ if width == WIDEST => WIDEST_FROM,
                _ => width / WIDE,
            };
            (from, width, place)
        })
        .collect();
    entries.push((COSINE_FROM[usize::from(middles > 0)], f64::INFINITY, COSINE));
    entries.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut ranges = [[f64::INFINITY; 2]; WEIGHTS];
    let mut in_use: Vec<(f64, usize)> = Vec::new();
    for (from, width, place) in entries {
        if in_use.len() == READS {
            in_use.sort_by(|a, b| b.0.total_cmp(&a.0));
            let (_, finest) = in_use.pop().expect("levels in use");
            ranges[finest][1] = from;
        }
        in_use.push((width, place));
        ranges[place][0] = from;
    }
    ranges
}

/// Over the ridge, the ridge of what is in use: 1 where a function is, 0 where it is not.
fn shares(octaves: Octaves, roughness: f64) -> [f64; WEIGHTS] {
    let share = |t: f64| {
        let share = (-RISE * (1.0 - t.min(1.0)) / t.max(0.0)).exp();
        if share > NONE { share } else { 0.0 }
    };
    let alpha = roughness * roughness;
    let over = |octaves: f64, at: f64| share(octaves / FADES[usize::from(at > LONG)]);
    let mut shares = ranges(octaves).map(|[from, to]| {
        let entered = if from == 0.0 { 1.0 } else { over((alpha / from).log2(), from) };
        entered * over((to / alpha).log2(), to)
    });
    for (place, width) in gaussians(octaves) {
        shares[place] *= share((NARROW * width / alpha).log2() / FADES[0]);
    }
    let [from, to] = HARMONICS;
    shares[ORDERS..LOBE].fill(share((roughness - from) / (to - from)));
    shares
}

/// The weights that fit GGX at `roughness`, as they are at a node.
pub fn fitted(octaves: Octaves, roughness: f64) -> [f32; WEIGHTS] {
    let mut weights = [0.0; WEIGHTS];
    weights[LOBE] = suns::lobe_share(octaves, roughness) as f32;
    let shares = shares(octaves, roughness);
    let used: Vec<usize> = (0..WEIGHTS).filter(|k| shares[*k] > 0.0).collect();
    if let [only] = used[..] {
        weights[only] = 1.0;
        return weights;
    }
    let count = used.len();
    // The normal equations, and a multiplier that holds the lobe's integral at 1.
    let mut system = vec![vec![0.0; count + 2]; count + 1];
    // Sharper lobes than the mirror's are served by the mirror.
    let alpha = (roughness.powi(8) + (0.5 * octaves.mirror_width()).powi(4)).powf(0.25);
    let points = lobe_points(alpha, octaves.mirror_width());
    let square: f64 = points.iter().map(|point| point.area * point.lobe * point.lobe).sum();
    for point in &points {
        let weight = point.area * (1.0 / (FLOOR / (4.0 * PI) + point.lobe) + PEAK / square);
        let values = functions(octaves, point.c);
        for (row, k) in system.iter_mut().zip(&used) {
            for (place, other) in row.iter_mut().zip(&used) {
                *place += weight * values[*k] * values[*other];
            }
            row[count + 1] += weight * values[*k] * point.lobe;
        }
    }
    for (place, k) in used.iter().enumerate() {
        system[place][place] += RIDGE / shares[*k];
        let integral = f64::from(u8::from(*k <= ORDERS));
        system[place][count] = integral;
        system[count][place] = integral;
    }
    system[count][count + 1] = 1.0;
    for (k, weight) in used.into_iter().zip(solved(system)) {
        weights[k] = weight as f32;
    }
    weights
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
