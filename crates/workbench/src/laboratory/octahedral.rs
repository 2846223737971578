//! Boxes on the octahedral square.
//!
//! Square boxes of the paper: the side is the root of the solid angle over the local density, which is
//! continuous across every fold. Unfolded, the square tiles the plane by wallpaper group p2: a box is cut at
//! the tiles' edges, and parts in odd tiles are turned by 180 degrees. Around the cone points +-X and +-Z
//! the plane covers the sphere twice, so boxes there count directions twice.

use super::charts::{Charts, Piece, for_each_period};
use glam::DVec2;
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::map::Place;
use octagloss_core::sphere::octahedral::solid_angle_density;

/// The octahedral square.
#[derive(Clone, Copy, Debug)]
pub(super) struct OctahedralCharts;

impl Charts for OctahedralCharts {
    fn name(&self) -> &'static str {
        "octahedral"
    }

    fn sides(&self, place: Place, solid_angle: f64) -> DVec2 {
        // At most the period of the plane.
        DVec2::splat((solid_angle / solid_angle_density(place.uv)).sqrt().min(4.0))
    }

    fn split(&self, grid: &Grid, piece: Piece, visit: &mut dyn FnMut(Piece)) {
        let n = f64::from(grid.size());
        let Piece { component, low, high } = piece;
        for_each_period(low.y, high.y, n, |j, bottom, top| {
            for_each_period(low.x, high.x, n, |i, left, right| {
                let (low, high) = (DVec2::new(left, bottom), DVec2::new(right, top));
                let is_turned = (i + j).rem_euclid(2) == 1;
                let (low, high) = if is_turned { (n - high, n - low) } else { (low, high) };
                visit(Piece { component, low, high });
            });
        });
    }
}
