//! One disc, or two of a hemisphere each: the sphere map, the dual paraboloid and the dual equidistant map.
//!
//! Component 0 lies around +Z, component 1 around -Z; u and v are those of the cube's faces +Z and -Z. The
//! rims of two discs are glued to each other; outside the discs the projections continue into the other
//! hemisphere.

use super::azimuthal::{Disc, Profile};
use super::map::{Place, SphereMap};
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;

/// A map by its projection and the number of its discs.
#[derive(Clone, Copy, Debug)]
pub struct Discs(Profile, u32);

/// Heidrich and Seidel 1998, section 3.1: (u, v) = (x, -y) / (1 + |z|), stereographic and so conformal.
pub(crate) const PARABOLOID: Discs = Discs(Profile::Stereographic { scale: 1.0 }, 2);

/// Snyder and Mitchell 2001: the radius is the angle from the axis, in quarter turns.
pub(crate) const EQUIDISTANT: Discs = Discs(Profile::Equidistant { rate: FRAC_PI_2 }, 2);

/// OpenGL's sphere map: the sphere as a mirror ball, +Z at its centre and -Z around its rim.
///
/// OpenGL specification 1.1 (1995), section 2.10.4: s = rx/m + 1/2 with m = 2 sqrt(rx^2 + ry^2 + (rz+1)^2),
/// here as u = 2s - 1 and v = 1 - 2t, downwards. Its cartographic name is Lambert's azimuthal equal-area
/// projection. The rim is singular: all of it is -Z, as is every texel outside the disc, and the stretch
/// grows without bound towards it.
pub(crate) const MIRROR_BALL: Discs = Discs(Profile::EqualArea, 1);

impl Discs {
    fn disc(self, component: u32) -> Disc {
        let sign = if component == 0 { 1.0 } else { -1.0 };
        let frame = [DVec3::X * sign, DVec3::NEG_Y, DVec3::Z * sign];
        Disc { profile: self.0, radius: 1.0, frame }
    }
}

impl SphereMap for Discs {
    fn components(&self) -> u32 {
        self.1
    }

    fn contains(&self, component: u32, uv: DVec2) -> bool {
        self.disc(component).contains(uv)
    }

    fn direction(&self, component: u32, uv: DVec2) -> DVec3 {
        self.disc(component).direction(uv)
    }

    fn locate(&self, direction: DVec3) -> Place {
        let component = u32::from(self.1 > 1 && direction.z < 0.0);
        Place { component, uv: self.disc(component).locate(direction) }
    }

    fn density(&self, component: u32, uv: DVec2) -> f64 {
        self.disc(component).density(uv)
    }

    fn solid_angle(&self, component: u32, low: DVec2, high: DVec2) -> f64 {
        self.disc(component).solid_angle(low, high)
    }

    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        let component = if axis == 2 { 1 - place.component } else { place.component };
        let uv = self.disc(place.component).mirrored(&self.disc(component), place.uv, axis);
        (component < self.1).then_some(Place { component, uv })
    }
}
