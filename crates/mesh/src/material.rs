//! Materials of meshes: glTF's metallic-roughness model and its textures.

use image::{ImageReader, Limits};
use octagloss_core::common::error::{Error, Result};
use std::io::Cursor;
use std::path::Path;

/// Most texels along an edge of a texture.
pub(super) const MAX_TEXELS: u32 = 8192;

/// Most bytes of all decoded textures of a mesh.
pub(super) const MAX_TEXTURES: u64 = 2 << 30;

/// Material of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Colour and opacity, linear: the reflectance of a metal at normal incidence, or the albedo of a
    /// dielectric.
    pub base: [f32; 4],
    /// 0 for a dielectric, 1 for a metal.
    pub metallic: f32,
    /// Perceptual roughness in \[0, 1\].
    pub roughness: f32,
    /// Opacity below which the surface is discarded.
    pub cutoff: Option<f32>,
    /// Radiance that the surface emits, linear, with its strength.
    pub emission: [f32; 3],
    /// Anisotropy in \[0, 1\], and its direction from the tangent in radians, counterclockwise.
    pub anisotropy: f32,
    /// See [`Self::anisotropy`].
    pub direction: f32,
    /// Share of a clear coat in \[0, 1\].
    pub clearcoat: f32,
    /// Perceptual roughness of the coat in \[0, 1\].
    pub coat_roughness: f32,
    /// Factors of the base colour, in sRGB.
    pub base_texture: Option<Texture>,
    /// Factors of the emission, in sRGB, at the coordinates of the base colour's texture.
    pub emission_texture: Option<Texture>,
    /// Factors of the roughness (green) and of the metalness (blue).
    pub surface_texture: Option<Texture>,
}

impl Default for Material {
    /// A white metal of roughness 1, as in glTF.
    fn default() -> Self {
        Self {
            base: [1.0; 4],
            metallic: 1.0,
            roughness: 1.0,
            cutoff: None,
            emission: [0.0; 3],
            anisotropy: 0.0,
            direction: 0.0,
            clearcoat: 0.0,
            coat_roughness: 0.0,
            base_texture: None,
            emission_texture: None,
            surface_texture: None,
        }
    }
}

/// A reference to an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Index of the mesh's images.
    pub image: usize,
    /// Address modes along u and v.
    pub wrap: [Wrap; 2],
    /// Whether magnification uses nearest-neighbour filtering.
    pub nearest: bool,
}

/// Address mode outside \[0, 1\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Repeats the image.
    #[default]
    Repeat,
    /// Repeats the image, mirrored every other time.
    Mirror,
    /// Repeats the texels at the edge.
    Clamp,
}

impl Wrap {
    /// The coordinate in \[0, 1\] that an image shows at `x`.
    pub fn within(self, x: f64) -> f64 {
        match self {
            Self::Repeat => x.rem_euclid(1.0),
            Self::Mirror => 1.0 - (x.rem_euclid(2.0) - 1.0).abs(),
            Self::Clamp => x.clamp(0.0, 1.0),
        }
    }
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
    /// Decodes the PNG or JPEG image in `bytes`, named `name`, of the mesh in `path`.
    ///
    /// # Errors
    /// [`Error::Input`] if it is not such an image, or too large.
    pub(super) fn decoded(path: &Path, name: &str, bytes: &[u8]) -> Result<Self> {
        let wrong = |error: String| Error::input(path, format!("{name}: {error}"));
        let mut limits = Limits::no_limits();
        limits.max_alloc = Some(8 * u64::from(MAX_TEXELS) * u64::from(MAX_TEXELS));
        let reader = || {
            let mut reader = ImageReader::new(Cursor::new(bytes));
            reader.limits(limits.clone());
            reader.with_guessed_format().map_err(|error| wrong(error.to_string()))
        };
        let started = reader()?;
        if !matches!(started.format(), Some(image::ImageFormat::Png | image::ImageFormat::Jpeg)) {
            return Err(wrong("its content is neither PNG nor JPEG".to_owned()));
        }
        let (width, height) = started.into_dimensions().map_err(|error| wrong(error.to_string()))?;
        if width.max(height) > MAX_TEXELS {
            return Err(wrong(format!(
                "{width} x {height} texels; use a texture of at most {MAX_TEXELS} per side"
            )));
        }
        let image = reader()?.decode().map_err(|error| wrong(error.to_string()))?.into_rgba8();
        let texels = image.pixels().map(|pixel| pixel.0).collect();
        Ok(Self { width, height, texels })
    }
}
