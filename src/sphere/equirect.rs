//! The panorama (equirectangular map): u = 1/2 + atan2(z, x)/2pi to the right, v = acos(y)/pi downwards.
//! Its centre looks along +X, its right half along +Z, its top along +Y.

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Unit direction at `u`, `v` in [0, 1].
#[must_use]
pub fn direction_from_equirect(u: f64, v: f64) -> DVec3 {
    let (sin_phi, cos_phi) = ((u - 0.5) * TAU).sin_cos();
    let (sin_theta, cos_theta) = (v * PI).sin_cos();
    DVec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi)
}

/// Panorama coordinates of `direction` (any length but zero): u in [0, 1], v in [0, 1]. At the poles u is
/// 1/2.
#[must_use]
pub fn equirect_from_direction(direction: DVec3) -> (f64, f64) {
    let d = direction;
    // atan2 keeps full precision beside the poles, where acos(y) loses half its digits.
    let theta = d.x.hypot(d.z).atan2(d.y);
    (0.5 + d.z.atan2(d.x) / TAU, theta / PI)
}

/// Exact solid angle of each texel of row `j` of a `width` x `height` panorama, in steradians.
#[must_use]
pub fn texel_solid_angle(width: u32, height: u32, j: u32) -> f64 {
    let edge = |k: u32| f64::from(k) / f64::from(height) * PI;
    // cos a - cos b as a product: no cancellation at the poles.
    let (a, b) = (edge(j), edge(j + 1));
    2.0 * ((a + b) / 2.0).sin() * ((b - a) / 2.0).sin() * TAU / f64::from(width)
}
