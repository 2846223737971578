//! The rhombic dodecahedron: twelve rhombi, each sheared to a square.
//!
//! Fu, Wan, Wong and Leung 2009 (*The Rhombic Dodecahedron Map*) subdivide its spherical faces; here a face
//! is projected to its plane, and the plane sheared to the square, which keeps great circles straight.
//! Derived from the solid's geometry.
//!
//! Component 4k + 2s + t has its axis pair k in (x, y), (y, z), (z, x), with signs s, t (0 positive, 1
//! negative): the face through (2, 0, 0), (1, 1, 1), (0, 2, 0) and (1, 1, -1) and its images. u = v = 0 at
//! the pair's first axis, u = v = 1 at its second, u grows towards the third axis and v away from it. Outside
//! a square its plane continues.

use super::map::{Component, Place, SphereMap};
use super::projected_solid_angle;
use glam::{DVec2, DVec3};

/// The map.
#[derive(Clone, Copy, Debug)]
pub struct RhombicDodecahedron;

/// Permutes x, y, z to a pair's first, second and third axis.
fn turned(d: DVec3, pair: u32) -> DVec3 {
    match pair {
        0 => d,
        1 => DVec3::new(d.y, d.z, d.x),
        _ => DVec3::new(d.z, d.x, d.y),
    }
}

/// Signs of a face's first and second axis.
fn signs(component: u32) -> DVec3 {
    let sign = |bit: u32| if component & bit == 0 { 1.0 } else { -1.0 };
    DVec3::new(sign(2), sign(1), 1.0)
}

/// Point of the dodecahedron at `uv` of `component`.
fn point(component: u32, uv: DVec2) -> DVec3 {
    let sum = uv.x + uv.y;
    let local = DVec3::new(2.0 - sum, sum, uv.x - uv.y) * signs(component);
    turned(local, (3 - component / 4) % 3)
}

impl SphereMap for RhombicDodecahedron {
    fn components(&self) -> u32 {
        12
    }

    fn component(&self, index: u32) -> Component {
        Component { low: DVec2::ZERO, high: DVec2::ONE, cells: [1, 1], at: [index % 4, index / 4] }
    }

    fn direction(&self, component: u32, uv: DVec2) -> DVec3 {
        point(component, uv).normalize()
    }

    fn locate(&self, direction: DVec3) -> Place {
        let a = direction.abs();
        // The face of the two greatest coordinates: all but the least.
        let pair = if a.z <= a.x && a.z <= a.y {
            0
        } else if a.x <= a.y {
            1
        } else {
            2
        };
        let d = turned(direction, pair);
        let component = 4 * pair + 2 * u32::from(d.x < 0.0) + u32::from(d.y < 0.0);
        let scale = 2.0 / (d.x.abs() + d.y.abs());
        let (second, third) = (d.y.abs() * scale, d.z * scale);
        Place { component, uv: DVec2::new(second + third, second - third) / 2.0 }
    }

    fn density(&self, component: u32, uv: DVec2) -> f64 {
        let squared = point(component, uv).length_squared();
        // The rhombus' edges (-1, 1, 1) and (-1, 1, -1) span 2 sqrt(2) at the distance sqrt(2).
        4.0 / (squared * squared.sqrt())
    }

    fn solid_angle(&self, component: u32, low: DVec2, high: DVec2) -> f64 {
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        projected_solid_angle(&corners.map(|uv| point(component, uv)))
    }

    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        let Place { component, uv } = place;
        Some(match (axis + 3 - component as usize / 4) % 3 {
            0 => Place { component: component ^ 2, uv },
            1 => Place { component: component ^ 1, uv },
            _ => Place { component, uv: DVec2::new(uv.y, uv.x) },
        })
    }
}
