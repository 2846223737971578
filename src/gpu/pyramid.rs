//! Pyramids on the GPU: their maps, the passes that build them from an OEM, and their look-up.
//!
//! ```text
//! OEM planes --suns--> light (suns, scale)
//!  +--mirror--> mirror --sharp--> sharp level --cascade--> level 0 --cascade--> level 1 ...
//!  +--cells--> cells --cosine--> cosine map
//!                +--harmonics--> light
//! ```

use super::device::readback;
use super::device::shader::{self, Queries};
use super::device::stage::{Dispatch, in_rows};
use super::{Context, OemPlanes, Stage};
use crate::error::{Error, Result};
use crate::oem::OemSize;
use crate::pyramid::fit::{INTERVALS, WEIGHTS, Weights};
use crate::pyramid::levels::{TAPS, taps};
use crate::pyramid::{COARSEST, Octaves, cells, suns};
use glam::DVec3;

/// Invocations of a workgroup over queries, blocks or cells.
pub const GROUP_SIZE: u32 = 64;

/// Invocations of the workgroup that chooses suns.
pub const SUNS_GROUP_SIZE: u32 = 256;

/// Invocations along an edge of a workgroup over texels.
pub const EDGE: u32 = 8;

/// Format of the maps.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Most environments whose lights fit a uniform of 64 KiB, WebGPU's least limit, side by side.
pub const MOST_PROBES: u32 = 64;

/// Table and sizes of a look-up: `OctaglossPyramid` of the shaders.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Table {
    inner: f32,
    border: f32,
    octaves: u32,
    pad: u32,
    weights: [[f32; WEIGHTS]; INTERVALS as usize + 1],
}

shader::members!(Table { inner, border, octaves, pad, weights });

/// `OctaglossSun` of the shaders.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SunWords {
    /// Mean direction.
    pub direction: [f32; 3],
    /// Mean squared distance of its light from there.
    pub spread: f32,
    /// Radiance times solid angle.
    pub energy: [f32; 3],
    pad: f32,
}

shader::members!(SunWords { direction, spread, energy, pad });

/// `OctaglossPyramidLight` of the shaders.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Light {
    world_from_source: [[f32; 4]; 3],
    /// The power of two that scales the maps.
    pub scale: f32,
    /// Its inverse.
    pub unscale: f32,
    /// What the rest is clamped to, scaled.
    pub clamp: f32,
    pad: f32,
    /// Harmonics of the rest, scaled.
    pub harmonics: [[f32; 4]; 25],
    /// Suns.
    pub suns: [SunWords; suns::COUNT],
    pad_to_256: [f32; 12],
}

shader::members!(Light { world_from_source, scale, unscale, clamp, pad, harmonics, suns, pad_to_256 });

/// `Level` of the shaders.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Level {
    inner: u32,
    border: u32,
    finer_inner: u32,
    finer_border: u32,
    variance: f32,
    pad: [u32; 3],
    taps: [[f32; 4]; TAPS],
}

shader::members!(Level { inner, border, finer_inner, finer_border, variance, pad, taps });

impl Level {
    /// A map of `size` under a Gaussian of `variance` over one of the size `finer`.
    fn new(size: OemSize, finer: OemSize, variance: f64) -> Self {
        Self {
            inner: size.inner,
            border: size.border,
            finer_inner: finer.inner,
            finer_border: finer.border,
            variance: variance as f32,
            pad: [0; 3],
            taps: taps().map(|(place, weight)| [place.x, place.y, weight, 0.0]),
        }
    }
}

/// The maps of one environment's pyramid, in textures that several share.
#[derive(Clone, Debug)]
pub struct PyramidMaps {
    octaves: Octaves,
    /// Place among the pyramids that share the textures.
    probe: u32,
    table: wgpu::Buffer,
    lights: wgpu::Buffer,
    /// The chain: one layer an environment.
    levels: wgpu::Texture,
    /// Mirror and sharp level: two layers an environment.
    sharp: wgpu::Texture,
    cosine: wgpu::Texture,
    linear: wgpu::Sampler,
}

/// Size of the cosine map.
const COSINE: OemSize = OemSize { inner: COARSEST, border: 1 };

