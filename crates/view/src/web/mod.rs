//! The viewer in a web page: the interface for JavaScript.

mod scene_side;
mod sides;
mod view_side;

use super::look::Look;
use super::scene::Scene;
use crate::interface::viewer::options;
use crate::interface::window::{Application, OpenWindow, Ready, Shown as _, Start};
use js_sys::Function;
use octagloss_core::common::error::Error;
use octagloss_core::cpu::reflector::ReflectorSettings;
use octagloss_core::files::io;
use octagloss_mesh::{Mesh, is_mesh};
use sides::{SideName, Sides};
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
#[allow(unnameable_types, reason = "JavaScript names it")]
pub struct Page {
    application: Rc<RefCell<Application<Sides>>>,
    on_event: Function,
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
        let create = Box::new(|context| Sides::new(context, start));
        let application = Application::new(create, None, attributes, events.create_proxy());
        let page = Self { application: Rc::new(RefCell::new(application)), on_event };
        events.spawn_app(page.clone());
        Ok(page)
    }

    /// Opens an environment or a mesh from `bytes`, the file named `name`; on the scene side the scene of a
    /// mesh file. On failure the panel shows the error and the picture stays.
    pub fn open(&self, name: &str, bytes: &[u8]) {
        self.act(|sides| sides.content().open(Path::new(name), Some(bytes)));
    }

    /// Shows a message in the panel.
    pub fn show_message(&self, message: String) {
        self.act(|sides| sides.content().panel().message = Some(message));
    }

    /// Shows the side named `side`: `view`, objects under an environment, or `scene`, a moving scene.
    ///
    /// # Errors
    /// If there is no such side, or the device cannot show it; the side stays.
    pub fn show(&self, side: &str) -> Result<(), JsError> {
        let side = parsed("side", Some(side.to_owned()))?.unwrap_or(SideName::View);
        Ok(self.act(|sides| sides.show(side)).unwrap_or(Ok(()))?)
    }

    /// The state as JSON; `null` until the device is ready.
    ///
    /// # Errors
    /// None in practice: the state always serialises.
    pub fn state(&self) -> Result<String, JsError> {
        let mut application = self.application.borrow_mut();
        let state = application.shown.as_mut().map(|OpenWindow { viewer, .. }| viewer.shown().state());
        Ok(serde_json::to_string(&state)?)
    }

    /// Applies `change`, a JSON object, to the side that is shown. The view side takes any of roughness,
    /// roughness_factor, anisotropy, direction, clearcoat, coat_roughness, backdrop, exposure (a number or
    /// "auto"), turn, filter, object and paint, as the command line's options. The scene side takes any of
    /// roughness (`null` for the objects' own), exposure, tone, scene_time, probes, probe_budget (`null` for
    /// none), proxy, direct, filter and oem_size, as the options, moving and gpu_times. Both take panel.
    ///
    /// # Errors
    /// If a field is unknown or its value out of range; nothing changes then.
    pub fn set(&self, change: &str) -> Result<(), JsError> {
        self.act(|sides| sides.shown().set(change)).unwrap_or(Ok(()))
    }
}

/// Parses `text`, if present.
fn parsed<T: FromStr<Err = String>>(what: &str, text: Option<String>) -> Result<Option<T>, Error> {
    let value = text.map(|text| text.parse()).transpose();
    value.map_err(|error| Error::Parameter(format!("{what} {error}")))
}

impl Page {
    /// Calls `act` if the device is ready, and requests a redraw.
    fn act<T>(&self, act: impl FnOnce(&mut Sides) -> T) -> Option<T> {
        let mut application = self.application.borrow_mut();
        let OpenWindow { viewer, window, .. } = application.shown.as_mut()?;
        let found = act(viewer);
        window.request_redraw();
        Some(found)
    }

    /// Forwards an event, and reports a fatal error to the page.
    fn hand_on(&self, event: impl FnOnce(&mut Application<Sides>)) {
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

impl ApplicationHandler<Ready<Sides>> for Page {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        self.hand_on(|application| application.resumed(event_loop));
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, ready: Ready<Sides>) {
        self.hand_on(|application| application.user_event(event_loop, ready));
        if self.application.borrow().shown.is_some() {
            self.call(&JsValue::UNDEFINED);
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, window: WindowId, event: WindowEvent) {
        self.hand_on(|application| application.window_event(event_loop, window, event));
    }
}

/// Reads `bytes`, the file named `name`, for the side named `side`, and discards the result. WebAssembly
/// aborts on a panic and on failed allocations. A page therefore has a worker, with an instance of its own,
/// read a file before [`Page::open`] does.
///
/// # Errors
/// If it is not what the side shows: an environment or a mesh, or a scene.
#[wasm_bindgen]
pub fn read(side: &str, name: &str, bytes: &[u8]) -> Result<(), JsError> {
    let path = Path::new(name);
    if side.parse() == Ok(SideName::Scene) {
        Scene::of_mesh(&Mesh::read_from_memory(path, bytes)?)?;
    } else if is_mesh(path) {
        Mesh::read_from_memory(path, bytes)?;
    } else {
        io::read_from_memory(path, bytes, &options())?;
    }
    Ok(())
}

/// The paths of all complete shaders, without files that others include.
#[wasm_bindgen]
pub fn shader_paths() -> Vec<String> {
    let included = |path: &str| {
        let line = format!("#include \"{path}\"");
        path.starts_with("common/")
            || octagloss_shaders::FILES.iter().any(|(_, text)| text.lines().any(|l| l == line))
    };
    let paths = octagloss_shaders::FILES.iter().map(|(path, _)| *path);
    paths.filter(|path| !included(path)).map(str::to_owned).collect()
}

/// The text of the shader `path` with its includes resolved.
#[wasm_bindgen]
pub fn shader_source(path: &str) -> String {
    octagloss_shaders::source(path)
}
