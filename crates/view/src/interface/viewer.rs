//! The viewer without its window: progressive drawing of the picture, and opening of files.

use super::later::{Later, later, taken};
use super::panel::{PanelState, beside_panel};
use super::view_panel::Motion;
#[cfg(not(target_arch = "wasm32"))]
use super::window;
use super::window::{Start, WindowContent};
use crate::look::camera::Camera;
use crate::look::legend::{self, INSET};
use crate::look::{Look, Object, Show, Technique};
use crate::picture::levels::Levels;
use crate::picture::light::Light;
use crate::picture::present::{Display, Viewport};
use crate::picture::renderer::Renderer;
use crate::picture::truth::{PixelQuery, Truth};
use glam::DMat3;
use half::f16;
use octagloss_core::common::error::Result;
use octagloss_core::cpu::reflector::ReflectorSettings;
use octagloss_core::files::io::regular::open_regular;
use octagloss_core::files::io::{self, ReadOptions};
use octagloss_core::light::chain::Chain;
use octagloss_core::light::environment::Environment;
use octagloss_gpu::Context;
use octagloss_mesh::{Mesh, is_mesh};
use std::io::Read as _;
use std::path::Path;
use std::time::Duration;
use web_time::Instant;

/// Time without changes after which the full picture is drawn.
const IDLE: Duration = Duration::from_millis(250);

/// Target time of a frame during changes.
pub(crate) const FRAME: Duration = Duration::from_millis(40);

/// Time per frame for the certified tier.
const SLICE: Duration = Duration::from_millis(60);

/// Greatest pixels per sample along an edge.
pub(crate) const COARSEST: f64 = 10.0;

/// Most bands of a full picture.
const MAX_BANDS: f64 = 16.0;

/// Refinement steps of the certified tier: pixels per sample along an edge.
const STEPS: [u32; 4] = [8, 4, 2, 1];

/// Rotation of the environment in degrees per second.
const TURN: f64 = 24.0;

/// A look and the pixels or samples of its picture.
type Picture = (Look, (u32, u32));

/// Progress of the certified tier on one picture.
pub(super) struct Refinement {
    /// The final picture.
    of: Picture,
    step: usize,
    /// Samples of this step.
    size: (u32, u32),
    /// The queries that are being read back.
    pending: Option<Later<Vec<PixelQuery>>>,
    pub(super) asked: Vec<PixelQuery>,
    pub(super) answers: Vec<[f32; 4]>,
}

/// What the last frame drew, if this one follows without idling.
#[derive(Clone, Copy, Debug, Default)]
enum Before {
    /// Other work, or the frames are not consecutive.
    #[default]
    Other,
    /// Only the existing picture and the panel.
    Bare,
    /// A coarse picture.
    Coarse,
}

/// A full picture in progress, drawn in bands that fit a frame.
struct Bands {
    of: Picture,
    /// Rows done.
    done: u32,
    /// Rows of the next band.
    rows: f64,
}

/// The legend of a debug view.
struct Note {
    /// The picture that it belongs to.
    of: Picture,
    values: Option<Later<Vec<[f16; 4]>>>,
    legend: Option<egui::TextureHandle>,
}

/// State of the viewer.
pub(crate) struct Viewer {
    pub(crate) panel: PanelState,
    pub(super) renderer: Renderer,
    /// Border and scan of the tables.
    table: ReflectorSettings,
    pub(super) light: Light,
    truth: Option<Truth>,
    pub(crate) look: Look,
    pub(super) motion: Motion,
    pub(crate) has_mesh: bool,
    /// Position of the roughness slider in the panel.
    pub(crate) slider: Option<egui::Rect>,
    /// Look and samples of the current picture.
    drawn: Option<Picture>,
    /// Pixels available for it.
    full: (u32, u32),
    /// The full picture in progress.
    bands: Option<Bands>,
    /// Whether the tables include the lamp.
    lamp_lit: bool,
    started: Instant,
    changed: Instant,
    last_frame: Instant,
    /// Pixels per sample along an edge during changes.
    coarseness: f64,
    /// Size shown in the panel.
    pub(super) reported_size: (u32, u32),
    /// What the last frame drew.
    before: Before,
    /// Duration of a frame that draws no picture.
    bare: Option<Duration>,
    pub(super) work: Option<Refinement>,
    note: Option<Note>,
}

impl Viewer {
    /// Samples of the current picture, columns and rows.
    pub(crate) fn picture_size(&self) -> (u32, u32) {
        self.drawn.map_or((0, 0), |(_, size)| size)
    }

    fn take_mesh(&mut self, mesh: &Mesh) -> Result<()> {
        self.renderer.set_mesh(mesh)?;
        self.has_mesh = true;
        if self.look.object != Object::Mesh {
            self.look.object = Object::Mesh;
            self.look.camera = self.look.first_camera();
        }
        self.drawn = None;
        Ok(())
    }

