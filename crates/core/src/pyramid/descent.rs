//! How the error of a fit changes with the places of its reads, by which `examples/fit_places.rs` finds them.

use super::places::{NUMBERS, READS};
use super::reads::{Fit, Read, moments};

/// Steps of slopes over alpha, and of logarithms of widths.
const STEP: f64 = 1e-4;

impl Fit {
    /// What the fit leaves of the lobe, with its best weights for reads at `places`, and how that changes
    /// with the slopes and the logarithms of widths: by each read's own part, for weights are at their best.
    pub fn slopes(&self, places: &[[f64; 2]; READS]) -> (f64, [f64; NUMBERS]) {
        let reads = places.map(|place| self.read(place).0);
        let beside = |[slope, width]: [f64; 2]| {
            let wider = [slope, width * STEP.exp()];
            [[slope + STEP, width], wider].map(|place| self.read(place).0)
        };
        let moved: [[Read; 2]; READS] = places.map(beside);
        let [mean, square] = moments(&self.points);
        let weights: Vec<f64> = self.weights(&reads).iter().map(|[a, b]| f64::from(a + b) / mean).collect();
        let mut error: f64 =
            weights[..READS].iter().zip(&self.ridge).map(|(weight, ridge)| ridge * weight * weight).sum();
        let mut slopes = [0.0; NUMBERS];
        for point in &self.points {
            let values = Self::functions(&reads, point.light);
            let found: f64 = weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
            let (left, count) = (point.lobe[0] / mean - found, point.weight(mean, square));
            error += count * left * left;
            for (k, moved) in moved.iter().enumerate() {
                for (side, read) in moved.iter().enumerate() {
                    let change = (read.at(point.light) - values[k]) / STEP;
                    slopes[side * READS + k] -= 2.0 * count * left * weights[k] * change;
                }
            }
        }
        (error, slopes)
    }
}
