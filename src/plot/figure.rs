//! A figure, and its files.

use super::render;
use super::scene::{Frame, Scene};
use crate::error::{Error, Result};
use std::path::Path;

/// A form of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Pixels.
    Png,
    /// Shapes and texts; heat maps and panoramas in it are embedded PNG.
    Svg,
}

impl Form {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Png, Self::Svg];

    /// Its file name extension.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Svg => "svg",
        }
    }

    /// The form that the extension of `path` names.
    ///
    /// # Errors
    /// [`Error::Parameter`] for another extension.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let form = Self::ALL.into_iter().find(|form| extension == form.extension());
        form.ok_or_else(|| Error::Parameter(format!("{} must end in .png or .svg", path.display())))
    }
}

/// A drawn figure.
#[derive(Clone, Debug)]
pub struct Figure {
    name: String,
    title: String,
    caption: String,
    scene: Scene,
}

impl Figure {
    pub(super) fn new(name: String, title: String, caption: String, scene: Scene) -> Self {
        Self { name, title, caption, scene }
    }

    /// Its name in files.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What stands above it.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// What stands below it.
    #[must_use]
    pub fn caption(&self) -> &str {
        &self.caption
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn sides(&self) -> [u32; 2] {
        [self.scene.width, self.scene.height]
    }

    /// Every line of text and the rectangle that it covers.
    #[must_use]
    pub fn texts(&self) -> Vec<(String, Frame)> {
        self.scene.texts().map(|text| (text.text.clone(), text.frame())).collect()
    }

    /// The figure's own rectangle.
    #[must_use]
    pub fn frame(&self) -> Frame {
        self.scene.frame()
    }

    /// The figure as a file in memory.
    #[must_use]
    pub fn bytes(&self, form: Form) -> Vec<u8> {
        match form {
            Form::Png => render::png(&render::picture(&self.scene)),
            Form::Svg => render::svg(&self.scene, &self.title, &self.caption).into_bytes(),
        }
    }
}
