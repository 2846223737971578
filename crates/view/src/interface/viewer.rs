//! The viewer without its window: progressive drawing of the picture, and opening of files.

use super::later::{Later, later, taken};
use super::panel::{PanelState, beside_panel};
use super::view_panel::{Motion, Status, show_controls};
#[cfg(not(target_arch = "wasm32"))]
use super::window;
use super::window::{FromStart, Start, WindowContent};
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
use octagloss_mesh::Mesh;
use std::fmt;
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

/// Progress of the certified tier on one picture.
#[derive(Debug)]
struct Refinement {
    look: Look,
    /// Pixels of the final picture.
    full: (u32, u32),
    step: usize,
    /// Samples of this step.
    size: (u32, u32),
    asked: Later<Vec<PixelQuery>>,
    answers: Vec<[f32; 4]>,
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
#[derive(Debug)]
struct Bands {
    look: Look,
    size: (u32, u32),
    /// Rows done.
    done: u32,
    /// Rows of the next band.
    rows: f64,
}

/// The legend of a debug view.
struct Note {
    /// The picture that it belongs to.
    of: (Look, (u32, u32)),
    values: Option<Later<Vec<[f16; 4]>>>,
    legend: Option<egui::TextureHandle>,
}

impl fmt::Debug for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Note").field("of", &self.of).finish_non_exhaustive()
    }
}

/// State of the viewer.
#[derive(Debug)]
pub(crate) struct Viewer {
    pub(crate) panel: PanelState,
    renderer: Renderer,
    /// Border and scan of the tables.
    table: ReflectorSettings,
    light: Light,
    truth: Option<Truth>,
    pub(crate) look: Look,
    motion: Motion,
    pub(crate) has_mesh: bool,
    /// Position of the roughness slider in the panel.
    pub(crate) slider: Option<egui::Rect>,
    /// Look and samples of the current picture.
    drawn: Option<(Look, (u32, u32))>,
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
    reported_size: (u32, u32),
    /// What the last frame drew.
    before: Before,
    /// Duration of a frame that draws no picture.
    bare: Option<Duration>,
    work: Option<Refinement>,
    note: Option<Note>,
}

