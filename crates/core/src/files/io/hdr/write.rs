//! Radiance .hdr output through the `image` crate: RGBE, run lengths, any radiance up to 2^127.

use crate::common::error::{Error, Result, wrong};
use crate::files::format::RGBE_MAX;
use crate::light::environment::Rgb;
use image::codecs::hdr::HdrEncoder;

/// Encodes a .hdr file of `width` x `height` row-major texels, with a header line `KEY=value` for each pair
/// of `metadata`.
///
/// # Errors
/// [`Error::Parameter`] if the texels do not fill the image, and for keys and values that a header line
/// cannot hold.
pub fn hdr_bytes(width: u32, height: u32, texels: &[Rgb], metadata: &[(String, String)]) -> Result<Vec<u8>> {
    let breaks = |text: &str| text.contains(char::is_control);
    if let Some((key, _)) =
        metadata.iter().find(|(key, value)| breaks(key) || breaks(value) || key.contains('='))
    {
        return wrong(format!("{key:?} and its value cannot be a line of a .hdr header"));
    }
    let mut bytes = plain_bytes(width, height, texels)?;
    // The header's first line is the signature.
    let at = bytes.iter().position(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let lines: String = metadata.iter().map(|(key, value)| format!("{key}={value}\n")).collect();
    bytes.splice(at..at, lines.into_bytes());
    Ok(bytes)
}

fn plain_bytes(width: u32, height: u32, texels: &[Rgb]) -> Result<Vec<u8>> {
    if texels.is_empty() || texels.len() != width as usize * height as usize {
        return wrong(format!("a .hdr file of {width}x{height} cannot hold {} texels", texels.len()));
    }
    let mut bytes = Vec::with_capacity(texels.len() * 4 + 128);
    let texels: Vec<_> = texels.iter().map(|t| image::Rgb(nearest_rgbe(*t))).collect();
    HdrEncoder::new(&mut bytes)
        .encode(&texels, width as usize, height as usize)
        .map_err(|e| Error::Parameter(format!("a .hdr file of {width}x{height}: {e}")))?;
    Ok(bytes)
}

/// Nearest RGBE colour to `rgb`. The encoder truncates, which darkens by 0.25 % on average, and wraps its
/// exponent outside 2^-127..2^127.
fn nearest_rgbe(rgb: Rgb) -> Rgb {
    let clamped = rgb.map(|c| c.clamp(0.0, RGBE_MAX));
    let greatest = clamped[0].max(clamped[1]).max(clamped[2]);
    if greatest < f32::MIN_POSITIVE {
        return [0.0; 3];
    }
    let rounded = |exponent: i32| {
        let quantum = f64::from(exponent - 8).exp2();
        clamped.map(|c| ((f64::from(c) / quantum).round() * quantum) as f32)
    };
    let exponent = (greatest.to_bits() >> 23) as i32 - 126;
    let nearest = rounded(exponent);
    // The maximum may round up to the next power of two, where the quantum doubles.
    if nearest.iter().any(|c| f64::from(*c) >= f64::from(exponent).exp2()) {
        rounded(exponent + 1)
    } else {
        nearest
    }
}
