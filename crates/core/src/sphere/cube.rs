//! The cube map: six faces in the order +X -X +Y -Y +Z -Z, each with the s_c/t_c axes of OpenGL, Vulkan and
//! Direct3D. Texel (i, j) of an n x n face lies at s = (i + 1/2)/n*2 - 1, t downwards by the same formula.

use super::map::{Place, SphereMap};
use glam::{DVec2, DVec3};

/// The map: component k is face k, u is s and v is t; outside a face its plane continues, to 90 degrees from
/// its centre.
#[derive(Clone, Copy, Debug)]
pub struct Cube;

impl SphereMap for Cube {
    fn components(&self) -> u32 {
        6
    }

    fn direction(&self, component: u32, uv: DVec2) -> DVec3 {
        direction_from_cube(Face::ALL[component as usize], uv.x, uv.y)
    }

    fn locate(&self, direction: DVec3) -> Place {
        let (face, s, t) = cube_from_direction(direction);
        Place { component: face as u32, uv: DVec2::new(s, t) }
    }

    fn density(&self, _: u32, uv: DVec2) -> f64 {
        let squared = 1.0 + uv.length_squared();
        1.0 / (squared * squared.sqrt())
    }

    fn solid_angle(&self, _: u32, low: DVec2, high: DVec2) -> f64 {
        rectangle_solid_angle(low, high)
    }

    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        let own = place.component as usize / 2;
        if axis == own {
            // s of opposite faces runs in opposite directions, on the faces +-Y t.
            let signs = if own == 1 { DVec2::new(1.0, -1.0) } else { DVec2::new(-1.0, 1.0) };
            return Some(Place { component: place.component ^ 1, uv: place.uv * signs });
        }
        // t runs along y, on the faces +-Y along z.
        let down = if own == 1 { 2 } else { 1 };
        let signs = if axis == down { DVec2::new(1.0, -1.0) } else { DVec2::new(-1.0, 1.0) };
        Some(Place { uv: place.uv * signs, ..place })
    }
}

/// A face of the cube, in storage order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Face {
    /// +X: direction (1, -t, -s).
    PosX,
    /// -X: direction (-1, -t, s).
    NegX,
    /// +Y: direction (s, 1, t).
    PosY,
    /// -Y: direction (s, -1, -t).
    NegY,
    /// +Z: direction (s, -t, 1).
    PosZ,
    /// -Z: direction (-s, -t, -1).
    NegZ,
}

impl Face {
    /// All six, in storage order.
    pub const ALL: [Self; 6] = [Self::PosX, Self::NegX, Self::PosY, Self::NegY, Self::PosZ, Self::NegZ];

    /// Position in [`Face::ALL`].
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The two letters of file names: `px`, `nx`, `py`, `ny`, `pz`, `nz`.
    #[must_use]
    pub const fn short_name(self) -> &'static str {
        ["px", "nx", "py", "ny", "pz", "nz"][self as usize]
    }
}

/// Point on the cube (not normalised) at `s`, `t` in [-1, 1] of `face`.
pub fn cube_point(face: Face, s: f64, t: f64) -> DVec3 {
    match face {
        Face::PosX => DVec3::new(1.0, -t, -s),
        Face::NegX => DVec3::new(-1.0, -t, s),
        Face::PosY => DVec3::new(s, 1.0, t),
        Face::NegY => DVec3::new(s, -1.0, -t),
        Face::PosZ => DVec3::new(s, -t, 1.0),
        Face::NegZ => DVec3::new(-s, -t, -1.0),
    }
}

/// Unit direction at `s`, `t` in [-1, 1] of `face`.
pub fn direction_from_cube(face: Face, s: f64, t: f64) -> DVec3 {
    cube_point(face, s, t).normalize()
}

/// s and t of the centre of texel (`i`, `j`) of an `n` x `n` face.
pub(crate) fn cube_from_texel(n: u32, i: u32, j: u32) -> [f64; 2] {
    let scale = 2.0 / f64::from(n);
    [i, j].map(|k| (f64::from(k) + 0.5) * scale - 1.0)
}

/// Unit direction of the centre of texel (`i`, `j`) of an `n` x `n` face.
pub fn direction_from_texel(face: Face, n: u32, i: u32, j: u32) -> DVec3 {
    let [s, t] = cube_from_texel(n, i, j);
    direction_from_cube(face, s, t)
}

/// The face that `direction` (any length but zero) points through, and s, t in [-1, 1] on it.
///
/// On edges and corners the axis first in x, y, z order among the greatest wins.
pub fn cube_from_direction(direction: DVec3) -> (Face, f64, f64) {
    let d = direction;
    let a = d.abs();
    if a.x >= a.y && a.x >= a.z {
        if d.x >= 0.0 { (Face::PosX, -d.z / a.x, -d.y / a.x) } else { (Face::NegX, d.z / a.x, -d.y / a.x) }
    } else if a.y >= a.z {
        if d.y >= 0.0 { (Face::PosY, d.x / a.y, d.z / a.y) } else { (Face::NegY, d.x / a.y, -d.z / a.y) }
    } else if d.z >= 0.0 {
        (Face::PosZ, d.x / a.z, -d.y / a.z)
    } else {
        (Face::NegZ, -d.x / a.z, -d.y / a.z)
    }
}

/// Index of the texel in column `x` and row `y` of `face`, which may be one outside: faces of `size` texels
/// along an edge, in storage order.
pub(crate) fn texel_around(size: u32, face: Face, x: i64, y: i64) -> usize {
    let n = f64::from(size);
    let coordinate = |k: i64| (k as f64 + 0.5) / n * 2.0 - 1.0;
    let (face, s, t) = cube_from_direction(cube_point(face, coordinate(x), coordinate(y)));
    // A point one texel outside projects to the adjacent row of the neighbour, at the same position: s/(1 +
    // 1/n) stays in its texel.
    let texel = |c: f64| (((c + 1.0) / 2.0 * n) as usize).min(size as usize - 1);
    (face.index() * size as usize + texel(t)) * size as usize + texel(s)
}

/// Solid angle of the rectangle from the face's centre to (`s`, `t`), signed by s*t.
fn quadrant_solid_angle(s: f64, t: f64) -> f64 {
    (s * t).atan2((s * s + t * t + 1.0).sqrt())
}

/// Exact solid angle of the rectangle of a face from `low` to `high`.
fn rectangle_solid_angle(low: DVec2, high: DVec2) -> f64 {
    quadrant_solid_angle(high.x, high.y)
        - quadrant_solid_angle(low.x, high.y)
        - quadrant_solid_angle(high.x, low.y)
        + quadrant_solid_angle(low.x, low.y)
}

/// Exact solid angle of texel (`i`, `j`) of an `n` x `n` face, in steradians.
pub fn texel_solid_angle(n: u32, i: u32, j: u32) -> f64 {
    let edge = |k: u32| f64::from(k) / f64::from(n) * 2.0 - 1.0;
    rectangle_solid_angle(DVec2::new(edge(i), edge(j)), DVec2::new(edge(i + 1), edge(j + 1)))
}
