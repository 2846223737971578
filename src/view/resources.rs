//! Short forms of wgpu's constructors, with the choices that all passes of the viewer share.

use crate::error::{Error, Result};
use crate::gpu::Context;

/// A uniform buffer.
pub(super) const UNIFORM: wgpu::BindingType = buffer_binding(wgpu::BufferBindingType::Uniform);

/// A sampler of filterable textures.
pub(super) const SAMPLER: wgpu::BindingType = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);

/// A storage buffer.
pub(super) const fn storage_binding(read_only: bool) -> wgpu::BindingType {
    buffer_binding(wgpu::BufferBindingType::Storage { read_only })
}

const fn buffer_binding(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

/// A texture of floats.
pub(super) const fn texture_binding(
    filterable: bool,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    let sample_type = wgpu::TextureSampleType::Float { filterable };
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

/// The layout of a group with these `bindings` from 0 on.
pub(super) fn group_layout(
    context: &Context,
    label: &str,
    visibility: wgpu::ShaderStages,
    bindings: &[wgpu::BindingType],
) -> wgpu::BindGroupLayout {
    let entry =
        |(binding, ty): (u32, &_)| wgpu::BindGroupLayoutEntry { binding, visibility, ty: *ty, count: None };
    let entries: Vec<_> = (0..).zip(bindings).map(entry).collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries };
    context.device().create_bind_group_layout(&descriptor)
}

/// A group with `resources` from binding 0 on.
pub(super) fn group<'a>(
    context: &Context,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    let descriptor = wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries };
    context.device().create_bind_group(&descriptor)
}

/// The layout of a pipeline with `groups` from 0 on.
pub(super) fn pipeline_layout<'a>(
    context: &Context,
    label: &str,
    groups: impl IntoIterator<Item = &'a wgpu::BindGroupLayout>,
) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.into_iter().map(Some).collect();
    context.device().create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}

/// A pipeline that draws triangles.
pub(super) struct Draw<'a> {
    pub(super) module: &'a wgpu::ShaderModule,
    /// Entry points of the vertex and the fragment shader.
    pub(super) entries: [&'a str; 2],
    /// `None` for that of the shaders.
    pub(super) layout: Option<&'a wgpu::PipelineLayout>,
    /// Vertices; `None` if the shader makes them.
    pub(super) corners: Option<wgpu::VertexBufferLayout<'a>>,
    pub(super) target: wgpu::ColorTargetState,
    /// Whether to write depths of [`DEPTH`], and the comparison; `None` without depths.
    pub(super) depth: Option<(bool, wgpu::CompareFunction)>,
}

/// Format of depths.
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

impl Draw<'_> {
    pub(super) fn pipeline(self, context: &Context) -> wgpu::RenderPipeline {
        let Self { module, entries: [vertex, fragment], layout, corners, target, depth } = self;
        let corners = corners.map(|corners| [Some(corners)]);
        context.device().create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout,
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: corners.as_ref().map_or(&[], |corners| &corners[..]),
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: depth.map(|(is_written, compare)| wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(is_written),
                depth_compare: Some(compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(target)],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// Begins a pass that draws into `view`, cleared to black if `clear`, with depths in a texture that is
/// cleared and discarded likewise.
pub(super) fn draw_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &str,
    view: &wgpu::TextureView,
    clear: bool,
    depth: Option<(&wgpu::TextureView, wgpu::StoreOp)>,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'a> {
    let load = if clear { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
    let far = if clear { wgpu::LoadOp::Clear(1.0) } else { wgpu::LoadOp::Load };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: depth.map(|(view, store)| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations { load: far, store }),
            stencil_ops: None,
        }),
        timestamp_writes,
        ..Default::default()
    })
}

/// A texture of `[width, height, layers]` with mip `levels`.
pub(super) fn texture(
    context: &Context,
    label: &str,
    format: wgpu::TextureFormat,
    [width, height, depth_or_array_layers]: [u32; 3],
    mip_level_count: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    context.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers },
        mip_level_count,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// A texture that shaders read, filled by [`write_level`].
pub(super) fn filled_texture(
    context: &Context,
    label: &str,
    format: wgpu::TextureFormat,
    sides: [u32; 3],
    levels: u32,
) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    texture(context, label, format, sides, levels, usage)
}

/// Fills all layers of a mip level of `texture` with `bytes`, row-major, layer by layer.
pub(super) fn write_level(context: &Context, texture: &wgpu::Texture, mip_level: u32, bytes: &[u8]) {
    let size = texture.size().mip_level_size(mip_level, wgpu::TextureDimension::D2);
    let rows = size.height * size.depth_or_array_layers;
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(bytes.len() as u32 / rows),
        rows_per_image: Some(size.height),
    };
    let place = wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() };
    context.queue().write_texture(place, bytes, layout, size);
}

/// A two-dimensional texture of `bytes`, row-major.
pub(super) fn texture_of(
    context: &Context,
    label: &str,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    bytes: &[u8],
) -> wgpu::TextureView {
    let texture = filled_texture(context, label, format, [width, height, 1], 1);
    write_level(context, &texture, 0, bytes);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// A render target that can be sampled and read back.
pub(super) fn target(
    context: &Context,
    label: &str,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
        | wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::COPY_SRC;
    texture(context, label, format, [width, height, 1], 1, usage)
}

/// Format of linear pictures.
pub(super) const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// A linear picture and its depths.
#[derive(Debug)]
pub(super) struct Targets {
    /// Columns and rows.
    pub(super) size: (u32, u32),
    pub(super) picture: wgpu::TextureView,
    pub(super) depth: wgpu::TextureView,
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
        let view = |label, format| {
            let texture = target(context, label, format, [width, height]);
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        Ok(Self { size, picture: view("picture", PICTURE), depth: view("depth", DEPTH) })
    }
}
