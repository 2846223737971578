//! The real-time tier on the GPU: for lists of directions, and as WGSL for the caller's shaders.
//!
//! ```text
//! OEM planes --build_fitted--> emitters, texture; tables, harmonics and least radiance of the residual map
//!                                                      |
//!                                                      +--> octagloss_fitted(direction, roughness)
//! ```

use super::device::readback;
use super::device::stage::{Dispatch, in_rows};
use super::octaves::{Octave, OctaveLayout};
use super::{Context, Stage};
use crate::cpu::fitted::HARMONICS_FROM;
use crate::error::{Error, Result};
use crate::lobe::{Lobe, kernel_integral, zonal_weights};
use crate::realtime::emitters;
use crate::realtime::tables::{BOX_PARAMETERS, COUNTS, KNOTS, Table};
use glam::DVec3;
use half::f16;
use std::f64::consts::PI;

/// Invocations of a workgroup.
pub const GROUP_SIZE: u32 = 64;

/// Coefficients of the polynomials for harmonics, over the roughness range from [`HARMONICS_FROM`] to 1.
const ZONAL: usize = 8;

/// Coefficients of the polynomial for peaks, over the roughness range of boxes and emitters.
const PEAK: usize = 12;

/// Least roughness of that range, slightly below that of the finest octave's sharpest lobe.
pub(super) const PEAK_FROM: f64 = 0.09;

/// Byte offset of the emitter array in `OctaglossLight`: it follows least radiance, units and harmonics.
pub const EMITTERS_OFFSET: u64 = 16 * (1 + 2 + 25);

/// Byte offset of its rotation.
pub const ROTATION_OFFSET: u64 = EMITTERS_OFFSET + 32 * emitters::COUNT as u64;

/// Bytes of `OctaglossLight`: a multiple of 256, at which bindings may begin.
pub(crate) const LIGHT: u64 = (ROTATION_OFFSET + 48).next_multiple_of(256);

/// Most tables that share buffers: their lights are one uniform.
pub(super) const MAX_LIGHTS: u32 = 14;

/// Uniform with the positions of the tables and the current lobes.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Octaves {
    inner: u32,
    finest: u32,
    entries: u32,
    sharpest: f32,
    models: [Model; 2],
    peak: [[f32; 4]; PEAK / 4],
    zonal: [[f32; 4]; ZONAL],
    octaves: [Octave; super::octaves::OCTAVES],
}

/// One table of parameters, in the shader's layout.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Model {
    boxes: u32,
    first_parameters: u32,
    first_wider: u32,
    intervals: u32,
}

/// All tables, in the order of their parameters in the buffer.
fn tables() -> impl Iterator<Item = &'static Table> {
    let counts = COUNTS.iter().map(|count| Table::of(*count).expect("a count that there is"));
    counts.chain([Table::around_cone_points()])
}

/// The table of `count` boxes, and the one around cone points.
fn models(count: u32) -> [Model; 2] {
    let table = Table::of(count).expect("a count that there is");
    [Some(table), table.beside_cone_points()].map(|table| table.map_or(Model::default(), model))
}

fn model(table: &Table) -> Model {
    let wider = table.shape().wider;
    let first_wider = wider.iter().position(|wider| *wider > 0).unwrap_or(wider.len());
    assert!(wider[first_wider..].iter().all(|wider| *wider == 1), "an octave wider from one box on");
    let before = tables().take_while(|other| !std::ptr::eq(*other, table));
    // A row per box and one for the harmonics, at every node of every knot of every octave.
    let first_parameters: usize = before.map(|other| other.values().len() / BOX_PARAMETERS).sum();
    Model {
        boxes: wider.len() as u32,
        first_parameters: first_parameters as u32,
        first_wider: first_wider as u32,
        intervals: table.shape().grid.intervals() as u32,
    }
}

/// The parameters of all tables, as half floats: rows of five padded to eight.
fn parameters() -> Vec<[u16; 8]> {
    let row =
        |five: &[f32]| std::array::from_fn(|k| f16::from_f32(five.get(k).copied().unwrap_or(0.0)).to_bits());
    tables().flat_map(|table| table.values().chunks_exact(BOX_PARAMETERS).map(row)).collect()
}

/// Weights of orders 1 to 4 as polynomials over the roughness from [`HARMONICS_FROM`] to 1. The weights are
/// analytic except at roughness 0; the error is below 1e-7.
fn zonal() -> [[f32; 4]; ZONAL] {
    let weights = |roughness: f64| {
        let [_, others @ ..] = zonal_weights(Lobe::Ggx, roughness * roughness);
        others
    };
    polynomials(HARMONICS_FROM, weights).map(|row| row.map(|value| value as f32))
}

