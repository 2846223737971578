//! The sides of the page: objects under an environment, and a moving scene.

use super::super::scene::{Scene, SceneSettings, SceneStart, SceneViewer};
use crate::interface::viewer::Viewer;
use crate::interface::window::{Shown, Start, WindowContent};
use octagloss_core::common::error::Result;
use octagloss_core::common::names::named;
use octagloss_gpu::Context;
use serde_json::Value;
use wasm_bindgen::JsError;

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
pub(super) struct Sides {
    viewer: Viewer,
    /// Created when it is first shown.
    scene: Option<SceneViewer>,
    side: SideName,
}

/// What a side shows, and its state and settings as JSON.
pub(super) trait Side: WindowContent {
    /// The state reported to the page.
    fn state(&self) -> Value;

    /// Applies `change`, an object whose absent fields stay unchanged.
    ///
    /// # Errors
    /// A message that names an unknown field or a value; nothing changes then.
    fn set(&mut self, change: &str) -> Result<(), JsError>;
}

impl Sides {
    /// Both sides, of which the viewer of `start` is shown first.
    pub(super) fn new(context: Context, start: Start) -> Result<Self> {
        let viewer = Viewer::new(context, start)?;
        Ok(Self { viewer, scene: None, side: SideName::View })
    }

    /// Shows `side`, with or without the panel as before.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Limit`] if the built-in scene does not fit the device; the
    /// side stays.
    pub(super) fn show(&mut self, side: SideName) -> Result<()> {
        let was_hidden = self.content().panel().is_hidden;
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
        if self.content().panel().is_hidden != was_hidden {
            self.content().toggle_panel();
        }
        Ok(())
    }

    /// The side that is shown.
    pub(super) fn shown(&mut self) -> &mut dyn Side {
        match (self.side, &mut self.scene) {
            (SideName::Scene, Some(scene)) => scene,
            _ => &mut self.viewer,
        }
    }
}

impl Shown for Sides {
    fn content(&mut self) -> &mut dyn WindowContent {
        self.shown()
    }
}
