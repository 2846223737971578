//! The low-distortion equal-area map: one square, every texel of the same solid angle.
//!
//! Derived here from the description: Snyder and Mitchell 2001, as the tennis-ball paper quotes it (one
//! component, equal area, sampling requirement 19.7), is met by the square of the octahedral unfolding with
//! each hemisphere filled by Shirley and Chiu's concentric map (1997) followed by Lambert's azimuthal
//! equal-area projection, as Clarberg published it (*Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD*,
//! 2008). `docs/maps.md` compares it with the quoted row.
//!
//! With p = |u| + |v| <= 1 the upper hemisphere is y = 1 - p^2 at the longitude (pi/2) |v| / p of its
//! quadrant; the lower one is unfolded as in [`super::octahedral`], with the same wrapping. Kinks along the
//! axes and the fold diagonals; the corners are -Y.

use super::map::{Place, SphereMap, Texel};
use super::octahedral::{mirrored_oct, wrap_oct, wrap_texel};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// The map.
#[derive(Clone, Copy, Debug)]
pub struct LowDistortion;

impl SphereMap for LowDistortion {
    fn direction(&self, _: u32, uv: DVec2) -> DVec3 {
        let uv = wrap_oct(uv);
        let (a, b) = (uv.x.abs(), uv.y.abs());
        let upper = a + b <= 1.0;
        let (a, b) = if upper { (a, b) } else { (1.0 - b, 1.0 - a) };
        let p = a + b;
        let (sin, cos) = (if p == 0.0 { 0.0 } else { b / p * FRAC_PI_2 }).sin_cos();
        let across = p * (2.0 - p * p).max(0.0).sqrt();
        let up = 1.0 - p * p;
        DVec3::new((across * cos).copysign(uv.x), if upper { up } else { -up }, (across * sin).copysign(uv.y))
    }

    fn locate(&self, direction: DVec3) -> Place {
        let d = direction.normalize();
        // 1 - |y| without its cancellation at the poles.
        let p = ((d.x * d.x + d.z * d.z) / (1.0 + d.y.abs())).sqrt();
        let share = d.z.abs().atan2(d.x.abs()) / FRAC_PI_2;
        let (a, b) = (p * (1.0 - share), p * share);
        let (a, b) = if d.y >= 0.0 { (a, b) } else { (1.0 - b, 1.0 - a) };
        Place { component: 0, uv: DVec2::new(a.copysign(d.x), b.copysign(d.z)) }
    }

    fn density(&self, _: u32, _: DVec2) -> f64 {
        PI
    }

    fn solid_angle(&self, _: u32, low: DVec2, high: DVec2) -> f64 {
        (high.x - low.x) * (high.y - low.y) * PI
    }

    fn wrap_texel(&self, size: u32, component: u32, x: i64, y: i64) -> Option<Texel> {
        let (x, y) = wrap_texel(size, x, y);
        Some(Texel { component, x, y })
    }

    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        Some(Place { uv: mirrored_oct(place.uv, axis), ..place })
    }
}
