//! Polar-capped maps: a band around the equator and two caps.
//!
//! Snyder and Mitchell 2001, by the tennis-ball paper's description of them (sections 1 and 4.2). Component 0
//! is the band, u the longitude of a panorama and v downwards; components 1 and 2 are the caps of +Y and -Y,
//! with u and v of the cube's faces +Y and -Y. Stretch is 1 at the equator and at the poles, its maximum.
//! Outside their domains the projections continue beyond the parallels that separate them. The meridian at u
//! = -pi is glued to that at u = pi.

use super::azimuthal::{Disc, Profile};
use super::map::{Component, Place, SphereMap};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// A polar-capped map by its projections and the latitude of its caps.
#[derive(Clone, Copy, Debug)]
pub struct PolarCapped {
    kind: Projection,
    /// Latitude where band and caps meet, in radians.
    latitude: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Projection {
    StretchInvariant,
    Conformal,
}

/// Stretch-invariant: the plane chart, v the latitude, and equidistant caps; they meet at 45 degrees.
pub(crate) const STRETCH_INVARIANT: PolarCapped =
    PolarCapped { kind: Projection::StretchInvariant, latitude: FRAC_PI_4 };

/// Conformal: Mercator's projection and stereographic caps; they meet at 42.2 degrees.
pub const CONFORMAL: PolarCapped = PolarCapped::conformal(42.2 / 180.0 * PI);

impl PolarCapped {
    /// The conformal map with caps from `latitude`, in (0, pi/2) radians.
    pub const fn conformal(latitude: f64) -> Self {
        Self { kind: Projection::Conformal, latitude }
    }

    fn cap(self, component: u32) -> Disc {
        let profile = match self.kind {
            Projection::StretchInvariant => Profile::Equidistant { rate: 1.0 },
            Projection::Conformal => Profile::Stereographic { scale: 2.0 },
        };
        let radius = match self.kind {
            Projection::StretchInvariant => FRAC_PI_2 - self.latitude,
            Projection::Conformal => 2.0 * ((FRAC_PI_2 - self.latitude) / 2.0).tan(),
        };
        let sign = if component == 1 { 1.0 } else { -1.0 };
        Disc { profile, radius, frame: [DVec3::X, DVec3::Z * sign, DVec3::Y * sign] }
    }

    /// Sine and cosine of the latitude at height `h` of the band.
    fn latitude_at(self, h: f64) -> (f64, f64) {
        match self.kind {
            Projection::StretchInvariant => h.sin_cos(),
            Projection::Conformal => (h.tanh(), 1.0 / h.cosh()),
        }
    }

    /// Height in the band of the latitude that rises by `up` over `along`.
    fn height(self, up: f64, along: f64) -> f64 {
        match self.kind {
            Projection::StretchInvariant => up.atan2(along),
            Projection::Conformal => (up / along).asinh(),
        }
    }
}

impl SphereMap for PolarCapped {
    fn components(&self) -> u32 {
        3
    }

    fn component(&self, index: u32) -> Component {
        if index > 0 {
            return Component::square(self.cap(index).radius, [index - 1, 1]);
        }
        let high = DVec2::new(PI, self.height(self.latitude.sin(), self.latitude.cos()));
        Component { low: -high, high, cells: [4, 1], at: [0, 0] }
    }

    fn contains(&self, component: u32, uv: DVec2) -> bool {
        component == 0 || self.cap(component).contains(uv)
    }

    fn direction(&self, component: u32, uv: DVec2) -> DVec3 {
        if component > 0 {
            return self.cap(component).direction(uv);
        }
        let (sin, cos) = self.latitude_at(-uv.y);
        let (sin_phi, cos_phi) = uv.x.sin_cos();
        DVec3::new(cos * cos_phi, sin, cos * sin_phi)
    }

    fn locate(&self, direction: DVec3) -> Place {
        let d = direction;
        let along = d.x.hypot(d.z);
        if d.y.abs().atan2(along) > self.latitude {
            let component = if d.y > 0.0 { 1 } else { 2 };
            return Place { component, uv: self.cap(component).locate(d) };
        }
        Place { component: 0, uv: DVec2::new(d.z.atan2(d.x), -self.height(d.y, along)) }
    }

    fn density(&self, component: u32, uv: DVec2) -> f64 {
        if component > 0 {
            return self.cap(component).density(uv);
        }
        let (_, cos) = self.latitude_at(uv.y);
        if self.kind == Projection::Conformal { cos * cos } else { cos }
    }

    fn solid_angle(&self, component: u32, low: DVec2, high: DVec2) -> f64 {
        if component > 0 {
            return self.cap(component).solid_angle(low, high);
        }
        // The difference of the latitudes' sines as a product: no cancellation in thin rows.
        let (a, b) = (low.y, high.y);
        let sines = match self.kind {
            Projection::StretchInvariant => 2.0 * ((a + b) / 2.0).cos() * ((b - a) / 2.0).sin(),
            Projection::Conformal => (b - a).sinh() / (a.cosh() * b.cosh()),
        };
        sines * (high.x - low.x)
    }

    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        let Place { component, uv } = place;
        if component > 0 {
            let other = if axis == 1 { 3 - component } else { component };
            let uv = self.cap(component).mirrored(&self.cap(other), uv, axis);
            return Some(Place { component: other, uv });
        }
        let uv = match axis {
            // Longitude u becomes pi - u.
            0 => DVec2::new((TAU - uv.x).rem_euclid(TAU) - PI, uv.y),
            1 => DVec2::new(uv.x, -uv.y),
            _ => DVec2::new(-uv.x, uv.y),
        };
        Some(Place { component, uv })
    }
}
