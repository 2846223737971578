//! PNG output through the `image` crate: 8-bit sRGB pictures.

use super::output::{self, Existing};
use crate::error::Result;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder as _, RgbImage};
use std::io;
use std::path::Path;

/// Writes `picture` to `path`, whole or not at all.
///
/// # Errors
/// As [`output::write_file`].
pub fn write_png(path: &Path, existing: Existing, picture: &RgbImage) -> Result<()> {
    output::write_file(path, existing, |file| {
        PngEncoder::new(file)
            .write_image(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::Rgb8)
            .map_err(io::Error::other)
    })
}
