//! The eight draws of a renderer's own scene into an octahedral map, by its own pipelines.

use super::view::{Bounded, octants};
use super::view_group;
use crate::Context;
use crate::triangles::{DirectMap, MAX, check_near};
use glam::DVec3;
use octagloss_core::common::error::{Result, wrong};

/// The views of the eight octants, each with its group.
#[derive(Clone, Debug)]
pub(crate) struct OctantDraws {
    map: DirectMap,
    views: Vec<(wgpu::Buffer, wgpu::BindGroup)>,
}

impl OctantDraws {
    /// Draws into the octahedral `map`; `layout` is that of [`super::view_layout`].
    pub(crate) fn new(context: &Context, layout: &wgpu::BindGroupLayout, map: DirectMap) -> Self {
        let views = octants(map, 1.0).into_iter().map(|Bounded { view, .. }| {
            let uniform = context.uniform("direct view", &view);
            let group = view_group(context, layout, &uniform);
            (uniform, group)
        });
        Self { views: views.collect(), map }
    }

    /// Moves the map to `centre`, which the caller calls `name`, from the next submission on.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for an invalid `near` and a `centre` that is not
    /// finite or beyond [`MAX`].
    pub(crate) fn place(&self, context: &Context, name: &str, centre: DVec3, near: f32) -> Result<()> {
        check_near(near)?;
        // Also true for NaN.
        if !centre.to_array().iter().all(|x| x.abs() <= f64::from(MAX)) {
            return wrong(format!("`{name}` is at {centre}; coordinates must be finite and at most {MAX:e}"));
        }
        for ((uniform, _), Bounded { mut view, .. }) in self.views.iter().zip(octants(self.map, near)) {
            view.centre = centre.as_vec3().to_array();
            context.queue().write_buffer(uniform, 0, bytemuck::bytes_of(&view));
        }
        Ok(())
    }

    /// Calls `record` for each octant, with the octant's scissor set and its group.
    pub(crate) fn record(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        mut record: impl FnMut(&mut wgpu::RenderPass<'_>, &wgpu::BindGroup),
    ) {
        for ((_, group), Bounded { scissor, .. }) in self.views.iter().zip(octants(self.map, 1.0)) {
            let [left, top, width, height] = scissor;
            pass.set_scissor_rect(left, top, width, height);
            record(pass, group);
        }
    }
}
