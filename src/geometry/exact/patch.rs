//! Pieces of the sphere with Gauss's rules over them: flat pieces of a cube face or an octahedron face, whose
//! central projection is the map, and bands of a panorama.

use crate::sphere::quadrature::gauss_legendre;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// The orders in use.
const ORDERS: [u32; 5] = [2, 3, 4, 6, 8];
static RULES: LazyLock<[Vec<(f64, f64)>; 5]> = LazyLock::new(|| ORDERS.map(gauss_legendre));

/// A quadrature point: where (any length), the squared length and the weight, a solid angle.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// A point in the direction.
    pub point: DVec3,
    /// Its squared length.
    pub length_squared: f64,
    /// Solid angle.
    pub weight: f64,
}

/// Nodes in (0, 1) and weights.
pub type Rule = &'static [(f64, f64)];

/// How exact an integral is to be: the greatest side of a piece, in units of the integrand's reach, for each
/// order of [`ORDERS`].
#[derive(Clone, Copy, Debug)]
pub struct Accuracy([f64; 5]);

impl Accuracy {
    /// Relative error of about `tolerance` on each piece.
    ///
    /// Gauss's rule of order q misses (1/rho)^2q of an integrand whose nearest pole is at its reach: over a
    /// side h, rho = 4 reach/h for small h, less for large ones.
    #[must_use]
    pub fn new(tolerance: f64) -> Self {
        Self(ORDERS.map(|q| {
            // rho = z + sqrt(z^2 + 1), z = 2 reach/h, solved for h.
            let rho = tolerance.powf(-0.5 / f64::from(q));
            4.0 * rho / (rho * rho - 1.0)
        }))
    }

    /// The cheapest rule for a piece of this side, in units of the reach; `None` where it must be split.
    #[must_use]
    pub fn rule(&self, side: f64) -> Option<Rule> {
        let order = self.0.iter().position(|&limit| side <= limit)?;
        Some(&RULES[order])
    }
}

/// The rule of the greatest order.
#[must_use]
pub fn finest_rule() -> Rule {
    &RULES[ORDERS.len() - 1]
}

/// A piece of the sphere.
pub trait Patch: Copy {
    /// Centre (unit vector) and the chord of a cap around it that holds the piece.
    fn cap(&self) -> (DVec3, f64);
    /// Four pieces that make up this one.
    fn split(&self) -> [Self; 4];
    /// Calls `visit` at every point of a product rule.
    fn sample(&self, rule: &[(f64, f64)], visit: &mut impl FnMut(Sample));
}

/// A plane of points `origin + u * along_u + v * along_v`, one face of a cube or an octahedron, such that the
/// solid angle of du dv is 1/|point|^3.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// The point at (0, 0).
    pub origin: DVec3,
    /// Its change with u.
    pub along_u: DVec3,
    /// Its change with v.
    pub along_v: DVec3,
}

impl Plane {
    /// The point at (u, v).
    #[must_use]
    pub fn point(&self, uv: DVec2) -> DVec3 {
        self.origin + self.along_u * uv.x + self.along_v * uv.y
    }
}

/// A quadrilateral of a plane, bilinear between its corners in the order 00 10 11 01; a triangle repeats its
/// first.
#[derive(Clone, Copy, Debug)]
pub struct Flat {
    /// The plane.
    pub plane: Plane,
    /// Coordinates of the corners.
    pub corners: [DVec2; 4],
}

impl Flat {
    /// The rectangle from `low` to `high`.
    #[must_use]
    pub fn rectangle(plane: Plane, low: DVec2, high: DVec2) -> Self {
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        Self { plane, corners }
    }

    /// The triangle `a` `b` `c`.
    #[must_use]
    pub const fn triangle(plane: Plane, a: DVec2, b: DVec2, c: DVec2) -> Self {
        Self { plane, corners: [a, b, c, a] }
    }

    fn at(&self, a: f64, b: f64) -> DVec2 {
        let [c00, c10, c11, c01] = self.corners;
        (c00 * (1.0 - a) + c10 * a) * (1.0 - b) + (c01 * (1.0 - a) + c11 * a) * b
    }
}

impl Patch for Flat {
    fn cap(&self) -> (DVec3, f64) {
        let corners = self.corners.map(|c| self.plane.point(c));
        let middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
        let length = middle.length();
        // Two points project to no more than their distance over the lesser of their lengths.
        let spread = corners.iter().map(|c| c.distance_squared(middle)).fold(0.0, f64::max).sqrt();
        // No point of the piece is nearer to the centre of the sphere than the plane.
        let normal = self.plane.along_u.cross(self.plane.along_v);
        let floor = (normal.dot(self.plane.origin) / normal.length()).abs();
        (middle / length, (spread / (length - spread).max(floor)).min(2.0))
    }

