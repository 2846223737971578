//! Maps of the sphere, one file each: both direction maps, domains, components, texels' exact solid angles
//! and neighbours across edges.
//!
//! [`map::SphereMap`] is their interface, [`registry::MAPS`] lists them, [`grid::Grid`] divides one into
//! texels. The three maps that store environments also have free functions, `x_from_direction` and
//! `direction_from_x`.
//!
//! Directions are unit vectors in a right-handed space with y up. Texel centres are half-integer everywhere.

mod azimuthal;
pub mod cube;
pub mod dual;
pub mod equirect;
pub mod grid;
pub mod healpix;
pub mod low_distortion;
pub mod map;
pub mod octahedral;
pub mod octahedral_perspective;
pub mod octahedral_rectangular;
pub mod oem_lookup;
pub mod polar_capped;
pub mod quadrature;
pub mod registry;
pub mod rhombic_dodecahedron;
pub mod tennis_ball;

use glam::DVec3;
use std::ops::{Add, Mul};

/// Sutherland and Hodgman 1974: the part of a convex polygon where `depth` is not negative.
pub(crate) fn clip<P>(corners: &[P], depth: impl Fn(P) -> f64, part: &mut Vec<P>)
where
    P: Copy + Add<Output = P> + Mul<f64, Output = P>,
{
    part.clear();
    for (k, &a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        let (depth_a, depth_b) = (depth(a), depth(b));
        if depth_a >= 0.0 {
            part.push(a);
        }
        if (depth_a > 0.0 && depth_b < 0.0) || (depth_a < 0.0 && depth_b > 0.0) {
            let share = depth_a / (depth_a - depth_b);
            part.push(a * (1.0 - share) + b * share);
        }
    }
}

/// Signed solid angle of the spherical triangle `a b c` (unit vectors), positive when they run
/// counter-clockwise seen from outside.
///
/// Van Oosterom and Strackee 1983, equation 8; exact for every triangle smaller than a hemisphere.
pub(crate) fn triangle_solid_angle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    // (a x b).c from differences: three nearby vectors would cancel in the plain triple product.
    let numerator = (b - a).cross(c - a).dot(a);
    let denominator = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
    2.0 * numerator.atan2(denominator)
}

/// Unsigned solid angle of a convex spherical polygon (unit vectors in order): a fan of triangles.
pub(crate) fn polygon_solid_angle(corners: &[DVec3]) -> f64 {
    let Some((&first, rest)) = corners.split_first() else { return 0.0 };
    rest.windows(2).map(|edge| triangle_solid_angle(first, edge[0], edge[1])).sum::<f64>().abs()
}

/// [`polygon_solid_angle`] of a polygon of at most six corners of any length, seen from the centre.
pub(crate) fn projected_solid_angle(corners: &[DVec3]) -> f64 {
    let mut unit = [DVec3::ZERO; 6];
    for (unit, corner) in unit.iter_mut().zip(corners) {
        *unit = corner.normalize();
    }
    polygon_solid_angle(&unit[..corners.len()])
}
