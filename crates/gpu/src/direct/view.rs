//! View of one draw: an octant of the octahedral map in either layout, or a face of a cube.
//!
//! In the octant of the signs s the planar projection is projective. With w = s.x x + s.y y + s.z z and
//! m = max(-s.y, 0), the square's coordinates are u = (x - m s.x y) / w and v = (z - m s.z y) / w: equation 2
//! of Engelhardt and Dachsbacher 2008 with 1 - |p.z| written as |p.x| + |p.y|. The rectangle's, by equation
//! 3, are u = (x - z - w) / w for y >= 0, u = (z - x + w) / w for y < 0, and v = (x + z) / w. Clip z is the
//! near distance, so that depth is near / w, which is continuous across folds.

use crate::triangles::DirectMap;
use glam::DVec3;
use octagloss_core::sphere::cube::{Face, cube_point};

/// Views of a target, at most: shaders have room for as many.
pub const VIEWS: usize = 8;

/// Planes that bound a view.
pub const PLANES: usize = 5;

/// Pixels by which the planes lie outside of the view.
const MARGIN: f64 = 2.0;

/// Uniform of a draw.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct View {
    clip_from_scene: [[f32; 4]; 4],
    /// The scene's origin.
    pub(super) centre: [f32; 3],
    size: u32,
    octant: u32,
    squares: u32,
    pad: [u32; 2],
}

/// A plane: inside is where the product with (x, y, z, 1) is not negative.
pub(super) type Plane = [f32; 4];

/// No plane: everything is inside.
const EVERYWHERE: Plane = [0.0, 0.0, 0.0, 1.0];

/// Planes of no view: nothing is inside.
pub(super) const NOWHERE: [Plane; PLANES] = [[0.0, 0.0, 0.0, -1.0]; PLANES];

/// A view with what limits its draw.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounded {
    pub(super) view: View,
    pub(super) planes: [Plane; PLANES],
    /// Left, top, width and height of the pixels that may change.
    pub(super) scissor: [u32; 4],
}

/// A matrix from the rows of clip x, y and w; clip z is `near`.
fn view(rows: [DVec3; 3], near: f32, map: DirectMap, octant: u32) -> View {
    let [x, y, w] = rows.map(|row| row.as_vec3());
    let column = |k: usize| [x[k], y[k], 0.0, w[k]];
    let clip_from_scene = [column(0), column(1), column(2), [0.0, 0.0, near, 0.0]];
    let (size, squares) = (map.size(), map.squares());
    View { clip_from_scene, centre: [0.0; 3], size, octant, squares, pad: [0; 2] }
}

fn plane(normal: DVec3, offset: f32) -> Plane {
    normal.as_vec3().extend(offset).to_array()
}

/// Signs of the coordinates in `octant`: bits 1 for x < 0, 2 for y < 0, 4 for z < 0.
fn signs(octant: u32) -> DVec3 {
    let sign = |bit: u32| if octant & bit == 0 { 1.0 } else { -1.0 };
    DVec3::new(sign(1), sign(2), sign(4))
}

/// The eight octants of an octahedral map of even size, in either layout.
pub(super) fn octants(map: DirectMap, near: f32) -> Vec<Bounded> {
    // A pixel in the map's coordinates, by which the planes are tilted.
    let margin = MARGIN * 2.0 / f64::from(map.size());
    (0..8)
        .map(|octant| {
            let s = signs(octant);
            let ([u, v], scissor) = match map {
                DirectMap::Rectangular { size } => of_rectangle(s, size),
                _ => of_square(s, map.size()),
            };
            let side = |axis: DVec3| plane(axis * s + margin * s, 0.0);
            Bounded {
                // Rows of pixels go downwards, as v does; clip y upwards.
                view: view([u, -v, s], near, map, octant),
                planes: [side(DVec3::X), side(DVec3::Y), side(DVec3::Z), plane(s, -near), EVERYWHERE],
                scissor,
            }
        })
        .collect()
}

/// Rows of u and v of the octant of signs `s` in the square, from -1 to 1, and the pixels around the octant.
fn of_square(s: DVec3, size: u32) -> ([DVec3; 2], [u32; 4]) {
    let half = size / 2;
    let fold = if s.y < 0.0 { 1.0 } else { 0.0 };
    let start = |sign: f64| if sign < 0.0 { 0 } else { half };
    let rows = [DVec3::new(1.0, -fold * s.x, 0.0), DVec3::new(0.0, -fold * s.z, 1.0)];
    (rows, [start(s.x), start(s.z), half, half])
}

/// Octants of the rectangle, both rows from -1 to 1.
fn of_rectangle(s: DVec3, size: u32) -> ([DVec3; 2], [u32; 4]) {
    let half = size / 2;
    let (left, side) = if s.y < 0.0 { (size, 1.0) } else { (0, -1.0) };
    let rows = [0.5 * side * (s + DVec3::Z - DVec3::X), DVec3::X + DVec3::Z];
    // A quarter of its square, between the diagonals: below or above the middle, or beside it.
    let scissor = if s.x == s.z {
        [left, if s.x < 0.0 { 0 } else { half }, size, half]
    } else {
        [left + if s.x * side > 0.0 { 0 } else { half }, 0, half, size]
    };
    (rows, scissor)
}

