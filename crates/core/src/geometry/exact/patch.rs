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
/// order of `ORDERS`.
#[derive(Clone, Copy, Debug)]
pub struct Accuracy([f64; 5]);

impl Accuracy {
    /// Relative error of about `tolerance` on each piece.
    ///
    /// Gauss's rule of order q misses (1/rho)^2q of an integrand whose nearest pole is at its reach: over a
    /// side h, rho = 4 reach/h for small h, less for large ones.
    pub fn new(tolerance: f64) -> Self {
        Self(ORDERS.map(|q| {
            // rho = z + sqrt(z^2 + 1), z = 2 reach/h, solved for h.
            let rho = tolerance.powf(-0.5 / f64::from(q));
            4.0 * rho / (rho * rho - 1.0)
        }))
    }

    /// The cheapest rule for a piece of this side, in units of the reach; `None` where it must be split.
    pub fn rule(&self, side: f64) -> Option<Rule> {
        let order = self.0.iter().position(|&limit| side <= limit)?;
        Some(&RULES[order])
    }
}

/// The rule of the greatest order.
pub fn finest_rule() -> Rule {
    &RULES[ORDERS.len() - 1]
}

/// A piece of the sphere.
pub trait Patch: Copy {
    /// Centre (unit vector) and the chord of a cap around it that holds the piece.
    fn cap(&self) -> (DVec3, f64);
    /// Its size in units of the distance of the nearest singularity of its own shape.
    fn bend(&self) -> f64 {
        0.0
    }
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
    pub fn rectangle(plane: Plane, low: DVec2, high: DVec2) -> Self {
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        Self { plane, corners }
    }

    /// The triangle `a` `b` `c`.
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

/// A rectangle of a panorama, in longitude about +X and polar angle from +Y, or a part of it.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    longitude: Span,
    polar: Span,
    part: Option<Part>,
}

/// The part of a band in one hemisphere, between two shares of the way along its meridians.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// Towards the middle of the hemisphere.
    direction: DVec3,
    /// How far from the real longitudes its edge's polar angle is singular.
    singular: f64,
    shares: [f64; 2],
}

/// Greatest width in longitude of a [`Part`], over the distance of the nearest singularity of its edge.
const MAX_PART_WIDTH: f64 = 2.0;

impl Band {
    /// The rectangle between two longitudes and two polar angles.
    pub fn new(longitude: [f64; 2], polar: [f64; 2]) -> Self {
        Self { longitude: Span::new(longitude), polar: Span::new(polar), part: None }
    }

    /// The polar angles between which a meridian lies in the band.
    fn ends(&self, longitude: Angle) -> [f64; 2] {
        let (low, high) = (self.polar.low.radians, self.polar.high.radians);
        let Some(Part { direction, shares, .. }) = self.part else { return [low, high] };
        // On the meridian, the cosine to the direction is that of its level part times the sine of the polar
        // angle, plus y times the cosine.
        let level = direction.x * longitude.cosine + direction.z * longitude.sine;
        let turn = direction.y.atan2(level);
        let [from, to] = if direction.y >= 0.0 {
            [low, (PI - turn).clamp(low, high)]
        } else {
            [(-turn).clamp(low, high), high]
        };
        shares.map(|share| from + share * (to - from))
    }

    /// The band's polar angles, from the least to the greatest.
    fn extent(&self) -> Span {
        let Some(Part { direction, .. }) = self.part else { return self.polar };
        let Span { low, middle, high } = self.longitude;
        // The great circle is farthest north and south at the direction's own longitude and across from it.
        let off = (middle.radians - direction.z.atan2(direction.x)).rem_euclid(PI);
        let extreme = middle.radians - if off > PI / 2.0 { off - PI } else { off };
        let extreme = Angle::new(extreme.clamp(low.radians, high.radians));
        let ends = [low, extreme, high].map(|longitude| self.ends(longitude));
        Span::new([
            ends.iter().map(|ends| ends[0]).fold(PI, f64::min),
            ends.iter().map(|ends| ends[1]).fold(0.0, f64::max),
        ])
    }