impl Viewer {
    /// Samples of the current picture, columns and rows.
    pub(crate) fn picture_size(&self) -> (u32, u32) {
        self.drawn.as_ref().map_or((0, 0), |(_, size)| *size)
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

    /// Whether the legend is not ready.
    fn is_noting(&self) -> bool {
        self.look.show != Show::Scene && self.note.as_ref().is_none_or(|note| note.values.is_some())
    }

    /// Whether the current picture is coarser than possible.
    fn coarse(&self) -> bool {
        self.drawn.as_ref().is_some_and(|(_, size)| *size != self.full)
    }

    /// Reads the values of a finished debug view, for its legend.
    fn take_note(&mut self) {
        let finished =
            (self.drawn.clone()).filter(|(look, size)| look.show != Show::Scene && *size == self.full);
        if self.note.as_ref().map(|note| &note.of) != finished.as_ref() {
            self.note = finished.map(|of| {
                let values = self.renderer.values().map(|values| later(self.renderer.context(), values));
                Note { of, values, legend: None }
            });
        }
    }

    /// Shows the legend in the lower left corner of the picture, which begins at `left` points.
    fn show_note(&mut self, context: &egui::Context, left: f32) -> Result<()> {
        let Some(note) = &mut self.note else { return Ok(()) };
        if let Some(values) = taken(&mut note.values) {
            let (look, (width, height)) = &note.of;
            let shown = legend::shown(look, &values?, look.exposure.ev(self.light.exposure()));
            note.legend = legend::legend(look, &self.light, [*width, *height], shown).map(|legend| {
                let size = [legend.width() as usize, legend.height() as usize];
                let image = egui::ColorImage::from_rgb(size, legend.bytes());
                context.load_texture("legend", image, egui::TextureOptions::LINEAR)
            });
        }
        if let Some(legend) = &note.legend {
            let offset = egui::vec2(left + INSET as f32, -(INSET as f32));
            let area = egui::Area::new(egui::Id::unique("legend")).anchor(egui::Align2::LEFT_BOTTOM, offset);
            area.interactable(false).show(context, |ui| ui.image(legend));
        }
        Ok(())
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
        if self.drawn.as_ref().is_none_or(|(look, _)| *look != self.look) {
            self.changed = now;
        }
        self.take_times(now)?;
        if self.look.needs_truth() {
            return self.refine();
        }
        self.work = None;
        let settled = now - self.changed >= IDLE;
        let size = if settled { full } else { coarser(full, self.coarseness) };
        if self.drawn.as_ref().is_some_and(|(look, drawn)| *look == self.look && (!settled || *drawn == size))
        {
            self.before = Before::Bare;
            return Ok(());
        }
        if settled {
            return self.draw_band(size, passed);
        }
        self.bands = None;
        self.renderer.draw(&self.look, &self.light, size.0, size.1)?;
        self.drawn = Some((self.look.clone(), size));
        self.before = Before::Coarse;
        Ok(())
    }

    /// Time of the picture in a frame of `passed`, relative to the target.
    fn pace(&self, passed: Duration) -> f64 {
        passed.saturating_sub(self.bare.unwrap_or_default()).as_secs_f64() / FRAME.as_secs_f64()
    }

    /// Draws the next band of the picture of `size`, after a frame of `passed`.
    fn draw_band(&mut self, size: (u32, u32), passed: Duration) -> Result<()> {
        let (_, height) = size;
        let under_way = self.bands.take().filter(|bands| bands.look == self.look && bands.size == size);
        let mut bands = under_way.map_or_else(
            || Bands {
                look: self.look.clone(),
                size,
                done: 0,
                rows: f64::from(height) / self.coarseness.powi(2),
            },
            |bands| {
                let least = f64::from(height) / MAX_BANDS;
                Bands { rows: (bands.rows / self.pace(passed).clamp(0.5, 2.0)).max(least), ..bands }
            },
        );
        let end = bands.done.saturating_add(bands.rows.ceil() as u32).clamp(1, height);
        self.renderer.draw_rows(&self.look, &self.light, size, bands.done..end)?;
        bands.done = end;
        if end < height {
            self.bands = Some(bands);
        } else {
            self.drawn = Some((bands.look, size));
        }
        Ok(())
    }

    /// Advances the certified tier by one time slice, coarse samples first.
    fn refine(&mut self) -> Result<()> {
        let done = self.drawn.as_ref().is_some_and(|(look, size)| *look == self.look && *size == self.full);
        let at_it = self.work.as_ref().is_some_and(|work| work.look == self.look && work.full == self.full);
        if done && !at_it {
            return Ok(());
        }
        if !at_it {
            self.work = Some(self.begin(0)?);
        }
        if self.truth.is_none() {
            self.truth = Some(Truth::new(self.light.environment())?);
        }
        let (Some(mut work), Some(truth)) = (self.work.take(), &self.truth) else { return Ok(()) };
        let answered = work.asked.borrow_mut().take();
        let asked = match answered {
            None => {
                self.work = Some(work);
                return Ok(());
            }
            Some(asked) => asked?,
        };
        let start = Instant::now();
        let width = work.size.0 as usize;
        let source_from_world = self.light.source_from_world(work.look.turn);
        while work.answers.len() < asked.len() {
            // Whole rows of tiles; true reflections take milliseconds each.
            let many = if work.look.judges_reflections() { 128 } else { 16 * width };
            let end = (work.answers.len() + many).min(asked.len());
            let band = &asked[work.answers.len()..end];
            work.answers.extend(truth.answers(band, width, source_from_world, work.look.tolerance())?);
            if start.elapsed() > SLICE {
                break;
            }
        }
        if work.answers.len() < asked.len() {
            *work.asked.borrow_mut() = Some(Ok(asked));
            self.work = Some(work);
            return Ok(());
        }
        let (step, (width, height)) = (work.step, work.size);
        self.renderer.set_truth(&work.answers, width);
        self.renderer.draw(&work.look, &self.light, width, height)?;
        self.drawn = Some((self.look.clone(), (width, height)));
        self.work = if step + 1 < STEPS.len() { Some(self.begin(step + 1)?) } else { None };
        Ok(())
    }

    fn begin(&mut self, step: usize) -> Result<Refinement> {
        let size = coarser(self.full, f64::from(STEPS[step]));
        let samples = self.renderer.samples(&self.look, &self.light, size.0, size.1)?;
        let asked = later(self.renderer.context(), samples);
        Ok(Refinement { look: self.look.clone(), full: self.full, step, size, asked, answers: Vec::new() })
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
            self.drawn = Some((self.look.clone(), self.full));
            self.bands = None;
        }
        Ok(())
    }

