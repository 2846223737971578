//! The octahedral map, rectangular layout: 2:1, a hemisphere a half.
//!
//! Engelhardt and Dachsbacher 2008, equation 3: with p on the octahedron, (p.x - p.z - 1, p.x + p.z) where
//! p.y >= 0 and (p.z - p.x + 1, p.x + p.z) elsewhere, on [-2, 2] x [-1, 1]. Directions are continuous across
//! the halves' common side u = 0, and from u = 2 to u = -2; the sides v = 1 and v = -1 are each glued to
//! themselves, turned by 180 degrees about u = 0. The rectangle repeats over the plane with period 4 along u,
//! turned in every other row of rectangles.

use super::map::{Component, Place, SphereMap, Texel};
use super::octahedral::octahedron_from_oct;
use super::{clip, projected_solid_angle};
use glam::{DVec2, DVec3};

/// The map.
#[derive(Clone, Copy, Debug)]
pub struct OctahedralRectangular;

/// The point of the rectangle equivalent to `uv`, anywhere on the unfolded plane.
fn wrap(uv: DVec2) -> DVec2 {
    if uv.x.abs() <= 2.0 && uv.y.abs() <= 1.0 {
        return uv;
    }
    let row = ((uv.y + 1.0) / 2.0).floor();
    let inside = DVec2::new(uv.x, uv.y - 2.0 * row);
    let turned = if row.rem_euclid(2.0) == 1.0 { -inside } else { inside };
    DVec2::new((turned.x + 2.0).rem_euclid(4.0) - 2.0, turned.y)
}

/// (p.x, p.z) of the half's own plane at `uv`, and the sign of p.y in its middle.
fn plane(uv: DVec2) -> (DVec2, f64) {
    if uv.x < 0.0 {
        let s = uv.x + 1.0;
        (DVec2::new(uv.y + s, uv.y - s) / 2.0, 1.0)
    } else {
        let s = uv.x - 1.0;
        (DVec2::new(uv.y - s, uv.y + s) / 2.0, -1.0)
    }
}

impl SphereMap for OctahedralRectangular {
    fn component(&self, _: u32) -> Component {
        let high = DVec2::new(2.0, 1.0);
        Component { low: -high, high, cells: [2, 1], at: [0, 0] }
    }

    fn direction(&self, _: u32, uv: DVec2) -> DVec3 {
        let (p, sign) = plane(wrap(uv));
        let point = octahedron_from_oct(p);
        DVec3::new(point.x, point.y * sign, point.z).normalize()
    }

    fn locate(&self, direction: DVec3) -> Place {
        let p = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs());
        let v = p.x + p.z;
        let u = if p.y >= 0.0 { p.x - p.z - 1.0 } else { p.z - p.x + 1.0 };
        Place { component: 0, uv: DVec2::new(u, v) }
    }

    fn density(&self, _: u32, uv: DVec2) -> f64 {
        let (p, _) = plane(uv);
        let squared = octahedron_from_oct(p).length_squared();
        // A unit of area is half of one in the quadratic layout.
        0.5 / (squared * squared.sqrt())
    }

    fn solid_angle(&self, _: u32, low: DVec2, high: DVec2) -> f64 {
        let halves = [(low.x, high.x.min(0.0)), (low.x.max(0.0), high.x)];
        let mut total = 0.0;
        for ((left, right), middle) in halves.into_iter().zip([-1.0, 1.0]) {
            if left >= right {
                continue;
            }
            // The four faces meet in the half's middle, along its diagonals.
            for [sx, sz] in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                let mut corners = vec![
                    DVec2::new(left, low.y),
                    DVec2::new(right, low.y),
                    DVec2::new(right, high.y),
                    DVec2::new(left, high.y),
                ];
                for corner in &mut corners {
                    // The half is `middle`'s, also for corners on the common side.
                    let s = corner.x - middle;
                    let (x, z) = if middle < 0.0 {
                        (corner.y + s, corner.y - s)
                    } else {
                        (corner.y - s, corner.y + s)
                    };
                    *corner = DVec2::new(x, z) / 2.0;
                }
                let [mut half, mut piece] = [const { Vec::new() }; 2];
                clip(&corners, |c| sx * c.x, &mut half);
                clip(&half, |c| sz * c.y, &mut piece);
                if piece.len() >= 3 {
                    let on_face: Vec<DVec3> =
                        piece.iter().map(|c| DVec3::new(c.x, 1.0 - c.x.abs() - c.y.abs(), c.y)).collect();
                    total += projected_solid_angle(&on_face);
                }
            }
        }
        total
    }

    fn wrap_texel(&self, size: u32, component: u32, x: i64, y: i64) -> Option<Texel> {
        let (width, height) = (2 * i64::from(size), i64::from(size));
        let inside = y.rem_euclid(height);
        let turned = y.div_euclid(height).rem_euclid(2) == 1;
        let (x, y) = if turned { (width - 1 - x, height - 1 - inside) } else { (x, inside) };
        let index = |k: i64| u32::try_from(k).expect("inside the rectangle");
        Some(Texel { component, x: index(x.rem_euclid(width)), y: index(y) })
    }

    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        if axis == 1 {
            return Some(Place { uv: DVec2::new(-place.uv.x, place.uv.y), ..place });
        }
        // The other two planes are the diagonals of each half.
        let middle = DVec2::new(1.0_f64.copysign(place.uv.x), 0.0);
        let off = place.uv - middle;
        let is_falling = (axis == 0) == (middle.x < 0.0);
        let uv = middle + if is_falling { DVec2::new(-off.y, -off.x) } else { DVec2::new(off.y, off.x) };
        Some(Place { uv, ..place })
    }
}
