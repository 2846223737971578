//! Short forms of wgpu's constructors, with the choices that passes share.

use super::context::Context;

/// A uniform buffer.
pub const UNIFORM: wgpu::BindingType = buffer_binding(wgpu::BufferBindingType::Uniform);

/// A sampler of filterable textures.
pub const SAMPLER: wgpu::BindingType = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);

/// A storage buffer.
pub const fn storage_binding(read_only: bool) -> wgpu::BindingType {
    buffer_binding(wgpu::BufferBindingType::Storage { read_only })
}

const fn buffer_binding(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

/// A texture.
pub const fn texture_binding(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

/// The layout of a group with these `bindings` from 0 on.
pub fn group_layout(
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

/// A group with `resources` at the bindings that they are listed with.
pub(crate) fn group_at<'a>(
    context: &Context,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: impl IntoIterator<Item = (u32, wgpu::BindingResource<'a>)>,
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = resources.into_iter().map(entry).collect();
    let descriptor = wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries };
    context.device().create_bind_group(&descriptor)
}

/// A group with `resources` from binding 0 on.
pub fn group<'a>(
    context: &Context,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
) -> wgpu::BindGroup {
    group_at(context, label, layout, (0..).zip(resources))
}

/// The layout of a pipeline with `groups` from 0 on.
pub fn pipeline_layout<'a>(
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

/// A texture that shaders read, filled by [`write_level`].
pub fn filled_texture(
    context: &Context,
    label: &str,
    format: wgpu::TextureFormat,
    sides: [u32; 3],
    levels: u32,
) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    context.texture(label, format, sides, levels, usage)
}

/// Fills all layers of a mip level of `texture` with `bytes`, row-major, layer by layer. Of a
/// texture of three dimensions, the finest.
pub fn write_level(context: &Context, texture: &wgpu::Texture, mip_level: u32, bytes: &[u8]) {
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
pub fn texture_of(
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

/// Format of depths.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Adds colours up.
pub fn added() -> wgpu::BlendState {
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    wgpu::BlendState { color: add, alpha: add }
}

/// A pipeline that draws triangles.
pub struct Draw<'a> {
    /// The file of its shaders.
    pub file: &'a str,
    /// Entry points of the vertex and the fragment shader.
    pub entries: [&'a str; 2],
    /// Layouts of its groups from 0 on; none for those of the shaders.
    pub groups: &'a [&'a wgpu::BindGroupLayout],
    /// Vertices; `None` if the shader makes them.
    pub corners: Option<wgpu::VertexBufferLayout<'a>>,
    /// Format and blending of the colour.
    pub target: wgpu::ColorTargetState,
    /// Whether to write depths of [`DEPTH`], and the comparison; `None` without depths.
    pub depth: Option<(bool, wgpu::CompareFunction)>,
}

impl Draw<'_> {
    /// Compiles it.
    pub fn pipeline(self, context: &Context) -> wgpu::RenderPipeline {
        let Self { file, entries: [vertex, fragment], groups, corners, target, depth } = self;
        let module = &context.module(file);
        let layout = (!groups.is_empty()).then(|| pipeline_layout(context, file, groups.iter().copied()));
        let corners = corners.map(|corners| [Some(corners)]);
        context.device().create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: layout.as_ref(),
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

/// A sampler, linear in texels and levels, clamped to the edge.
pub fn trilinear(context: &Context) -> wgpu::Sampler {
    context.device().create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}

/// The finest level of `texture` as an array of layers.
pub(crate) fn layers(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        mip_level_count: Some(1),
        ..Default::default()
    })
}

/// One level of one layer of `texture`.
pub(crate) fn single(texture: &wgpu::Texture, layer: u32, level: u32) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_array_layer: layer,
        array_layer_count: Some(1),
        base_mip_level: level,
        mip_level_count: Some(1),
        ..Default::default()
    })
}