impl PyramidMaps {
    /// The maps of an environment over an OEM of `inner` texels along an edge, black.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an `inner` that is not a power of two from 32 to 2048, [`Error::Limit`] if the
    /// device has no textures of this size.
    pub fn new(context: &Context, inner: u32) -> Result<Self> {
        Ok(Self::sharing(context, inner, 1)?.remove(0))
    }

    /// Such maps of `probes` environments, at most [`MOST_PROBES`], in shared textures.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn sharing(context: &Context, inner: u32, probes: u32) -> Result<Vec<Self>> {
        let octaves = Octaves::over(inner)?;
        let size = octaves.size(0);
        let limits = context.device().limits();
        if size.bordered() > limits.max_texture_dimension_2d || 2 * probes > limits.max_texture_array_layers {
            let most = limits.max_texture_dimension_2d;
            return Err(Error::Limit {
                what: format!("{probes} pyramids over maps of {inner} x {inner}"),
                needed: u64::from(size.bordered()),
                available: u64::from(most),
                remedy: format!("choose `size` of at most {}", (most / 2 + 1).next_power_of_two() / 2),
            });
        }
        let device = context.device();
        let texture = |label, size: OemSize, layers, mips| {
            let (width, height) = (size.bordered(), size.bordered());
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
                mip_level_count: mips,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: FORMAT,
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        };
        let mut weights = [[0.0; WEIGHTS]; INTERVALS as usize + 1];
        weights.copy_from_slice(Weights::of(octaves).nodes());
        let table = Table {
            inner: inner as f32,
            border: size.border as f32,
            octaves: octaves.count(),
            pad: 0,
            weights,
        };
        let lights = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("light of pyramids"),
            size: size_of::<Light>() as u64 * u64::from(probes),
            usage: wgpu::BufferUsages::UNIFORM
                | wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let first = Self {
            octaves,
            probe: 0,
            table: context.uniform("pyramid", &table),
            lights,
            levels: texture("levels", size, probes, octaves.count()),
            sharp: texture("sharp levels", size, 2 * probes, 1),
            cosine: texture("cosine maps", COSINE, probes, 1),
            linear: device.create_sampler(&wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
        };
        let all: Vec<_> = (0..probes).map(|probe| Self { probe, ..first.clone() }).collect();
        for maps in &all {
            maps.set_rotation(context, [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
        }
        Ok(all)
    }

    /// Sets the rotation for shaders that turn the environment, from the next submission on: columns.
    pub(super) fn set_rotation(&self, context: &Context, world_from_source: [[f32; 4]; 3]) {
        let at = size_of::<Light>() as u64 * u64::from(self.probe);
        context.queue().write_buffer(&self.lights, at, bytemuck::bytes_of(&world_from_source));
    }

    /// Bytes of the textures of one environment.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let texels = |size: OemSize| u64::from(size.bordered()).pow(2);
        let chain: u64 = (0..self.octaves.count()).map(|level| texels(self.octaves.size(level))).sum();
        8 * (chain + 2 * texels(self.octaves.size(0)) + texels(COSINE))
    }

    /// The levels.
    #[must_use]
    pub const fn octaves(&self) -> Octaves {
        self.octaves
    }

    fn light(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.lights,
            offset: size_of::<Light>() as u64 * u64::from(self.probe),
            size: std::num::NonZero::new(size_of::<Light>() as u64),
        })
    }

    /// One level of one layer.
    fn single(texture: &wgpu::Texture, layer: u32, level: u32) -> wgpu::TextureView {
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: layer,
            array_layer_count: Some(1),
            base_mip_level: level,
            mip_level_count: Some(1),
            ..Default::default()
        })
    }

    /// Bind group of the resources of a look-up, with `layout`.
    #[must_use]
    pub fn bind_group(&self, device: &wgpu::Device, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let layers = |texture: &wgpu::Texture, count| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                base_array_layer: count * self.probe,
                array_layer_count: Some(count),
                ..Default::default()
            })
        };
        let [levels, sharp, cosine] = [(&self.levels, 1), (&self.sharp, 2), (&self.cosine, 1)]
            .map(|(texture, count)| layers(texture, count));
        let resources = [
            self.table.as_entire_binding(),
            self.light(),
            wgpu::BindingResource::TextureView(&levels),
            wgpu::BindingResource::TextureView(&sharp),
            wgpu::BindingResource::TextureView(&cosine),
            wgpu::BindingResource::Sampler(&self.linear),
        ];
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("octagloss pyramid"),
            layout,
            entries: &entries,
        })
    }

    /// Reads the light back.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    pub async fn read_light(&self, context: &Context) -> Result<Light> {
        let lights: Vec<Light> = readback::read(context, &self.lights).await?;
        Ok(lights[self.probe as usize])
    }
}

