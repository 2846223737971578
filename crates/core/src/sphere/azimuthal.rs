//! Azimuthal projections of a cap onto a disc, shared by the sphere map, the dual maps and the polar caps.
//!
//! A disc lies around an axis; distance r from its centre is a function of the angle theta from the axis, and
//! azimuth is kept.

use super::quadrature::gauss_legendre;
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

/// Relation of radius and angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Profile {
    /// r = scale * tan(theta/2): conformal.
    Stereographic {
        /// Radius of the equator.
        scale: f64,
    },
    /// theta = rate * r: preserves distances from the centre.
    Equidistant {
        /// Radians per unit of radius.
        rate: f64,
    },
    /// r = sin(theta/2): Lambert's, preserves areas.
    EqualArea,
}

/// A disc around an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Disc {
    pub(super) profile: Profile,
    /// Radius of the domain.
    pub(super) radius: f64,
    /// Directions that u, v and the disc's centre point to.
    pub(super) frame: [DVec3; 3],
}

/// [`gauss_legendre`] of 16 points: exact to rounding, since all integrands are analytic well beyond the
/// edges.
static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(16));

/// The rule of 4 points, for densities over squares of [`SMALL`].
static SMALL_RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(4));

/// Largest rectangle for [`SMALL_RULE`], as a share of the radius; the error is of the order of (1/64)^8 =
/// 4e-15.
const SMALL: f64 = 1.0 / 32.0;

impl Profile {
    /// Angle from the axis at radius `r`.
    fn angle(self, r: f64) -> f64 {
        match self {
            Self::Stereographic { scale } => 2.0 * (r / scale).atan(),
            Self::Equidistant { rate } => r * rate,
            Self::EqualArea => 2.0 * r.min(1.0).asin(),
        }
    }

    /// Radius at angle `theta` from the axis.
    fn radius(self, theta: f64) -> f64 {
        match self {
            Self::Stereographic { scale } => scale * (theta / 2.0).tan(),
            Self::Equidistant { rate } => theta / rate,
            Self::EqualArea => (theta / 2.0).sin(),
        }
    }

    /// Steradians per unit of area at squared radius `q`.
    fn density(self, q: f64) -> f64 {
        match self {
            Self::Stereographic { scale } => {
                let k = scale * scale;
                4.0 * k / ((k + q) * (k + q))
            }
            Self::Equidistant { rate } => rate * rate * sinc(rate * q.sqrt()),
            Self::EqualArea => 4.0,
        }
    }

    /// (1 - cos theta) / r^2 at squared radius `q`.
    fn cap(self, q: f64) -> f64 {
        match self {
            Self::Stereographic { scale } => 2.0 / (scale * scale + q),
            Self::Equidistant { rate } => {
                let half = sinc(rate * q.sqrt() / 2.0);
                rate * rate / 2.0 * half * half
            }
            Self::EqualArea => 2.0,
        }
    }
}

/// sin(x) / x.
fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

impl Disc {
    pub(super) fn contains(&self, uv: DVec2) -> bool {
        uv.length_squared() <= self.radius * self.radius
    }

    /// Unit direction at `uv`, also outside the disc; beyond the end of the profile that of its rim.
    pub(super) fn direction(&self, uv: DVec2) -> DVec3 {
        let [right, down, axis] = self.frame;
        let r = uv.length();
        let (sin, cos) = self.profile.angle(r).sin_cos();
        let along = if r == 0.0 { DVec2::ZERO } else { uv * (sin / r) };
        right * along.x + down * along.y + axis * cos
    }

    /// Coordinates of `direction`, of any length but zero; of the axis' antipode, a point on the u axis.
    pub(super) fn locate(&self, direction: DVec3) -> DVec2 {
        let [right, down, axis] = self.frame;
        let across = DVec2::new(direction.dot(right), direction.dot(down));
        let sin = across.length();
        let r = self.profile.radius(sin.atan2(direction.dot(axis)));
        if sin == 0.0 { DVec2::new(r, 0.0) } else { across * (r / sin) }
    }

    /// Coordinates in `other`, the image of this disc in the mirror of coordinate `axis`, of the image of
    /// `uv`. Both have frames along the axes.
    pub(super) fn mirrored(&self, other: &Self, uv: DVec2, axis: usize) -> DVec2 {
        let sign = |k: usize| {
            let mut image = self.frame[k];
            image[axis] = -image[axis];
            image.dot(other.frame[k])
        };
        DVec2::new(sign(0), sign(1)) * uv
    }

    pub(super) fn density(&self, uv: DVec2) -> f64 {
        self.profile.density(uv.length_squared())
    }

    /// Exact solid angle of the intersection of the disc with the rectangle from `low` to `high`.
    pub(super) fn solid_angle(&self, low: DVec2, high: DVec2) -> f64 {
        let (extent, farthest) = (high - low, low.abs().max(high.abs()));
        if extent.max_element() <= SMALL * self.radius && self.contains(farthest) {
            let mut sum = 0.0;
            for (v, row) in SMALL_RULE.iter() {
                for (u, weight) in SMALL_RULE.iter() {
                    sum += row * weight * self.density(low + extent * DVec2::new(*u, *v));
                }
            }
            return sum * extent.x * extent.y;
        }
        let to = |x: f64, y: f64| self.quarter(x.abs(), y.abs()).copysign(x * y);
        to(high.x, high.y) - to(low.x, high.y) - to(high.x, low.y) + to(low.x, low.y)
    }

    /// Solid angle of the part in the disc of the rectangle from the centre to (`x`, `y`), neither negative.
    ///
    /// By Green's theorem the integral of (1 - cos theta) d(azimuth) along the outline; the two sides through
    /// the centre add nothing.
    fn quarter(&self, x: f64, y: f64) -> f64 {
        let leg = |c: f64| (self.radius * self.radius - c * c).max(0.0).sqrt();
        let (right_end, top_end) = (y.min(leg(x)), x.min(leg(y)));
        let side = |c: f64, end: f64| -> f64 {
            let sum: f64 = RULE
                .iter()
                .map(|(node, weight)| weight * self.profile.cap(c * c + (end * node) * (end * node)))
                .sum();
            c * end * sum
        };
        let mut total = 0.0;
        let mut from = 0.0;
        let mut to = FRAC_PI_2;
        if x < self.radius {
            total += side(x, right_end);
            from = right_end.atan2(x);
        }
        if y < self.radius {
            total += side(y, top_end);
            to = y.atan2(top_end);
        }
        let whole = self.radius * self.radius;
        total + self.profile.cap(whole) * whole * (to - from).max(0.0)
    }
}
