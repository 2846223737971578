//! The octahedral map, quadratic layout: (u, v) in [-1, 1]^2, u along x and v along z; the centre is +Y, the
//! four corners are -Y, the edge midpoints are +-X and +-Z.
//!
//! Engelhardt and Dachsbacher 2008, section 3.1: the planar projection (equation 1) and the square unfolding.
//! The paper's equation 2 prints a sigma where an absolute value belongs; the form here is the one that
//! round-trips.
//!
//! Unfolded over the plane the square repeats as wallpaper group p2: tile (i, j) is the square itself
//! where i + j is even, and the square turned by 180 degrees where it is odd. [`wrap_oct`] and [`wrap_texel`]
//! bring any point and any texel of that plane back to the square.
//!
//! The map itself is [`super::octahedral_perspective::PLANAR`], the perspective projection with the
//! octahedron's faces as image planes.

use super::{clip, projected_solid_angle};
use glam::{DVec2, DVec3};

/// Point on the octahedron |x| + |y| + |z| = 1 at `uv` in [-1, 1]^2.
pub fn octahedron_from_oct(uv: DVec2) -> DVec3 {
    let y = 1.0 - uv.x.abs() - uv.y.abs();
    if y >= 0.0 {
        DVec3::new(uv.x, y, uv.y)
    } else {
        DVec3::new((1.0 - uv.y.abs()).copysign(uv.x), y, (1.0 - uv.x.abs()).copysign(uv.y))
    }
}

/// Unit direction at `uv` in [-1, 1]^2.
pub fn direction_from_oct(uv: DVec2) -> DVec3 {
    octahedron_from_oct(uv).normalize()
}

/// How [`direction_from_oct`] changes with u and with v at `uv` in [-1, 1]^2: tangents of the sphere.
pub(crate) fn steps_from_oct(uv: DVec2) -> [DVec3; 2] {
    let point = octahedron_from_oct(uv);
    let (length, sign) = (point.length(), uv.signum());
    let steps = if point.y >= 0.0 {
        [DVec3::new(1.0, -sign.x, 0.0), DVec3::new(0.0, -sign.y, 1.0)]
    } else {
        [DVec3::new(0.0, -sign.x, -sign.x * sign.y), DVec3::new(-sign.x * sign.y, -sign.y, 0.0)]
    };
    steps.map(|step| step.reject_from_normalized(point / length) / length)
}

/// Octahedral coordinates in [-1, 1]^2 of `direction` (any length but zero). -Y goes to the corner (1, 1).
pub fn oct_from_direction(direction: DVec3) -> DVec2 {
    let p = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs());
    if p.y >= 0.0 {
        DVec2::new(p.x, p.z)
    } else {
        DVec2::new((1.0 - p.z.abs()).copysign(p.x), (1.0 - p.x.abs()).copysign(p.z))
    }
}

/// The point of the square that `uv`, anywhere on the unfolded plane, stands for.
pub fn wrap_oct(uv: DVec2) -> DVec2 {
    let tile = ((uv + 1.0) / 2.0).floor();
    let inside = uv - tile * 2.0;
    // Odd tiles are turned by 180 degrees. `tile` is integral, so the remainder is exact.
    if (tile.x + tile.y).rem_euclid(2.0) == 1.0 { -inside } else { inside }
}

/// The point of the square whose direction is that at `uv`, in the square, with its coordinate `axis`
/// negated.
pub(super) fn mirrored_oct(uv: DVec2, axis: usize) -> DVec2 {
    match axis {
        0 => DVec2::new(-uv.x, uv.y),
        // Across the fold: u + v = 1 in its quadrant.
        1 => DVec2::new((1.0 - uv.y.abs()).copysign(uv.x), (1.0 - uv.x.abs()).copysign(uv.y)),
        _ => DVec2::new(uv.x, -uv.y),
    }
}

