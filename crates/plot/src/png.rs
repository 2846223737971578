//! Encodes pictures of figures.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _, RgbImage};

/// Encodes `pixels` as PNG without filters, which halves the size of flat colours.
pub(super) fn png(pixels: &RgbImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::NoFilter);
    let (width, height) = pixels.dimensions();
    let written = encoder.write_image(pixels.as_raw(), width, height, ExtendedColorType::Rgb8);
    written.expect("drawing to memory cannot fail");
    bytes
}