/// WGSL with `octagloss_radiance(direction, roughness)` and `octagloss_irradiance(normal)` over a pyramid,
/// with its resources at bindings 0 to 5 of group `group`.
#[must_use]
pub fn wgsl(group: u32) -> String {
    shader::queries(&[Queries::Pyramid(group)])
}

/// The passes that fill [`PyramidMaps`].
#[derive(Clone, Debug)]
pub struct BuildPyramid {
    brightest: wgpu::ComputePipeline,
    suns: wgpu::ComputePipeline,
    mirror: wgpu::ComputePipeline,
    sharp: wgpu::ComputePipeline,
    cascade: wgpu::ComputePipeline,
    cells: wgpu::ComputePipeline,
    cosine: wgpu::ComputePipeline,
    harmonics: wgpu::ComputePipeline,
}

impl BuildPyramid {
    /// Compiles the passes.
    #[must_use]
    pub fn new(context: &Context) -> Self {
        let [suns, levels, cells] = ["pyramid/suns.wgsl", "pyramid/levels.wgsl", "pyramid/cells.wgsl"]
            .map(|path| shader::module(context, path));
        let pipeline = |module, entry| shader::pipeline(context, module, entry, &[]);
        Self {
            brightest: pipeline(&suns, "brightest_of_blocks"),
            suns: pipeline(&suns, "suns"),
            mirror: pipeline(&levels, "mirror"),
            sharp: pipeline(&levels, "sharp"),
            cascade: pipeline(&levels, "cascade"),
            cells: pipeline(&cells, "cells_of_texels"),
            cosine: pipeline(&cells, "cosine"),
            harmonics: pipeline(&cells, "harmonics"),
        }
    }

