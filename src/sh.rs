//! Spherical harmonics of an environment.
//!
//! Real, orthonormal, without the Condon-Shortley phase, in the world's own axes (x, y up, z), in the order
//! L0; L1 by y, z, x; L2 by xy, yz, 3z^2 - 1, zx, x^2 - y^2, which is m = -l..l of the usual formulas. Coefficients
//! are of radiance: c_k is the integral of L * Y_k over the sphere, and L(d) is about the sum of c_k Y_k(d).

use crate::environment::Environment;
use crate::oracle::SourceTexels;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// The nine basis functions at `direction` (unit length).
#[must_use]
pub fn basis(direction: DVec3) -> [f64; 9] {
    let d = direction;
    let outer = DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    from_moments(1.0, d, outer)
}

/// Coefficients of `environment`'s radiance up to L2, red, green and blue.
///
/// The basis functions are polynomials of the direction, so the exact integrals of 1, l and l l^T over each texel are
/// all that it takes.
#[must_use]
pub fn spherical_harmonics(environment: &Environment) -> [[f64; 3]; 9] {
    let texels = SourceTexels::new(environment.layout());
    let world_from_source = environment.source_from_world().transpose();
    // The integrals of 1, l and l l^T over each block, in its own space.
    let moments: Vec<[f64; 10]> = texels
        .blocks()
        .iter()
        .map(|texel| {
            let (mean, second) = (texel.mean, texel.second_moment());
            let (x, y, z) = (second.x_axis, second.y_axis, second.z_axis);
            [1.0, mean.x, mean.y, mean.z, x.x, y.y, z.z, x.y, y.z, z.x]
                .map(|moment| moment * texel.solid_angle)
        })
        .collect();
    // Moments of the radiance, gathered in each frame's own space.
    let mut gathered = vec![[[0.0; 10]; 3]; texels.frames().len()];
    texels.for_each(|index, block, frame| {
        for (sums, radiance) in gathered[frame].iter_mut().zip(environment.texels()[index]) {
            for (sum, moment) in sums.iter_mut().zip(&moments[block]) {
                *sum += f64::from(radiance) * moment;
            }
        }
    });
    let mut coefficients = [[0.0; 3]; 9];
    for channel in 0..3 {
        let (mut area, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for (frame, gathered) in texels.frames().iter().zip(&gathered) {
            let [one, x, y, z, xx, yy, zz, xy, yz, zx] = gathered[channel];
            let world_from_block = world_from_source * frame.transpose();
            let own =
                DMat3::from_cols(DVec3::new(xx, xy, zx), DVec3::new(xy, yy, yz), DVec3::new(zx, yz, zz));
            area += one;
            first += world_from_block * DVec3::new(x, y, z);
            second += world_from_block * own * world_from_block.transpose();
        }
        for (coefficient, value) in coefficients.iter_mut().zip(from_moments(area, first, second)) {
            coefficient[channel] = value;
        }
    }
    coefficients
}

/// The integrals of the nine basis functions, from those of 1, l and l l^T.
fn from_moments(area: f64, first: DVec3, second: DMat3) -> [f64; 9] {
    let linear = (3.0 / (4.0 * PI)).sqrt();
    let quadratic = (15.0 / (4.0 * PI)).sqrt();
    [
        area / (4.0 * PI).sqrt(),
        linear * first.y,
        linear * first.z,
        linear * first.x,
        quadratic * second.y_axis.x,
        quadratic * second.z_axis.y,
        (5.0 / (16.0 * PI)).sqrt() * (3.0 * second.z_axis.z - area),
        quadratic * second.x_axis.z,
        quadratic / 2.0 * (second.x_axis.x - second.y_axis.y),
    ]
}
