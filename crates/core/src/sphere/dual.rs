//! Two discs, a hemisphere each: the dual paraboloid and the dual equidistant map.
//!
//! Component 0 is the hemisphere of +Z, component 1 that of -Z; u and v are those of the cube's faces +Z and
//! -Z. The rims are glued to each other; outside the discs the projections continue into the other
//! hemisphere.

use super::azimuthal::{Disc, Profile};
use super::map::{Place, SphereMap};
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;

/// A dual map by its projection.
#[derive(Clone, Copy, Debug)]
pub struct Dual(Profile);

/// Heidrich and Seidel 1998, section 3.1: (u, v) = (x, -y) / (1 + |z|), stereographic and so conformal.
pub(crate) const PARABOLOID: Dual = Dual(Profile::Stereographic { scale: 1.0 });

/// Snyder and Mitchell 2001: the radius is the angle from the axis, in quarter turns.
pub(crate) const EQUIDISTANT: Dual = Dual(Profile::Equidistant { rate: FRAC_PI_2 });

impl Dual {
    fn disc(self, component: u32) -> Disc {
        let sign = if component == 0 { 1.0 } else { -1.0 };
        let frame = [DVec3::X * sign, DVec3::NEG_Y, DVec3::Z * sign];
        Disc { profile: self.0, radius: 1.0, frame }
    }
}

impl SphereMap for Dual {
    fn components(&self) -> u32 {
        2
    }

    fn contains(&self, component: u32, uv: DVec2) -> bool {
        self.disc(component).contains(uv)
    }

    fn direction(&self, component: u32, uv: DVec2) -> DVec3 {
        self.disc(component).direction(uv)
    }

    fn locate(&self, direction: DVec3) -> Place {
        let component = u32::from(direction.z < 0.0);
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
        Some(Place { component, uv })
    }
}
