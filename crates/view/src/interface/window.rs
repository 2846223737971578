//! A window around a viewer: events, the surface, and the panel over the picture.

use super::panel::PanelState;
use crate::look::Look;
use crate::look::camera::Camera;
use crate::picture::levels::Levels;
use crate::picture::present::{Display, Viewport};
use crate::picture::resources::draw_pass;
use glam::DVec2;
use octagloss_core::common::error::{Error, Result};
use octagloss_core::cpu::reflector::ReflectorSettings;
use octagloss_core::light::environment::Environment;
use octagloss_gpu::Context;
use octagloss_mesh::Mesh;
use std::path::Path;
use std::sync::Arc;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, Touch, TouchPhase, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoopProxy};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowAttributes, WindowId};

/// Initial content of a window.
#[derive(Clone, Debug)]
pub struct Start {
    /// The environment.
    pub environment: Environment,
    /// Name of the environment.
    pub name: String,
    /// The levels of the bake whose level 0 is the environment.
    pub levels: Option<Levels>,
    /// The mesh of [`crate::Object::Mesh`].
    pub mesh: Option<Mesh>,
    /// The initial look.
    pub look: Look,
    /// Size, border and scan of the OEM's tables; a size of `None` selects by the environment.
    pub table: ReflectorSettings,
    /// Part of the GPU's name; `None` selects the best that can present.
    pub adapter: Option<String>,
    /// Window size in points.
    pub size: (u32, u32),
}

/// What a window shows: always the same, or one of several.
pub(crate) trait Shown: 'static {
    /// What the window shows now.
    fn content(&mut self) -> &mut dyn WindowContent;
}

impl<C: WindowContent + 'static> Shown for C {
    fn content(&mut self) -> &mut dyn WindowContent {
        self
    }
}

/// Creates what a window shows, on its device.
pub(crate) type Create<V> = Box<dyn FnOnce(Context) -> Result<V>>;

/// What a window shows: the viewer of an environment or of a scene.
pub(crate) trait WindowContent {
    /// The device.
    fn context(&self) -> &Context;

    /// Runs the panel; returns the viewport left for the picture, in pixels of a target of `size`.
    fn interface(&mut self, ui: &mut egui::Ui, size: (u32, u32)) -> Viewport;

    /// Draws as much of a picture of `full` pixels as the frame time allows.
    fn draw(&mut self, full: (u32, u32));

    /// Draws the current picture to `display`.
    fn present(&mut self, display: Display<'_>);

    /// Whether the next frame will differ from the last.
    fn is_busy(&self) -> bool;

    /// Opens the file `path`, with the content `bytes` if it is in memory. On failure sets the message and
    /// keeps the current content.
    fn open(&mut self, path: &Path, bytes: Option<&[u8]>);

    /// The camera.
    fn camera(&mut self) -> &mut Camera;

    /// Moves the camera back to its first place.
    fn reset_camera(&mut self);

    /// The panel.
    fn panel(&mut self) -> &mut PanelState;

    /// Shows or hides the panel.
    fn toggle_panel(&mut self) {
        let panel = self.panel();
        panel.is_hidden = !panel.is_hidden;
    }
}

/// Message to the event loop: the device, or why there is none.
pub(crate) struct Ready<V>(Box<Result<OpenWindow<V>>>);

/// Opens a window of `size` in points, named `name`, on the GPU of which `adapter` is a part of the name, and
/// runs its event loop until it is closed.
///
/// # Errors
/// [`Error::Gpu`] if no window or no device is available.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn open<V: Shown>(
    create: Create<V>,
    name: &str,
    (width, height): (u32, u32),
    adapter: Option<String>,
) -> Result<()> {
    // The system's message follows the location in winit's source.
    let refused = |error: winit::error::EventLoopError| {
        let said = error.to_string();
        let said = said.rsplit(": ").next().unwrap_or(&said).trim_end_matches('.');
        Error::Gpu(format!("cannot open a window: {said}; `screenshot` FILE.png needs none"))
    };
    let attributes = Window::default_attributes()
        .with_title(format!("{name} - octagloss"))
        .with_inner_size(winit::dpi::LogicalSize::new(width, height));
    let events = winit::event_loop::EventLoop::with_user_event().build().map_err(refused)?;
    let mut application = Application::new(create, adapter, attributes, events.create_proxy());
    events.run_app(&mut application).map_err(refused)?;
    application.failure.map_or(Ok(()), Err)
}

