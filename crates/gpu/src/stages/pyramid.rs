//! Pyramids on the GPU: their maps, their look-up for lists of directions, and as WGSL for callers' shaders.

use super::build_pyramid;
use crate::device::readback;
use crate::device::resources::{
    SAMPLER, UNIFORM, group, group_layout, single, texture_binding, texture_of, trilinear,
};
use crate::device::stage::{Dispatch, in_rows};
use crate::{Context, Stage};
use glam::DVec3;
use octagloss_core::common::error::{Error, Result};
use octagloss_core::pyramid::fit::{self, WEIGHTS};
use octagloss_core::pyramid::light::OctaglossLight;
use octagloss_core::pyramid::{Levels, SQUARES, Square, cells, suns};

/// Invocations of a workgroup over queries.
pub const GROUP_SIZE: u32 = 64;

/// Nodes of the table of weights in a row of texels.
pub const NODES_A_ROW: u32 = 32;

/// The table of weights, which shaders load texels of.
pub(super) const WEIGHTS_TEXTURE: wgpu::BindingType =
    texture_binding(wgpu::TextureSampleType::Float { filterable: false }, wgpu::TextureViewDimension::D2);

/// Cells of a workgroup that sums harmonics.
pub const HARMONIC_CELLS: u64 = 128;

/// Sums of three channels of harmonics, in floats.
const BYTES_OF_HARMONICS: u64 = 4 * 3 * cells::BASIS as u64;

/// Moments of the light above the clamp in an area.
pub const MOMENTS_OF_AREA: u64 = 32 * suns::COUNT as u64;

/// Format of the maps.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Most environments whose lights fit a uniform of 64 KiB, WebGPU's least limit.
pub const MAX_PROBES: u32 = 64;

/// Bytes of a light: a multiple of 256, at which bindings may begin.
const LIGHT: u64 = size_of::<OctaglossLight>() as u64;

/// The maps of one environment's pyramid, in textures that several share.
#[derive(Clone, Debug)]
pub struct PyramidMaps {
    levels: Levels,
    /// Place among the pyramids that share the textures.
    probe: u32,
    weights: wgpu::TextureView,
    lights: wgpu::Buffer,
    /// [`SQUARES`] layers an environment.
    maps: wgpu::Texture,
    linear: wgpu::Sampler,
    passed: Passed,
}

/// What passes of a build hand on, overwritten by each.
#[derive(Clone, Debug)]
pub(super) struct Passed {
    /// Brightness of texels; then radiance of the rest, in halves.
    pub(super) texels: wgpu::Buffer,
    /// The brightest texel of each area.
    pub(super) areas: wgpu::Buffer,
    /// `Seeds` of the shaders.
    pub(super) seeds: wgpu::Buffer,
    /// `Excess` of the shaders: moments of the light above the clamp.
    pub(super) excess: wgpu::Buffer,
    /// Light of cells.
    pub(super) cells: wgpu::Buffer,
    /// Sums of harmonics over [`HARMONIC_CELLS`] cells each.
    pub(super) harmonics: wgpu::Buffer,
}

impl Passed {
    fn new(context: &Context, inner: u32) -> Self {
        let storage = |label, bytes| context.storage(label, bytes);
        let areas = u64::from(build_pyramid::AREAS.pow(2));
        let cells = u64::from(inner.min(cells::FINEST)).pow(2);
        Self {
            texels: storage("brightness, then the rest", 8 * u64::from(inner).pow(2)),
            areas: storage("brightest texels", 8 * areas),
            seeds: storage("seeds of suns", 16 + 16 * suns::COUNT as u64),
            excess: storage("light above the clamp", 4 * areas * (1 + MOMENTS_OF_AREA)),
            cells: storage("light of cells", 48 * cells),
            harmonics: storage("sums of harmonics", BYTES_OF_HARMONICS * cells / HARMONIC_CELLS),
        }
    }

    /// How many sums of harmonics there are.
    pub(super) fn sums_of_harmonics(&self) -> u32 {
        (self.harmonics.size() / BYTES_OF_HARMONICS) as u32
    }
}

impl PyramidMaps {
    /// The maps of an environment over an OEM of `inner` texels along an edge, black.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an `inner` that is not a power of two from 32 to 2048, [`Error::Limit`] if
    /// the device has no textures of this size.
    pub fn new(context: &Context, inner: u32) -> Result<Self> {
        Ok(Self::sharing(context, inner, 1)?.remove(0))
    }

