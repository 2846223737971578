//! Radiance .hdr output: RGBE, run lengths, any radiance up to 2^127.

use super::scanlines;
use crate::common::error::{Result, wrong};
use crate::light::environment::Rgb;

/// Encodes a .hdr file of `width` x `height` row-major texels, with a header line `KEY=value` for each pair
/// of `metadata`.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if the texels do not fill the image, and for keys and values
/// that a header line cannot hold.
pub fn hdr_bytes(width: u32, height: u32, texels: &[Rgb], metadata: &[(String, String)]) -> Result<Vec<u8>> {
    let breaks = |text: &str| text.contains(char::is_control);
    if let Some((key, _)) =
        metadata.iter().find(|(key, value)| breaks(key) || breaks(value) || key.contains('='))
    {
        return wrong(format!("{key:?} and its value cannot be a line of a .hdr header"));
    }
    if texels.is_empty() || texels.len() != width as usize * height as usize {
        return wrong(format!("a .hdr file of {width}x{height} cannot hold {} texels", texels.len()));
    }
    let lines: String = metadata.iter().map(|(key, value)| format!("{key}={value}\n")).collect();
    let header = format!("#?RADIANCE\n{lines}FORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
    let mut bytes = Vec::with_capacity(header.len() + texels.len() * 4);
    bytes.extend(header.into_bytes());
    scanlines::encode(width as usize, texels, &mut bytes);
    Ok(bytes)
}