/// A window with its device.
pub(crate) struct OpenWindow<V> {
    pub window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    pub viewer: V,
    egui: egui_winit::State,
    painter: egui_wgpu::Renderer,
    /// Position of the pointer, and whether it orbits the camera.
    pointer: (f64, f64),
    dragging: bool,
    /// Touches on the picture and their positions.
    fingers: Vec<(u64, DVec2)>,
}

/// State of the event loop.
pub(crate) struct Application<V: 'static> {
    start: Option<(Create<V>, Option<String>, WindowAttributes)>,
    messages: EventLoopProxy<Ready<V>>,
    /// `None` until the device is ready.
    pub shown: Option<OpenWindow<V>>,
    /// The error that ended the loop.
    pub failure: Option<Error>,
}

impl<V: Shown> Application<V> {
    pub(crate) fn new(
        create: Create<V>,
        adapter: Option<String>,
        attributes: WindowAttributes,
        messages: EventLoopProxy<Ready<V>>,
    ) -> Self {
        Self { start: Some((create, adapter, attributes)), messages, shown: None, failure: None }
    }

    fn fail(&mut self, event_loop: &ActiveEventLoop, error: Error) {
        self.failure = Some(error);
        event_loop.exit();
    }
}

impl<V: Shown> OpenWindow<V> {
    /// Opens the device and creates the content of `window`.
    async fn new(
        create: Create<V>,
        name: Option<String>,
        window: Arc<Window>,
        display: Box<dyn wgpu::wgt::WgpuHasDisplayHandle>,
    ) -> Result<Self> {
        let instance =
            wgpu::Instance::new(wgpu::InstanceDescriptor::new_with_display_handle_from_env(display));
        let surface = instance
            .create_surface(Arc::clone(&window))
            .map_err(|error| Error::Gpu(format!("cannot draw into the window: {error}")))?;
        let adapter = adapter(&instance, &surface, name.as_deref()).await?;
        let context = Context::new(&adapter).await?;
        let size = window.inner_size();
        let mut configuration =
            surface
                .get_default_config(&adapter, size.width.max(1), size.height.max(1))
                .ok_or_else(|| Error::Gpu(format!("{} cannot present to windows", context.describe())))?;
        // The shader encodes sRGB itself.
        let is_plain = |format: &wgpu::TextureFormat| !format.is_srgb() && format.components() == 4;
        let mut formats = surface.get_capabilities(&adapter).formats.into_iter();
        configuration.format = formats.find(is_plain).unwrap_or(configuration.format);
        surface.configure(context.device(), &configuration);
        let options = egui_wgpu::RendererOptions::default();
        let painter = egui_wgpu::Renderer::new(context.device(), configuration.format, options);
        let viewer = create(context.clone())?;
        let egui = egui_winit::State::new(
            egui::Context::default(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            None,
            Some(context.device().limits().max_texture_dimension_2d as usize),
        );
        Ok(Self {
            window,
            surface,
            configuration,
            viewer,
            egui,
            painter,
            pointer: (0.0, 0.0),
            dragging: false,
            fingers: Vec::new(),
        })
    }

    fn resize(&mut self, size: PhysicalSize<u32>) {
        if size.width > 0 && size.height > 0 {
            (self.configuration.width, self.configuration.height) = (size.width, size.height);
            self.surface.configure(self.viewer.content().context().device(), &self.configuration);
            self.window.request_redraw();
        }
    }

    /// Draws one frame: runs the interface, draws the picture, and presents both.
    fn redraw(&mut self) -> Result<()> {
        let size = (self.configuration.width, self.configuration.height);
        let input = self.egui.take_egui_input(&self.window);
        let interface = self.egui.egui_ctx().clone();
        let mut viewport = None;
        let output = interface.run_ui(input, |ui| viewport = Some(self.viewer.content().interface(ui, size)));
        let Some(viewport) = viewport else { return Ok(()) };
        self.egui.handle_platform_output(&self.window, output.platform_output);
        self.viewer.content().draw((viewport.width, viewport.height));

        let context = self.viewer.content().context().clone();
        let frame = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(frame) | wgpu::CurrentSurfaceTexture::Suboptimal(frame) => {
                frame
            }
            wgpu::CurrentSurfaceTexture::Timeout | wgpu::CurrentSurfaceTexture::Occluded => return Ok(()),
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                self.surface.configure(context.device(), &self.configuration);
                self.window.request_redraw();
                return Ok(());
            }
            wgpu::CurrentSurfaceTexture::Validation => {
                context.check()?;
                return Err(Error::Gpu("the window's surface is invalid".to_owned()));
            }
        };
        let view = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let triangles = interface.tessellate(output.shapes, output.pixels_per_point);
        let (device, queue) = (context.device(), context.queue());
        for (id, deltas) in &output.textures_delta.set {
            for delta in deltas {
                self.painter.update_texture(device, queue, *id, delta);
            }
        }
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: [size.0, size.1],
            pixels_per_point: output.pixels_per_point,
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let format = self.configuration.format;
        self.viewer.content().present(Display { encoder: &mut encoder, view: &view, format, viewport });
        let uploads = self.painter.update_buffers(device, queue, &mut encoder, &triangles, &screen);
        let pass = draw_pass(&mut encoder, "panel", &view, false, None, None);
        let mut pass = pass.forget_lifetime();
        self.painter.render(&mut pass, &triangles, &screen);
        drop(pass);
        queue.submit(uploads.into_iter().chain([encoder.finish()]));
        self.window.pre_present_notify();
        queue.present(frame);
        for id in &output.textures_delta.free {
            self.painter.free_texture(id);
        }
        context.check()?;
        let again = output.viewport_output.values().any(|viewport| viewport.repaint_delay.is_zero());
        if again || self.viewer.content().is_busy() {
            self.window.request_redraw();
        }
        Ok(())
    }

    /// Handles camera input, keys and dropped files.
    fn on_event(&mut self, event: &WindowEvent) {
        match event {
            WindowEvent::DroppedFile(path) => self.viewer.content().open(path, None),
            WindowEvent::MouseInput { state, button: MouseButton::Left, .. } => {
                self.dragging = *state == ElementState::Pressed;
            }
            WindowEvent::CursorMoved { position, .. } => {
                let (x, y) = self.pointer;
                self.pointer = (position.x, position.y);
                if self.dragging {
                    self.orbit(position.x - x, position.y - y);
                }
            }
            WindowEvent::Touch(touch) => self.on_touch(touch),
            WindowEvent::MouseWheel { delta, .. } => {
                let lines = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => f64::from(*lines),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / 50.0,
                };
                self.approach((0.1 * lines).exp());
            }
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                match &event.logical_key {
                    Key::Character(text) if text.eq_ignore_ascii_case("h") => {
                        self.viewer.content().toggle_panel();
                    }
                    Key::Named(NamedKey::Home) => self.viewer.content().reset_camera(),
                    _ => {}
                }
            }
            _ => {}
        }
    }

    /// One finger orbits the camera; two zoom.
    fn on_touch(&mut self, touch: &Touch) {
        let here = DVec2::new(touch.location.x, touch.location.y);
        let known = self.fingers.iter().position(|(id, _)| *id == touch.id);
        match (touch.phase, known) {
            (TouchPhase::Started, None) => self.fingers.push((touch.id, here)),
            (TouchPhase::Moved, Some(finger)) => {
                let before = std::mem::replace(&mut self.fingers[finger].1, here);
                match self.fingers[..] {
                    [_] => self.orbit(here.x - before.x, here.y - before.y),
                    [(_, a), (_, b)] => {
                        let other = if finger == 0 { b } else { a };
                        self.approach(here.distance(other).max(1.0) / before.distance(other).max(1.0));
                    }
                    _ => {}
                }
            }
            (TouchPhase::Ended | TouchPhase::Cancelled, Some(finger)) => {
                self.fingers.swap_remove(finger);
            }
            _ => {}
        }
    }

    /// Divides the camera's distance by `times`.
    fn approach(&mut self, times: f64) {
        let camera = self.viewer.content().camera();
        camera.distance = (camera.distance / times).clamp(1.05, 100.0);
    }

    /// Orbits the camera by a drag in pixels: half a turn for the window's height.
    fn orbit(&mut self, right: f64, down: f64) {
        let turn = std::f64::consts::PI / f64::from(self.configuration.height);
        let camera = self.viewer.content().camera();
        camera.yaw = (camera.yaw - right * turn).rem_euclid(std::f64::consts::TAU);
        camera.pitch = (camera.pitch + down * turn)
            .clamp(-crate::look::camera::MAX_PITCH, crate::look::camera::MAX_PITCH);
    }
}

