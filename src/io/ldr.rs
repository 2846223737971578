//! PNG and JPEG, taken as sRGB: their values become linear, alpha is ignored.

use super::picture::{Content, Picture, Source, TEXEL_BYTES};
use crate::environment::Rgb;
use crate::error::Result;
use image::codecs::{jpeg::JpegDecoder, png::PngDecoder};
use image::{DynamicImage, ImageDecoder, Limits};
use std::io::Cursor;

/// Decodes a PNG of any bit depth.
pub(super) fn decode_png(source: &Source<'_>) -> Result<Picture> {
    // The sides stand first of all, in the header chunk; the decoder refuses a zero in words of its own.
    if let Some((width, height)) = png_size(source.bytes) {
        source.check_memory(width, height, 0)?;
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(source.memory_limit);
    let decoder = PngDecoder::with_limits(Cursor::new(source.bytes), limits);
    decode(source, "PNG", decoder.map_err(|error| source.decoder_error("PNG", &error))?)
}

fn png_size(bytes: &[u8]) -> Option<(u32, u32)> {
    let side = |at: usize| Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    (bytes.get(12..16)? == b"IHDR").then_some(())?;
    Some((side(16)?, side(20)?))
}

/// Decodes a JPEG.
pub(super) fn decode_jpeg(source: &Source<'_>) -> Result<Picture> {
    if !ends_with_its_end(source.bytes) {
        return Err(source.error(format!(
            "truncated: the JPEG data ends after {} bytes; copy it anew",
            source.bytes.len()
        )));
    }
    // The decoder reads the first header only; it allocates no pixels yet.
    let decoder = JpegDecoder::new(Cursor::new(source.bytes));
    decode(source, "JPEG", decoder.map_err(|error| source.decoder_error("JPEG", &error))?)
}

fn decode(source: &Source<'_>, name: &str, decoder: impl ImageDecoder) -> Result<Picture> {
    let (width, height) = decoder.dimensions();
    // Beside the texels: the decoded samples, and the copy of a decoder that works on whole images (a progressive
    // JPEG's coefficients).
    let samples = u64::from(decoder.color_type().bytes_per_pixel());
    source.check_memory(width, height, TEXEL_BYTES + 4 * samples)?;
    let color_type = decoder.color_type();
    let image = DynamicImage::from_decoder(decoder).map_err(|error| source.decoder_error(name, &error))?;
    let texels: Vec<Rgb> = if is_deep(&image) {
        let table = linear_from_srgb(u16::MAX);
        image.into_rgb16().pixels().map(|pixel| pixel.0.map(|value| table[usize::from(value)])).collect()
    } else {
        let table = linear_from_srgb(u8::MAX.into());
        image.into_rgb8().pixels().map(|pixel| pixel.0.map(|value| table[usize::from(value)])).collect()
    };
    Ok(Picture {
        width,
        height,
        texels,
        content: Content::Image,
        format: format!(
            "{name}, {} bits a channel, sRGB",
            8 * samples / u64::from(color_type.channel_count())
        ),
        warnings: vec![format!("a {name} is not HDR: what was brighter than its white is lost")],
    })
}

fn is_deep(image: &DynamicImage) -> bool {
    image.color().bytes_per_pixel() > image.color().channel_count()
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

/// Whether a JPEG's end marker stands where its segments lead; its decoder fills what is missing with grey.
fn ends_with_its_end(bytes: &[u8]) -> bool {
    const END: u8 = 0xd9;
    let mut at = 2;
    loop {
        // To the next marker: past entropy-coded bytes, their stuffing (00) and restarts (d0 to d7).
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