    /// Sets an environment and, for a bake, its `chain`.
    fn take_environment(
        &mut self,
        environment: &Environment,
        chain: Option<Chain>,
        path: &Path,
    ) -> Result<()> {
        let levels = chain.and_then(|chain| Levels::new(chain, DMat3::IDENTITY).transpose());
        let mut light = self.renderer.light(environment, &self.table)?;
        // If the levels cannot be shown, still show the environment.
        let taken = levels.map(|levels| light.set_levels(self.renderer.context(), &levels?)).transpose();
        if light.own_levels {
            self.look.filter = Technique::Levels;
        } else if self.light.own_levels && self.look.filter == Technique::Levels {
            self.look.filter = Look::default().filter;
        }
        self.light = light;
        self.panel.set_name(path);
        self.truth = None;
        self.work = None;
        self.drawn = None;
        taken.map(drop)
    }

    /// Reads the values of a finished debug view, for its legend.
    fn take_note(&mut self) {
        let finished = self.drawn.filter(|(look, size)| look.show != Show::Scene && *size == self.full);
        if self.note.as_ref().map(|note| note.of) != finished {
            self.note = finished.map(|of| {
                let values = self.renderer.values().map(|values| later(self.renderer.context(), values));
                Note { of, values, legend: None }
            });
        }
    }

    /// Shows the legend in the lower left corner of the picture, which begins at `left` points.
    fn show_note(&mut self, context: &egui::Context, left: f32) {
        let Some(note) = &mut self.note else { return };
        match taken(&mut note.values) {
            None => {}
            Some(Err(error)) => self.panel.message = Some(error.to_string()),
            Some(Ok(values)) => {
                let (look, (width, height)) = note.of;
                let shown = legend::shown(&look, &values, look.exposure.ev(self.light.exposure()));
                note.legend = legend::legend(&look, &self.light, [width, height], shown).map(|legend| {
                    let size = [legend.width() as usize, legend.height() as usize];
                    let image = egui::ColorImage::from_rgb(size, legend.bytes());
                    context.load_texture("legend", image, egui::TextureOptions::LINEAR)
                });
            }
        }
        if let Some(legend) = &note.legend {
            let offset = egui::vec2(left + INSET as f32, -(INSET as f32));
            let area = egui::Area::new(egui::Id::unique("legend")).anchor(egui::Align2::LEFT_BOTTOM, offset);
            area.interactable(false).show(context, |ui| ui.image(legend));
        }
    }

    fn try_draw(&mut self, full: (u32, u32)) -> Result<()> {
        self.full = full;
        let now = Instant::now();
        let passed = now - self.last_frame;
        self.last_frame = now;
        if self.motion.turning {
            self.look.turn = (self.look.turn + TURN * passed.as_secs_f64().min(0.2)).rem_euclid(360.0);
        }
        let lamp = self.motion.lamp && self.look.follows_lamp();
        if lamp || self.lamp_lit {
            let place = lamp.then(|| (now - self.started).as_secs_f64());
            self.light.move_lamp(self.renderer.context(), place);
            self.lamp_lit = lamp;
            self.drawn = None;
        }
        // Consecutive frames measure the time of the last one.
        match std::mem::take(&mut self.before) {
            Before::Other => {}
            Before::Bare => self.bare = Some(self.bare.map_or(passed, |bare| bare.min(passed))),
            Before::Coarse => {
                self.coarseness =
                    (self.coarseness * self.pace(passed).sqrt().clamp(0.9, 2.0)).clamp(1.0, COARSEST);
            }
        }
        if self.drawn.is_none_or(|(look, _)| look != self.look) {
            self.changed = now;
        }
        self.take_times(now)?;
        if self.look.needs_truth() {
            return self.refine();
        }
        self.work = None;
        let settled = now - self.changed >= IDLE;
        let size = if settled { full } else { coarser(full, self.coarseness) };
        if self.drawn.is_some_and(|(look, drawn)| look == self.look && (!settled || drawn == size)) {
            self.before = Before::Bare;
            return Ok(());
        }
        if settled {
            return self.draw_band(size, passed);
        }
        self.bands = None;
        self.renderer.draw(&self.look, &self.light, size.0, size.1)?;
        self.drawn = Some((self.look, size));
        self.before = Before::Coarse;
        Ok(())
    }

    /// Time of the picture in a frame of `passed`, relative to the target.
    fn pace(&self, passed: Duration) -> f64 {
        passed.saturating_sub(self.bare.unwrap_or_default()).as_secs_f64() / FRAME.as_secs_f64()
    }

