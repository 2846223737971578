//! A scene in a window: time, the probes' turns, and the panel.

use super::super::camera::Camera;
use super::super::look::Tone;
use super::super::panel::{SLIDER, WIDTH, choice};
use super::super::present::Viewport;
use super::super::window::{Content, open};
use super::content::Scene;
use super::picture::{Proxy, SceneLook};
use super::renderer::{SceneRenderer, SceneSettings};
use super::schedule::Schedule;
use crate::error::{Error, Result};
use crate::gpu::direct::Method;
use crate::gpu::{Context, block_on};
use crate::mesh::Mesh;
use egui::{Checkbox, Color32, Grid, RichText, ScrollArea, Slider, Ui};
use std::path::Path;
use std::time::{Duration, Instant};

/// Target time of a frame.
const FRAME: Duration = Duration::from_millis(40);

/// Greatest pixels per sample along an edge.
const COARSEST: f64 = 10.0;

/// Interval between measurements of the passes' times.
const TIMES: Duration = Duration::from_millis(500);

/// Drawing methods and their names.
const METHODS: [(Method, &str); 8] = [
    (Method::Octants, "octants"),
    (Method::ClipMask, "clip mask"),
    (Method::StrictSplit, "strict split"),
    (Method::XzSplit, "XZ-split (wrong)"),
    (Method::EdgeStrip, "edge strip (wrong)"),
    (Method::PerCorner, "per corner (wrong)"),
    (Method::Cube, "cube"),
    (Method::WholeCube, "whole cube"),
];

/// Initial content of a window that shows a scene.
#[derive(Debug)]
pub struct SceneStart {
    /// The scene.
    pub scene: Scene,
    /// Its name.
    pub name: String,
    /// The initial look.
    pub look: SceneLook,
    /// How the probes are drawn.
    pub settings: SceneSettings,
    /// Time at the beginning, in seconds.
    pub time: f64,
    /// Seconds of a frame for the probes; `None` updates all in every frame.
    pub budget: Option<f64>,
    /// Part of the GPU's name; `None` selects the best that can present.
    pub adapter: Option<String>,
    /// Window size in points.
    pub size: (u32, u32),
}

/// Opens a window with a scene and runs its event loop until it is closed.
///
/// # Errors
/// [`Error::Gpu`] if no window or no device is available, [`Error::Limit`] if the scene does not fit it.
pub fn run_scene(start: SceneStart) -> Result<()> {
    let (name, size) = (start.name.clone(), start.size);
    open::<SceneViewer>(start, &name, size)
}

/// State of the window's content.
#[derive(Debug)]
struct SceneViewer {
    renderer: SceneRenderer,
    look: SceneLook,
    first_camera: Camera,
    /// What the panel selects; the renderer has the last that worked.
    settings: SceneSettings,
    name: String,
    adapter: String,
    message: Option<String>,
    panel_hidden: bool,
    time: f64,
    playing: bool,
    /// Milliseconds of a frame for the probes, and whether they are limited.
    budget: f64,
    limited: bool,
    schedule: Schedule,
    /// Probes updated in the last frame.
    updated: usize,
    timing: bool,
    times: Vec<(&'static str, f64)>,
    measured: Option<Instant>,
    last_frame: Instant,
    /// Duration of the last frame, if frames follow each other.
    passed: Duration,
    /// Pixels per sample along an edge.
    coarseness: f64,
    drawn: Option<(SceneLook, SceneSettings, f64, (u32, u32))>,
}

impl SceneViewer {
    fn try_draw(&mut self, full: (u32, u32)) -> Result<()> {
        let now = Instant::now();
        self.passed = now - self.last_frame;
        self.last_frame = now;
        if self.playing {
            // A window that was hidden does not jump.
            self.time += self.passed.as_secs_f64().min(0.2);
            let pace = self.passed.as_secs_f64() / FRAME.as_secs_f64();
            self.coarseness = (self.coarseness * pace.sqrt().clamp(0.9, 1.5)).clamp(1.0, COARSEST);
        }
        if self.settings != self.renderer.settings() {
            self.schedule = Schedule::default();
            self.renderer.configure(self.settings)?;
        }
        self.renderer.set_time(self.time, self.look.roughness);
        let side = |pixels: u32| ((f64::from(pixels) / self.coarseness).round() as u32).max(1);
        let size = if self.playing { (side(full.0), side(full.1)) } else { full };
        self.measure(now, size)?;
        let budget = self.limited.then_some(self.budget / 1e3);
        let turn = self.schedule.turn(self.renderer.probes(), budget);
        self.updated = turn.len();
        self.renderer.update(&turn)?;
        self.renderer.draw(&self.look, size)
    }

