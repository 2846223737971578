//! Measures trilinear look-ups of a chain, between texels and levels, against lobes.

use crate::analysis::channels::{ErrorSums, Relative};
use crate::common::error::Result;
use crate::common::finite::finite;
use crate::common::parallel;
use crate::light::chain::Chain;
use crate::light::chain_lookup::ChainLookup;
use crate::light::environment::Rgb;
use crate::lobe::ladder::Ladder;
use glam::{DQuat, DVec3};
use serde::Serialize;
use std::f64::consts::PI;
use std::ops::Range;

/// Directions per roughness, enough to hit a small sun.
pub const DIRECTIONS: usize = 20_000;

/// Directions near the sun per roughness.
const SUN_DIRECTIONS: usize = 2_000;

/// Reach of the directions near the sun, in units of alpha: random directions miss the core of a sharp lobe.
const SUN_REACH: f64 = 6.0;

/// Errors of look-ups at one roughness, in luminance and in every channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DeliveredError {
    /// Perceptual roughness.
    pub roughness: f64,
    /// The level of detail that the ladder assigns to it.
    pub lod: f64,
    /// Root mean square errors over the sphere.
    #[serde(flatten)]
    pub rmse: Relative,
    /// Greatest error of luminance at a direction, divided by the mean of the lobe.
    #[serde(serialize_with = "finite")]
    pub max_error: f64,
    /// The same of red, green and blue.
    #[serde(serialize_with = "finite")]
    pub channel_max_error: [f64; 3],
    /// Root mean square errors within six alpha of the reflection of the brightest region; `None` without
    /// one, and where that is everywhere.
    pub near_sun: Option<Relative>,
}

/// Returns `count` evenly distributed directions: a fixed Fibonacci lattice.
pub fn even_directions(count: usize) -> Vec<DVec3> {
    directions_within(count, PI, DVec3::Y)
}

/// Returns `count` evenly distributed directions within the angle `reach` of the unit vector `axis`.
fn directions_within(count: usize, reach: f64, axis: DVec3) -> Vec<DVec3> {
    // The golden angle.
    let turn = PI * (3.0 - 5.0_f64.sqrt());
    let height = 1.0 - reach.cos();
    let from_y = DQuat::from_rotation_arc(DVec3::Y, axis);
    let direction = |k: usize| {
        let y = 1.0 - (k as f64 + 0.5) * height / count as f64;
        let (sin, cos) = (turn * (k as f64 + 0.5)).sin_cos();
        let radius = (1.0 - y * y).max(0.0).sqrt();
        from_y * DVec3::new(radius * cos, y, radius * sin)
    };
    (0..count).map(direction).collect()
}

/// Default roughnesses of a measurement: the midpoints of three equal parts of each step between levels, from
/// the first level with a lobe.
pub fn default_roughnesses(chain: &Chain) -> Vec<f64> {
    let levels: Vec<f64> = chain.levels.iter().map(|level| level.roughness).filter(|r| *r > 0.0).collect();
    let part = |pair: &[f64], k: u32| pair[0] + (pair[1] - pair[0]) * (f64::from(k) + 0.5) / 3.0;
    let steps = levels.windows(2).filter(|pair| pair[1] > pair[0]);
    steps.flat_map(|pair| (0..3).map(move |k| part(pair, k))).collect()
}

/// Exact lobes: radiance of GGX at a roughness along given directions.
pub type Truth<'a> = &'a dyn Fn(f64, &[DVec3]) -> Result<Vec<Rgb>>;

/// Measures the look-up errors of `chain`, GGX lobes, at `roughnesses` in [0, 1] with `ladder`; also around
/// the direction of the `sun`, if any.
///
/// # Errors
/// Those of `truth`.
pub fn delivered_errors(
    chain: &Chain,
    ladder: Ladder,
    roughnesses: &[f64],
    sun: Option<DVec3>,
    truth: Truth<'_>,
) -> Result<Vec<DeliveredError>> {
    let (size, levels) = (chain.levels[0].size(), chain.levels.len() as u32);
    let lookup = ChainLookup::new(&chain.levels);
    let even = even_directions(DIRECTIONS);
    let error_at = |roughness: &f64| {
        // Within the whole sphere they would add nothing.
        let reach = SUN_REACH * roughness * roughness;
        let sun = sun.filter(|_| reach < PI);
        let near = sun.map_or_else(Vec::new, |sun| directions_within(SUN_DIRECTIONS, reach, sun));
        let directions = [&even[..], &near].concat();
        let expected = truth(*roughness, &directions)?;
        let lod = ladder.lod(*roughness, levels, size);
        let got = parallel::values(directions.len(), |k| lookup.read(directions[k], lod));
        let sums = |range: Range<usize>| {
            let mut sums = ErrorSums::default();
            for (got, expected) in got[range.clone()].iter().zip(&expected[range]) {
                sums.add(1.0, *got, expected.map(f64::from));
            }
            sums
        };
        let whole = sums(0..even.len());
        let most = whole.greatest();
        let near_sun = (!near.is_empty()).then(|| sums(even.len()..got.len()).rel_rmse());
        Ok(DeliveredError {
            roughness: *roughness,
            lod,
            rmse: whole.rel_rmse(),
            max_error: most.luminance,
            channel_max_error: most.channels,
            near_sun,
        })
    };
    roughnesses.iter().map(error_at).collect()
}
