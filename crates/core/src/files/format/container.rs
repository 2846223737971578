//! File formats of bakes.

use crate::common::error::{Result, wrong};
use crate::common::names::named;
use crate::files::format::{OutputLayout, Pixel};
use std::path::Path;

/// A file format of bakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Container {
    /// KTX 2, Zstandard.
    Ktx2,
    /// KTX 1, plain.
    #[cfg_attr(feature = "cli", value(name = "ktx"))]
    Ktx1,
    /// DDS with the DX10 header.
    Dds,
    /// OpenEXR: one part per face and level, or one image a file.
    Exr,
    /// Radiance .hdr, one image a file.
    Hdr,
}

named!(Container { Ktx2 = "ktx2", Ktx1 = "ktx", Dds = "dds", Exr = "exr", Hdr = "hdr" });

impl Container {
    /// The container that the extension of `path` names.
    #[must_use]
    pub fn of_path(path: &Path) -> Option<Self> {
        Self::named(&path.extension()?.to_str()?.to_ascii_lowercase())
    }

    /// Whether one file can hold a whole cube chain.
    #[must_use]
    pub const fn is_single(self) -> bool {
        matches!(self, Self::Ktx2 | Self::Ktx1 | Self::Dds)
    }

    /// Whether the container supports `pixel`.
    #[must_use]
    pub fn holds(self, pixel: Pixel) -> bool {
        match self {
            Self::Ktx2 | Self::Dds => pixel.in_textures().is_some(),
            Self::Ktx1 => pixel.gl().is_some(),
            Self::Exr => matches!(pixel, Pixel::F16 | Pixel::F32),
            Self::Hdr => pixel == Pixel::Rgbe,
        }
    }

    /// The pixel format of the levels in `layout` by default: in folders of EXR images floats where half
    /// floats are insufficient.
    #[must_use]
    pub const fn default_pixel(self, layout: OutputLayout) -> Pixel {
        match (self, layout) {
            (Self::Hdr, _) => Pixel::Rgbe,
            (Self::Exr, OutputLayout::Parts | OutputLayout::Mips)
            | (Self::Ktx2 | Self::Ktx1 | Self::Dds, _) => Pixel::F16,
            (Self::Exr, _) => Pixel::Auto,
        }
    }

    /// The pixel format of a file: `choice`, or `default`, which the container supports or replaces.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] if the container does not support the choice.
    pub fn pixel(self, choice: Option<Pixel>, default: Pixel) -> Result<Pixel> {
        let pixel = match (self, choice) {
            (Self::Hdr, None) => return Ok(Pixel::Rgbe),
            (Self::Exr, None) => return Ok(default),
            (_, choice) => choice.unwrap_or(default),
        };
        if self != Self::Hdr && self.holds(pixel) {
            return Ok(pixel);
        }
        let name = pixel.name();
        wrong(match self {
            Self::Hdr => "`pixel` cannot be combined with hdr; its pixels are always RGBE".to_owned(),
            Self::Exr => format!("`pixel` {name} is for ktx2 and dds; exr supports f16 and f32"),
            _ => format!("{} does not support `pixel` {name}; ktx2 and dds do", self.name()),
        })
    }
}

/// Magic number of an `.env`.
pub const ENV_MAGIC: [u8; 8] = [0x86, 0x16, 0x87, 0x96, 0xf6, 0xd6, 0x96, 0x36];
