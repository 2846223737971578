//! Fills the data for mirrors: an OEM's square as one texture, and the least radiance of the residual map.

use super::device::stage::Dispatch;
use super::fitted::FittedTables;
use super::least;
use super::{Context, OemPlanes, Stage};

/// Invocations along an edge of a workgroup.
pub const EDGE: u32 = 16;

/// Stage that writes the square of `oem`, and the least radiance of the residual map `rest`, to `tables`.
///
/// # Panics
/// If `tables` was made for another size.
#[must_use]
pub fn stage(context: &Context, oem: &OemPlanes, rest: &OemPlanes, tables: &FittedTables) -> Stage {
    assert_eq!(oem.size().inner, tables.inner(), "tables for this size");
    let own = tables.oem();
    let resources = [oem.bindings(), vec![(5, wgpu::BindingResource::TextureView(&own))]].concat();
    let groups = tables.inner().div_ceil(EDGE);
    let of_rest = wgpu::BufferBinding { size: std::num::NonZero::new(16), ..tables.light() };
    let mut dispatches =
        vec![Dispatch::new(context, ("mirror.wgsl", "mirror"), &resources, [groups, groups, 1])];
    dispatches.extend(least::dispatches(context, rest, wgpu::BindingResource::Buffer(of_rest)));
    Stage::new("mirror", dispatches)
}