    /// Such maps of `probes` environments, at most [`MAX_PROBES`], in shared textures.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn sharing(context: &Context, inner: u32, probes: u32) -> Result<Vec<Self>> {
        let levels = Levels::over(inner)?;
        Self::check_fits(context, levels, probes)?;
        let (weights, passed) = (weights(context, levels), Passed::new(context, inner));
        Ok(Self::in_textures(context, levels, probes, weights, passed))
    }

    /// Maps of another environment, black, in textures of their own. Builds of both pass through the same
    /// buffers.
    pub fn sibling(&self, context: &Context) -> Self {
        let (weights, passed) = (self.weights.clone(), self.passed.clone());
        Self::in_textures(context, self.levels, 1, weights, passed).remove(0)
    }

    /// Maps in new textures.
    fn in_textures(
        context: &Context,
        levels: Levels,
        probes: u32,
        weights: wgpu::TextureView,
        passed: Passed,
    ) -> Vec<Self> {
        let side = levels.size(0).bordered();
        let shape = [side, side, SQUARES * probes];
        let sampled = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let usage = sampled | wgpu::TextureUsages::STORAGE_BINDING;
        let copied = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let used = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE | copied;
        let first = Self {
            levels,
            probe: 0,
            weights,
            // Shaders of several declare the most.
            lights: context.buffer("light of pyramids", LIGHT * u64::from(MAX_PROBES), used),
            maps: context.texture("maps of pyramids", FORMAT, shape, levels.mips(), usage),
            linear: trilinear(context),
            passed,
        };
        let all: Vec<_> = (0..probes).map(|probe| Self { probe, ..first.clone() }).collect();
        for maps in &all {
            maps.set_rotation(context, [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
        }
        all
    }

    /// Checks that the maps of `probes` environments fit the device's textures.
    pub fn check_fits(context: &Context, levels: Levels, probes: u32) -> Result<()> {
        let limits = context.device().limits();
        let (side, most) = (levels.size(0).bordered(), limits.max_texture_dimension_2d);
        if side > most {
            let fits = |size: &u32| Levels::over(*size).is_ok_and(|of| of.size(0).bordered() <= most);
            let largest = Levels::sizes().rev().find(fits).unwrap_or_default();
            return Err(Error::Limit {
                what: format!("a pyramid over a map of {0} x {0}", levels.inner()),
                needed: u64::from(side),
                available: u64::from(most),
                remedy: format!("choose `oem_size` of at most {largest}"),
            });
        }
        let (needed, available) = (SQUARES * probes, limits.max_texture_array_layers);
        if needed > available {
            return Err(Error::Limit {
                what: format!("{probes} pyramids in one texture"),
                needed: u64::from(needed),
                available: u64::from(available),
                remedy: format!("choose `count` of at most {}", available / SQUARES),
            });
        }
        Ok(())
    }

    /// Sets the rotation for shaders that turn the environment, from the next submission on: columns.
    pub fn set_rotation(&self, context: &Context, world_from_source: [[f32; 4]; 3]) {
        let at = LIGHT * u64::from(self.probe);
        context.queue().write_buffer(&self.lights, at, bytemuck::bytes_of(&world_from_source));
    }

    /// Bytes of the textures of one environment.
    pub fn bytes(&self) -> u64 {
        let texels = |mip| u64::from(self.levels.size(mip).bordered()).pow(2);
        8 * u64::from(SQUARES) * (0..self.levels.mips()).map(texels).sum::<u64>()
    }

    /// The levels.
    pub const fn levels(&self) -> Levels {
        self.levels
    }

    /// The light of this environment.
    pub(super) fn light(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.lights,
            offset: LIGHT * u64::from(self.probe),
            size: std::num::NonZero::new(LIGHT),
        })
    }

    /// One of the maps.
    pub(super) fn square(&self, square: Square) -> wgpu::TextureView {
        single(&self.maps, SQUARES * self.probe + square.layer, square.mip)
    }

    pub(super) const fn passed(&self) -> &Passed {
        &self.passed
    }

    pub(super) const fn linear(&self) -> &wgpu::Sampler {
        &self.linear
    }

    /// Layout of a bind group with the resources of `wgsl`, for the shader stages `visibility`.
    pub fn bind_group_layout(context: &Context, visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayout {
        let filterable = wgpu::TextureSampleType::Float { filterable: true };
        let maps = texture_binding(filterable, wgpu::TextureViewDimension::D2Array);
        let bindings = [WEIGHTS_TEXTURE, UNIFORM, maps, SAMPLER];
        group_layout(context, "octagloss pyramid", visibility, &bindings)
    }

    /// Bind group of these resources, with `layout`.
    pub fn bind_group(&self, context: &Context, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        self.with_resources(false, |resources| group(context, "octagloss pyramid", layout, resources))
    }

    /// Bind group of these and all maps that share their textures.
    pub fn bind_group_of_all(&self, context: &Context, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        self.with_resources(true, |resources| group(context, "octagloss pyramids", layout, resources))
    }

    /// What `make` makes of the resources of this environment, or of all that share them, in the order of
    /// their bindings.
    pub(super) fn with_resources<T>(
        &self,
        all: bool,
        make: impl FnOnce([wgpu::BindingResource<'_>; 4]) -> T,
    ) -> T {
        let maps = self.maps.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            base_array_layer: if all { 0 } else { SQUARES * self.probe },
            array_layer_count: (!all).then_some(SQUARES),
            ..Default::default()
        });
        let weights = wgpu::BindingResource::TextureView(&self.weights);
        let lights = if all { self.lights.as_entire_binding() } else { self.light() };
        let linear = wgpu::BindingResource::Sampler(&self.linear);
        make([weights, lights, wgpu::BindingResource::TextureView(&maps), linear])
    }
}

