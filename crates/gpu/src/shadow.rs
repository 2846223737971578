//! Shadows of a point lamp, by an octahedral map of depth around it.
//!
//! ```text
//! triangles --draw x 8--> depth, near / w --octagloss_lit(position, normal)--> share of the lamp's light
//! ```

use super::Context;
use super::device::resources::{DEPTH, UNIFORM, group, group_layout, texture_binding};
use super::direct::{OctantDraws, cleared_depth, depth_texture, view_layout};
use super::live::LiveEnvironment;
use crate::triangles::DirectMap;
use glam::DVec3;
use octagloss_core::common::error::{Result, wrong};

/// Bias at first.
const BIAS: f32 = 1e-3;

/// Uniform of look-ups.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Shadow {
    lamp: [f32; 3],
    size: u32,
    near: f32,
    bias: f32,
    pad: [u32; 2],
}

/// An octahedral map of the depth around a lamp, which a renderer draws its own scene into, and the look-up
/// of shadows for its own shaders.
///
/// One square texture serves all directions: no faces, no array layers. The renderer owns device, queue and
/// encoder. [`ShadowMap::draw`] records the pass that follows a move of the lamp or the scene;
/// [`ShadowMap::wgsl`] and [`ShadowMap::bind_group`] give its shaders the look-up. `examples/shadows.rs` is a
/// whole renderer.
#[derive(Debug)]
pub struct ShadowMap {
    context: Context,
    shadow: Shadow,
    uniform: wgpu::Buffer,
    depth: wgpu::TextureView,
    octants: OctantDraws,
    draw_layout: wgpu::BindGroupLayout,
    layout: wgpu::BindGroupLayout,
    bind_group: wgpu::BindGroup,
}

impl ShadowMap {
    /// Format of the depth, see [`Self::draw`].
    pub const DEPTH: wgpu::TextureFormat = DEPTH;

    /// Allocates a map of even `size` texels along an edge. Nothing is in shadow until the first draw.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for a size that is odd, 0, or beyond the device's
    /// textures.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, size: u32) -> Result<Self> {
        let context = Context::from_device(device.clone(), queue.clone());
        let map = DirectMap::Octahedral { size };
        let depth = depth_texture(&context, map)?.create_view(&Default::default());
        let shadow = Shadow { lamp: [0.0; 3], size, near: 1.0, bias: BIAS, pad: [0; 2] };
        let uniform = context.uniform("octagloss shadow", &shadow);
        let visibility = wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE;
        let map_of_depth = texture_binding(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2);
        let layout = group_layout(&context, "octagloss shadow", visibility, &[UNIFORM, map_of_depth]);
        let bind_group = bind_group(&context, &layout, &uniform, &depth);
        let draw_layout = view_layout(&context);
        let octants = OctantDraws::new(&context, &draw_layout, map);
        Ok(Self { context, shadow, uniform, depth, octants, draw_layout, layout, bind_group })
    }

    /// Records one render pass that draws a scene's depth around `lamp` (world space).
    ///
    /// The pass has eight parts, one per octant of directions. `record` is called for each with the group of
    /// [`Self::draw_layout`] to bind, and records all draws of what casts shadows with the caller's own
    /// pipelines: no colour, depth [`Self::DEPTH`] compared by `Greater`, one sample. Vertex stages return
    /// `octagloss_direct_position(position)`, fragment stages discard what `octagloss_direct_owns` denies;
    /// both are in [`Self::draw_wgsl`]. As in the faces of a cube, triangles wind the other way round than in
    /// a picture. The scissor is the octant's.
    ///
    /// Points nearer than `near`, by |x| + |y| + |z| from the lamp, cast no shadow: the lamp's own body may
    /// be there. Depth is `near` over that distance, cleared to 0.
    ///
    /// Lamp and `near` take effect with the next submission: submit once for each draw.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for a `near` that is not positive or a `lamp` that
    /// is not finite.
    pub fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        lamp: DVec3,
        near: f32,
        record: impl FnMut(&mut wgpu::RenderPass<'_>, &wgpu::BindGroup),
    ) -> Result<()> {
        self.octants.place(&self.context, "lamp", lamp, near)?;
        self.set(Shadow { lamp: lamp.as_vec3().to_array(), near, ..self.shadow });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("octagloss shadow"),
            depth_stencil_attachment: Some(cleared_depth(&self.depth)),
            ..Default::default()
        });
        self.octants.record(&mut pass, record);
        Ok(())
    }

    /// Takes surfaces to be farther from the lamp by a share `bias` of their distance, 1/1000 at first, from
    /// the next submission on. It covers what a receiver's plane does not know: rounding of positions, and
    /// normals that are not the triangle's own.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] unless it is between 0 and 1/2.
    pub fn set_bias(&mut self, bias: f32) -> Result<()> {
        if !(0.0..=0.5).contains(&bias) {
            return wrong(format!("`bias` is {bias}; choose a share from 0 to 0.5"));
        }
        self.set(Shadow { bias, ..self.shadow });
        Ok(())
    }

    fn set(&mut self, shadow: Shadow) {
        self.shadow = shadow;
        self.context.queue().write_buffer(&self.uniform, 0, bytemuck::bytes_of(&shadow));
    }

    /// WGSL for the caller's shaders that draw into the map: that of [`LiveEnvironment::draw_wgsl`].
    #[must_use]
    pub fn draw_wgsl(group: u32) -> String {
        LiveEnvironment::draw_wgsl(group)
    }

    /// The layout of the group that [`Self::draw`] passes on, for the caller's pipeline layouts.
    #[must_use]
    pub const fn draw_layout(&self) -> &wgpu::BindGroupLayout {
        &self.draw_layout
    }

    /// WGSL with `octagloss_lit(position: vec3<f32>, normal: vec3<f32>) -> f32`: the share of the lamp's
    /// light that reaches a position in world space on a plane of that unit normal, which is best the
    /// triangle's own. Its resources are declared in bind group `group`.
    #[must_use]
    pub fn wgsl(group: u32) -> String {
        let resources = [
            "var<uniform> octagloss_shadow: OctaglossShadow",
            "var octagloss_shadow_depth: texture_depth_2d",
        ];
        octagloss_shaders::for_callers("common/shadow.wgsl", &resources, group, "octagloss_shadow")
    }

    /// The layout of [`Self::bind_group`], for the caller's pipeline layouts: visible to vertex, fragment and
    /// compute shaders.
    #[must_use]
    pub const fn bind_group_layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// The resources of [`Self::wgsl`]; the same group after every draw.
    #[must_use]
    pub const fn bind_group(&self) -> &wgpu::BindGroup {
        &self.bind_group
    }

    /// The resources as a group of `layout`, which wgpu derived for a pipeline from its shader.
    #[must_use]
    pub fn bind_group_of(&self, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        bind_group(&self.context, layout, &self.uniform, &self.depth)
    }
}

fn bind_group(
    context: &Context,
    layout: &wgpu::BindGroupLayout,
    uniform: &wgpu::Buffer,
    depth: &wgpu::TextureView,
) -> wgpu::BindGroup {
    let resources = [uniform.as_entire_binding(), wgpu::BindingResource::TextureView(depth)];
    group(context, "octagloss shadow", layout, resources)
}
