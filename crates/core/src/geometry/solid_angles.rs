//! Solid angles of the texels of an OEM.

use super::quadrant::Quadrant;
use crate::sphere::octahedral;

/// Minimum size for Gauss quadrature with three points (two from four times this size). It is exact to
/// float32: its error is (2/n)^6/2016000 or (2/n)^4/4320 of the density's sixth or fourth derivative
/// (below 1e6 and 1e4), that is 1e-9.
const GAUSS_FROM: u32 = 128;

/// Solid angles of the texels of an octahedral square of `n`.
pub fn solid_angles(n: u32) -> Quadrant<f32> {
    Quadrant::new(n, |x, y| solid_angle(n, x, y))
}

/// That of the texel (`x`, `y`), u, v >= 0.
fn solid_angle(n: u32, x: u32, y: u32) -> f32 {
    let centre = octahedral::texel_centre(n, x, y).abs();
    // The density has a kink across an axis or a fold diagonal, where quadrature is inaccurate.
    let reach = (1.0 - 1e-9) / f64::from(n);
    let kinked = centre.min_element() < reach || (centre.x + centre.y - 1.0).abs() < 2.0 * reach;
    if n < GAUSS_FROM || kinked {
        return octahedral::texel_solid_angle(n, x, y) as f32;
    }
    let (nodes, weights): (&[f64], &[f64]) = if n < 4 * GAUSS_FROM {
        (&[-0.774_596_669_241_483_4, 0.0, 0.774_596_669_241_483_4], &[5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0])
    } else {
        (&[-0.577_350_269_189_625_8, 0.577_350_269_189_625_8], &[0.5, 0.5])
    };
    let h = 1.0 / f64::from(n);
    let mut sum = 0.0;
    for (dv, weight_v) in nodes.iter().zip(weights) {
        for (du, weight_u) in nodes.iter().zip(weights) {
            let uv = centre + glam::DVec2::new(*du, *dv) * h;
            sum += weight_u * weight_v * octahedral::solid_angle_density(uv);
        }
    }
    (sum * 4.0 * h * h) as f32
}
