//! True reflections out of pyramids on the GPU: their tables, and their look-up as WGSL for callers' shaders.

use super::pyramid::{PyramidMaps, WEIGHTS_TEXTURE, wgsl_of};
use crate::Context;
use crate::device::resources::{SAMPLER, UNIFORM, group, group_layout, layers, texture_binding, write_level};
use half::f16;
use octagloss_core::pyramid::reads::{LAYERS, NODES, table};
use octagloss_core::pyramid::{Levels, albedo, anisotropic};

/// Surfaces that shaders ask for. The table of anisotropic ones takes seconds to fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surfaces {
    /// Without anisotropy.
    Isotropic,
    /// Of any anisotropy.
    Any,
}

/// The tables as a texture: a layer for each texel of a node, then the albedo, row after row.
fn texture(context: &Context, levels: Levels) -> wgpu::Texture {
    let [width, height] = NODES.map(|nodes| nodes as u32);
    let nodes = table(levels);
    let reads = (0..LAYERS).flat_map(|layer| nodes.iter().map(move |node| node[layer]));
    let mut texels: Vec<_> = reads.chain(albedo::texels()).collect();
    let depth = texels.len().div_ceil(nodes.len());
    texels.resize(depth * nodes.len(), [0.0; 4]);
    filled(context, wgpu::TextureDimension::D2, [width, height, depth as u32], &texels)
}

/// A texture of half floats.
fn filled(
    context: &Context,
    dimension: wgpu::TextureDimension,
    [width, height, depth_or_array_layers]: [u32; 3],
    texels: &[[f32; 4]],
) -> wgpu::Texture {
    let texture = context.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("reflections"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let halves: Vec<u16> =
        texels.as_flattened().iter().map(|value| f16::from_f32(*value).to_bits()).collect();
    write_level(context, &texture, 0, bytemuck::cast_slice(&halves));
    texture
}

/// Layout of a bind group with the resources of `wgsl`, for the shader stages `visibility`.
pub fn bind_group_layout(context: &Context, visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayout {
    let filterable = wgpu::TextureSampleType::Float { filterable: true };
    let layers = texture_binding(filterable, wgpu::TextureViewDimension::D2Array);
    let rows = texture_binding(filterable, wgpu::TextureViewDimension::D3);
    let bindings = [WEIGHTS_TEXTURE, UNIFORM, layers, SAMPLER, layers, rows];
    group_layout(context, "octagloss reflections", visibility, &bindings)
}

/// Bind group of `maps`, or `all` that share their textures, and the tables, with `layout`. The first call
/// for a size of maps fits the tables.
pub fn bind_group(
    context: &Context,
    maps: &PyramidMaps,
    all: bool,
    surfaces: Surfaces,
    layout: &wgpu::BindGroupLayout,
) -> wgpu::BindGroup {
    let view = layers(&texture(context, maps.levels()));
    let (sides, texels) = match surfaces {
        // Nothing is read there.
        Surfaces::Isotropic => ([1; 3], vec![[0.0; 4]]),
        Surfaces::Any => (anisotropic::TEXTURE, anisotropic::texels(maps.levels())),
    };
    let rows = filled(context, wgpu::TextureDimension::D3, sides, &texels).create_view(&Default::default());
    maps.with_resources(all, |resources| {
        let tables = [&view, &rows].map(wgpu::BindingResource::TextureView);
        group(context, "octagloss reflections", layout, resources.into_iter().chain(tables))
    })
}

/// WGSL of all look-ups over `count` lights, with their resources in bind group `group`.
pub fn wgsl(count: u32, group: u32) -> String {
    let tables = ["var octagloss_reflections: texture_2d_array<f32>", "var octagloss_rows: texture_3d<f32>"];
    wgsl_of("common/reflect_maps.wgsl", count, &tables, group)
}
