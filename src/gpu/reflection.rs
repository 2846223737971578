//! True reflections out of pyramids on the GPU: their table, and their look-up as WGSL for callers' shaders.

use super::Context;
use super::device::resources::{SAMPLER, UNIFORM, group, group_layout, texture_binding};
use super::device::shader;
use super::pyramid::{PyramidMaps, RESOURCES};
use crate::pyramid::Octaves;
use crate::pyramid::reads::{LAYERS, NODES, table};
use half::f16;

/// The table as a texture: a layer for each texel of a node.
fn texture(context: &Context, octaves: Octaves) -> wgpu::Texture {
    let [width, height] = NODES.map(|nodes| nodes as u32);
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let size = [width, height, LAYERS as u32];
    let texture = context.texture("reflections", wgpu::TextureFormat::Rgba16Float, size, 1, usage);
    let nodes = table(octaves);
    let layers = (0..LAYERS).flat_map(|layer| nodes.iter().flat_map(move |node| node[layer]));
    let texels: Vec<u16> = layers.map(|value| f16::from_f32(value).to_bits()).collect();
    context.queue().write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&texels),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(8 * width),
            rows_per_image: Some(height),
        },
        texture.size(),
    );
    texture
}

/// Layout of a bind group with the resources of `wgsl`, for the shader stages `visibility`.
#[must_use]
pub fn bind_group_layout(context: &Context, visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayout {
    let filterable = wgpu::TextureSampleType::Float { filterable: true };
    let layers = texture_binding(filterable, wgpu::TextureViewDimension::D2Array);
    let bindings = [UNIFORM, UNIFORM, layers, layers, layers, SAMPLER, layers];
    group_layout(context, "octagloss reflections", visibility, &bindings)
}

/// Bind group of `maps` and the table, with `layout`. The first call for a size of maps fits the table.
#[must_use]
pub fn bind_group(context: &Context, maps: &PyramidMaps, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
    let view = texture(context, maps.octaves()).create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    maps.with_resources(false, |resources| {
        let table = wgpu::BindingResource::TextureView(&view);
        group(context, "octagloss reflections", layout, resources.into_iter().chain([table]))
    })
}

/// WGSL of all look-ups of one environment, with their resources in bind group `group`.
pub(super) fn wgsl(group: u32) -> String {
    let lights = "var<uniform> octagloss_lights: array<OctaglossLight, 1>";
    let mut resources = RESOURCES.to_vec();
    resources.insert(1, lights);
    resources.push("var octagloss_reflections: texture_2d_array<f32>");
    shader::for_callers("common/reflect_maps.wgsl", &resources, group, "octagloss")
}

/// How the look-ups of files are used.
#[cfg(any(test, feature = "internals"))]
const READER: &str = "\
// Reads files of `octagloss bake --target pyramid`: reflections of any roughness and view, and irradiance.
// octagloss_lights holds the 256 floats `uniform` of NAME_pyramid.json, octagloss_maps NAME_pyramid.ktx2,
// octagloss_tables pyramid_tables.ktx2; octagloss_linear is a sampler, linear in texels and in mip levels and
// clamped to the edge. Directions are in the world, right-handed, y up. To use: octagloss_radiance,
// octagloss_irradiance, octagloss_reflect and octagloss_albedo; `probe` is 0.
";

/// WGSL of the look-ups of pyramids in files, as [`crate::target::READERS`] has it.
#[cfg(any(test, feature = "internals"))]
#[must_use]
pub fn reader_wgsl() -> String {
    let resources = [
        "var<uniform> octagloss_lights: array<OctaglossLight, 1>",
        "var octagloss_maps: texture_2d_array<f32>",
        "var octagloss_tables: texture_2d<f32>",
        "var octagloss_linear: sampler",
    ];
    READER.to_owned() + &shader::for_callers("common/pyramid_file.wgsl", &resources, 0, "octagloss")
}
