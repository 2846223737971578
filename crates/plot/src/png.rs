//! Encodes pictures of figures.

use octagloss_drawing::bitmap::Bitmap;

/// Encodes `pixels` as PNG without filters, which halves the size of flat colours.
pub(super) fn png(pixels: &Bitmap) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_filter(png::Filter::NoFilter);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(pixels.bytes()));
    written.expect("drawing to memory cannot fail");
    bytes
}
