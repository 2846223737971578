//! Measures trilinear look-ups of a chain, between texels and levels, against lobes.

use crate::chain::Chain;
use crate::chain_lookup::ChainLookup;
use crate::environment::{Rgb, exact_luminance};
use crate::error::Result;
use crate::finite::finite;
use crate::ladder::Ladder;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::PI;

/// Directions per roughness, enough to hit a small sun.
pub const DIRECTIONS: usize = 20_000;

/// Luminance error of look-ups at one roughness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DeliveredError {
    /// Perceptual roughness.
    pub roughness: f64,
    /// The level of detail that the ladder assigns to it.
    pub lod: f64,
    /// RMS error divided by the mean of the lobe.
    #[serde(serialize_with = "finite")]
    pub rel_rmse: f64,
    /// Greatest error of a direction, divided by the mean of the lobe.
    #[serde(serialize_with = "finite")]
    pub max_error: f64,
}

/// Returns `count` evenly distributed directions: a fixed Fibonacci lattice.
#[must_use]
pub fn even_directions(count: usize) -> Vec<DVec3> {
    // The golden angle.
    let turn = PI * (3.0 - 5.0_f64.sqrt());
    let direction = |k: usize| {
        let y = 1.0 - (2 * k + 1) as f64 / count as f64;
        let (sin, cos) = (turn * (k as f64 + 0.5)).sin_cos();
        let radius = (1.0 - y * y).sqrt();
        DVec3::new(radius * cos, y, radius * sin)
    };
    (0..count).map(direction).collect()
}

/// Default roughnesses of a measurement: the midpoints of three equal parts of each step between levels, from
/// the first level with a lobe.
#[must_use]
pub fn default_roughnesses(chain: &Chain) -> Vec<f64> {
    let levels: Vec<f64> = chain.levels.iter().map(|level| level.roughness).filter(|r| *r > 0.0).collect();
    let part = |pair: &[f64], k: u32| pair[0] + (pair[1] - pair[0]) * (f64::from(k) + 0.5) / 3.0;
    let steps = levels.windows(2).filter(|pair| pair[1] > pair[0]);
    steps.flat_map(|pair| (0..3).map(move |k| part(pair, k))).collect()
}

/// Exact lobes: radiance of GGX at a roughness along given directions.
pub type Truth<'a> = &'a dyn Fn(f64, &[DVec3]) -> Result<Vec<Rgb>>;

/// Measures the look-up errors of `chain`, GGX lobes, at `roughnesses` in [0, 1] with `ladder`.
///
/// # Errors
/// Those of `truth`.
pub fn delivered_errors(
    chain: &Chain,
    ladder: Ladder,
    roughnesses: &[f64],
    truth: Truth<'_>,
) -> Result<Vec<DeliveredError>> {
    let (size, levels) = (chain.levels[0].size(), chain.levels.len() as u32);
    let lookup = ChainLookup::new(&chain.levels);
    let directions = even_directions(DIRECTIONS);
    let error_at = |roughness: &f64| {
        let expected = truth(*roughness, &directions)?;
        let lod = ladder.lod(*roughness, levels, size);
        let pairs: Vec<(f64, f64)> = directions
            .par_iter()
            .zip(&expected)
            .map(|(direction, expected)| {
                (exact_luminance(lookup.read(*direction, lod)), exact_luminance(*expected))
            })
            .collect();
        let count = pairs.len() as f64;
        let mean = pairs.iter().map(|(_, expected)| expected).sum::<f64>() / count;
        let squares = pairs.iter().map(|(got, expected)| (got - expected).powi(2)).sum::<f64>();
        let most = pairs.iter().map(|(got, expected)| (got - expected).abs()).fold(0.0, f64::max);
        let over_mean = |error: f64| match (error > 0.0, mean > 0.0) {
            (false, _) => 0.0,
            (true, true) => error / mean,
            (true, false) => 1.0,
        };
        Ok(DeliveredError {
            roughness: *roughness,
            lod,
            rel_rmse: over_mean((squares / count).sqrt()),
            max_error: over_mean(most),
        })
    };
    roughnesses.iter().map(error_at).collect()
}

/// Root mean square of `errors` over the roughnesses from `first` to 1.
#[must_use]
pub fn over_roughness(errors: &[DeliveredError], first: f64) -> f64 {
    let squares: Vec<f64> =
        errors.iter().filter(|error| error.roughness >= first).map(|error| error.rel_rmse.powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}
