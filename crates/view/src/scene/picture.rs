//! Pipelines of pictures, and what a picture shows.

use super::content::Bounds;
use super::look::SceneLook;
use super::probe::SceneBuffers;
use super::renderer::SceneRenderer;
use super::uniforms::{FrameUniform, MAX_PROBES, SceneCorner};
use crate::look::camera::field_of_angle;
use crate::picture::resources::{PICTURE, Targets, draw_pass};
use bytemuck::Zeroable as _;
use glam::DVec3;
use octagloss_core::common::error::Result;
use octagloss_gpu::Context;
use octagloss_gpu::device::resources::{Draw, UNIFORM, added, group, group_layout, storage_binding};

/// Vertical angle of view in radians.
const ANGLE: f64 = 0.6;

/// Pipelines of pictures.
#[derive(Debug)]
pub(super) struct Pictures {
    frame: wgpu::Buffer,
    frame_group: wgpu::BindGroup,
    matte: wgpu::RenderPipeline,
    cover: wgpu::RenderPipeline,
    glossy: wgpu::RenderPipeline,
}

impl Pictures {
    pub(super) fn new(
        context: &Context,
        live_layout: &wgpu::BindGroupLayout,
        buffers: &SceneBuffers,
    ) -> Self {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let kinds = [UNIFORM, UNIFORM, storage_binding(true), storage_binding(true)];
        let frame_layout = group_layout(context, "scene frame", stages, &kinds);
        let frame = context.uniform("scene frame", &FrameUniform::zeroed());
        let resources = [&frame, &buffers.light, &buffers.parts, &buffers.texels];
        let resources = resources.map(wgpu::Buffer::as_entire_binding);
        let frame_group = group(context, "scene frame", &frame_layout, resources);
        let groups = [&frame_layout, live_layout];
        let (less, equal) = (wgpu::CompareFunction::Less, wgpu::CompareFunction::Equal);
        Self {
            matte: pipeline(context, ["matte_corner", "matte"], &groups[..1], less, None),
            cover: pipeline(context, ["glossy_corner", "cover_glossy"], &groups[..1], less, None),
            glossy: pipeline(context, ["glossy_corner", "glossy"], &groups, equal, Some(added())),
            frame,
            frame_group,
        }
    }
}

impl SceneRenderer {
    /// Records a linear picture of `size` samples.
    pub(super) fn record_picture(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        look: &SceneLook,
        size: (u32, u32),
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> Result<()> {
        look.check()?;
        let Self { context, scene, buffers, lives, centres, pictures, targets, .. } = self;
        if targets.as_ref().is_none_or(|targets| targets.size != size) {
            *targets = Some(Targets::new(context, size)?);
        }
        let Targets { picture, depth, .. } = targets.as_ref().expect("made");
        let three = |v: DVec3| v.as_vec3().to_array();
        let frame = look.camera.frame(f64::from(size.0) / f64::from(size.1), field_of_angle(ANGLE));
        let Bounds { low, high, radius } = scene.bounds;
        let mut positions = [[0.0; 4]; MAX_PROBES];
        for (place, centre) in positions.iter_mut().zip(&*centres) {
            *place = centre.as_vec3().extend(0.0).to_array();
        }
        let uniform = FrameUniform {
            clip_from_world: frame.clip_from_world.as_mat4().to_cols_array_2d(),
            eye: three(frame.eye),
            exposure: look.exposure.exp2() as f32,
            low: three(low),
            proxy: look.proxy as u32,
            high: three(high),
            probes: centres.len() as u32,
            sphere: (0.5 * (low + high)).as_vec3().extend(radius as f32).to_array(),
            centres: positions,
        };
        context.queue().write_buffer(&pictures.frame, 0, bytemuck::bytes_of(&uniform));

        let depth = Some((depth, wgpu::StoreOp::Discard));
        let mut pass = draw_pass(encoder, "picture", picture, true, depth, timestamp_writes);
        pass.set_vertex_buffer(0, buffers.corners.slice(..));
        pass.set_index_buffer(buffers.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.set_bind_group(0, &pictures.frame_group, &[]);
        let all = scene.indices.len() as u32;
        let matte = scene.parts.get(scene.glossy().start).map_or(all, |part| part.indices.start);
        pass.set_pipeline(&pictures.matte);
        pass.draw_indexed(0..matte, 0, 0..1);
        pass.set_pipeline(&pictures.cover);
        pass.draw_indexed(matte..all, 0, 0..1);
        if let Some(lives) = lives {
            pass.set_pipeline(&pictures.glossy);
            pass.set_bind_group(1, lives.bind_group(), &[]);
            pass.draw_indexed(matte..all, 0, 0..1);
        }
        Ok(())
    }
}

fn pipeline(
    context: &Context,
    entries: [&str; 2],
    groups: &[&wgpu::BindGroupLayout],
    compare: wgpu::CompareFunction,
    blend: Option<wgpu::BlendState>,
) -> wgpu::RenderPipeline {
    let corners = wgpu::VertexBufferLayout {
        array_stride: size_of::<SceneCorner>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        // In the order of the struct.
        attributes: &wgpu::vertex_attr_array![
            0 => Float32x3, 1 => Uint32, 2 => Float32x3, 5 => Float32, 3 => Float32x3, 6 => Float32,
            4 => Float32x3
        ],
    };
    Draw {
        file: "view/scene.wgsl",
        entries,
        groups,
        corners: Some(corners),
        target: wgpu::ColorTargetState { format: PICTURE, blend, write_mask: wgpu::ColorWrites::ALL },
        depth: Some((blend.is_none(), compare)),
    }
    .pipeline(context)
}
