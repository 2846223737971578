//! Blurred tables for soft boxes: SATs of an OEM blurred by a tent, one for each octave of alpha.

use super::device::stage::Dispatch;
use super::fitted::FittedTables;
use super::octaves::OctaveLayout;
use super::{Context, SatPlanes, Stage, oem};

const FILE: &str = "blur.wgsl";

/// The blurred texels of all octaves of a map of `inner` texels along an edge, before they are summed.
pub(super) fn texels(context: &Context, inner: u32) -> wgpu::Buffer {
    context.storage("blurred texels", 32 * u64::from(OctaveLayout::new(inner).texels))
}

/// Stage that writes the blurred tables of `sat` to `tables`, by way of [`texels`].
///
/// # Panics
/// If `tables` was made for another size.
pub(super) fn stage(
    context: &Context,
    sat: &SatPlanes,
    texels: &wgpu::Buffer,
    tables: &FittedTables,
) -> Stage {
    assert_eq!(sat.size().inner, tables.inner(), "tables for this size");
    let layout = OctaveLayout::new(tables.inner());
    let table = context.uniform("table", &oem::Table::new(sat.size()));
    let octaves = (5, tables.octaves().as_entire_binding());
    let entries = (8, wgpu::BindingResource::Buffer(tables.entries()));
    let mut blur = vec![(0, table.as_entire_binding()), octaves.clone(), (6, texels.as_entire_binding())];
    blur.extend((1..).zip(sat.planes.iter().map(wgpu::Buffer::as_entire_binding)));
    let rows = [octaves.clone(), (7, texels.as_entire_binding()), entries.clone()];
    Stage::new(
        "blur",
        vec![
            Dispatch::new(context, (FILE, "blur"), &blur, [layout.tiles, oem::CHANNELS as u32, 1]),
            Dispatch::new(context, (FILE, "rows"), &rows, [layout.rows, 1, 1]),
            Dispatch::new(context, (FILE, "columns"), &[octaves, entries], [layout.rows, 1, 1]),
        ],
    )
}
