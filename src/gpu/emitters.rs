//! Extracts the brightest cells of an OEM as point emitters, like [`crate::realtime::emitters`].

use super::device::stage::Dispatch;
use super::fitted::FittedTables;
use super::{Context, OemPlanes, Stage};
use crate::realtime::emitters::{COUNT, GRID, block};

/// Invocations along an edge of a workgroup that writes the residual map.
pub const EDGE: u32 = 16;

/// Cells that a workgroup sorts.
pub const BATCH: u32 = 1024;

/// Cells that a workgroup keeps: one per emitter, and the next brightest.
pub const KEPT: u32 = COUNT as u32 + 1;

const FILE: &str = "emitters.wgsl";

/// Stage that writes the emitters of `oem` to `tables`, and the residual map to `rest`, which shares the
/// solid angles of `oem`.
///
/// # Panics
/// If the tables were made for another size.
#[must_use]
pub fn stage(context: &Context, oem: &OemPlanes, rest: &OemPlanes, tables: &FittedTables) -> Stage {
    let inner = oem.size().inner;
    assert_eq!(inner, tables.inner(), "tables for this size");
    let cells = (inner / block(inner)).pow(2);
    debug_assert!(cells <= GRID * GRID, "the grid is no finer");
    let brightness = context.storage("brightness of cells", 4 * u64::from(cells));
    let list = |groups: u32| context.storage("brightest cells", 8 * u64::from(groups * KEPT));
    let planes = oem.bindings();
    // Without the solid angles.
    let energies = planes[..4].to_vec();

    let mut groups = cells.div_ceil(BATCH);
    let mut brightest = list(groups);
    let mut cells = planes.clone();
    cells.extend([(5, brightness.as_entire_binding()), (7, brightest.as_entire_binding())]);
    let mut dispatches = vec![Dispatch::new(context, (FILE, "brightest_cells"), &cells, [groups, 1, 1])];
    while groups > 1 {
        groups = (groups * KEPT).div_ceil(BATCH);
        let fewer = list(groups);
        let lists = [(6, brightest.as_entire_binding()), (7, fewer.as_entire_binding())];
        dispatches.push(Dispatch::new(context, (FILE, "brightest_of_lists"), &lists, [groups, 1, 1]));
        brightest = fewer;
    }
    let listed = (6, brightest.as_entire_binding());
    let mut kept = energies.clone();
    kept.extend([listed.clone(), (5, brightness.as_entire_binding())]);
    kept.extend((8..).zip(rest.planes[..3].iter().map(wgpu::Buffer::as_entire_binding)));
    let groups = oem.table().side.div_ceil(EDGE);
    dispatches.push(Dispatch::new(context, (FILE, "rest"), &kept, [groups, groups, 1]));
    let mut given = energies.clone();
    given.extend([listed, (11, wgpu::BindingResource::Buffer(tables.light()))]);
    dispatches.push(Dispatch::new(context, (FILE, "emitters"), &given, [1, 1, 1]));
    Stage::new("emitters", dispatches)
}
