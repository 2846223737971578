//! Surfaces of meshes: glTF's metallic-roughness model and its textures.

use crate::error::{Error, Result};
use image::{ImageReader, Limits};
use std::io::Cursor;
use std::path::Path;

/// Most texels along an edge of a texture.
pub(super) const MOST_TEXELS: u32 = 8192;

/// Most bytes of all decoded textures of a mesh.
pub(super) const MOST_TEXTURES: u64 = 2 << 30;

/// What a surface is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Colour and opacity, linear: the reflectance of a metal at normal incidence, or the albedo of a
    /// dielectric.
    pub base: [f32; 4],
    /// 0 for a dielectric, 1 for a metal.
    pub metallic: f32,
    /// Perceptual roughness in \[0, 1\].
    pub roughness: f32,
    /// Opacity below which there is no surface.
    pub cutoff: Option<f32>,
    /// Factors of the base colour, in sRGB.
    pub base_texture: Option<Texture>,
    /// Factors of the roughness (green) and of the metalness (blue).
    pub surface_texture: Option<Texture>,
}

impl Default for Material {
    /// A white metal as rough as can be, as in glTF.
    fn default() -> Self {
        Self {
            base: [1.0; 4],
            metallic: 1.0,
            roughness: 1.0,
            cutoff: None,
            base_texture: None,
            surface_texture: None,
        }
    }
}

/// An image on a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Index of the mesh's images.
    pub image: usize,
    /// What is beyond the image's edges, along u and v.
    pub wrap: [Wrap; 2],
    /// Whether magnified texels are squares.
    pub nearest: bool,
}

/// What a texture shows outside of \[0, 1\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image again, every other time mirrored.
    Mirror,
    /// The texels at its edge.
    Clamp,
}

/// A decoded texture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue and opacity, rows from the top.
    pub texels: Vec<[u8; 4]>,
}

impl Image {
    /// The PNG or JPEG image in `bytes`, called `name`, of the mesh in `path`.
    ///
    /// # Errors
    /// [`Error::Input`] for what is no such image, or too large.
    pub(super) fn decoded(path: &Path, name: &str, bytes: &[u8]) -> Result<Self> {
        let wrong = |error: String| Error::input(path, format!("{name}: {error}"));
        let mut limits = Limits::no_limits();
        limits.max_alloc = Some(8 * u64::from(MOST_TEXELS) * u64::from(MOST_TEXELS));
        let reader = || {
            let mut reader = ImageReader::new(Cursor::new(bytes));
            reader.limits(limits.clone());
            reader.with_guessed_format().map_err(|error| wrong(error.to_string()))
        };
        let started = reader()?;
        if !matches!(started.format(), Some(image::ImageFormat::Png | image::ImageFormat::Jpeg)) {
            return Err(wrong("neither PNG nor JPEG by its content".to_owned()));
        }
        let (width, height) = started.into_dimensions().map_err(|error| wrong(error.to_string()))?;
        if width.max(height) > MOST_TEXELS {
            return Err(wrong(format!(
                "{width} x {height} texels; use a texture of at most {MOST_TEXELS} a side"
            )));
        }
        let image = reader()?.decode().map_err(|error| wrong(error.to_string()))?.into_rgba8();
        let texels = image.pixels().map(|pixel| pixel.0).collect();
        Ok(Self { width, height, texels })
    }
}
