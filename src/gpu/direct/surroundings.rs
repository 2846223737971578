//! An octahedral map that a renderer draws its own scene into, by its own pipelines.

use super::view::{Bounded, octants};
use super::{DirectTarget, cleared, view_group};
use crate::direct::{DirectMap, MOST, check_near};
use crate::error::{Error, Result};
use crate::gpu::Context;
use glam::DVec3;

/// Colour, depth and the views of the eight octants.
#[derive(Clone, Debug)]
pub(in crate::gpu) struct Surroundings {
    target: DirectTarget,
    colour: wgpu::TextureView,
    depth: wgpu::TextureView,
    views: Vec<(wgpu::Buffer, wgpu::BindGroup)>,
}

impl Surroundings {
    /// A map of even `size` in half floats; `layout` is that of [`super::view_layout`].
    ///
    /// # Errors
    /// Those of [`DirectTarget::new`].
    pub(in crate::gpu) fn new(context: &Context, layout: &wgpu::BindGroupLayout, size: u32) -> Result<Self> {
        let format = wgpu::TextureFormat::Rgba16Float;
        let target = DirectTarget::new(context, DirectMap::Octahedral { size }, format)?;
        let [colour, depth] = target.views(0);
        let views = octants(target.map(), 1.0).into_iter().map(|Bounded { view, .. }| {
            let uniform = context.uniform("direct view", &view);
            let group = view_group(context.device(), layout, &uniform);
            (uniform, group)
        });
        Ok(Self { views: views.collect(), target, colour, depth })
    }

    /// The map's colour.
    pub(in crate::gpu) const fn colour(&self) -> &wgpu::Texture {
        self.target.colour()
    }

    /// Records one pass that clears the map and calls `record` for each octant, with the octant's group.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an invalid `near` and a `centre` that is not finite or beyond [`MOST`].
    pub(in crate::gpu) fn draw(
        &self,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        centre: DVec3,
        near: f32,
        mut record: impl FnMut(&mut wgpu::RenderPass<'_>, &wgpu::BindGroup),
    ) -> Result<()> {
        check_near(near)?;
        // Also true for NaN.
        if !centre.to_array().iter().all(|x| x.abs() <= f64::from(MOST)) {
            return Err(Error::Parameter(format!(
                "`centre` is at {centre}; coordinates must be finite and at most {MOST:e}"
            )));
        }
        let octants = octants(self.target.map(), near);
        for ((uniform, _), Bounded { view, .. }) in self.views.iter().zip(&octants) {
            let view = view.around(centre.as_vec3().to_array());
            context.queue().write_buffer(uniform, 0, bytemuck::bytes_of(&view));
        }
        let mut pass = cleared(encoder, &self.colour, Some(&self.depth), None);
        for ((_, group), Bounded { scissor: [left, top, width, height], .. }) in
            self.views.iter().zip(&octants)
        {
            pass.set_scissor_rect(*left, *top, *width, *height);
            record(&mut pass, group);
        }
        Ok(())
    }
}
