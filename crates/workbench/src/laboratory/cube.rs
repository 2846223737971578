//! Boxes on the faces of a cube.
//!
//! A box has the solid angle of the footprint by the local density, and sides in the inverse ratio of the
//! stretches along s and t, so that it is about as long as wide on the sphere; the ratio is continuous across
//! edges, where neighbouring faces are mirror images. Across an edge a box continues on the neighbour,
//! unfolded into the face's plane, up to the neighbour's far edge. The part beyond two edges at once is
//! omitted: three faces meet at a corner, and the plane's fourth quadrant has no directions of its own.

use super::charts::{Charts, Piece};
use glam::{DVec2, DVec3};
use octagloss_core::sphere::cube::{Face, cube_from_direction, cube_point};
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::map::Place;

/// The cube.
#[derive(Clone, Copy, Debug)]
pub(super) struct CubeCharts;

/// Centre of a face and its axes s and t.
fn axes(face: Face) -> [DVec3; 3] {
    let centre = cube_point(face, 0.0, 0.0);
    [centre, cube_point(face, 1.0, 0.0) - centre, cube_point(face, 0.0, 1.0) - centre]
}

impl Charts for CubeCharts {
    fn name(&self) -> &'static str {
        "cube"
    }

    fn sides(&self, place: Place, solid_angle: f64) -> DVec2 {
        // Stretches sqrt(1 + t^2) and sqrt(1 + s^2) over 1 + s^2 + t^2, density (1 + s^2 + t^2)^-1.5.
        let squared = place.uv * place.uv;
        let area = solid_angle * (1.0 + squared.x + squared.y).powf(1.5);
        let ratio = ((1.0 + squared.x) / (1.0 + squared.y)).sqrt();
        DVec2::new((area * ratio).sqrt(), (area / ratio).sqrt())
    }

    fn split(&self, grid: &Grid, piece: Piece, visit: &mut dyn FnMut(Piece)) {
        // Texels from the face's centre, so that whole texels stay whole; the face ends at `edge`.
        let edge = f64::from(grid.size()) / 2.0;
        let (low, high) = (piece.low - edge, piece.high - edge);
        let (near, far) = (low.max(DVec2::splat(-edge)), high.min(DVec2::splat(edge)));
        if near.x < far.x && near.y < far.y {
            visit(Piece { component: piece.component, low: near + edge, high: far + edge });
        }
        let [centre, s, t] = axes(Face::ALL[piece.component as usize]);
        // Strips beyond the four edges: the direction out of the face and the box's range along it, the
        // direction along the edge and the range along that.
        let strips = [
            (s, [low.x, high.x], t, [low.y, high.y]),
            (-s, [-high.x, -low.x], t, [low.y, high.y]),
            (t, [low.y, high.y], s, [low.x, high.x]),
            (-t, [-high.y, -low.y], s, [low.x, high.x]),
        ];
        for (out, [start, end], along, [from, to]) in strips {
            let (start, end) = (start.max(edge), end.min(3.0 * edge));
            let (from, to) = (from.max(-edge), to.min(edge));
            if start >= end || from >= to {
                continue;
            }
            let (face, ..) = cube_from_direction(out);
            let [_, other_s, other_t] = axes(face);
            // Past the edge the neighbour's plane leads along -centre.
            let place = |a: f64, b: f64| {
                let point = out * edge + along * b + centre * (2.0 * edge - a);
                DVec2::new(point.dot(other_s), point.dot(other_t))
            };
            let (a, b) = (place(start, from), place(end, to));
            visit(Piece { component: face as u32, low: a.min(b) + edge, high: a.max(b) + edge });
        }
    }
}
