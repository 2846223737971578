//! PNG and JPEG files, read as sRGB: values are linearised, alpha is ignored; and PNG of eight bits a
//! channel, written.

use crate::common::error::{Error, Result};
use crate::files::io::output::{self, Existing};
use crate::files::io::picture::{Picture, Source, TEXEL_BYTES};
use crate::light::environment::Rgb;
use octagloss_drawing::bitmap::Bitmap;
use png::ColorType;
use std::io::Cursor;
use std::path::Path;
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Decodes a PNG of any bit depth.
pub(super) fn decode_png(source: &Source<'_>) -> Result<Picture> {
    // Check the size in the header chunk first; the decoder reports a zero size less clearly.
    if let Some((width, height)) = png_size(source.bytes) {
        source.check_memory(width, height, 0)?;
    }
    let limits = png::Limits { bytes: usize::try_from(source.memory_limit).unwrap_or(usize::MAX) };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(source.bytes), limits);
    // Skip profiles and texts: they are unused, and a small file can decompress to gigabytes.
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_ignore_text_chunk(true);
    // Expand palettes to colours and samples of less than a byte to bytes.
    decoder.set_transformations(png::Transformations::EXPAND);
    let refused = |error: png::DecodingError| source.decoder_error("PNG", &error);
    let mut reader = decoder.read_info().map_err(refused)?;
    let (color, depth) = reader.output_color_type();
    let channels = color.samples();
    let is_deep = depth == png::BitDepth::Sixteen;
    let (width, height) = reader.info().size();
    let pixel_bytes = if is_deep { 2 * channels } else { channels };
    source.check_memory(width, height, TEXEL_BYTES + pixel_bytes as u64)?;
    let mut samples = vec![0; width as usize * height as usize * pixel_bytes];
    reader.next_frame(&mut samples).map_err(refused)?;
    let table = linear_from_srgb(if is_deep { u16::MAX } else { u8::MAX.into() });
    let linear = |pixel: &[u8], channel: usize| {
        // Grey has one channel. Alpha is last and not read.
        let channel = if channels >= 3 { channel } else { 0 };
        table[if is_deep {
            usize::from(u16::from_be_bytes([pixel[2 * channel], pixel[2 * channel + 1]]))
        } else {
            usize::from(pixel[channel])
        }]
    };
    let texels = samples.chunks_exact(pixel_bytes).map(|pixel| [0, 1, 2].map(|c| linear(pixel, c))).collect();
    Ok(picture("PNG", if is_deep { 16 } else { 8 }, (width, height), texels))
}

fn png_size(bytes: &[u8]) -> Option<(u32, u32)> {
    let side = |at: usize| Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    (bytes.get(12..16)? == b"IHDR").then_some(())?;
    Some((side(16)?, side(20)?))
}

/// Decodes a JPEG.
pub(super) fn decode_jpeg(source: &Source<'_>) -> Result<Picture> {
    if !ends_with_its_end(source.bytes) {
        return Err(source.truncated("JPEG"));
    }
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
    let options = options.set_strict_mode(false).set_max_width(usize::MAX).set_max_height(usize::MAX);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(source.bytes), options);
    let refused = |error: DecodeErrors| source.decoder_error("JPEG", &error);
    decoder.decode_headers().map_err(refused)?;
    let info = decoder.info().expect("the headers were read");
    let (width, height) = (u32::from(info.width), u32::from(info.height));
    // Decoded samples in addition to the texels, and a second copy for a progressive JPEG's coefficients.
    source.check_memory(width, height, TEXEL_BYTES + 4 * u64::from(info.components))?;
    let samples = decoder.decode().map_err(refused)?;
    let table = linear_from_srgb(u8::MAX.into());
    let linear = |pixel: &[u8; 3]| pixel.map(|value| table[usize::from(value)]);
    let texels = samples.as_chunks().0.iter().map(linear).collect();
    Ok(picture("JPEG", 8, (width, height), texels))
}

fn picture(name: &str, bits: u32, (width, height): (u32, u32), texels: Vec<Rgb>) -> Picture {
    Picture {
        width,
        height,
        texels,
        format: format!("{name}, {bits} bits a channel, sRGB"),
        warnings: vec![format!("a {name} is not HDR: radiance above its white is clipped")],
        ..Picture::default()
    }
}

/// The sRGB transfer function (IEC 61966-2-1) at every value up to `greatest`.
fn linear_from_srgb(greatest: u16) -> Vec<f32> {
    (0..=greatest)
        .map(|value| {
            let encoded = f64::from(value) / f64::from(greatest);
            let linear =
                if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
            linear as f32
        })
        .collect()
}

/// Whether a JPEG's segments lead to its end marker; the decoder fills missing data with grey.
fn ends_with_its_end(bytes: &[u8]) -> bool {
    const END: u8 = 0xd9;
    let mut at = 2;
    loop {
        // Skip to the next marker: past entropy-coded bytes, stuffing (00) and restarts (d0 to d7).
        let Some(step) = bytes.get(at..).and_then(|rest| {
            rest.windows(2).position(|pair| pair[0] == 0xff && !matches!(pair[1], 0x00 | 0xd0..=0xd7 | 0xff))
        }) else {
            return false;
        };
        at += step;
        if bytes[at + 1] == END {
            return true;
        }
        let Some(length) = bytes.get(at + 2..at + 4) else { return false };
        at += 2 + usize::from(u16::from_be_bytes([length[0], length[1]]));
    }
}

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