/// The table of weights: five texels for each node, [`NODES_A_ROW`] side by side; and one for the size of the
/// maps.
fn weights(context: &Context, levels: Levels) -> wgpu::TextureView {
    let mut nodes = fit::table(levels);
    nodes.push([levels.inner() as f32; WEIGHTS]);
    nodes.resize(nodes.len().next_multiple_of(NODES_A_ROW as usize), [0.0; WEIGHTS]);
    let [width, height] = [NODES_A_ROW * WEIGHTS as u32 / 4, nodes.len() as u32 / NODES_A_ROW];
    let format = wgpu::TextureFormat::Rgba32Float;
    texture_of(context, "weights", format, [width, height], bytemuck::cast_slice(&nodes))
}

/// WGSL of the look-ups over `count` lights, with their resources in bind group `group`.
pub fn wgsl(count: u32, group: u32) -> String {
    wgsl_of("common/pyramid_maps.wgsl", count, &[], group)
}

/// WGSL of the look-ups in `file`, which read `further` resources, too.
pub(super) fn wgsl_of(file: &str, count: u32, further: &[&str], group: u32) -> String {
    let lights = format!("var<uniform> octagloss_lights: array<OctaglossLight, {count}>");
    let resources = [
        "var octagloss_weights: texture_2d<f32>",
        &lights,
        "var octagloss_maps: texture_2d_array<f32>",
        "var octagloss_linear: sampler",
    ];
    octagloss_shaders::for_callers(file, &[&resources, further].concat(), group, "octagloss")
}

/// Stage that answers `queries`, directions in the map's space with their roughness, and its output: four
/// floats per query.
///
/// # Panics
/// If there are more queries than fit a buffer.
pub fn stage(context: &Context, maps: &PyramidMaps, queries: &[(DVec3, f64)]) -> (Stage, wgpu::Buffer) {
    let pipeline = context.pipeline("pyramid/query.wgsl", "query", None);
    let queries: Vec<[f32; 4]> = queries
        .iter()
        .map(|(direction, roughness)| direction.as_vec3().extend(*roughness as f32).to_array())
        .collect();
    let groups = u32::try_from(queries.len()).expect("what a buffer holds").div_ceil(GROUP_SIZE);
    let answers = context.storage("answers", 16 * queries.len() as u64);
    let queries = context.storage_of("queries", &queries);
    let lists = [&queries, &answers].map(wgpu::Buffer::as_entire_binding);
    let lists = group(context, "queries", &pipeline.get_bind_group_layout(0), lists);
    let maps = maps.bind_group(context, &pipeline.get_bind_group_layout(1));
    let dispatch = Dispatch::with_groups(&pipeline, vec![lists, maps], in_rows(groups));
    (Stage::new("pyramid", vec![dispatch]), answers)
}

/// Radiance for each of `queries` in the form of [`stage`], read back.
///
/// # Errors
/// [`Error::Gpu`] if the device fails.
pub async fn radiance(
    context: &Context,
    maps: &PyramidMaps,
    queries: &[(DVec3, f64)],
) -> Result<Vec<[f32; 3]>> {
    let mut radiance = Vec::with_capacity(queries.len());
    for batch in queries.chunks(1 << 22) {
        let (stage, answers) = stage(context, maps, batch);
        context.submit(|encoder| stage.record(encoder));
        let found: Vec<[f32; 4]> = readback::read(context, &answers).await?;
        radiance.extend(found.iter().map(|[r, g, b, _]| [*r, *g, *b]));
    }
    Ok(radiance)
}
