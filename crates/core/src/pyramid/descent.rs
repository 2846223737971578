//! How the error of a fit changes with the places of its reads, by which `examples/fit_places.rs` and
//! `examples/fit_law.rs` find them.

use super::anisotropic::{self, Law, row};
use super::places::{NUMBERS, READS};
use super::reads::{Fit, Lobe, Point, Read};
use glam::DVec3;

/// Steps of slopes, of logarithms of widths, and of the law's numbers.
const STEP: f64 = 1e-4;

impl Fit {
    /// What the fit leaves of the lobe, with its best weights for reads at `places`, and how that changes
    /// with the slopes and the logarithms of widths, both over alpha.
    pub fn slopes(&self, places: &[[f64; 2]; READS]) -> (f64, [f64; NUMBERS]) {
        let reads = places.map(|place| self.read(place).0);
        let moved = beside(places, |place| self.read(place).0);
        let weights = self.weights(&reads);
        let (error, [slopes, widths]) =
            left(&self.lobe, &self.ridge, &weights, |light| Self::functions(&reads, light), &moved);
        let mut all = [0.0; NUMBERS];
        all[..READS].copy_from_slice(&slopes);
        all[READS..].copy_from_slice(&widths);
        (error, all)
    }
}

impl anisotropic::Fit {
    /// What the fit leaves of the lobe, with its best weights for reads by `law`, and how that changes with
    /// the law.
    pub fn slopes(&self, law: &Law) -> (f64, Law) {
        let numbers = self.shape.numbers(law);
        let read = |[slope, width]: [f64; 2]| self.read([slope, width * self.shape.length]);
        let places = row(numbers);
        let reads = places.map(read);
        let moved = beside(&places, read);
        let weights = self.weights(&reads);
        let functions = Self::functions(&reads);
        let (error, [slopes, widths]) = left(&self.lobe, &self.ridge, &weights, functions, &moved);
        let mut changes = [[0.0; anisotropic::TERMS]; anisotropic::NUMBERS];
        for (k, changes) in changes.iter_mut().enumerate() {
            let mut beside = numbers;
            beside[k] += STEP;
            let moved = row(beside);
            let change: f64 = (0..anisotropic::READS)
                .map(|read| {
                    let ([slope, width], [other, wider]) = (places[read], moved[read]);
                    (slopes[read] * (other - slope) + widths[read] * (wider / width).ln()) / STEP
                })
                .sum();
            let counts = if k == 0 { self.shape.tilt } else { 1.0 };
            *changes = self.shape.terms.map(|term| change * counts * term);
        }
        (error, changes)
    }
}

/// For each of `places`, a read of a greater slope, and a wider one.
fn beside<const N: usize>(places: &[[f64; 2]; N], read: impl Fn([f64; 2]) -> Read) -> [[Read; 2]; N] {
    places.map(|[slope, width]| [[slope + STEP, width], [slope, width * STEP.exp()]].map(&read))
}

/// What a fit of `weights` for f0 and f90 leaves of `lobe`, and how that changes with the slope of each read,
/// and with the logarithm of its width: by the read's own part, for weights are at their best.
/// `functions` and `ridge` begin with those of the reads.
fn left<const N: usize, const FUNCTIONS: usize>(
    lobe: &Lobe,
    ridge: &[f64; FUNCTIONS],
    weights: &[[f32; 2]],
    functions: impl Fn(DVec3) -> [f64; FUNCTIONS],
    moved: &[[Read; 2]; N],
) -> (f64, [[f64; N]; 2]) {
    let weights: Vec<f64> = weights.iter().map(|[a, b]| f64::from(a + b) / lobe.mean).collect();
    let mut error: f64 = weights[..N].iter().zip(ridge).map(|(weight, ridge)| ridge * weight * weight).sum();
    let mut slopes = [[0.0; N]; 2];
    let at = |point: &Point, numbers: &mut [f64]| {
        let values = functions(point.light);
        let found: f64 = weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
        numbers[0] = point.lobe[0] / lobe.mean - found;
        for (side, changes) in numbers[1..].chunks_exact_mut(N).enumerate() {
            for (k, change) in changes.iter_mut().enumerate() {
                *change = weights[k] * (moved[k][side].at(point.light) - values[k]) / STEP;
            }
        }
    };
    lobe.each(1 + 2 * N, at, |count, numbers| {
        let (left, changes) = (numbers[0], &numbers[1..]);
        error += count * left * left;
        for (slope, change) in slopes.as_flattened_mut().iter_mut().zip(changes) {
            *slope -= 2.0 * count * left * change;
        }
    });
    (error, slopes)
}