    /// [`Viewer::show_note`]; errors become messages.
    fn note_or_message(&mut self, context: &egui::Context, left: f32) {
        if let Err(error) = self.show_note(context, left) {
            self.panel.message = Some(error.to_string());
        }
    }
}

impl WindowContent for Viewer {
    fn context(&self) -> &Context {
        self.renderer.context()
    }

    fn interface(&mut self, ui: &mut egui::Ui, size: (u32, u32)) -> Viewport {
        let (width, height) = size;
        if self.panel.is_hidden {
            self.slider = None;
            self.note_or_message(ui.ctx(), 0.0);
            return Viewport { x: 0, y: 0, width, height };
        }
        let progress = self.work.as_ref().map(|work| {
            let asked = work.asked.borrow();
            let count = asked.as_ref().and_then(|asked| asked.as_ref().ok()).map_or(1, Vec::len);
            work.answers.len() as f64 / count.max(1) as f64
        });
        let size = self.picture_size();
        self.reported_size = size;
        let (has_materials, has_levels) = (self.renderer.has_materials(), self.light.own_levels);
        let exposure = self.light.exposure();
        let half_height =
            self.look.camera.frame(f64::from(width) / f64::from(height), self.look.field()).up.length();
        let automatic = Look { backdrop: None, ..self.look.clone() };
        let backdrop = automatic.backdrop_roughness(self.light.texel_angle(), half_height);
        let Self { panel, look, motion, has_mesh, .. } = self;
        let has_mesh = *has_mesh;
        let status =
            Status { panel, has_mesh, has_materials, has_levels, exposure, backdrop, size, progress };
        let (slider, right, viewport) =
            beside_panel(ui, (width, height), |ui| show_controls(ui, look, motion, &status));
        self.slider = Some(slider);
        self.note_or_message(ui.ctx(), right);
        viewport
    }

    fn draw(&mut self, full: (u32, u32)) {
        let drawn = self.try_draw(full);
        self.take_note();
        if let Err(error) = drawn {
            // Do not retry before something changes.
            self.drawn = Some((self.look.clone(), full));
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
        let settled = self.drawn.as_ref().is_some_and(|(look, _)| *look == self.look);
        let Motion { turning, lamp, timing } = self.motion;
        // The panel shows the picture's size.
        let size_shown = self.panel.is_hidden || self.reported_size == self.picture_size();
        !settled
            || !size_shown
            || turning
            || lamp
            || timing
            || self.work.is_some()
            || self.coarse()
            || self.is_noting()
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

impl FromStart for Viewer {
    type Start = Start;

    fn adapter(start: &Start) -> Option<&str> {
        start.adapter.as_deref()
    }

    fn new(context: Context, start: Start) -> Result<Self> {
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

    fn content(&mut self) -> &mut dyn WindowContent {
        self
    }
}

/// Read options; in a browser limits memory to 1 GiB of WebAssembly's 4.
pub(crate) fn options() -> ReadOptions {
    let options = ReadOptions::default();
    if cfg!(target_arch = "wasm32") { ReadOptions { memory_limit: 1 << 30, ..options } } else { options }
}

/// Samples of a picture of `full` pixels at `coarseness` pixels per sample along an edge.
fn coarser((width, height): (u32, u32), coarseness: f64) -> (u32, u32) {
    let side = |pixels: u32| ((f64::from(pixels) / coarseness).round() as u32).max(1);
    (side(width), side(height))
}

pub(crate) fn is_mesh(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    ["gltf", "glb", "obj"].iter().any(|mesh| extension.eq_ignore_ascii_case(mesh))
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
    let (name, size) = (start.name.clone(), start.size);
    window::open::<Viewer>(start, &name, size)
}