    /// Draws the next band of the picture of `size`, after a frame of `passed`.
    fn draw_band(&mut self, size: (u32, u32), passed: Duration) -> Result<()> {
        let height = f64::from(size.1);
        let under_way = self.bands.take().filter(|bands| bands.of == (self.look, size));
        let (start, rows) = match under_way {
            None => (0, height / self.coarseness.powi(2)),
            Some(Bands { done, rows, .. }) => {
                (done, (rows / self.pace(passed).clamp(0.5, 2.0)).max(height / MAX_BANDS))
            }
        };
        let done = start.saturating_add(rows.ceil() as u32).clamp(1, size.1);
        self.renderer.draw_rows(&self.look, &self.light, size, start..done)?;
        if done < size.1 {
            self.bands = Some(Bands { of: (self.look, size), done, rows });
        } else {
            self.drawn = Some((self.look, size));
        }
        Ok(())
    }

    /// Advances the certified tier by one time slice, coarse samples first.
    fn refine(&mut self) -> Result<()> {
        let wanted = (self.look, self.full);
        if self.work.as_ref().is_none_or(|work| work.of != wanted) {
            if self.drawn == Some(wanted) {
                return Ok(());
            }
            self.work = Some(self.begin(0)?);
        }
        if self.truth.is_none() {
            self.truth = Some(Truth::new(self.light.environment())?);
        }
        let (Some(work), Some(truth)) = (&mut self.work, &self.truth) else { return Ok(()) };
        if let Some(asked) = taken(&mut work.pending) {
            work.asked = asked?;
        }
        if work.pending.is_some() {
            return Ok(());
        }
        let start = Instant::now();
        let (step, (width, height)) = (work.step, work.size);
        let source_from_world = self.light.source_from_world(self.look.turn);
        // Whole rows of tiles; true reflections take milliseconds each.
        let many = if self.look.judges_reflections() { 128 } else { 16 * width as usize };
        while let Some(band) = work.asked[work.answers.len()..].chunks(many).next() {
            if start.elapsed() > SLICE {
                return Ok(());
            }
            let tolerance = self.look.tolerance();
            work.answers.extend(truth.answers(band, width as usize, source_from_world, tolerance)?);
        }
        self.renderer.set_truth(&work.answers, width);
        self.renderer.draw(&self.look, &self.light, width, height)?;
        self.drawn = Some((self.look, (width, height)));
        self.work = if step + 1 < STEPS.len() { Some(self.begin(step + 1)?) } else { None };
        Ok(())
    }

    fn begin(&mut self, step: usize) -> Result<Refinement> {
        let size = coarser(self.full, f64::from(STEPS[step]));
        let samples = self.renderer.samples(&self.look, &self.light, size.0, size.1)?;
        let pending = Some(later(self.renderer.context(), samples));
        let of = (self.look, self.full);
        Ok(Refinement { of, step, size, pending, asked: Vec::new(), answers: Vec::new() })
    }

    /// Measures the times of the passes at intervals.
    fn take_times(&mut self, now: Instant) -> Result<()> {
        if !self.motion.timing {
            return Ok(());
        }
        self.panel.poll()?;
        if self.panel.is_due(now) {
            let (width, height) = self.full;
            let times = self.renderer.times(&self.look, &self.light, width, height);
            self.motion.timing = times.is_ok();
            self.panel.measure(self.renderer.context(), times?);
            // The measurement drew a full picture.
            self.drawn = Some((self.look, self.full));
            self.bands = None;
        }
        Ok(())
    }
}

impl WindowContent for Viewer {
    fn context(&self) -> &Context {
        self.renderer.context()
    }

    fn interface(&mut self, ui: &mut egui::Ui, size: (u32, u32)) -> Viewport {
        let (aspect, is_hidden) = (f64::from(size.0) / f64::from(size.1), self.panel.is_hidden);
        let (slider, right, viewport) =
            beside_panel(ui, size, is_hidden, |ui| self.show_controls(ui, aspect));
        self.slider = slider;
        self.show_note(ui.ctx(), right);
        viewport
    }

    fn draw(&mut self, full: (u32, u32)) {
        let drawn = self.try_draw(full);
        self.take_note();
        if let Err(error) = drawn {
            // Do not retry before something changes.
            self.drawn = Some((self.look, full));
            self.work = None;
            self.panel.message = Some(error.to_string());
        }
        // Measure consecutive frames only.
        if !self.is_busy() {
            self.before = Before::Other;
        }
    }

    fn present(&mut self, display: Display<'_>) {
        if let Some((look, _)) = &self.drawn {
            self.renderer.present(display, look);
        }
    }

    fn is_busy(&self) -> bool {
        let is_final = self.drawn == Some((self.look, self.full));
        // The panel shows the picture's size.
        let is_size_shown = self.panel.is_hidden || self.reported_size == self.picture_size();
        let is_noted =
            self.look.show == Show::Scene || self.note.as_ref().is_some_and(|note| note.values.is_none());
        !(is_final && is_size_shown && is_noted) || self.motion != Motion::default() || self.work.is_some()
    }

