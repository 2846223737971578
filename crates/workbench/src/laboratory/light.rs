//! The light that tables are filled from.

use glam::DVec3;
use octagloss_core::analysis::delivered::even_directions;
use octagloss_core::common::error::Result;
pub use octagloss_core::geometry::light::Light;
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::sphere::cube::{Face, direction_from_cube};
use rayon::prelude::*;

/// Number of lamps of [`lamps`].
const LAMPS: usize = 400;

/// Cosine of a lamp's radius, 1.6 degrees.
const LAMP_COSINE: f64 = 0.9996;

/// A cube of `size` x `size` texels a face: 400 round lamps, evenly spread over the sphere, of 1 to 100 times
/// the radiance of each other, over a dim ground. Every region of the sphere has the same light on average,
/// so that differences between regions are those of the map.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Parameter`] for no texels.
pub fn lamps(size: u32) -> Result<Environment> {
    let lamps: Vec<(DVec3, f64)> = (0..)
        .zip(even_directions(LAMPS))
        .map(|(k, direction)| {
            // The fractional parts of multiples of sqrt(2) are even and independent of the place.
            (direction, 100_f64.powf((f64::from(k) * std::f64::consts::SQRT_2).fract()))
        })
        .collect();
    let radiance = |direction: DVec3| {
        let lit = lamps.iter().filter(|(lamp, _)| lamp.dot(direction) > LAMP_COSINE);
        lit.fold(0.1, |sum, (_, strength)| sum + strength)
    };
    let texel = |index: u32| {
        let (face, j, i) = (index / (size * size), index / size % size, index % size);
        let at = |k: u32, share: u32| {
            2.0 * (f64::from(k) + (f64::from(share) + 0.5) / 4.0) / f64::from(size) - 1.0
        };
        let sum: f64 = (0..16)
            .map(|k| radiance(direction_from_cube(Face::ALL[face as usize], at(i, k % 4), at(j, k / 4))))
            .sum();
        [(sum / 16.0) as f32; 3]
    };
    let texels = (0..6 * size * size).into_par_iter().map(texel).collect();
    Environment::new(Layout::Cube { size }, texels)
}
