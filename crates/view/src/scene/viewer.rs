//! A scene in a window or a page: time, and the probes' turns.

use super::content::Scene;
use super::look::SceneLook;
use super::panel::Controls;
use super::renderer::{ROUNDS, SceneRenderer, SceneSettings};
use super::schedule::Schedule;
use crate::interface::later::{Later, later, taken};
use crate::interface::panel::{PanelState, beside_panel};
use crate::interface::viewer::{COARSEST, FRAME, coarser, read_mesh};
use crate::interface::window::WindowContent;
#[cfg(not(target_arch = "wasm32"))]
use crate::interface::window::open;
use crate::look::camera::Camera;
use crate::picture::present::{Display, Viewport};
use egui::Ui;
use octagloss_core::common::error::Result;
use octagloss_gpu::Context;
use octagloss_gpu::device::readback;
use octagloss_mesh::Mesh;
use std::path::Path;
use std::time::Duration;
use web_time::Instant;

/// Budget of the probes in milliseconds, once it is chosen.
const BUDGET: f64 = 4.0;

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
/// [`octagloss_core::common::error::Error::Gpu`] if no window or no device is available,
/// [`octagloss_core::common::error::Error::Limit`] if the scene does not fit it.
#[cfg(not(target_arch = "wasm32"))]
pub fn run_scene(start: SceneStart) -> Result<()> {
    let (name, size, adapter) = (start.name.clone(), start.size, start.adapter.clone());
    open(Box::new(|context| SceneViewer::new(context, start)), &name, size, adapter)
}

/// What the maps of the probes depend on: settings, time and roughness.
type Maps = (SceneSettings, f64, Option<f64>);

/// State of the content.
#[derive(Debug)]
pub(crate) struct SceneViewer {
    pub(crate) panel: PanelState,
    pub(crate) renderer: SceneRenderer,
    /// What the panel selects; the renderer has the settings that worked last.
    pub(crate) controls: Controls,
    first_camera: Camera,
    schedule: Schedule,
    /// What the maps show, and the updates until they show reflections of reflections of it.
    maps: Option<Maps>,
    due: usize,
    /// Probes updated in the last frame.
    pub(super) updated: usize,
    /// In a browser, the GPU's work of the last frame: nothing else keeps frames from piling up.
    submitted: Option<Later<()>>,
    last_frame: Instant,
    /// Duration of the last frame, if frames follow each other.
    pub(super) passed: Duration,
    /// Pixels per sample along an edge.
    coarseness: f64,
    /// What the last frame drew: look, maps, and samples.
    drawn: Option<(SceneLook, Maps, (u32, u32))>,
}

impl SceneViewer {
    /// Samples of the current picture, columns and rows.
    pub(crate) fn picture_size(&self) -> (u32, u32) {
        self.drawn.map_or((0, 0), |(.., size)| size)
    }

    fn take_scene(&mut self, path: &Path, mesh: &Mesh) -> Result<()> {
        let scene = Scene::of_mesh(mesh)?;
        let (was, first) = (self.renderer.scene().first_look(), scene.first_look());
        self.renderer = SceneRenderer::new(self.renderer.context().clone(), scene, self.controls.settings)?;
        self.panel.set_name(path);
        if first != was {
            let SceneLook { camera, proxy, .. } = first;
            self.controls.look = SceneLook { camera, proxy, ..self.controls.look };
            self.first_camera = camera;
        }
        self.schedule = Schedule::default();
        (self.maps, self.drawn) = (None, None);
        Ok(())
    }

    /// Replaces the probes, if `settings` do.
    pub(crate) fn configure(&mut self, settings: SceneSettings) -> Result<()> {
        if settings != self.renderer.settings() {
            self.renderer.configure(settings)?;
            self.schedule = Schedule::default();
        }
        Ok(())
    }

    const fn shown_maps(&self) -> Maps {
        (self.controls.settings, self.controls.time, self.controls.look.roughness)
    }