/// 1 over pi times the lobe's integral as a polynomial over the roughness from [`PEAK_FROM`] to 1, to a
/// relative 5e-8.
fn peak() -> [[f32; 4]; PEAK / 4] {
    let reciprocal = |roughness: f64| [1.0 / (PI * kernel_integral(Lobe::Ggx, roughness * roughness))];
    let powers: [[f64; 1]; PEAK] = polynomials(PEAK_FROM, reciprocal);
    std::array::from_fn(|row| std::array::from_fn(|k| powers[4 * row + k][0] as f32))
}

/// Interpolates `functions` of the roughness from `from` to 1 at Chebyshev points; returns polynomials in t
/// from -1 to 1, lowest power first.
fn polynomials<const POWERS: usize, const COUNT: usize>(
    from: f64,
    functions: impl Fn(f64) -> [f64; COUNT],
) -> [[f64; COUNT]; POWERS] {
    let node = |k: usize| ((2 * k + 1) as f64 / (2 * POWERS) as f64 * PI).cos();
    let mut sums = [[0.0; COUNT]; POWERS];
    for k in 0..POWERS {
        let t = node(k);
        let values = functions(from + (1.0 - from) * (t + 1.0) / 2.0);
        // Lagrange polynomial of this point.
        let mut own = [0.0; POWERS];
        own[0] = 1.0;
        for other in (0..POWERS).filter(|other| *other != k).map(node) {
            for power in (0..POWERS).rev() {
                let lower = if power > 0 { own[power - 1] } else { 0.0 };
                own[power] = (lower - other * own[power]) / (t - other);
            }
        }
        for (sum, own) in sums.iter_mut().zip(own) {
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += own * value;
            }
        }
    }
    sums
}

/// Bytes of the entries of one map of `inner` texels along an edge.
fn bytes(inner: u32) -> u64 {
    32 * u64::from(OctaveLayout::new(inner).entries)
}

/// Tables for fitted lobes, in the form that shaders query.
///
/// The stages of [`super::build_fitted::stages`] fill them; record these whenever the light has changed.
/// `octagloss_fitted(direction, roughness)` of `common/fitted.wgsl` reads them; the roughness may differ per
/// pixel.
#[derive(Clone, Debug)]
pub struct FittedTables {
    inner: u32,
    /// Place among the tables that share the buffers.
    probe: u32,
    octaves: wgpu::Buffer,
    lights: wgpu::Buffer,
    entries: wgpu::Buffer,
    parameters: wgpu::Buffer,
    oems: wgpu::Texture,
}

impl FittedTables {
    /// Tables over an OEM of `inner` texels along an edge, for lobes of `count` boxes (1, 2, 4 or 8).
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unsupported count, and for an `inner` that is not a power of two of at
    /// least 16; [`Error::Limit`] if the tables exceed the device's buffers or textures.
    pub fn new(context: &Context, inner: u32, count: u32) -> Result<Self> {
        Ok(Self::sharing(context, inner, count, 1)?.remove(0))
    }

    /// `probes` such tables in shared buffers, at most [`MAX_LIGHTS`]. They share the count of boxes, too.
    ///
    /// # Errors
    /// Those of [`FittedTables::new`].
    pub(super) fn sharing(context: &Context, inner: u32, count: u32, probes: u32) -> Result<Vec<Self>> {
        crate::filter::Filter::Fitted(count).check(Lobe::Ggx, Some(inner))?;
        Self::check_fits(context, inner, probes)?;
        let parameters = context.storage_of("parameters of fitted lobes", &parameters());
        let first = Self::with_parameters(context, inner, count, probes, parameters);
        Ok((0..probes).map(|probe| Self { probe, ..first.clone() }).collect())
    }

    /// Other tables of this size, for lobes of `count` boxes (1, 2, 4 or 8); they share the parameters.
    pub(super) fn sibling(&self, context: &Context, count: u32) -> Self {
        Self::with_parameters(context, self.inner, count, 1, self.parameters.clone())
    }

