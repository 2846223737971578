//! PNG output: 8-bit pictures.

use crate::common::error::{Error, Result};
use crate::files::io::output::{self, Existing};
use octagloss_drawing::bitmap::Bitmap;
use png::ColorType;
use std::path::Path;

/// Writes `picture` atomically to `path`.
///
/// # Errors
/// As [`output::write_file`].
pub fn write_png(path: &Path, existing: Existing, picture: &Bitmap) -> Result<()> {
    let bytes = png_bytes(picture)?;
    output::write_file(path, existing, |file| file.write_all(&bytes))
}

/// Encodes `picture` as a file in memory.
///
/// # Errors
/// [`Error::Parameter`] for a picture larger than PNG supports.
pub fn png_bytes(picture: &Bitmap) -> Result<Vec<u8>> {
    png_of(picture.width(), picture.height(), ColorType::Rgb, picture.bytes())
}

/// Encodes channels of eight bits.
pub(crate) fn png_of(width: u32, height: u32, colour: ColorType, channels: &[u8]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(channels));
    written.map_err(|error| Error::Parameter(format!("a PNG of {width}x{height}: {error}")))?;
    Ok(bytes)
}
