//! OpenGL's sphere map: the sphere as a mirror ball, +Z at its centre and -Z around its rim.
//!
//! OpenGL specification 1.1 (1995), section 2.10.4: s = rx/m + 1/2 with m = 2 sqrt(rx^2 + ry^2 + (rz+1)^2),
//! here as u = 2s - 1 and v = 1 - 2t, downwards. Its cartographic name is Lambert's azimuthal equal-area
//! projection. The rim is singular: all of it is -Z, and the stretch grows without bound towards it.

use super::azimuthal::{Disc, Profile};
use super::map::{Place, SphereMap};
use glam::{DVec2, DVec3};

const DISC: Disc =
    Disc { profile: Profile::EqualArea, radius: 1.0, frame: [DVec3::X, DVec3::NEG_Y, DVec3::Z] };

/// The map; outside the disc every texel is -Z.
#[derive(Clone, Copy, Debug)]
pub struct MirrorBall;

impl SphereMap for MirrorBall {
    fn contains(&self, _: u32, uv: DVec2) -> bool {
        DISC.contains(uv)
    }

    fn direction(&self, _: u32, uv: DVec2) -> DVec3 {
        DISC.direction(uv)
    }

    fn locate(&self, direction: DVec3) -> Place {
        Place { component: 0, uv: DISC.locate(direction) }
    }

    fn density(&self, _: u32, uv: DVec2) -> f64 {
        DISC.density(uv)
    }

    fn solid_angle(&self, _: u32, low: DVec2, high: DVec2) -> f64 {
        DISC.solid_angle(low, high)
    }

    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        (axis < 2).then(|| Place { uv: DISC.mirrored(&DISC, place.uv, axis), ..place })
    }
}