    /// The first of `probes` tables.
    fn with_parameters(
        context: &Context,
        inner: u32,
        count: u32,
        probes: u32,
        parameters: wgpu::Buffer,
    ) -> Self {
        let layout = OctaveLayout::new(inner);
        let octaves = Octaves {
            inner,
            finest: layout.finest,
            entries: layout.entries,
            sharpest: (KNOTS[0] - f64::from(layout.finest)).exp2() as f32,
            models: models(count),
            peak: peak(),
            zonal: zonal(),
            octaves: layout.octaves,
        };
        let device = context.device();
        let lights = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("light of fitted lobes"),
            // Shaders of several declare the most.
            size: LIGHT * u64::from(MAX_LIGHTS),
            usage: wgpu::BufferUsages::UNIFORM
                | wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let oems = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("OEM"),
            size: wgpu::Extent3d { width: inner, height: inner, depth_or_array_layers: probes },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
            view_formats: &[],
        });
        Self {
            inner,
            probe: 0,
            octaves: context.uniform("octaves", &octaves),
            lights,
            entries: context.storage("blurred tables", u64::from(probes) * bytes(inner)),
            parameters,
            oems,
        }
    }

    /// Checks that `probes` tables over OEMs of `inner` texels fit the device.
    pub(super) fn check_fits(context: &Context, inner: u32, probes: u32) -> Result<()> {
        let most = context.device().limits().max_texture_dimension_2d;
        if inner > most {
            return Err(Error::Limit {
                what: format!("an OEM of {inner} x {inner} as a texture"),
                needed: 16 * u64::from(inner) * u64::from(inner),
                available: 16 * u64::from(most) * u64::from(most),
                remedy: format!("choose `oem_size` of at most {most}"),
            });
        }
        let all = u64::from(probes);
        context.fits("tables of blurred octaves", all * bytes(inner), |available| {
            let sizes = (4..u32::BITS).map(|log2| 1 << log2).take_while(|smaller| *smaller < inner);
            let fitting = sizes.filter(|smaller| all * bytes(*smaller) <= available).last();
            format!("choose `oem_size` of at most {}, or `engine` cpu", fitting.unwrap_or(0))
        })
    }

    /// Most tables over OEMs of `inner` texels that share buffers on the device.
    pub(super) fn most_probes(context: &Context, inner: u32) -> u32 {
        let limits = context.device().limits();
        let available = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
        (available / bytes(inner)).min(u64::from(MAX_LIGHTS)) as u32
    }

    /// Selects lobes of `count` boxes (1, 2, 4 or 8) from the next submission on. The tables stay unchanged.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unsupported count.
    pub fn set_count(&self, context: &Context, count: u32) -> Result<()> {
        crate::filter::Filter::Fitted(count).check(Lobe::Ggx, None)?;
        let at = std::mem::offset_of!(Octaves, models) as u64;
        context.queue().write_buffer(&self.octaves, at, bytemuck::bytes_of(&models(count)));
        Ok(())
    }

    /// Texels along an edge of the OEM's square.
    #[must_use]
    pub const fn inner(&self) -> u32 {
        self.inner
    }

    pub(super) const fn octaves(&self) -> &wgpu::Buffer {
        &self.octaves
    }

    /// Sets the rotation for shaders that turn the environment, from the next submission on: columns.
    pub(super) fn set_rotation(&self, context: &Context, world_from_source: [[f32; 4]; 3]) {
        let at = LIGHT * u64::from(self.probe) + ROTATION_OFFSET;
        context.queue().write_buffer(&self.lights, at, bytemuck::bytes_of(&world_from_source));
    }

    /// The light of these tables.
    #[must_use]
    pub fn light(&self) -> wgpu::BufferBinding<'_> {
        self.part(&self.lights, LIGHT)
    }

    /// The entries of these tables.
    #[must_use]
    pub fn entries(&self) -> wgpu::BufferBinding<'_> {
        self.part(&self.entries, bytes(self.inner))
    }

    /// The bytes of these tables in a shared buffer that has `bytes` of each.
    fn part<'a>(&self, buffer: &'a wgpu::Buffer, bytes: u64) -> wgpu::BufferBinding<'a> {
        let offset = bytes * u64::from(self.probe);
        wgpu::BufferBinding { buffer, offset, size: std::num::NonZero::new(bytes) }
    }

    /// The map of these tables, as a texture of one layer.
    pub(super) fn oem(&self) -> wgpu::TextureView {
        self.layers(wgpu::TextureViewDimension::D2, self.probe, Some(1))
    }

    fn layers(
        &self,
        dimension: wgpu::TextureViewDimension,
        first: u32,
        count: Option<u32>,
    ) -> wgpu::TextureView {
        self.oems.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(dimension),
            base_array_layer: first,
            array_layer_count: count,
            ..Default::default()
        })
    }

    /// Layout of a bind group with the resources of `common/fitted.wgsl`, for the shader stages `visibility`.
    #[must_use]
    pub fn bind_group_layout(device: &wgpu::Device, visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayout {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("octagloss fitted lobes"),
            entries: &Self::layout_entries(visibility),
        })
    }

    /// The entries of that layout.
    fn layout_entries(visibility: wgpu::ShaderStages) -> [wgpu::BindGroupLayoutEntry; 5] {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
        let buffer = |binding, ty| {
            entry(
                binding,
                wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            )
        };
        let uniform = wgpu::BufferBindingType::Uniform;
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        };
        [buffer(0, uniform), buffer(1, uniform), buffer(2, storage), buffer(3, storage), entry(4, texture)]
    }

    /// Bind group of the tables' resources, with `layout`.
    #[must_use]
    pub fn bind_group(&self, device: &wgpu::Device, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let oem = self.layers(wgpu::TextureViewDimension::D2Array, self.probe, Some(1));
        self.bind_group_over(device, layout, self.light(), self.entries(), &oem)
    }

    /// Bind group of these and all tables that share their buffers.
    pub(super) fn bind_group_of_all(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
    ) -> wgpu::BindGroup {
        let oems = self.layers(wgpu::TextureViewDimension::D2Array, 0, None);
        let [lights, entries] = [&self.lights, &self.entries].map(wgpu::Buffer::as_entire_buffer_binding);
        self.bind_group_over(device, layout, lights, entries, &oems)
    }

    fn bind_group_over(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        lights: wgpu::BufferBinding<'_>,
        entries: wgpu::BufferBinding<'_>,
        oems: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let resources = [
            self.octaves.as_entire_binding(),
            wgpu::BindingResource::Buffer(lights),
            wgpu::BindingResource::Buffer(entries),
            self.parameters.as_entire_binding(),
            wgpu::BindingResource::TextureView(oems),
        ];
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let label = Some("octagloss fitted lobes");
        device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout, entries: &entries })
    }
}

