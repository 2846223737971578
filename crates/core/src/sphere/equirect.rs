//! The panorama (equirectangular map): u = 1/2 + atan2(z, x)/2pi to the right, v = acos(y)/pi downwards.
//! Its centre looks along +X, its right half along +Z, its top along +Y.

use super::map::{Component, Place, SphereMap, Texel};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// The map, in radians: (u, v) from (0, 0) to (2pi, pi), which are 2pi and pi times the functions' u and v.
/// The poles are singular: a row of texels each. Outside the rectangle u wraps around and v continues over
/// the poles.
///
/// Blinn and Newell 1976; the cartographers' plane chart.
#[derive(Clone, Copy, Debug)]
pub struct Equirect;

impl SphereMap for Equirect {
    fn component(&self, _: u32) -> Component {
        Component { low: DVec2::ZERO, high: DVec2::new(TAU, PI), cells: [2, 1], at: [0, 0] }
    }

    fn direction(&self, _: u32, uv: DVec2) -> DVec3 {
        direction_from_equirect(uv.x / TAU, uv.y / PI)
    }

    fn locate(&self, direction: DVec3) -> Place {
        let (u, v) = equirect_from_direction(direction);
        Place { component: 0, uv: DVec2::new(u * TAU, v * PI) }
    }

    fn density(&self, _: u32, uv: DVec2) -> f64 {
        uv.y.sin()
    }

    fn solid_angle(&self, _: u32, low: DVec2, high: DVec2) -> f64 {
        band_height(low.y, high.y) * (high.x - low.x)
    }

    fn wrap_texel(&self, size: u32, component: u32, x: i64, y: i64) -> Option<Texel> {
        let (height, width) = (i64::from(size), 2 * i64::from(size));
        // Across a pole to the opposite meridian.
        let turn = y.rem_euclid(2 * height);
        let (x, y) = if turn < height { (x, turn) } else { (x + height, 2 * height - 1 - turn) };
        let index = |k: i64| u32::try_from(k).expect("inside the panorama");
        Some(Texel { component, x: index(x.rem_euclid(width)), y: index(y) })
    }

    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        let DVec2 { x: u, y: v } = place.uv;
        let uv = match axis {
            // Longitude phi = u - pi becomes pi - phi.
            0 => DVec2::new((3.0 * PI - u).rem_euclid(TAU), v),
            1 => DVec2::new(u, PI - v),
            _ => DVec2::new(TAU - u, v),
        };
        Some(Place { uv, ..place })
    }
}

/// Unit direction at `u`, `v` in [0, 1].
pub fn direction_from_equirect(u: f64, v: f64) -> DVec3 {
    let (sin_phi, cos_phi) = ((u - 0.5) * TAU).sin_cos();
    let (sin_theta, cos_theta) = (v * PI).sin_cos();
    DVec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi)
}

/// Panorama coordinates of `direction` (any length but zero): u in [0, 1], v in [0, 1]. At the poles u is
/// 1/2.
pub fn equirect_from_direction(direction: DVec3) -> (f64, f64) {
    let d = direction;
    // atan2 keeps full precision near the poles, where acos(y) loses half its digits.
    let theta = d.x.hypot(d.z).atan2(d.y);
    (0.5 + d.z.atan2(d.x) / TAU, theta / PI)
}

/// Exact solid angle of each texel of row `j` of a `width` x `height` panorama, in steradians.
pub fn texel_solid_angle(width: u32, height: u32, j: u32) -> f64 {
    let edge = |k: u32| f64::from(k) / f64::from(height) * PI;
    band_height(edge(j), edge(j + 1)) * TAU / f64::from(width)
}

/// cos(`a`) - cos(`b`) as a product: no cancellation at the poles.
fn band_height(a: f64, b: f64) -> f64 {
    2.0 * ((a + b) / 2.0).sin() * ((b - a) / 2.0).sin()
}
