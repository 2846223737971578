//! An environment on the GPU: its tables, and the stages that rebuild them.

use super::frame::Diffuse;
use super::levels::{self, Cube, Levels};
use glam::{DMat3, DVec3};
use octagloss_core::bake::{self, BakeSettings, bake};
use octagloss_core::common::error::Result;
use octagloss_core::cpu::reflector::ReflectorSettings;
use octagloss_core::cpu::table_bytes::{LIMIT, LobeRequest};
use octagloss_core::files::image::exposure;
use octagloss_core::light::environment::{Environment, luminance, of_sound};
use octagloss_core::light::light_scale::LightScale;
use octagloss_core::light::oem::OemSize;
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter;
use octagloss_gpu::stages::box_filter::{self, SatTextures};
use octagloss_gpu::stages::build_pyramid;
use octagloss_gpu::stages::lamp::{self, Lamp};
use octagloss_gpu::stages::pyramid::PyramidMaps;
use octagloss_gpu::stages::reflection::{self, Surfaces};
use octagloss_gpu::stages::reparameterise::{self, upload};
use octagloss_gpu::{Context, OemPlanes, Stage};
use std::cell::OnceCell;
use std::f64::consts::{FRAC_PI_2, PI};

/// An environment and its tables on the GPU.
#[derive(Debug)]
pub struct Light {
    /// In its own space; `source_from_world` maps world directions to it. Its light, and everything derived
    /// from it, is scaled by `scale`.
    environment: Environment,
    scale: LightScale,
    source_from_world: DMat3,
    lamp: wgpu::Buffer,
    mean_luminance: f64,
    /// The automatic exposure of the source, in powers of two.
    exposure: f64,
    pub(super) diffuse: wgpu::Buffer,
    /// The levels of a bake, or built on first use.
    levels: OnceCell<Cube>,
    /// Whether the levels are those of a bake.
    pub own_levels: bool,
    pub(super) boxes: SatTextures,
    pub(super) pyramid: PyramidMaps,
    /// Its groups for true reflections, isotropic and of any anisotropy, whose tables are fitted at the first
    /// use.
    reflections: [OnceCell<wgpu::BindGroup>; 2],
    /// Texels of the octahedral map.
    pub oem: OemSize,
    /// Stages from texels to tables, in order.
    stages: Vec<Stage>,
}

/// Edge of the cube of prefiltered levels.
const LEVELS_SIZE: u32 = 256;

/// The lamp after `seconds` of circling at half height, seven degrees wide. It gives half as much light as an
/// environment of `mean` luminance.
fn lamp_after(seconds: f64, mean: f64) -> Lamp {
    const DISC: f64 = 0.0523;
    const EDGE: f64 = 0.0611;
    /// Radians per second.
    const SPEED: f64 = 0.8;
    let (sin, cos) = (SPEED * seconds).sin_cos();
    let radiance = mean / (1.0 - EDGE.cos());
    Lamp::new(DVec3::new(cos, 0.7, sin), radiance as f32, DISC, EDGE)
}

impl Light {
    /// Builds the tables of `environment` with the OEM's size (or a suitable default), border and scan of
    /// `table`.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for an OEM of no texels,
    /// [`octagloss_core::common::error::Error::Limit`] if the tables exceed
    /// [`octagloss_core::bake::memory::LIMIT`] or do not fit the device.
    pub(super) fn new(
        context: &Context,
        environment: &Environment,
        table: &ReflectorSettings,
    ) -> Result<Self> {
        let source_from_world = environment.source_from_world();
        let scale = LightScale::new(environment);
        let texels = scale.scaled(environment).texels().to_vec();
        let environment = of_sound(environment.layout(), texels)?;
        let settings = ReflectorSettings { pyramid: true, ..*table };
        let (size, _) = settings.plan(environment.layout())?;
        let served = [Filter::Box, Filter::Pyramid].map(|filter| LobeRequest {
            lobe: Lobe::Ggx,
            roughness: 1.0,
            filter,
        });
        let settled = ReflectorSettings { oem_size: Some(size.inner), ..settings };
        settled.check_memory("this viewer", environment.layout(), &served, LIMIT)?;
        let texture = upload(context, &environment)?;
        let lamp_buffer = Lamp::default().buffer(context);
        let planes = OemPlanes::new(context, size)?;
        let (boxes, tables) = box_filter::tables(context, settings.scan, &planes)?;
        let pyramid = PyramidMaps::new(context, size.inner)?;
        let mut stages = vec![
            reparameterise::stage(context, environment.layout(), &texture, &planes)?,
            lamp::stage(context, &lamp_buffer, &planes),
        ];
        stages.extend(tables);
        stages.push(build_pyramid::stage(context, &planes, &pyramid));
        context.submit(|encoder| stages.iter().for_each(|stage| stage.record(encoder)));
        context.check()?;
        let mut sum = 0.0;
        environment.for_each_texel(|_, solid_angle, rgb| sum += solid_angle * f64::from(luminance(rgb)));
        let mean_luminance = sum / (4.0 * PI);
        let exposure = exposure::of_environment(&environment) + f64::from(scale.exponent());
        let diffuse = context.uniform("diffuse light", &Diffuse::new(&environment));
        let levels = OnceCell::new();
        Ok(Self {
            environment,
            scale,
            source_from_world,
            lamp: lamp_buffer,
            mean_luminance,
            exposure,
            diffuse,
            levels,
            own_levels: false,
            boxes,
            pyramid,
            reflections: [const { OnceCell::new() }; 2],
            oem: size,
            stages,
        })
    }

