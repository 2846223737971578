//! The viewer in a web page: the interface for JavaScript.

use super::look::{Look, Object, Paint, Technique};
use super::viewer::{Viewer, is_mesh, options};
use super::window::{Application, Ready, Shown, Start};
use crate::gpu::device::shader;
use crate::image::exposure::Exposure;
use crate::io;
use crate::mesh::Mesh;
use crate::reflector::ReflectorSettings;
use js_sys::Function;
use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::str::FromStr;
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::{JsError, JsValue};
use web_sys::HtmlCanvasElement;
use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::platform::web::{EventLoopExtWebSys, WindowAttributesExtWebSys};
use winit::window::{Window, WindowId};

/// Logs panics to the console.
#[wasm_bindgen(start)]
fn start() {
    console_error_panic_hook::set_once();
}

/// A viewer on a canvas.
#[wasm_bindgen]
#[derive(Clone)]
pub struct Page {
    application: Rc<RefCell<Application>>,
    on_event: Function,
}

/// Changes of a look; absent fields stay unchanged.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Change {
    roughness: Option<f64>,
    roughness_factor: Option<f64>,
    backdrop: Option<f64>,
    exposure: Option<ExposureChange>,
    turn: Option<f64>,
    filter: Option<String>,
    object: Option<String>,
    paint: Option<String>,
    panel: Option<bool>,
}

/// `"auto"` or a number.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum ExposureChange {
    Ev(f64),
    Text(String),
}

/// The state reported to the page.
#[derive(Debug, Serialize)]
struct State<'a> {
    environment: &'a str,
    message: Option<&'a str>,
    adapter: String,
    roughness: f64,
    roughness_factor: f64,
    exposure: String,
    filter: String,
    object: String,
    paint: String,
    /// Samples of the picture.
    size: (u32, u32),
    /// Whether the picture is final.
    settled: bool,
    panel: bool,
    /// Left, top, right and bottom in CSS pixels.
    roughness_slider: Option<[f32; 4]>,
}

#[wasm_bindgen]
impl Page {
    /// Shows the environment in `bytes`, the file named `name`, on `canvas`, and handles its events from then
    /// on. Calls `on_event` without an argument once the device is ready, and with a message if the viewer
    /// cannot continue.
    ///
    /// # Errors
    /// If the environment cannot be read, or a viewer exists already.
    #[wasm_bindgen(constructor)]
    pub fn new(
        canvas: HtmlCanvasElement,
        name: &str,
        bytes: &[u8],
        on_event: Function,
    ) -> Result<Self, JsError> {
        let environment = io::read_from_memory(Path::new(name), bytes, &options())?.environment;
        let size = (canvas.width(), canvas.height());
        let start = Start {
            environment,
            name: name.to_owned(),
            levels: None,
            mesh: None,
            look: Look::default(),
            table: ReflectorSettings::default(),
            adapter: None,
            size,
        };
        let attributes = Window::default_attributes().with_canvas(Some(canvas));
        let events = EventLoop::with_user_event().build()?;
        let application = Application::new(start, attributes, events.create_proxy());
        let page = Self { application: Rc::new(RefCell::new(application)), on_event };
        events.spawn_app(page.clone());
        Ok(page)
    }

    /// Opens an environment or a mesh from `bytes`, the file named `name`. On failure the panel shows the
    /// error and the picture stays.
    pub fn open(&self, name: &str, bytes: &[u8]) {
        self.act(|viewer| viewer.open(Path::new(name), bytes));
    }

    /// Shows a message in the panel.
    pub fn show_message(&self, message: String) {
        self.act(|viewer| viewer.show_message(message));
    }

    /// The state as JSON; `null` until the device is ready.
    ///
    /// # Errors
    /// None in practice: the state always serialises.
    pub fn state(&self) -> Result<String, JsError> {
        let application = self.application.borrow();
        let state = application.shown.as_ref().map(|Shown { viewer, .. }| State {
            environment: viewer.name(),
            message: viewer.message(),
            adapter: viewer.context().describe(),
            roughness: viewer.look().roughness,
            roughness_factor: viewer.look().roughness_factor,
            exposure: viewer.look().exposure.to_string(),
            filter: viewer.look().filter.to_string(),
            object: viewer.look().object.to_string(),
            paint: viewer.look().paint.to_string(),
            size: viewer.picture_size(),
            settled: !viewer.is_busy(),
            panel: viewer.panel(),
            roughness_slider: viewer.roughness_slider(),
        });
        Ok(serde_json::to_string(&state)?)
    }

