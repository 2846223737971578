//! The sides of the page: objects under an environment, and a moving scene.

use super::super::camera::Camera;
use super::super::present::Viewport;
use super::super::scene::{Scene, SceneSettings, SceneStart, SceneViewer};
use super::super::viewer::Viewer;
use super::super::window::{Content, FromStart, Start};
use crate::error::Result;
use crate::gpu::Context;
use crate::names::named;
use std::path::Path;

/// A side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SideName {
    /// Objects under an environment.
    View,
    /// A moving scene.
    Scene,
}

named!(SideName { View = "view", Scene = "scene" });

/// Both sides, of which one is shown.
#[derive(Debug)]
pub(super) struct Sides {
    viewer: Viewer,
    /// Created when it is first shown.
    scene: Option<SceneViewer>,
    side: SideName,
}

/// The side that is shown.
pub(super) enum Side<'a> {
    View(&'a mut Viewer),
    Scene(&'a mut SceneViewer),
}

impl Sides {
    /// Shows `side`, with or without the panel as before.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if the built-in scene does not fit the device; the side stays.
    pub(super) fn show(&mut self, side: SideName) -> Result<()> {
        let had_panel = self.has_panel();
        if side == SideName::Scene && self.scene.is_none() {
            let scene = Scene::gallery()?;
            let start = SceneStart {
                look: scene.first_look(),
                scene,
                name: "scene".to_owned(),
                settings: SceneSettings::default(),
                time: 0.0,
                budget: None,
                adapter: None,
                size: (0, 0),
            };
            self.scene = Some(SceneViewer::new(self.viewer.context().clone(), start)?);
        }
        self.side = side;
        if self.has_panel() != had_panel {
            self.content_mut().toggle_panel();
        }
        Ok(())
    }

    /// The side that is shown.
    pub(super) const fn shown(&mut self) -> Side<'_> {
        match (self.side, &mut self.scene) {
            (SideName::Scene, Some(scene)) => Side::Scene(scene),
            _ => Side::View(&mut self.viewer),
        }
    }

    const fn has_panel(&self) -> bool {
        match (self.side, &self.scene) {
            (SideName::Scene, Some(scene)) => scene.has_panel(),
            _ => self.viewer.panel(),
        }
    }

    fn content(&self) -> &dyn Content {
        match (self.side, &self.scene) {
            (SideName::Scene, Some(scene)) => scene,
            _ => &self.viewer,
        }
    }

    fn content_mut(&mut self) -> &mut dyn Content {
        match self.shown() {
            Side::View(viewer) => viewer,
            Side::Scene(scene) => scene,
        }
    }
}

impl FromStart for Sides {
    type Start = Start;

    fn adapter(start: &Start) -> Option<&str> {
        Viewer::adapter(start)
    }

    fn new(context: Context, start: Start) -> Result<Self> {
        let viewer = <Viewer as FromStart>::new(context, start)?;
        Ok(Self { viewer, scene: None, side: SideName::View })
    }
}

impl Content for Sides {
    fn context(&self) -> &Context {
        self.content().context()
    }

    fn interface(&mut self, ui: &mut egui::Ui, size: (u32, u32)) -> Viewport {
        self.content_mut().interface(ui, size)
    }

    fn draw(&mut self, full: (u32, u32)) {
        self.content_mut().draw(full);
    }

    fn present(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        viewport: Viewport,
    ) {
        self.content_mut().present(encoder, view, format, viewport);
    }

    fn is_busy(&self) -> bool {
        self.content().is_busy()
    }

    fn open_file(&mut self, path: &Path) {
        self.content_mut().open_file(path);
    }

    fn camera(&mut self) -> &mut Camera {
        self.content_mut().camera()
    }

    fn reset_camera(&mut self) {
        self.content_mut().reset_camera();
    }

    fn toggle_panel(&mut self) {
        self.content_mut().toggle_panel();
    }
}
