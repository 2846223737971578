//! Lists the maps with box rules.

use super::charts::Charts;
use super::cube::CubeCharts;
use super::equirect::EquirectCharts;
use super::octahedral::OctahedralCharts;
use super::tennis_ball::TennisBallCharts;

/// All maps with box rules; the first is the engines' own.
pub static CHARTS: [&dyn Charts; 4] = [&OctahedralCharts, &TennisBallCharts, &EquirectCharts, &CubeCharts];

/// The charts of the map called `name`.
pub fn charts_of(name: &str) -> Option<&'static dyn Charts> {
    CHARTS.into_iter().find(|charts| charts.name() == name)
}