    /// Applies `change`, a JSON object with any of roughness, roughness_factor, backdrop, exposure (a number
    /// or "auto"), turn, filter, object and paint (as [`Technique`], [`Object`] and [`Paint`] format them)
    /// and panel.
    ///
    /// # Errors
    /// If a field is unknown or its value out of range; nothing changes then.
    pub fn set(&self, change: &str) -> Result<(), JsError> {
        let change: Change = serde_json::from_str(change)?;
        let filter: Option<Technique> = parsed("filter", change.filter)?;
        let object: Option<Object> = parsed("object", change.object)?;
        let paint: Option<Paint> = parsed("paint", change.paint)?;
        let exposure = match change.exposure {
            Some(ExposureChange::Ev(ev)) => Some(Exposure::Ev(ev)),
            Some(ExposureChange::Text(text)) => parsed("exposure", Some(text))?,
            None => None,
        };
        let set = self.act(|viewer| {
            let was = viewer.look().clone();
            let look = Look {
                roughness: change.roughness.unwrap_or(was.roughness),
                backdrop: change.backdrop.or(was.backdrop),
                exposure: exposure.unwrap_or(was.exposure),
                roughness_factor: change.roughness_factor.unwrap_or(was.roughness_factor),
                turn: change.turn.unwrap_or(was.turn),
                filter: filter.unwrap_or(was.filter),
                object: object.unwrap_or(was.object),
                paint: paint.unwrap_or(was.paint),
                ..was
            };
            look.check()?;
            if look.object == Object::Mesh && !viewer.has_mesh() {
                return Err(crate::Error::Parameter("no mesh is loaded; open one first".to_owned()));
            }
            *viewer.look_mut() = look;
            if let Some(shown) = change.panel {
                viewer.set_panel(shown);
            }
            Ok::<_, crate::Error>(())
        });
        Ok(set.unwrap_or(Ok(()))?)
    }
}

/// Parses `text`, if present.
fn parsed<T: FromStr<Err = String>>(what: &str, text: Option<String>) -> Result<Option<T>, JsError> {
    let value = text.map(|text| text.parse()).transpose();
    value.map_err(|error| JsError::new(&format!("{what} {error}")))
}

impl Page {
    /// Calls `act` if the device is ready, and requests a redraw.
    fn act<T>(&self, act: impl FnOnce(&mut Viewer) -> T) -> Option<T> {
        let mut application = self.application.borrow_mut();
        let Shown { viewer, window, .. } = application.shown.as_mut()?;
        let found = act(viewer);
        window.request_redraw();
        Some(found)
    }

    /// Forwards an event, and reports a fatal error to the page.
    fn hand_on(&self, event: impl FnOnce(&mut Application)) {
        let failure = {
            let mut application = self.application.borrow_mut();
            event(&mut application);
            application.failure.take()
        };
        if let Some(failure) = failure {
            self.call(&JsValue::from_str(&failure.to_string()));
        }
    }

    /// Ignores exceptions that the page throws.
    fn call(&self, message: &JsValue) {
        self.on_event.call1(&JsValue::UNDEFINED, message).ok();
    }
}

impl ApplicationHandler<Ready> for Page {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        self.hand_on(|application| application.resumed(event_loop));
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, ready: Ready) {
        self.hand_on(|application| application.user_event(event_loop, ready));
        if self.application.borrow().shown.is_some() {
            self.call(&JsValue::UNDEFINED);
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, window: WindowId, event: WindowEvent) {
        self.hand_on(|application| application.window_event(event_loop, window, event));
    }
}

/// Reads `bytes`, the file named `name`, and discards the result. WebAssembly aborts on a panic and on failed
/// allocations. A page therefore has a worker, with an instance of its own, read a file before [`Page::open`]
/// does.
///
/// # Errors
/// If it is neither an environment nor a mesh.
#[wasm_bindgen]
pub fn read(name: &str, bytes: &[u8]) -> Result<(), JsError> {
    let path = Path::new(name);
    if is_mesh(path) {
        Mesh::read_from_memory(path, bytes)?;
    } else {
        io::read_from_memory(path, bytes, &options())?;
    }
    Ok(())
}

/// The paths of all complete shaders, without files that others include.
#[wasm_bindgen]
#[must_use]
pub fn shader_paths() -> Vec<String> {
    let included = |path: &str| {
        let line = format!("#include \"{path}\"");
        path.starts_with("common/") || shader::FILES.iter().any(|(_, text)| text.lines().any(|l| l == line))
    };
    let paths = shader::FILES.iter().map(|(path, _)| *path);
    paths.filter(|path| !included(path)).map(str::to_owned).collect()
}

/// The text of the shader `path` with its includes resolved.
#[wasm_bindgen]
#[must_use]
pub fn shader_source(path: &str) -> String {
    shader::source(path)
}
