//! Keeps the probes of a scene up to date and draws pictures.

use super::super::look::{Technique, Tone};
use super::content::Scene;
use super::look::SceneLook;
use super::picture::Pictures;
use super::probe::{Probe, ProbePasses, SceneBuffers};
use super::uniforms::MAX_PROBES;
use crate::picture::model::filled_buffer;
use crate::picture::present::{Display, Presenter};
use crate::picture::resources::{Targets, Times};
use crate::picture::screenshot::{Screenshot, presented};
use glam::DVec3;
use half::f16;
use octagloss_core::common::error::{Result, wrong};
use octagloss_drawing::bitmap::Bitmap;
use octagloss_gpu::Context;
use octagloss_gpu::device::readback;
use octagloss_gpu::device::timer::Timer;
use octagloss_gpu::direct::Method;
use octagloss_gpu::live::layout;
use octagloss_gpu::live_probes::LiveProbes;
use web_time::Instant;

/// Passes of a measured frame, at most: lists, six faces, eight stages, pose, picture.
const PASSES: u32 = 17;

/// Rounds of updates before a picture that does not move: reflections of reflections of reflections.
pub(super) const ROUNDS: usize = 3;

/// How the probes are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneSettings {
    /// How the scene comes into their maps.
    pub method: Method,
    /// Number of probes: at most one a glossy part, and as many as have tables that fit one binding.
    /// Parts without a probe blend all by distance.
    pub probes: usize,
    /// Edge of their octahedral maps; a cube has as many texels.
    pub size: u32,
}

impl Default for SceneSettings {
    fn default() -> Self {
        Self { method: Method::Octants, probes: MAX_PROBES, size: 256 }
    }
}

/// Checks that scenes have `filter`.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Parameter`] for other filters than the real-time tier.
pub fn check_scene_filter(filter: Technique) -> Result<()> {
    match filter {
        Technique::Pyramid => Ok(()),
        other => wrong(format!("`filter` {other} is not for scenes; use pyramid")),
    }
}

/// A scene on one device.
#[derive(Debug)]
pub struct SceneRenderer {
    pub(super) context: Context,
    pub(super) scene: Scene,
    settings: SceneSettings,
    passes: ProbePasses,
    pub(super) buffers: SceneBuffers,
    probes: Vec<Probe>,
    /// Their tables; `None` without glossy parts.
    pub(super) lives: Option<LiveProbes>,
    /// Where each probe was at its last update.
    pub(super) centres: Vec<DVec3>,
    pub(super) pictures: Pictures,
    pub(super) targets: Option<Targets>,
    presenter: Presenter,
    time: f64,
    roughness: Option<f64>,
}

impl SceneRenderer {
    /// Uploads `scene` and creates its probes, at time 0. Their maps are black until they are updated.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for invalid settings,
    /// [`octagloss_core::common::error::Error::Limit`] if the scene or the tables do not fit the device,
    /// [`octagloss_core::common::error::Error::Gpu`] if a shader fails to compile.
    pub fn new(context: Context, scene: Scene, settings: SceneSettings) -> Result<Self> {
        let corner_bytes: &[u8] = bytemuck::cast_slice(&scene.corners);
        let index_bytes: &[u8] = bytemuck::cast_slice(&scene.indices);
        let storage = wgpu::BufferUsages::STORAGE;
        let parts = scene.part_uniforms(0.0, None, 0);
        let buffers = SceneBuffers {
            corners: buffer(&context, "corners", wgpu::BufferUsages::VERTEX | storage, corner_bytes)?,
            indices: buffer(&context, "triangles", wgpu::BufferUsages::INDEX, index_bytes)?,
            parts: buffer(&context, "parts", storage, bytemuck::cast_slice(&parts))?,
            texels: buffer(&context, "texels of textures", storage, scene.texels.bytes())?,
            light: context.uniform("scene light", &scene.light_uniform()),
        };
        let layout = layout(&context);
        let passes = ProbePasses::new(&context, &layout)?;
        let pictures = Pictures::new(&context, &layout, &buffers);
        let mut renderer = Self {
            presenter: Presenter::new(&context),
            context,
            scene,
            settings,
            passes,
            buffers,
            probes: Vec::new(),
            lives: None,
            centres: Vec::new(),
            pictures,
            targets: None,
            time: 0.0,
            roughness: None,
        };
        renderer.configure(settings)?;
        Ok(renderer)
    }