    fn open(&mut self, path: &Path, bytes: Option<&[u8]>) {
        let outcome = if is_mesh(path) {
            read_mesh(path, bytes).and_then(|mesh| self.take_mesh(&mesh))
        } else {
            read_environment(path, bytes)
                .and_then(|(environment, chain)| self.take_environment(&environment, chain, path))
        };
        self.panel.report(outcome);
    }

    fn camera(&mut self) -> &mut Camera {
        &mut self.look.camera
    }

    fn reset_camera(&mut self) {
        self.look.camera = self.look.first_camera();
    }

    fn panel(&mut self) -> &mut PanelState {
        &mut self.panel
    }

    fn toggle_panel(&mut self) {
        self.panel.is_hidden = !self.panel.is_hidden;
        // The picture's size changes.
        self.drawn = None;
    }
}

impl Viewer {
    /// The viewer of `start` on a device.
    pub(crate) fn new(context: Context, start: Start) -> Result<Self> {
        let Start { environment, name, levels, mesh, look, table, .. } = start;
        let mut renderer = Renderer::new(context)?;
        if let Some(mesh) = &mesh {
            renderer.set_mesh(mesh)?;
        }
        let mut light = renderer.light(&environment, &table)?;
        if let Some(levels) = &levels {
            light.set_levels(renderer.context(), levels)?;
        }
        let now = Instant::now();
        Ok(Self {
            panel: PanelState::new(renderer.context(), name),
            has_mesh: look.object == Object::Mesh,
            renderer,
            // Other environments have other sizes.
            table: ReflectorSettings { oem_size: None, ..table },
            light,
            truth: None,
            look,
            motion: Motion::default(),
            slider: None,
            drawn: None,
            full: (1, 1),
            bands: None,
            lamp_lit: false,
            started: now,
            changed: now,
            last_frame: now,
            coarseness: 2.0,
            reported_size: (0, 0),
            before: Before::Other,
            bare: None,
            work: None,
            note: None,
        })
    }
}

/// Read options; in a browser limits memory to 1 GiB of WebAssembly's 4.
pub(crate) fn options() -> ReadOptions {
    let options = ReadOptions::default();
    if cfg!(target_arch = "wasm32") { ReadOptions { memory_limit: 1 << 30, ..options } } else { options }
}

/// Samples of a picture of `full` pixels at `coarseness` pixels per sample along an edge.
pub(crate) fn coarser((width, height): (u32, u32), coarseness: f64) -> (u32, u32) {
    let side = |pixels: u32| ((f64::from(pixels) / coarseness).round() as u32).max(1);
    (side(width), side(height))
}

/// Whether a file that begins with `bytes` may hold a prefiltered chain: KTX, DDS and OpenEXR.
fn is_chain(bytes: &[u8]) -> bool {
    [&b"\xabKTX "[..], b"DDS ", b"\x76\x2f\x31\x01"].iter().any(|magic| bytes.starts_with(magic))
}

/// [`is_chain`] for the file `path`.
fn starts_as_chain(path: &Path) -> bool {
    let mut start = Vec::new();
    open_regular(path).is_ok_and(|file| file.take(12).read_to_end(&mut start).is_ok() && is_chain(&start))
}

/// Reads the environment in `path`, or in `bytes` of that name, and its levels if it is a bake.
fn read_environment(path: &Path, bytes: Option<&[u8]>) -> Result<(Environment, Option<Chain>)> {
    let options = options();
    let (may_be_chain, loaded) = match bytes {
        Some(bytes) => (is_chain(bytes), io::read_from_memory(path, bytes, &options)?),
        None => (path.is_dir() || starts_as_chain(path), io::read(path, &options)?),
    };
    let chain = may_be_chain.then(|| match bytes {
        Some(bytes) => io::read_chain_from_memory(path, bytes, options.memory_limit),
        None => io::read_chain(path),
    });
    Ok((loaded.environment, chain.and_then(Result::ok)))
}

/// Reads the mesh in `path`, or in `bytes` of that name.
pub(crate) fn read_mesh(path: &Path, bytes: Option<&[u8]>) -> Result<Mesh> {
    bytes.map_or_else(|| Mesh::read(path), |bytes| Mesh::read_from_memory(path, bytes))
}

/// Opens a window and runs its event loop until it is closed.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Gpu`] if no window or no device is available.
#[cfg(not(target_arch = "wasm32"))]
pub fn run(start: Start) -> Result<()> {
    let (name, size, adapter) = (start.name.clone(), start.size, start.adapter.clone());
    window::open(Box::new(|context| Viewer::new(context, start)), &name, size, adapter)
}