    fn try_draw(&mut self, full: (u32, u32)) -> Result<()> {
        if self.submitted.is_some() {
            let Some(done) = taken(&mut self.submitted) else { return Ok(()) };
            done?;
        }
        if !self.is_busy() && self.picture_size() == full {
            return Ok(());
        }
        let now = Instant::now();
        self.passed = now - self.last_frame;
        self.last_frame = now;
        let moving = self.controls.moving;
        if moving {
            // A window that was hidden does not jump.
            self.controls.time += self.passed.as_secs_f64().min(0.2);
            let pace = self.passed.as_secs_f64() / FRAME.as_secs_f64();
            self.coarseness = (self.coarseness * pace.sqrt().clamp(0.9, 1.5)).clamp(1.0, COARSEST);
        }
        self.configure(self.controls.settings)?;
        let maps = self.shown_maps();
        if self.maps != Some(maps) {
            self.maps = Some(maps);
            self.due = ROUNDS * self.renderer.probes();
        }
        let Controls { look, time, budget, limited, .. } = self.controls;
        self.renderer.set_time(time, look.roughness);
        let size = if moving { coarser(full, self.coarseness) } else { full };
        self.measure(now, size)?;
        let mut turn = Vec::new();
        if self.due > 0 {
            turn = self.schedule.turn(self.renderer.probes(), limited.then_some(budget / 1e3));
        }
        self.updated = turn.len();
        self.due = self.due.saturating_sub(turn.len());
        self.renderer.update(&turn)?;
        self.renderer.draw(&look, size)?;
        self.drawn = Some((look, maps, size));
        if cfg!(target_arch = "wasm32") {
            let context = self.renderer.context().clone();
            let done = async move { readback::finished(&context).await };
            self.submitted = Some(later(self.renderer.context(), done));
        }
        Ok(())
    }

    /// Measures the passes at intervals, where the panel shows them or a budget needs them.
    fn measure(&mut self, now: Instant, size: (u32, u32)) -> Result<()> {
        let Controls { look, timing, limited, .. } = self.controls;
        if self.panel.poll()? {
            let probe = self.panel.times.iter().filter(|(label, _)| *label != "picture");
            self.schedule.seconds = Some(probe.map(|(_, seconds)| seconds).sum());
        }
        if !(timing || limited) || !self.panel.is_due(now) {
            return Ok(());
        }
        let context = self.renderer.context().clone();
        let measurable = context.device().features().contains(wgpu::Features::TIMESTAMP_QUERY);
        if !(timing || measurable) {
            // Without timestamps, from submission to completion.
            self.panel.measure(&context, self.renderer.update_time()?);
            return Ok(());
        }
        let times = self.renderer.times(&look, size);
        self.controls.timing &= times.is_ok();
        self.panel.measure(&context, times?);
        Ok(())
    }
}

impl SceneViewer {
    /// The viewer of `start` on a device.
    pub(crate) fn new(context: Context, start: SceneStart) -> Result<Self> {
        let SceneStart { scene, name, look, settings, time, budget, .. } = start;
        let settings = SceneSettings { probes: settings.probes.min(scene.glossy_parts()), ..settings };
        Ok(Self {
            panel: PanelState::new(&context, name),
            renderer: SceneRenderer::new(context, scene, settings)?,
            controls: Controls {
                look,
                settings,
                time,
                moving: true,
                budget: budget.map_or(BUDGET, |seconds| 1e3 * seconds),
                limited: budget.is_some(),
                timing: false,
            },
            first_camera: look.camera,
            schedule: Schedule::default(),
            maps: None,
            due: 0,
            updated: 0,
            submitted: None,
            last_frame: Instant::now(),
            passed: Duration::ZERO,
            coarseness: 1.0,
            drawn: None,
        })
    }
}

impl WindowContent for SceneViewer {
    fn context(&self) -> &Context {
        self.renderer.context()
    }

    fn interface(&mut self, ui: &mut Ui, size: (u32, u32)) -> Viewport {
        let is_hidden = self.panel.is_hidden;
        beside_panel(ui, size, is_hidden, |ui| self.show_controls(ui)).2
    }

    fn draw(&mut self, full: (u32, u32)) {
        if let Err(error) = self.try_draw(full) {
            // Do not retry before something changes.
            self.panel.message = Some(error.to_string());
            self.controls.settings = self.renderer.settings();
            self.controls.moving = false;
            let maps = self.shown_maps();
            (self.maps, self.due) = (Some(maps), 0);
            self.drawn = Some((self.controls.look, maps, full));
        }
    }

    fn present(&mut self, display: Display<'_>) {
        if self.renderer.targets.is_some() {
            self.renderer.present(display, self.controls.look.tone);
        }
    }

    fn is_busy(&self) -> bool {
        let shown = (self.controls.look, self.shown_maps());
        let settled = self.drawn.is_some_and(|(look, maps, _)| (look, maps) == shown);
        self.controls.moving || self.controls.timing || self.due > 0 || self.submitted.is_some() || !settled
    }

    fn open(&mut self, path: &Path, bytes: Option<&[u8]>) {
        let taken = read_mesh(path, bytes).and_then(|mesh| self.take_scene(path, &mesh));
        self.panel.report(taken);
    }

    fn camera(&mut self) -> &mut Camera {
        &mut self.controls.look.camera
    }

    fn reset_camera(&mut self) {
        self.controls.look.camera = self.first_camera;
    }

    fn panel(&mut self) -> &mut PanelState {
        &mut self.panel
    }
}