    /// Replaces the probes by those of `settings`, black until they are updated.
    ///
    /// # Errors
    /// Those of [`SceneRenderer::new`]; the probes stay.
    pub fn configure(&mut self, settings: SceneSettings) -> Result<()> {
        let glossy = self.scene.glossy();
        let count = settings.probes.min(glossy.len());
        if count == 0 && !glossy.is_empty() {
            return wrong("no probes; choose 1 to 8");
        }
        let SceneSettings { method, size, .. } = settings;
        let Self { context, passes, scene, buffers, .. } = self;
        let count = count.min(LiveProbes::most(context) as usize);
        let mut lives = (count > 0).then(|| LiveProbes::on(context, size, count as u32)).transpose()?;
        let pairs = glossy.zip(lives.iter_mut().flat_map(|lives| lives.iter_mut()));
        let probes: Vec<Probe> = pairs
            .map(|(part, live)| Probe::new(context, passes, scene, buffers, part, method, live))
            .collect::<Result<_>>()?;
        self.centres = probes.iter().map(|probe| self.scene.place(probe.part, self.time)).collect();
        (self.lives, self.probes, self.settings) = (lives, probes, settings);
        self.write_parts();
        self.context.check()
    }

    /// The device.
    pub const fn context(&self) -> &Context {
        &self.context
    }

    /// The scene.
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// How the probes are drawn.
    pub const fn settings(&self) -> SceneSettings {
        self.settings
    }

    /// Number of probes.
    pub fn probes(&self) -> usize {
        self.probes.len()
    }

    /// Triangles of the scene.
    pub fn triangles(&self) -> usize {
        self.probes.first().map_or(self.scene.indices.len() / 3, |probe| probe.mesh.triangles() as usize)
    }

    /// Moves the parts to `time` in seconds. Glossy parts have `roughness`, or their own.
    pub fn set_time(&mut self, time: f64, roughness: Option<f64>) {
        (self.time, self.roughness) = (time, roughness);
        self.write_parts();
    }

    fn write_parts(&self) {
        let parts = self.scene.part_uniforms(self.time, self.roughness, self.probes.len());
        self.context.queue().write_buffer(&self.buffers.parts, 0, bytemuck::cast_slice(&parts));
    }

    /// Draws the scene of the current time into the maps of `probes` and builds their tables, in order.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Gpu`] if the device fails.
    ///
    /// # Panics
    /// If there are fewer probes.
    pub fn update(&mut self, probes: &[usize]) -> Result<()> {
        for probe in probes {
            let mut encoder = self.context.device().create_command_encoder(&Default::default());
            self.record_update(&mut encoder, *probe, None)?;
            self.context.queue().submit([encoder.finish()]);
        }
        self.context.check()
    }