/// Pipeline for lists of queries.
#[derive(Clone, Debug)]
pub struct Fitted {
    pipeline: wgpu::ComputePipeline,
}

impl Fitted {
    /// Compiles the stage.
    #[must_use]
    pub fn new(context: &Context) -> Self {
        Self { pipeline: context.pipeline("fitted.wgsl", "fitted", None) }
    }

    /// Stage that answers `queries`, directions in the OEM's space with their roughness, and its output: four
    /// floats per query.
    ///
    /// # Panics
    /// If there are more queries than fit a buffer.
    #[must_use]
    pub fn stage(
        &self,
        context: &Context,
        tables: &FittedTables,
        queries: &[(DVec3, f64)],
    ) -> (Stage, wgpu::Buffer) {
        let queries: Vec<[f32; 4]> = queries
            .iter()
            .map(|(direction, roughness)| direction.as_vec3().extend(*roughness as f32).to_array())
            .collect();
        let groups = u32::try_from(queries.len()).expect("what a buffer holds").div_ceil(GROUP_SIZE);
        let answers = context.storage("answers", 16 * queries.len() as u64);
        let queries = context.storage_of("queries", &queries);
        let device = context.device();
        let tables = tables.bind_group(device, &self.pipeline.get_bind_group_layout(0));
        let lists = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("queries"),
            layout: &self.pipeline.get_bind_group_layout(1),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: queries.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: answers.as_entire_binding() },
            ],
        });
        let workgroups = in_rows(groups);
        let dispatch = Dispatch::with_groups(&self.pipeline, vec![tables, lists], workgroups);
        (Stage::new("fitted", vec![dispatch]), answers)
    }

    /// Radiance for each of `queries` in the form of [`Fitted::stage`], read back.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    pub async fn radiance(
        &self,
        context: &Context,
        tables: &FittedTables,
        queries: &[(DVec3, f64)],
    ) -> Result<Vec<[f32; 3]>> {
        let mut radiance = Vec::with_capacity(queries.len());
        for batch in queries.chunks(1 << 22) {
            let (stage, answers) = self.stage(context, tables, batch);
            context.submit(|encoder| stage.record(encoder));
            let found: Vec<[f32; 4]> = readback::read(context, &answers).await?;
            radiance.extend(found.iter().map(|[r, g, b, _]| [*r, *g, *b]));
        }
        Ok(radiance)
    }
}