    fn split(&self) -> [Self; 4] {
        let quarter = |a: f64, b: f64| Self {
            corners: [self.at(a, b), self.at(a + 0.5, b), self.at(a + 0.5, b + 0.5), self.at(a, b + 0.5)],
            ..*self
        };
        [quarter(0.0, 0.0), quarter(0.5, 0.0), quarter(0.5, 0.5), quarter(0.0, 0.5)]
    }

    fn sample(&self, rule: &[(f64, f64)], visit: &mut impl FnMut(Sample)) {
        let [c00, c10, c11, c01] = self.corners;
        for &(b, weight_b) in rule {
            let along_a = (c10 - c00) * (1.0 - b) + (c11 - c01) * b;
            let start = c00 * (1.0 - b) + c01 * b;
            for &(a, weight_a) in rule {
                let along_b = (c01 - c00) * (1.0 - a) + (c11 - c10) * a;
                let uv = start + along_a * a;
                let point = self.plane.point(uv);
                let length_squared = point.length_squared();
                let area = weight_a * weight_b * along_a.perp_dot(along_b).abs();
                let weight = area / (length_squared * length_squared.sqrt());
                visit(Sample { point, length_squared, weight });
            }
        }
    }
}

/// An angle with its sine and cosine.
#[derive(Clone, Copy, Debug)]
struct Angle {
    radians: f64,
    sine: f64,
    cosine: f64,
}

impl Angle {
    fn new(radians: f64) -> Self {
        let (sine, cosine) = radians.sin_cos();
        Self { radians, sine, cosine }
    }
}

/// An interval of angles.
#[derive(Clone, Copy, Debug)]
struct Span {
    low: Angle,
    middle: Angle,
    high: Angle,
}

impl Span {
    fn new([low, high]: [f64; 2]) -> Self {
        Self::between(Angle::new(low), Angle::new(high))
    }

    fn between(low: Angle, high: Angle) -> Self {
        Self { low, middle: Angle::new(f64::midpoint(low.radians, high.radians)), high }
    }

    fn width(&self) -> f64 {
        self.high.radians - self.low.radians
    }

    fn halves(&self) -> [Self; 2] {
        [Self::between(self.low, self.middle), Self::between(self.middle, self.high)]
    }

    /// The angle at `share` of the way from the low end.
    fn at(&self, share: f64) -> Angle {
        Angle::new(self.low.radians + share * self.width())
    }
}

/// A rectangle of a panorama, in longitude about +X and polar angle from +Y.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    longitude: Span,
    polar: Span,
}

impl Band {
    /// The rectangle between two longitudes and two polar angles.
    #[must_use]
    pub fn new(longitude: [f64; 2], polar: [f64; 2]) -> Self {
        Self { longitude: Span::new(longitude), polar: Span::new(polar) }
    }
}

fn band_direction(longitude: Angle, polar: Angle) -> DVec3 {
    DVec3::new(polar.sine * longitude.cosine, polar.cosine, polar.sine * longitude.sine)
}

impl Patch for Band {
    fn cap(&self) -> (DVec3, f64) {
        let Self { longitude, polar } = self;
        // The way to any point is along a meridian and then a parallel, the widest one of the piece.
        let widest = if polar.low.radians <= PI / 2.0 && polar.high.radians >= PI / 2.0 {
            1.0
        } else {
            polar.low.sine.max(polar.high.sine)
        };
        let half_size = DVec2::new(longitude.width() / 2.0 * widest, polar.width() / 2.0);
        (band_direction(longitude.middle, polar.middle), half_size.length().min(2.0))
    }

    fn split(&self) -> [Self; 4] {
        let ([west, east], [north, south]) = (self.longitude.halves(), self.polar.halves());
        [(west, north), (east, north), (east, south), (west, south)]
            .map(|(longitude, polar)| Self { longitude, polar })
    }

    fn sample(&self, rule: &[(f64, f64)], visit: &mut impl FnMut(Sample)) {
        let area = self.longitude.width() * self.polar.width();
        // Room for the greatest order.
        let mut longitudes = [self.longitude.middle; ORDERS[ORDERS.len() - 1] as usize];
        for (longitude, &(a, _)) in longitudes.iter_mut().zip(rule) {
            *longitude = self.longitude.at(a);
        }
        for &(b, weight_b) in rule {
            let polar = self.polar.at(b);
            for (&longitude, &(_, weight_a)) in longitudes.iter().zip(rule) {
                visit(Sample {
                    point: band_direction(longitude, polar),
                    length_squared: 1.0,
                    weight: weight_a * weight_b * area * polar.sine,
                });
            }
        }
    }
}
