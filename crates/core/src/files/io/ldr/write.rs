//! PNG output through the `image` crate: 8-bit sRGB pictures.

use crate::common::error::{Error, Result};
use crate::files::io::output::{self, Existing};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder as _, RgbImage};
use std::path::Path;

/// Writes `picture` atomically to `path`.
///
/// # Errors
/// As [`output::write_file`].
pub fn write_png(path: &Path, existing: Existing, picture: &RgbImage) -> Result<()> {
    let bytes = png_bytes(picture)?;
    output::write_file(path, existing, |file| file.write_all(&bytes))
}

/// Encodes `picture` as a file in memory.
///
/// # Errors
/// [`Error::Parameter`] for a picture larger than PNG supports.
pub fn png_bytes(picture: &RgbImage) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::Rgb8)
        .map_err(|error| Error::Parameter(format!("PNG: {error}")))?;
    Ok(bytes)
}
