//! Boxes on a panorama.
//!
//! Longitude and latitude are orthogonal, so a box has the same length along both on the sphere: its height
//! is the root of the solid angle, its width that over the sine of the polar angle, at most the whole
//! circle. Across the left and right edges a box continues at the other edge. Across a pole it continues on
//! the opposite meridian with rows in reverse; a box as wide as the circle then counts a cap around the pole
//! twice.

use super::charts::{Charts, Piece, for_each_period};
use glam::DVec2;
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::map::Place;
use std::f64::consts::{PI, TAU};

/// The panorama.
#[derive(Clone, Copy, Debug)]
pub(super) struct EquirectCharts;

impl Charts for EquirectCharts {
    fn name(&self) -> &'static str {
        "equirect"
    }

    fn sides(&self, place: Place, solid_angle: f64) -> DVec2 {
        let side = solid_angle.sqrt().min(PI);
        // At a pole 0 / 0 for a footprint of 0: f64::min ignores NaN.
        DVec2::new((side / place.uv.y.sin()).min(TAU), side)
    }

    fn split(&self, grid: &Grid, piece: Piece, visit: &mut dyn FnMut(Piece)) {
        let height = f64::from(grid.size());
        let width = 2.0 * height;
        let Piece { component, low, high } = piece;
        // No longitude more than once.
        let middle = f64::midpoint(low.x, high.x);
        let (left, right) = (low.x.max(middle - height), high.x.min(middle + height));
        for_each_period(low.y, high.y, height, |j, top, bottom| {
            let is_beyond = j.rem_euclid(2) == 1;
            let (top, bottom) = if is_beyond { (height - bottom, height - top) } else { (top, bottom) };
            let shift = if is_beyond { height } else { 0.0 };
            for_each_period(left + shift, right + shift, width, |_, left, right| {
                visit(Piece { component, low: DVec2::new(left, top), high: DVec2::new(right, bottom) });
            });
        });
    }
}