    /// The longitudes at which the great circle across from `direction` enters or leaves the band, and the
    /// band's own ends; in order.
    fn crossings(&self, direction: DVec3) -> Vec<f64> {
        let (west, east) = (self.longitude.low.radians, self.longitude.high.radians);
        let level = direction.x.hypot(direction.z);
        let mut places = vec![west, east];
        for polar in [self.polar.low, self.polar.high] {
            // Where there is no crossing, the edge's own extremes do no harm.
            let cosine = -direction.y * polar.cosine / (level * polar.sine);
            let turn = cosine.clamp(-1.0, 1.0).acos();
            for turn in [turn, -turn] {
                let place = direction.z.atan2(direction.x) + turn;
                let place = west + (place - west).rem_euclid(2.0 * PI);
                places.extend((place < east).then_some(place));
            }
        }
        places.sort_by(f64::total_cmp);
        places
    }

    /// Calls `keep` with the parts in the hemisphere around `direction`; false where the pole is too near to
    /// the great circle, and the band to be split first.
    pub fn cut_at_hemisphere(&self, direction: DVec3, keep: &mut impl FnMut(Self)) -> bool {
        let singular = (direction.y.abs() / direction.x.hypot(direction.z)).asinh();
        if self.longitude.width() > MAX_PART_WIDTH * singular {
            return false;
        }
        let part = Some(Part { direction, singular, shares: [0.0, 1.0] });
        for ends in self.crossings(direction).windows(2) {
            let piece = Self { longitude: Span::new([ends[0], ends[1]]), part, ..*self };
            let [from, to] = piece.ends(piece.longitude.middle);
            if to - from >= self.polar.width() {
                keep(Self { part: None, ..piece });
            } else if from < to {
                keep(piece);
            }
        }
        true
    }
}

fn band_direction(longitude: Angle, polar: Angle) -> DVec3 {
    DVec3::new(polar.sine * longitude.cosine, polar.cosine, polar.sine * longitude.sine)
}

impl Patch for Band {
    fn cap(&self) -> (DVec3, f64) {
        let (longitude, polar) = (self.longitude, self.extent());
        // The way to any point is along a meridian and then a parallel, the widest one of the piece.
        let widest = if polar.low.radians <= PI / 2.0 && polar.high.radians >= PI / 2.0 {
            1.0
        } else {
            polar.low.sine.max(polar.high.sine)
        };
        let half_size = DVec2::new(longitude.width() / 2.0 * widest, polar.width() / 2.0);
        (band_direction(longitude.middle, polar.middle), half_size.length().min(2.0))
    }

    fn bend(&self) -> f64 {
        self.part.map_or(0.0, |part| self.longitude.width() / part.singular)
    }

    fn split(&self) -> [Self; 4] {
        let [west, east] = self.longitude.halves();
        let [north, south] = match self.part {
            None => self.polar.halves().map(|polar| (polar, None)),
            Some(part) => {
                let [from, to] = part.shares;
                let middle = f64::midpoint(from, to);
                [[from, middle], [middle, to]].map(|shares| (self.polar, Some(Part { shares, ..part })))
            }
        };
        [(west, north), (east, north), (east, south), (west, south)].map(|(longitude, (polar, part))| Self {
            longitude,
            polar,
            part,
        })
    }

    fn sample(&self, rule: &[(f64, f64)], visit: &mut impl FnMut(Sample)) {
        // Room for the greatest order.
        let mut polars = [self.polar.middle; ORDERS[ORDERS.len() - 1] as usize];
        for (polar, &(b, _)) in polars.iter_mut().zip(rule) {
            *polar = self.polar.at(b);
        }
        for &(a, weight_a) in rule {
            let longitude = self.longitude.at(a);
            let [from, to] = self.ends(longitude);
            let area = weight_a * self.longitude.width() * (to - from);
            for (&polar, &(b, weight_b)) in polars.iter().zip(rule) {
                let polar = if self.part.is_some() { Angle::new(from + b * (to - from)) } else { polar };
                visit(Sample {
                    point: band_direction(longitude, polar),
                    length_squared: 1.0,
                    weight: area * weight_b * polar.sine,
                });
            }
        }
    }
}
