//! Boxes on the charts of a map: their size, and where they continue beyond a chart's edge.

use super::cube::CubeCharts;
use super::equirect::EquirectCharts;
use super::octahedral::OctahedralCharts;
use super::tennis_ball::TennisBallCharts;
use glam::DVec2;
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::map::Place;
use octagloss_core::sphere::registry::{NamedMap, named};
use std::fmt::Debug;

/// A rectangle of one component, from `low` to `high` in texels of its image; negative coordinates and those
/// beyond the image lie in its border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Index of the component.
    pub component: u32,
    /// Minimum coordinates.
    pub low: DVec2,
    /// Maximum coordinates.
    pub high: DVec2,
}

/// Boxes on a map of the sphere.
pub trait Charts: Debug + Sync {
    /// Name of the map in `sphere::registry`.
    fn name(&self) -> &'static str;

    /// Sides, in the map's own coordinates, of the box around `place` for a footprint of `solid_angle`.
    fn sides(&self, place: Place, solid_angle: f64) -> DVec2;

    /// Border texels that boxes of up to `solid_angle` need on a map of `size`. 0 where [`Charts::split`]
    /// continues boxes in the charts themselves.
    fn border(&self, size: u32, solid_angle: f64) -> u32 {
        let _ = (size, solid_angle);
        0
    }

    /// Solid angle of a texel of the border from `low` to `high`, in the map's own coordinates, of a map with
    /// [`Charts::border`]; also for texels of the image that lie partly outside the domain.
    fn continued_solid_angle(&self, component: u32, low: DVec2, high: DVec2) -> f64 {
        let _ = (component, low, high);
        0.0
    }

    /// Calls `visit` with parts of `piece`, which may leave its component, each inside a component of `grid`
    /// and the border that boxes of its size need.
    fn split(&self, grid: &Grid, piece: Piece, visit: &mut dyn FnMut(Piece));

    /// The map.
    fn named(&self) -> &'static NamedMap {
        named(self.name()).expect("a map of the registry")
    }
}

/// All maps with box rules; the first is the engines' own.
pub static CHARTS: [&dyn Charts; 4] = [&OctahedralCharts, &TennisBallCharts, &EquirectCharts, &CubeCharts];

/// Calls `visit` for every interval between multiples of `period` that `low` to `high` is cut into, with the
/// number of the period and the ends inside it.
pub(super) fn for_each_period(low: f64, high: f64, period: f64, mut visit: impl FnMut(i64, f64, f64)) {
    let (first, last) = ((low / period).floor(), (high / period).ceil());
    let mut k = first;
    while k < last {
        let (from, to) = (low.max(k * period) - k * period, high.min((k + 1.0) * period) - k * period);
        if from < to {
            visit(k as i64, from, to.min(period));
        }
        k += 1.0;
    }
}
