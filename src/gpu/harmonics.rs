//! Computes harmonics of an OEM to order 4 from its exact table.

use super::device::stage::Dispatch;
use super::fitted::FittedTables;
use super::{Context, SatPlanes, Stage, oem};
use crate::sh;

/// Texels that a workgroup sums per batch.
pub const GROUP_SIZE: u32 = 128;

/// Batches of a workgroup.
pub(crate) const BATCHES: u32 = 4;

/// Texels along an edge of the finest grid.
pub(crate) const FINEST: u32 = 256;

/// Stage that writes the harmonics and units of `sat` to `tables`.
#[must_use]
pub fn stage(context: &Context, sat: &SatPlanes, tables: &FittedTables) -> Stage {
    let side = sat.size().inner.min(FINEST);
    let groups = (side * side).div_ceil(GROUP_SIZE * BATCHES);
    let partials = context.storage("harmonics of groups", 16 * sh::MAX_COUNT as u64 * u64::from(groups));
    let table = context.uniform("table", &oem::Table::new(sat.size()));
    let table = (0, table.as_entire_binding());
    let partials = (6, partials.as_entire_binding());
    let mut sums = vec![table.clone(), partials.clone()];
    sums.extend((1..).zip(sat.planes.iter().map(wgpu::Buffer::as_entire_binding)));
    let exponents = (5, sat.exponents.as_entire_binding());
    let all = [table, exponents, partials, (7, wgpu::BindingResource::Buffer(tables.light()))];
    Stage::new(
        "harmonics",
        vec![
            Dispatch::new(context, ("harmonics.wgsl", "sums_of_groups"), &sums, [groups, 1, 1]),
            Dispatch::new(context, ("harmonics.wgsl", "sum_of_all"), &all, [1, 1, 1]),
        ],
    )
}
