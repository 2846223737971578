//! True reflections out of pyramids on the GPU: their table, their look-up for lists of frames, and as WGSL
//! for callers' shaders.

use super::Context;
use super::device::readback;
use super::device::resources::{SAMPLER, UNIFORM, group, group_at, group_layout, texture_binding};
use super::device::shader;
use super::device::stage::{Dispatch, Stage, in_rows};
use super::pyramid::{GROUP_SIZE, PyramidMaps, RESOURCES};
use crate::error::Result;
use crate::pyramid::Octaves;
use crate::pyramid::reads::{LAYERS, NODES, table};
use glam::DVec3;
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

/// Layout of a bind group with the resources of [`wgsl`], for the shader stages `visibility`.
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
    maps.with_resources(|resources| {
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
    shader::for_callers("common/reflect.wgsl", &resources, group, "octagloss")
}

/// What a reflection is asked for.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Query {
    /// Normal in the map's space.
    pub normal: [f32; 3],
    /// Perceptual roughness.
    pub roughness: f32,
    /// Towards the viewer, in the map's space.
    pub view: [f32; 3],
    /// Reflectance at grazing incidence.
    pub f90: f32,
    /// Reflectance at normal incidence.
    pub f0: [f32; 3],
    pad: f32,
}

impl Query {
    /// A query with directions of any length.
    #[must_use]
    pub fn new(normal: DVec3, view: DVec3, roughness: f32, f0: [f32; 3], f90: f32) -> Self {
        let [normal, view] = [normal, view].map(|direction| direction.as_vec3().to_array());
        Self { normal, roughness, view, f90, f0, pad: 0.0 }
    }
}

/// For each of `queries` the radiance, and the share of f0 in the albedo.
///
/// # Errors
/// [`crate::Error::Gpu`] if the device fails.
pub async fn reflect(context: &Context, maps: &PyramidMaps, queries: &[Query]) -> Result<Vec<[f32; 4]>> {
    let pipeline = context.pipeline("pyramid/reflect_query.wgsl", "query", None);
    let groups = u32::try_from(queries.len()).expect("what a buffer holds").div_ceil(GROUP_SIZE);
    let answers = context.storage("answers", 16 * queries.len() as u64);
    let queries = context.storage_of("queries", queries);
    let maps = bind_group(context, maps, &pipeline.get_bind_group_layout(0));
    let lists = [(0, queries.as_entire_binding()), (1, answers.as_entire_binding())];
    let lists = group_at(context, "queries", &pipeline.get_bind_group_layout(1), lists);
    let dispatch = Dispatch::with_groups(&pipeline, vec![maps, lists], in_rows(groups));
    let stage = Stage::new("reflections", vec![dispatch]);
    context.submit(|encoder| stage.record(encoder));
    readback::read(context, &answers).await
}
