//! Figures and their file formats.

use super::png::png;
use super::svg::svg;
use octagloss_core::common::error::{Error, Result};
use octagloss_core::common::names::named;
use octagloss_drawing::scene::Scene;
use std::path::Path;

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Pixel image.
    Png,
    /// Vector graphics; heat maps and panoramas are embedded PNG.
    Svg,
}

named!(Form { Png = "png", Svg = "svg" });

impl Form {
    /// The format of the extension of `path`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for another extension.
    pub fn from_path(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let form = Self::ALL.into_iter().find(|form| extension == form.name());
        form.ok_or_else(|| Error::Parameter(format!("{} must end in .png or .svg", path.display())))
    }
}

/// A drawn figure.
#[derive(Clone, Debug)]
pub struct Figure {
    title: String,
    /// Caption below the figure.
    pub caption: String,
    /// The drawing.
    pub scene: Scene,
}

impl Figure {
    pub fn new(title: String, caption: String, scene: Scene) -> Self {
        Self { title, caption, scene }
    }

    /// Encodes the figure in memory.
    pub fn bytes(&self, form: Form) -> Vec<u8> {
        match form {
            Form::Png => png(&self.scene.picture()),
            Form::Svg => svg(&self.scene, &self.title, &self.caption).into_bytes(),
        }
    }
}