    /// The resources of true reflections of `surfaces`, as a group of `layout`.
    pub(super) fn reflections(
        &self,
        context: &Context,
        surfaces: Surfaces,
        layout: &wgpu::BindGroupLayout,
    ) -> wgpu::BindGroup {
        let make = || reflection::bind_group(context, &self.pyramid, false, surfaces, layout);
        self.reflections[usize::from(surfaces == Surfaces::Any)].get_or_init(make).clone()
    }

    /// The environment, in its own space. Light beyond the range of float32 arithmetic is scaled by a power
    /// of two; the exposure compensates.
    pub const fn environment(&self) -> &Environment {
        &self.environment
    }

    /// Maps directions of a world rotated by `degrees` about +Y to the environment's own space.
    pub fn source_from_world(&self, degrees: f64) -> DMat3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let turn = DMat3::from_cols_array(&[cos, 0.0, sin, 0.0, 1.0, 0.0, -sin, 0.0, cos]);
        self.source_from_world * turn
    }

    /// Stages that rebuild the tables, in order; record them whenever the light changes.
    pub fn stages(&self) -> &[Stage] {
        &self.stages
    }

    /// Places the lamp after `seconds` of circling, or removes it, and rebuilds the tables.
    pub fn move_lamp(&self, context: &Context, seconds: Option<f64>) {
        self.set_lamp(context, seconds.map(|seconds| lamp_after(seconds, self.mean_luminance)));
    }

    /// Rebuilds the tables with `lamp` added to the environment, or without a lamp.
    pub fn set_lamp(&self, context: &Context, lamp: Option<Lamp>) {
        context.queue().write_buffer(&self.lamp, 0, bytemuck::bytes_of(&lamp.unwrap_or_default()));
        let diffuse = Diffuse::of_lamp(lamp);
        context.queue().write_buffer(&self.diffuse, Diffuse::LAMP_OFFSET, bytemuck::bytes_of(&diffuse));
        context.submit(|encoder| self.stages.iter().for_each(|stage| stage.record(encoder)));
    }

    /// The automatic exposure, in powers of two.
    pub const fn exposure(&self) -> f64 {
        self.exposure
    }

    /// Converts `ev` for the source's light to the scaled light, clamped to the range of float32.
    pub(super) fn scaled_ev(&self, ev: f64) -> f64 {
        (ev - f64::from(self.scale.exponent())).clamp(-100.0, 100.0)
    }

    /// Angle of a texel of the environment or of its map, the coarser, in radians.
    pub fn texel_angle(&self) -> f64 {
        let quarter = self.environment.layout().face_edge().min(self.oem.inner.div_ceil(2));
        FRAC_PI_2 / f64::from(quarter)
    }

    /// Sets the levels of the bake whose level 0 is the environment.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Limit`] if they do not fit the device.
    pub fn set_levels(&mut self, context: &Context, levels: &Levels) -> Result<()> {
        let levels_from_source = levels.levels_from_world * self.source_from_world.transpose();
        let cube = levels::upload(context, &levels.chain, levels_from_source, self.scale.exponent())?;
        self.levels = OnceCell::from(cube);
        self.own_levels = true;
        Ok(())
    }

    /// The levels of the bake, or of a default bake of the environment.
    pub(super) fn levels(&self, context: &Context) -> Result<&Cube> {
        if let Some(cube) = self.levels.get() {
            return Ok(cube);
        }
        let settings = BakeSettings { size: LEVELS_SIZE, ..BakeSettings::default() };
        let bake::Bake { chain, .. } = bake(&self.environment, &settings)?;
        let cube = levels::upload(context, &chain, DMat3::IDENTITY, 0)?;
        Ok(self.levels.get_or_init(|| cube))
    }
}
