//! The tennis-ball map: two congruent panels that meet along the seam of a tennis ball.
//!
//! Herron, *The Tennis-ball Map*: equations 1 (directions), 2 (rectangles) and 3 (the inverse), and the
//! component test of section 2.3. Component 0 is C_1, around +Z and as far as +X and -X; component 1 is C_2,
//! around -Z and as far as +Y and -Y. u is phi, along the panel; v is -theta, so that a picture has +Y (C_1)
//! or +X (C_2) at its top. The domain is the rectangle with its corners rounded off by the seam, which lies
//! in the half planes y = +-sqrt(1/2), z >= 0 and x = +-sqrt(1/2), z <= 0; outside it the panel's spherical
//! coordinates continue.

use super::map::{Component, Place, SphereMap};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI};

/// The map.
#[derive(Clone, Copy, Debug)]
pub struct TennisBall;

/// Half the length of a panel: three eighths of the circle.
const REACH: f64 = 3.0 * FRAC_PI_4;

/// The panel that holds `direction`, a unit vector: 0 or 1.
pub fn panel(direction: DVec3) -> u32 {
    let d = direction;
    let first = if d.z >= 0.0 { d.y.abs() <= FRAC_1_SQRT_2 } else { d.x.abs() >= FRAC_1_SQRT_2 };
    u32::from(!first)
}

/// Theta of the seam at `phi`, both of a panel's own coordinates and at least 0, phi at most 3/4 pi.
///
/// Along the sides theta is pi/4; around the ends sin(phi) cos(theta) is sqrt(1/2).
pub fn seam(phi: f64) -> f64 {
    if phi <= FRAC_PI_2 { FRAC_PI_4 } else { (FRAC_1_SQRT_2 / phi.sin()).min(1.0).acos() }
}

/// A point of the seam for `t` in [0, 1), a closed curve of four half circles.
///
/// Section 2.1: segments (t, sqrt(1/2), sqrt(1/2 - t^2)), reflected and turned; here by the angle along
/// each half circle.
pub fn seam_point(t: f64) -> DVec3 {
    let quarter = (t * 4.0).floor();
    let (sin, cos) = ((t * 4.0 - quarter) * PI).sin_cos();
    let (a, b, h) = (cos * FRAC_1_SQRT_2, FRAC_1_SQRT_2, sin * FRAC_1_SQRT_2);
    match quarter.rem_euclid(4.0) as u32 {
        0 => DVec3::new(a, b, h),
        1 => DVec3::new(-b, a, -h),
        2 => DVec3::new(-a, -b, h),
        _ => DVec3::new(b, -a, -h),
    }
}

/// Solid angle of the part of the domain between the panel's centre and (`phi`, `theta`), neither negative.
fn quarter(phi: f64, theta: f64) -> f64 {
    let sin = theta.sin();
    // The phi at which the seam falls below theta.
    let leaves = PI - (FRAC_1_SQRT_2 / theta.cos()).min(1.0).asin();
    if phi <= leaves { phi * sin } else { leaves * sin + sines_of_seam(phi) - sines_of_seam(leaves) }
}

/// An antiderivative of sin(seam(phi)) = sqrt(1 - 1/(2 sin^2 phi)) from pi/2 on.
///
/// With w = cos(phi) it is that of -sqrt(1/2 - w^2) / (1 - w^2).
fn sines_of_seam(phi: f64) -> f64 {
    let w = phi.cos();
    let rest = (0.5 - w * w).max(0.0).sqrt();
    // Both angles from one `rest`, whose rounding at the seam's ends then cancels.
    FRAC_1_SQRT_2 * (w * FRAC_1_SQRT_2).atan2(rest) - w.atan2(rest)
}

impl SphereMap for TennisBall {
    fn components(&self) -> u32 {
        2
    }

    fn component(&self, index: u32) -> Component {
        let high = DVec2::new(REACH, FRAC_PI_4);
        Component { low: -high, high, cells: [3, 1], at: [0, index] }
    }

    fn contains(&self, _: u32, uv: DVec2) -> bool {
        uv.x.abs() <= REACH && uv.y.abs() <= seam(uv.x.abs())
    }

    fn direction(&self, component: u32, uv: DVec2) -> DVec3 {
        let (sin_phi, cos_phi) = uv.x.sin_cos();
        let (sin_theta, cos_theta) = (-uv.y).sin_cos();
        if component == 0 {
            DVec3::new(sin_phi * cos_theta, sin_theta, cos_phi * cos_theta)
        } else {
            DVec3::new(sin_theta, sin_phi * cos_theta, -cos_phi * cos_theta)
        }
    }

    fn locate(&self, direction: DVec3) -> Place {
        let d = direction.normalize();
        let component = panel(d);
        // atan2 in place of equation 3's asin: as precise everywhere.
        let (up, along, forward) = if component == 0 { (d.y, d.x, d.z) } else { (d.x, d.y, -d.z) };
        Place { component, uv: DVec2::new(along.atan2(forward), -up.atan2(along.hypot(forward))) }
    }

    fn density(&self, _: u32, uv: DVec2) -> f64 {
        uv.y.cos()
    }

    fn solid_angle(&self, _: u32, low: DVec2, high: DVec2) -> f64 {
        if low.x.abs().max(high.x.abs()) <= FRAC_PI_2 {
            // Wholly inside: the seam runs along the panel's sides.
            return (high.y.sin() - low.y.sin()) * (high.x - low.x);
        }
        let to = |u: f64, v: f64| quarter(u.abs(), v.abs()).copysign(u * v);
        to(high.x, high.y) - to(low.x, high.y) - to(high.x, low.y) + to(low.x, low.y)
    }

    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        let (along, across) = (DVec2::new(-1.0, 1.0), DVec2::new(1.0, -1.0));
        // The mirror z = 0 would have to exchange the panels, which are turned against each other.
        let signs = match (axis, place.component) {
            (0, 0) | (1, 1) => along,
            (0, _) | (1, _) => across,
            _ => return None,
        };
        Some(Place { uv: place.uv * signs, ..place })
    }
}
