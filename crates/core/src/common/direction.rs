//! Directions of any length as unit vectors.

use crate::common::error::{Error, Result};
use glam::DVec3;

/// The unit vector along `direction`, unchanged if it is one; `None` if it is zero or not finite.
#[must_use]
pub fn unit(direction: DVec3) -> Option<DVec3> {
    if (direction.length_squared() - 1.0).abs() < 4.0 * f64::EPSILON {
        return Some(direction);
    }
    // Scale first: squares of tiny and huge lengths exceed the range of floats.
    let longest = direction.abs().max_element();
    (direction.is_finite() && longest > 0.0).then(|| (direction / longest).normalize())
}

/// The unit vectors along `directions`.
///
/// # Errors
/// [`Error::Parameter`] for one that is zero or not finite.
pub fn units(directions: &[DVec3]) -> Result<Vec<DVec3>> {
    let of = |(index, direction): (usize, &DVec3)| {
        unit(*direction).ok_or_else(|| {
            let DVec3 { x, y, z } = direction;
            Error::Parameter(format!(
                "direction {index} is {x}, {y}, {z}; finite numbers that are not all 0 are needed"
            ))
        })
    };
    directions.iter().enumerate().map(of).collect()
}