    /// Measures the passes at intervals, where the panel shows them or a budget needs them.
    fn measure(&mut self, now: Instant, size: (u32, u32)) -> Result<()> {
        let due = self.measured.is_none_or(|measured| now - measured > TIMES);
        if !due || !(self.timing || self.limited) {
            return Ok(());
        }
        self.measured = Some(now);
        let context = self.renderer.context().clone();
        match block_on(Some(&context), self.renderer.times(&self.look, size))? {
            Ok(times) => {
                let probe = times.iter().filter(|(label, _)| *label != "picture").map(|(_, seconds)| seconds);
                self.schedule.seconds = Some(probe.sum());
                self.times = times;
            }
            Err(error) if self.timing => {
                self.timing = false;
                return Err(error);
            }
            // Without timestamps, from submission to completion.
            Err(_) => {
                let start = Instant::now();
                self.renderer.update(&[0])?;
                context.device().poll(wgpu::PollType::wait_indefinitely()).map_err(|error| {
                    Error::Gpu(format!("{} stopped responding: {error}", context.describe()))
                })?;
                self.schedule.seconds = Some(start.elapsed().as_secs_f64());
            }
        }
        Ok(())
    }

    fn take_scene(&mut self, path: &Path) -> Result<()> {
        let scene = Scene::of_mesh(&Mesh::read(path)?)?;
        self.renderer = SceneRenderer::new(self.renderer.context().clone(), scene, self.settings)?;
        self.name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        self.schedule = Schedule::default();
        Ok(())
    }

    fn panel(&mut self, ui: &mut Ui) {
        ui.add_space(6.0);
        ui.label(RichText::new("octagloss").heading());
        ui.label(&self.name);
        if let Some(message) = &self.message {
            ui.label(RichText::new(message).color(Color32::from_rgb(255, 140, 120)));
        }
        ui.separator();
        ui.spacing_mut().slider_width = SLIDER;
        ui.label("Roughness");
        let mut own = self.look.roughness.is_none();
        let mut roughness = self.look.roughness.unwrap_or(0.3);
        if ui.add(Slider::new(&mut roughness, 0.0..=1.0).max_decimals(3)).changed() {
            (own, self.look.roughness) = (false, Some(roughness));
        }
        if ui.checkbox(&mut own, "the objects' own").changed() {
            self.look.roughness = (!own).then_some(roughness);
        }
        ui.separator();
        ui.label("Time");
        ui.add(Slider::new(&mut self.time, 0.0..=60.0).clamping(egui::SliderClamping::Never).suffix(" s"));
        ui.checkbox(&mut self.playing, "move");
        ui.separator();
        Grid::new("scene").num_columns(2).show(ui, |ui| {
            choice(ui, "Draw", &mut self.settings.method, &METHODS, None);
            let proxies = [(Proxy::None, "none"), (Proxy::Box, "box"), (Proxy::Sphere, "sphere")];
            choice(ui, "Proxy", &mut self.look.proxy, &proxies, None);
            let boxes = [(1, "fitted:1"), (2, "fitted:2"), (4, "fitted:4"), (8, "fitted:8")];
            choice(ui, "Filter", &mut self.settings.boxes, &boxes, None);
            let sizes = [(64, "64"), (128, "128"), (256, "256"), (512, "512"), (1024, "1024")];
            let own = (self.settings.size, "other");
            let further = sizes.iter().all(|(size, _)| *size != own.0).then_some(own);
            choice(ui, "Map", &mut self.settings.size, &sizes, further);
            let tones = [
                (Tone::Neutral, "neutral"),
                (Tone::Aces, "ACES"),
                (Tone::Reinhard, "Reinhard"),
                (Tone::Linear, "linear"),
            ];
            choice(ui, "Tone", &mut self.look.tone, &tones, None);
        });
        ui.label("Exposure");
        ui.add(Slider::new(&mut self.look.exposure, -8.0..=8.0).step_by(0.01).suffix(" EV"));
        ui.separator();
        ui.label("Probes");
        let most = self.renderer.scene().glossy_parts();
        self.settings.probes = self.settings.probes.min(most);
        ui.add_enabled(most > 1, Slider::new(&mut self.settings.probes, most.min(1)..=most));
        ui.checkbox(&mut self.limited, "limit their time");
        ui.add_enabled(
            self.limited,
            Slider::new(&mut self.budget, 0.1..=50.0).logarithmic(true).suffix(" ms"),
        );
        ui.label(
            RichText::new(format!("{} of {} in this frame", self.updated, self.renderer.probes())).weak(),
        );
        ui.separator();
        ui.add(Checkbox::new(&mut self.timing, "GPU times, of one probe and the picture"));
        if self.timing {
            Grid::new("times").num_columns(2).show(ui, |ui| {
                for (pass, seconds) in &self.times {
                    ui.label(*pass);
                    ui.label(format!("{:.3} ms", 1e3 * seconds));
                    ui.end_row();
                }
            });
        }
        ui.label(RichText::new(format!("{} triangles", self.renderer.triangles())).weak());
        let frame = 1e3 * self.passed.as_secs_f64();
        ui.label(RichText::new(format!("{frame:.1} ms from frame to frame")).weak());
        ui.label(RichText::new(&self.adapter).weak());
        ui.label(
            RichText::new("Drag to turn, scroll or pinch to zoom; drop a scene. H hides the panel.").weak(),
        );
    }
}

impl Content for SceneViewer {
    type Start = SceneStart;