/// Selects the adapter named `name`, or the best one, that can present to `surface`.
async fn adapter(
    instance: &wgpu::Instance,
    surface: &wgpu::Surface<'static>,
    name: Option<&str>,
) -> Result<wgpu::Adapter> {
    if let Some(name) = name {
        let adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
        let called = |adapter: &wgpu::Adapter| {
            adapter.get_info().name.to_lowercase().contains(&name.to_lowercase())
                && adapter.is_surface_supported(surface)
        };
        let found = adapters.into_iter().find(called);
        return found.ok_or_else(|| {
            Error::Gpu(format!("no adapter named {name} can present to windows; choose another `adapter`"))
        });
    }
    let options = wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        compatible_surface: Some(surface),
        ..Default::default()
    };
    instance.request_adapter(&options).await.map_err(|error| {
        Error::Gpu(format!("no adapter presents to windows: {error}; install a Vulkan driver such as Mesa's"))
    })
}

impl<V: Shown> ApplicationHandler<Ready<V>> for Application<V> {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        event_loop.set_control_flow(ControlFlow::Wait);
        let Some((create, adapter, attributes)) = self.start.take() else { return };
        let window = match event_loop.create_window(attributes) {
            Ok(window) => Arc::new(window),
            Err(error) => {
                return self.fail(event_loop, Error::Gpu(format!("cannot open a window: {error}")));
            }
        };
        let display = Box::new(event_loop.owned_display_handle());
        let shown = OpenWindow::new(create, adapter, window, display);
        let messages = self.messages.clone();
        #[cfg(not(target_arch = "wasm32"))]
        {
            let shown = octagloss_gpu::block_on(None, shown).and_then(|shown| shown);
            // The receiver is gone once the loop has ended.
            messages.send_event(Ready(Box::new(shown))).ok();
        }
        #[cfg(target_arch = "wasm32")]
        wasm_bindgen_futures::spawn_local(async move {
            messages.send_event(Ready(Box::new(shown.await))).ok();
        });
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, Ready(shown): Ready<V>) {
        match *shown {
            Ok(mut shown) => {
                shown.resize(shown.window.inner_size());
                shown.window.request_redraw();
                self.shown = Some(shown);
            }
            Err(error) => self.fail(event_loop, error),
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(shown) = &mut self.shown else { return };
        let response = shown.egui.on_window_event(&shown.window, &event);
        // egui requests a repaint with every frame.
        if response.repaint && event != WindowEvent::RedrawRequested {
            shown.window.request_redraw();
        }
        match event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::Resized(size) => shown.resize(size),
            WindowEvent::RedrawRequested => {
                if let Err(error) = shown.redraw() {
                    self.fail(event_loop, error);
                }
            }
            _ => {
                // A drag that began on the picture may end over the panel.
                let released = matches!(
                    event,
                    WindowEvent::MouseInput { state: ElementState::Released, .. }
                        | WindowEvent::Touch(Touch { phase: TouchPhase::Ended | TouchPhase::Cancelled, .. })
                );
                if !response.consumed || released {
                    shown.on_event(&event);
                }
                if shown.viewer.content().is_busy() {
                    shown.window.request_redraw();
                }
            }
        }
    }
}