/// The texel of the `n` x `n` square that texel (`x`, `y`), anywhere on the unfolded plane, stands for.
///
/// Agrees with [`wrap_oct`] of the texel's centre at every distance; `n` must be at least 1.
pub fn wrap_texel(n: u32, x: i64, y: i64) -> (u32, u32) {
    let n = i64::from(n);
    if (0..n).contains(&x) && (0..n).contains(&y) {
        return (x as u32, y as u32);
    }
    let (tile_x, tile_y) = (x.div_euclid(n), y.div_euclid(n));
    let (inside_x, inside_y) = (x.rem_euclid(n), y.rem_euclid(n));
    let (x, y) = if (tile_x + tile_y).rem_euclid(2) == 1 {
        (n - 1 - inside_x, n - 1 - inside_y)
    } else {
        (inside_x, inside_y)
    };
    (u32::try_from(x).expect("inside the square"), u32::try_from(y).expect("inside the square"))
}

/// Solid angle of a unit of (u, v) area at `uv` in [-1, 1]^2: 1/|p|^3, p on the octahedron. Between 1
/// (vertices) and 3^1.5 (face centres).
pub fn solid_angle_density(uv: DVec2) -> f64 {
    let squared = octahedron_from_oct(uv).length_squared();
    1.0 / (squared * squared.sqrt())
}

/// Centre of texel (`x`, `y`) of the `n` x `n` square in (u, v).
pub fn texel_centre(n: u32, x: u32, y: u32) -> DVec2 {
    (DVec2::new(f64::from(x), f64::from(y)) + 0.5) * (2.0 / f64::from(n)) - 1.0
}

/// Exact solid angle of texel (`x`, `y`) of the `n` x `n` square, in steradians.
pub fn texel_solid_angle(n: u32, x: u32, y: u32) -> f64 {
    let edge = |k: u32| (2.0 * f64::from(k) - f64::from(n)) / f64::from(n);
    rectangle_solid_angle(DVec2::new(edge(x), edge(y)), DVec2::new(edge(x + 1), edge(y + 1)), |p| p)
}

/// Exact solid angle of the rectangle of the square from `low` to `high`, after its points on the
/// octahedron were moved by `project`, which must keep the octants' planes and carry straight lines to
/// great circles.
///
/// The rectangle is cut along the axes and the fold diagonals into pieces that each lie on one octahedron
/// face; straight lines there are great circles, so every piece is a spherical polygon.
pub(super) fn rectangle_solid_angle(low: DVec2, high: DVec2, project: impl Fn(DVec3) -> DVec3) -> f64 {
    let spans_x = fold_span(low.x, high.x);
    let spans_y = fold_span(low.y, high.y);
    let mut total = 0.0;
    for &(u0, u1) in spans_x.iter().flatten() {
        for &(v0, v1) in spans_y.iter().flatten() {
            let corners = [DVec2::new(u0, v0), DVec2::new(u1, v0), DVec2::new(u1, v1), DVec2::new(u0, v1)];
            for_each_face_piece(corners, |piece| {
                let mut moved = [DVec3::ZERO; 6];
                moved.iter_mut().zip(piece).for_each(|(moved, corner)| *moved = project(*corner));
                total += projected_solid_angle(&moved[..piece.len()]);
            });
        }
    }
    total
}

/// An interval folded to the non-negative half-axis: one piece, or two where it straddles zero.
fn fold_span(low: f64, high: f64) -> [Option<(f64, f64)>; 2] {
    if low >= 0.0 {
        [Some((low, high)), None]
    } else if high <= 0.0 {
        [Some((-high, -low)), None]
    } else {
        [Some((0.0, high)), Some((0.0, -low))]
    }
}

/// Cuts a rectangle of the square that crosses no axis along the fold diagonal: calls `visit` with each part
/// as a polygon on one face of the octahedron |x| + |y| + |z| = 1.
pub(crate) fn for_each_face_piece(corners: [DVec2; 4], mut visit: impl FnMut(&[DVec3])) {
    for sign in [1.0, -1.0] {
        let depth = |c: DVec2| sign * (1.0 - c.x.abs() - c.y.abs());
        let mut part = Vec::with_capacity(6);
        clip(&corners, depth, &mut part);
        if part.len() >= 3 {
            let piece: Vec<DVec3> = part.into_iter().map(octahedron_from_oct).collect();
            visit(&piece);
        }
    }
}