    fn adapter(start: &SceneStart) -> Option<&str> {
        start.adapter.as_deref()
    }

    fn new(context: Context, start: SceneStart) -> Result<Self> {
        let SceneStart { scene, name, look, settings, time, budget, .. } = start;
        let settings = SceneSettings { probes: settings.probes.min(scene.glossy_parts()), ..settings };
        Ok(Self {
            adapter: context.describe(),
            renderer: SceneRenderer::new(context, scene, settings)?,
            look,
            first_camera: look.camera,
            settings,
            name,
            message: None,
            panel_hidden: false,
            time,
            playing: true,
            budget: budget.map_or(4.0, |seconds| 1e3 * seconds),
            limited: budget.is_some(),
            schedule: Schedule::default(),
            updated: 0,
            timing: false,
            times: Vec::new(),
            measured: None,
            last_frame: Instant::now(),
            passed: Duration::ZERO,
            coarseness: 1.0,
            drawn: None,
        })
    }

    fn context(&self) -> &Context {
        self.renderer.context()
    }

    fn interface(&mut self, ui: &mut Ui, (width, height): (u32, u32)) -> Viewport {
        if self.panel_hidden {
            return Viewport { x: 0, y: 0, width, height };
        }
        let shown = egui::Panel::left("panel")
            .exact_size(WIDTH)
            .resizable(false)
            .show(ui, |ui| ScrollArea::vertical().show(ui, |ui| self.panel(ui)));
        let edge = (shown.response.rect.right() * ui.ctx().pixels_per_point()).round() as u32;
        let x = edge.min(width.saturating_sub(1));
        Viewport { x, y: 0, width: width - x, height }
    }

    fn draw(&mut self, full: (u32, u32)) {
        let state = (self.look, self.settings, self.time, full);
        if !self.playing && self.drawn == Some(state) && !self.timing {
            return;
        }
        if let Err(error) = self.try_draw(full) {
            self.message = Some(error.to_string());
            self.settings = self.renderer.settings();
            self.playing = false;
        }
        self.drawn = Some((self.look, self.settings, self.time, full));
    }

    fn present(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        viewport: Viewport,
    ) {
        if self.renderer.has_picture() {
            self.renderer.present(encoder, view, format, viewport, self.look.tone);
        }
    }

    fn is_busy(&self) -> bool {
        let settled = self.drawn.is_some_and(|(look, settings, time, _)| {
            (look, settings, time) == (self.look, self.settings, self.time)
        });
        self.playing || self.timing || !settled
    }

    fn open_file(&mut self, path: &Path) {
        self.message = self.take_scene(path).err().map(|error| error.to_string());
        self.drawn = None;
    }

    fn camera(&mut self) -> &mut Camera {
        &mut self.look.camera
    }

    fn reset_camera(&mut self) {
        self.look.camera = self.first_camera;
    }

    fn toggle_panel(&mut self) {
        self.panel_hidden = !self.panel_hidden;
        self.drawn = None;
    }
}
