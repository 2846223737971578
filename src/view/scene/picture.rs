//! Pipelines of pictures, and what a picture shows.

use super::super::camera::field_of_angle;
use super::content::{Bounds, Scene};
use super::look::SceneLook;
use super::probe::SceneBuffers;
use super::uniforms::{FrameUniform, MOST_PROBES, SceneCorner};
use crate::error::{Error, Result};
use crate::gpu::Context;
use crate::gpu::device::shader;
use glam::DVec3;

pub(super) const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Vertical angle of view in radians.
const ANGLE: f64 = 0.6;

/// What a picture is drawn from.
#[derive(Debug)]
pub(super) struct Drawn<'a> {
    pub(super) scene: &'a Scene,
    pub(super) buffers: &'a SceneBuffers,
    /// The group of all probes, if there are glossy parts.
    pub(super) lives: Option<&'a wgpu::BindGroup>,
}

/// Textures of one size.
#[derive(Debug)]
pub(super) struct Targets {
    pub(super) size: (u32, u32),
    pub(super) picture: wgpu::TextureView,
    depth: wgpu::TextureView,
}

/// Pipelines of pictures.
#[derive(Debug)]
pub(super) struct Pictures {
    frame: wgpu::Buffer,
    frame_group: wgpu::BindGroup,
    matte: wgpu::RenderPipeline,
    cover: wgpu::RenderPipeline,
    glossy: wgpu::RenderPipeline,
}

impl Targets {
    /// # Errors
    /// [`Error::Parameter`] for a size that the device does not have.
    pub(super) fn new(context: &Context, size: (u32, u32)) -> Result<Self> {
        let most = context.device().limits().max_texture_dimension_2d;
        let (width, height) = size;
        if !(1..=most).contains(&width) || !(1..=most).contains(&height) {
            return Err(Error::Parameter(format!(
                "a picture of {width} x {height} pixels; each side must be 1 to {most}"
            )));
        }
        let texture = |label, format| super::super::textures::target(context, label, format, [width, height]);
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let (picture, depth) = (texture("picture", PICTURE), texture("depth", DEPTH));
        Ok(Self { size, picture: view(&picture), depth: view(&depth) })
    }
}

impl Pictures {
    pub(super) fn new(
        context: &Context,
        live_layout: &wgpu::BindGroupLayout,
        buffers: &SceneBuffers,
    ) -> Self {
        let device = context.device();
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let uniform = wgpu::BufferBindingType::Uniform;
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        let frame_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("scene frame"),
            entries: &[entry(0, uniform), entry(1, uniform), entry(2, storage), entry(3, storage)],
        });
        let frame = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("scene frame"),
            size: size_of::<FrameUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let resources = [&frame, &buffers.light, &buffers.parts, &buffers.texels];
        let frame_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scene frame"),
            layout: &frame_layout,
            entries: &[0, 1, 2, 3].map(|k| wgpu::BindGroupEntry {
                binding: k as u32,
                resource: resources[k].as_entire_binding(),
            }),
        });
        let module = shader::module(context, "view/scene.wgsl");
        let groups = [Some(&frame_layout), Some(live_layout)];
        let build = |vertex, fragment, groups: &[Option<&wgpu::BindGroupLayout>], depth, blend| {
            pipeline(device, &module, [vertex, fragment], groups, depth, blend)
        };
        let (less, equal) = (wgpu::CompareFunction::Less, wgpu::CompareFunction::Equal);
        Self {
            matte: build("matte_corner", "matte", &groups[..1], less, None),
            cover: build("glossy_corner", "cover_glossy", &groups[..1], less, None),
            glossy: build("glossy_corner", "glossy", &groups, equal, Some(added())),
            frame,
            frame_group,
        }
    }

    /// Writes the uniform of a picture `aspect` times as wide as high, of probes at `centres`.
    pub(super) fn set_frame(
        &self,
        context: &Context,
        look: &SceneLook,
        aspect: f64,
        bounds: &Bounds,
        centres: &[DVec3],
    ) {
        let three = |v: DVec3| v.as_vec3().to_array();
        let frame = look.camera.frame(aspect, field_of_angle(ANGLE));
        let Bounds { low, high, radius } = *bounds;
        let mut positions = [[0.0; 4]; MOST_PROBES];
        for (place, centre) in positions.iter_mut().zip(centres) {
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
        context.queue().write_buffer(&self.frame, 0, bytemuck::bytes_of(&uniform));
    }

    /// Records the pass that draws a scene into `targets`.
    pub(super) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        Drawn { scene, buffers, lives }: &Drawn<'_>,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &targets.picture,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes,
            ..Default::default()
        });
        pass.set_vertex_buffer(0, buffers.corners.slice(..));
        pass.set_index_buffer(buffers.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.set_bind_group(0, &self.frame_group, &[]);
        let all = scene.indices.len() as u32;
        let matte = scene.parts.get(scene.glossy().start).map_or(all, |part| part.indices.start);
        pass.set_pipeline(&self.matte);
        pass.draw_indexed(0..matte, 0, 0..1);
        pass.set_pipeline(&self.cover);
        pass.draw_indexed(matte..all, 0, 0..1);
        if let Some(lives) = lives {
            pass.set_pipeline(&self.glossy);
            pass.set_bind_group(1, *lives, &[]);
            pass.draw_indexed(matte..all, 0, 0..1);
        }
    }
}

/// Adds colours up.
fn added() -> wgpu::BlendState {
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    wgpu::BlendState { color: add, alpha: add }
}

fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    [vertex, fragment]: [&str; 2],
    groups: &[Option<&wgpu::BindGroupLayout>],
    depth_compare: wgpu::CompareFunction,
    blend: Option<wgpu::BlendState>,
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(fragment),
        bind_group_layouts: groups,
        immediate_size: 0,
    });
    let attribute =
        |shader_location, offset, format| wgpu::VertexAttribute { format, offset, shader_location };
    let three = wgpu::VertexFormat::Float32x3;
    let attributes = [
        attribute(0, 0, three),
        attribute(1, 12, wgpu::VertexFormat::Uint32),
        attribute(2, 16, three),
        attribute(3, 32, three),
        attribute(4, 48, three),
        attribute(5, 28, wgpu::VertexFormat::Float32),
        attribute(6, 44, wgpu::VertexFormat::Float32),
    ];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<SceneCorner>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            })],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(blend.is_none()),
            depth_compare: Some(depth_compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: PICTURE,
                blend,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
