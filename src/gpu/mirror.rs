//! Fills the data for mirrors: an OEM's square as one texture, and the least radiance of the residual map.

use super::device::shader;
use super::device::stage::Dispatch;
use super::fitted::FittedTables;
use super::least::Least;
use super::{Context, OemPlanes, Stage};

/// Invocations along an edge of a workgroup.
pub const EDGE: u32 = 16;

/// Pipelines of the stage.
#[derive(Clone, Debug)]
pub struct Mirror {
    mirror: wgpu::ComputePipeline,
    least: Least,
}

impl Mirror {
    /// Compiles the stage.
    #[must_use]
    pub fn new(context: &Context) -> Self {
        let module = shader::module(context, "mirror.wgsl");
        Self { mirror: shader::pipeline(context, &module, "mirror", &[]), least: Least::new(context) }
    }

    /// Stage that writes the square of `oem`, and the least radiance of the residual map `rest`, to `tables`.
    ///
    /// # Panics
    /// If `tables` was made for another size.
    #[must_use]
    pub fn stage(
        &self,
        context: &Context,
        oem: &OemPlanes,
        rest: &OemPlanes,
        tables: &FittedTables,
    ) -> Stage {
        assert_eq!(oem.size().inner, tables.inner(), "tables for this size");
        let own = tables.oem();
        let resources = [oem.bindings(), vec![(5, wgpu::BindingResource::TextureView(&own))]].concat();
        let groups = tables.inner().div_ceil(EDGE);
        let least = wgpu::BufferBinding { size: std::num::NonZero::new(16), ..tables.light() };
        let mut dispatches = vec![Dispatch::new(context, &self.mirror, &resources, [groups, groups, 1])];
        dispatches.extend(self.least.dispatches(context, rest, wgpu::BindingResource::Buffer(least)));
        Stage::new("mirror", dispatches)
    }
}