    /// Records the update of one probe; returns the labels of its passes in a timer's slots.
    fn record_update(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        index: usize,
        timer: Option<&Timer>,
    ) -> Result<Vec<&'static str>> {
        let Self { context, probes, centres, .. } = self;
        let (probe, lives) = (&probes[index], self.lives.as_mut().expect("tables of the probes"));
        let centre = self.scene.place(probe.part, self.time);
        centres[index] = centre;
        let writes = timer.map(|timer| timer.compute_writes(probe.passes));
        probe.pose(context, encoder, centre, lives.bind_group(), writes);
        let mut labels = probe.fill(&mut lives[index], encoder, timer)?;
        labels.push("pose");
        Ok(labels)
    }

    /// Draws a linear picture of `size` samples.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for an unsupported size or look,
    /// [`octagloss_core::common::error::Error::Gpu`] if the device fails.
    pub fn draw(&mut self, look: &SceneLook, size: (u32, u32)) -> Result<()> {
        let mut encoder = self.context.device().create_command_encoder(&Default::default());
        self.record_picture(&mut encoder, look, size, None)?;
        self.context.queue().submit([encoder.finish()]);
        self.context.check()
    }

    /// Seconds of the passes of one probe's update and of a picture, which are done once more: labels in
    /// order, the picture last.
    ///
    /// # Errors
    /// Those of [`SceneRenderer::draw`], and [`octagloss_core::common::error::Error::Gpu`] if the adapter has
    /// no timestamp queries.
    pub(super) fn times(
        &mut self,
        look: &SceneLook,
        size: (u32, u32),
    ) -> Result<impl Future<Output = Result<Times>> + use<>> {
        let timer = Timer::new(&self.context, PASSES)?;
        let mut encoder = self.context.device().create_command_encoder(&Default::default());
        let mut labels = Vec::new();
        if !self.probes.is_empty() {
            labels = self.record_update(&mut encoder, 0, Some(&timer))?;
        }
        let picture = labels.len() as u32;
        self.record_picture(&mut encoder, look, size, Some(timer.render_writes(picture)))?;
        self.context.queue().submit([encoder.finish()]);
        labels.push("picture");
        let context = self.context.clone();
        Ok(async move {
            let seconds = timer.read(&context, labels.len() as u32).await?;
            let mut sums = Times::new();
            for (label, seconds) in labels.into_iter().zip(seconds) {
                match sums.last_mut().filter(|(last, _)| *last == label) {
                    Some((_, sum)) => *sum += seconds,
                    None => sums.push((label, seconds)),
                }
            }
            Ok(sums)
        })
    }

    /// Seconds from the submission of one probe's update, which is done once more, to its completion.
    ///
    /// # Errors
    /// Those of [`SceneRenderer::update`].
    pub(super) fn update_time(&mut self) -> Result<impl Future<Output = Result<Times>> + use<>> {
        let start = Instant::now();
        self.update(&[0])?;
        let context = self.context.clone();
        Ok(async move {
            readback::finished(&context).await?;
            Ok(vec![("update", start.elapsed().as_secs_f64())])
        })
    }

    /// Draws the last picture to `display`, tone-mapped, in sRGB.
    ///
    /// # Panics
    /// If no picture was drawn.
    pub fn present(&mut self, display: Display<'_>, tone: Tone) {
        let picture = &self.targets.as_ref().expect("a picture was drawn").picture;
        self.presenter.present(picture, display, tone);
    }

    /// Reads the map of a probe: linear radiance, 1 where it shows a triangle, row by row, face by face.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Gpu`] if the device fails.
    ///
    /// # Panics
    /// If there are fewer probes.
    pub async fn map(&self, probe: usize) -> Result<Vec<[f32; 4]>> {
        let map = &self.probes[probe].target.colour;
        let texels: Vec<[f16; 4]> = readback::read_texture(&self.context, map).await?;
        Ok(texels.into_iter().map(|texel| texel.map(f16::to_f32)).collect())
    }

    /// Reads the last picture: linear radiance times exposure, row by row.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Gpu`] if the device fails.
    ///
    /// # Panics
    /// If no picture was drawn.
    pub async fn pixels(&self) -> Result<Vec<[f32; 3]>> {
        let texture = self.targets.as_ref().expect("a picture was drawn").picture.texture();
        let texels: Vec<[f16; 4]> = readback::read_texture(&self.context, texture).await?;
        Ok(texels.into_iter().map(|[red, green, blue, _]| [red, green, blue].map(f16::to_f32)).collect())
    }
}

/// Renders `look` at `time` as a window would show it after some frames, in sRGB.
///
/// # Errors
/// Those of [`SceneRenderer::draw`].
pub async fn screenshot_of_scene(
    renderer: &mut SceneRenderer,
    look: &SceneLook,
    time: f64,
    Screenshot { width, height, samples }: Screenshot,
    progress: impl Fn(usize, usize),
) -> Result<Bitmap> {
    renderer.set_time(time, look.roughness);
    let context = renderer.context().clone();
    let probes = renderer.probes();
    for update in 0..ROUNDS * probes {
        renderer.update(&[update % probes])?;
        readback::finished(&context).await?;
        progress(update + 1, ROUNDS * probes);
    }
    renderer.draw(look, (width.saturating_mul(samples), height.saturating_mul(samples)))?;
    presented(&context, [width, height], |display| renderer.present(display, look.tone)).await
}

/// A buffer of the scene's `content`.
fn buffer(context: &Context, content: &str, usage: wgpu::BufferUsages, bytes: &[u8]) -> Result<wgpu::Buffer> {
    let limits = context.device().limits();
    let available = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
    filled_buffer(context, ["scene", content], usage, bytes, available)
}