/// The whole octahedral map, for pieces of triangles that carry their octants.
pub(super) fn whole(map: DirectMap, near: f32) -> Bounded {
    // Shaders compute coordinates by the octant of each corner, and read only clip z of the matrix.
    let view = view([DVec3::ZERO; 3], near, map, 0);
    Bounded { view, planes: NOWHERE, scissor: [0, 0, map.squares() * map.size(), map.size()] }
}

/// The six faces of a cube with edges of `size` pixels; the near surface is a cube.
pub(super) fn faces(size: u32, near: f32) -> Vec<Bounded> {
    let map = DirectMap::Cube { size };
    let margin = MARGIN * 2.0 / f64::from(size);
    Face::ALL
        .iter()
        .map(|face| {
            let axis = cube_point(*face, 0.0, 0.0);
            let s = cube_point(*face, 1.0, 0.0) - axis;
            let t = cube_point(*face, 0.0, 1.0) - axis;
            let side = |across: DVec3| plane(axis * (1.0 + margin) + across, 0.0);
            Bounded {
                view: view([s, -t, axis], near, map, 0),
                planes: [side(s), side(-s), side(t), side(-t), plane(axis, -near)],
                scissor: [0, 0, size, size],
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{faces, octants};
    use crate::triangles::DirectMap;
    use glam::{DVec2, DVec3};
    use octagloss_core::sphere::cube::{Face, direction_from_cube};
    use octagloss_core::sphere::map::SphereMap;
    use octagloss_core::sphere::octahedral_perspective::PLANAR;
    use octagloss_core::sphere::octahedral_rectangular::OctahedralRectangular;

    /// Clip coordinates of `position`.
    fn clip(matrix: [[f32; 4]; 4], position: DVec3) -> [f64; 4] {
        let at = position.extend(1.0).to_array();
        std::array::from_fn(|row| (0..4).map(|k| f64::from(matrix[k][row]) * at[k]).sum())
    }

    #[test]
    fn matrices_of_octants_are_the_maps_of_the_sphere() {
        let maps: [(DirectMap, &dyn SphereMap); 2] = [
            (DirectMap::Octahedral { size: 64 }, &PLANAR),
            (DirectMap::Rectangular { size: 64 }, &OctahedralRectangular),
        ];
        for (map, of_sphere) in maps {
            let views = octants(map, 0.25);
            let high = of_sphere.component(0).high;
            for k in 0..1000_u32 {
                // Off the sides of squares, where a direction has two places.
                let place = DVec2::new(f64::from(k * 37 % 997), f64::from(k * 61 % 991)) + 0.25;
                let uv = place / 500.0 - 1.0;
                let position = of_sphere.direction(0, uv * high) * 3.0;
                assert!((of_sphere.locate(position).uv - uv * high).length() < 1e-12);
                let bit = |x: f64, bit: u32| if x.is_sign_negative() { bit } else { 0 };
                let octant = bit(position.x, 1) | bit(position.y, 2) | bit(position.z, 4);
                let bounded = &views[octant as usize];
                assert_eq!(bounded.view.octant, octant);
                let [x, y, z, w] = clip(bounded.view.clip_from_scene, position);
                assert!((DVec2::new(x / w, -y / w) - uv).length() < 1e-6, "{position}: {x} {y} {w}");
                assert!((z / w - 0.25 / position.abs().element_sum()).abs() < 1e-6);
                let squares = DVec2::new(f64::from(map.squares()), 1.0);
                let pixel = ((uv + 1.0) * 32.0 * squares).to_array().map(|x| x as u32);
                let [left, top, width, height] = bounded.scissor;
                assert!((left..left + width).contains(&pixel[0]) && (top..top + height).contains(&pixel[1]));
                for plane in bounded.planes {
                    assert!(position.as_vec3().extend(1.0).dot(plane.into()) > 0.0, "{plane:?}");
                }
            }
        }
    }

    #[test]
    fn planes_lie_two_pixels_outside() {
        // Along v = 0.3 from the inner side of octant 0, the plane is at u = -2 pixels.
        let views = octants(DirectMap::Octahedral { size: 64 }, 0.01);
        let pixel = 2.0 / 64.0;
        let height = |u: f64| {
            // The octant's own map, also beyond its side.
            let position = DVec3::new(u, 1.0 - u - 0.3, 0.3);
            position.as_vec3().extend(1.0).dot(views[0].planes[0].into())
        };
        assert!(height(-1.9 * pixel) > 0.0 && height(-2.1 * pixel) < 0.0);
    }

    #[test]
    fn matrices_of_faces_are_the_cube_s() {
        for (face, bounded) in Face::ALL.iter().zip(faces(16, 0.5)) {
            let [s, t] = [0.3, -0.8];
            let position = direction_from_cube(*face, s, t) * 2.0;
            let [x, y, _, w] = clip(bounded.view.clip_from_scene, position);
            assert!((x / w - s).abs() < 1e-6 && (-y / w - t).abs() < 1e-6, "{face:?}");
            let inside = |s: f64, t: f64| {
                let at = direction_from_cube(*face, s, t).as_vec3() * 4.0;
                bounded.planes.iter().all(|plane| at.extend(1.0).dot((*plane).into()) > 0.0)
            };
            assert!(inside(1.2, -1.2) && !inside(1.3, 0.0) && !inside(0.0, -1.3), "{face:?}");
        }
    }
}
