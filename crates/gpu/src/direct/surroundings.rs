//! An octahedral map that a renderer draws its own scene into, by its own pipelines.

use super::{DirectTarget, OctantDraws, cleared};
use crate::Context;
use crate::triangles::DirectMap;
use glam::DVec3;
use octagloss_core::common::error::Result;

/// Colour, depth and the draws of the eight octants.
#[derive(Clone, Debug)]
pub(crate) struct Surroundings {
    pub(crate) target: DirectTarget,
    colour: wgpu::TextureView,
    depth: wgpu::TextureView,
    octants: OctantDraws,
}

impl Surroundings {
    /// A map of even `size` in half floats; `layout` is that of [`super::view_layout`].
    ///
    /// # Errors
    /// Those of [`DirectTarget::new`].
    pub(crate) fn new(context: &Context, layout: &wgpu::BindGroupLayout, size: u32) -> Result<Self> {
        let map = DirectMap::Octahedral { size };
        let target = DirectTarget::new(context, map, wgpu::TextureFormat::Rgba16Float)?;
        let [colour, depth] = target.views(0);
        let octants = OctantDraws::new(context, layout, map);
        Ok(Self { target, colour, depth, octants })
    }

    /// The same map with draws of its own, for another centre; each overwrites what the other drew.
    pub(crate) fn sharing_target(&self, context: &Context, layout: &wgpu::BindGroupLayout) -> Self {
        Self { octants: OctantDraws::new(context, layout, self.target.map()), ..self.clone() }
    }

    /// Records one pass that clears the map and calls `record` for each octant, with the octant's group.
    ///
    /// # Errors
    /// Those of [`OctantDraws::place`].
    pub(crate) fn draw(
        &self,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        centre: DVec3,
        near: f32,
        record: impl FnMut(&mut wgpu::RenderPass<'_>, &wgpu::BindGroup),
    ) -> Result<()> {
        self.octants.place(context, "centre", centre, near)?;
        let mut pass = cleared(encoder, &self.colour, Some(&self.depth), None);
        self.octants.record(&mut pass, record);
        Ok(())
    }
}