    /// The stages that fill `maps` from `oem`, in order. Record them whenever `oem` has changed.
    ///
    /// # Panics
    /// If `maps` were made for another size.
    #[must_use]
    pub fn stages(&self, context: &Context, oem: &OemPlanes, maps: &PyramidMaps) -> Vec<Stage> {
        let octaves = maps.octaves;
        assert_eq!(oem.size().inner, octaves.inner(), "maps for this size");
        let table = (0, oem.table_buffer().as_entire_binding());
        let light = || maps.light();
        let mut planes = vec![table.clone()];
        planes.extend((1..).zip(oem.planes().iter().map(wgpu::Buffer::as_entire_binding)));
        let dispatch = |pipeline: &_, resources: &[(u32, wgpu::BindingResource<'_>)], workgroups| {
            Dispatch::new(context, pipeline, resources, workgroups)
        };
        let size = octaves.size(0);
        let squares = |size: OemSize| [size.inner / EDGE, size.inner / EDGE, 1];
        let level = |size, finer, variance| context.uniform("level", &Level::new(size, finer, variance));
        let view = |texture, layer, mip| PyramidMaps::single(texture, layer, mip);
        let probe = maps.probe;

        let side = size.inner.min(suns::FINEST);
        let blocks = context.storage("brightest of blocks", 4 * u64::from(side * side));
        let blocks_at = (5, blocks.as_entire_binding());
        let suns = Stage::new(
            "suns",
            vec![
                dispatch(
                    &self.brightest,
                    &[&planes[..], std::slice::from_ref(&blocks_at)].concat(),
                    [(side * side).div_ceil(GROUP_SIZE), 1, 1],
                ),
                dispatch(&self.suns, &[&planes[..], &[blocks_at, (6, light())]].concat(), [1, 1, 1]),
            ],
        );

        let mirror = view(&maps.sharp, 2 * probe, 0);
        let to_mirror = level(size, size, 0.0);
        let mut dispatches = vec![dispatch(
            &self.mirror,
            &[
                &planes[..],
                &[
                    (5, light()),
                    (7, to_mirror.as_entire_binding()),
                    (8, wgpu::BindingResource::TextureView(&mirror)),
                ],
            ]
            .concat(),
            squares(size),
        )];
        let sharp = view(&maps.sharp, 2 * probe + 1, 0);
        let to_sharp = level(size, size, octaves.sharp_width().powi(2));
        dispatches.push(dispatch(
            &self.sharp,
            &[
                (5, light()),
                (6, wgpu::BindingResource::TextureView(&mirror)),
                (7, to_sharp.as_entire_binding()),
                (8, wgpu::BindingResource::TextureView(&sharp)),
            ],
            squares(size),
        ));
        let (mut finer, mut finer_size) = (sharp, size);
        for k in 0..octaves.count() {
            let own = view(&maps.levels, probe, k);
            let own_size = octaves.size(k);
            let to_level = level(own_size, finer_size, 0.75 * octaves.width(k).powi(2));
            dispatches.push(dispatch(
                &self.cascade,
                &[
                    (6, wgpu::BindingResource::TextureView(&finer)),
                    (7, to_level.as_entire_binding()),
                    (8, wgpu::BindingResource::TextureView(&own)),
                    (9, wgpu::BindingResource::Sampler(&maps.linear)),
                ],
                squares(own_size),
            ));
            (finer, finer_size) = (own, own_size);
        }
        let levels = Stage::new("levels", dispatches);

        let side = size.inner.min(cells::FINEST);
        let count = side * side;
        let cells = context.storage("cells of the light", 48 * u64::from(count));
        let cells_at = (6, cells.as_entire_binding());
        let cosine = view(&maps.cosine, probe, 0);
        let to_cosine = level(COSINE, COSINE, 0.0);
        let moments = Stage::new(
            "cells",
            vec![
                dispatch(
                    &self.cells,
                    &[&planes[..], &[(5, light()), cells_at.clone()]].concat(),
                    [count.div_ceil(GROUP_SIZE), 1, 1],
                ),
                dispatch(
                    &self.cosine,
                    &[
                        table.clone(),
                        cells_at.clone(),
                        (7, to_cosine.as_entire_binding()),
                        (8, wgpu::BindingResource::TextureView(&cosine)),
                    ],
                    [COARSEST * COARSEST / GROUP_SIZE, 1, 1],
                ),
                dispatch(&self.harmonics, &[table.clone(), (5, light()), cells_at], [25, 1, 1]),
            ],
        );
        vec![suns, levels, moments]
    }
}

/// Pipeline for lists of queries.
#[derive(Clone, Debug)]
pub struct PyramidQuery {
    pipeline: wgpu::ComputePipeline,
}

impl PyramidQuery {
    /// Compiles the stage.
    #[must_use]
    pub fn new(context: &Context) -> Self {
        let module = shader::module(context, "pyramid/query.wgsl");
        Self { pipeline: shader::pipeline(context, &module, "query", &[]) }
    }

    /// Stage that answers `queries`, directions in the map's space with their roughness, and its output: four
    /// floats per query.
    ///
    /// # Panics
    /// If there are more queries than fit a buffer.
    #[must_use]
    pub fn stage(
        &self,
        context: &Context,
        maps: &PyramidMaps,
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
        let maps = maps.bind_group(device, &self.pipeline.get_bind_group_layout(0));
        let lists = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("queries"),
            layout: &self.pipeline.get_bind_group_layout(1),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: queries.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: answers.as_entire_binding() },
            ],
        });
        let dispatch = Dispatch::with_groups(&self.pipeline, vec![maps, lists], in_rows(groups));
        (Stage::new("pyramid", vec![dispatch]), answers)
    }

    /// Radiance for each of `queries` in the form of [`Self::stage`], read back.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    pub async fn radiance(
        &self,
        context: &Context,
        maps: &PyramidMaps,
        queries: &[(DVec3, f64)],
    ) -> Result<Vec<[f32; 3]>> {
        let (stage, answers) = self.stage(context, maps, queries);
        context.submit(|encoder| stage.record(encoder));
        let found: Vec<[f32; 4]> = readback::read(context, &answers).await?;
        Ok(found.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect())
    }
}
