//! RGBD: eight bits a channel in gamma 2.2, divided by a fourth; and PNG images of such texels.
//!
//! Babylon.js, packages/dev/core/src/Shaders/ShadersInclude/helperFunctions.fx, `fromRGBD`: radiance is
//! (code/255)^2.2 / (divisor/255). Divisors from 1/255 to 1 hold radiance up to 255.

use crate::common::error::{Result, wrong};
use crate::files::io::ldr::write::png_of;
use crate::light::environment::Rgb;
use png::ColorType;

/// Maximum of a channel in RGBD.
pub const RGBD_MAX: f32 = 255.0;

const GAMMA: f64 = 2.2;

/// Encodes `rgb` in RGBD, each channel clamped to [0, [`RGBD_MAX`]]: the largest divisor that keeps the
/// brightest channel below 1, codes rounded to nearest.
pub fn rgbd_from_rgb(rgb: Rgb) -> [u8; 4] {
    let clamped = rgb.map(|c| f64::from(c.clamp(0.0, RGBD_MAX)));
    let greatest = clamped[0].max(clamped[1]).max(clamped[2]).max(1.0);
    let divisor = (255.0 / greatest).floor().max(1.0);
    let [r, g, b] = clamped.map(|c| ((c * divisor / 255.0).powf(GAMMA.recip()) * 255.0).round() as u8);
    [r, g, b, divisor as u8]
}

/// Encodes row-major `texels` of `width` columns as a PNG in RGBD.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if the texels do not fill the image.
pub fn rgbd_png_bytes(width: u32, texels: &[Rgb]) -> Result<Vec<u8>> {
    let codes: Vec<[u8; 4]> = texels.iter().map(|texel| rgbd_from_rgb(*texel)).collect();
    png_bytes(width, &codes)
}

/// Encodes row-major `codes` of `width` columns as a PNG with alpha.
///
/// # Errors
/// [`Error::Parameter`] if the codes do not fill the image.
pub(crate) fn png_bytes(width: u32, codes: &[[u8; 4]]) -> Result<Vec<u8>> {
    let height = codes.len() / width.max(1) as usize;
    if codes.is_empty() || codes.len() != width as usize * height {
        return wrong(format!("a PNG of {width} columns cannot hold {} texels", codes.len()));
    }
    png_of(width, height as u32, ColorType::Rgba, codes.as_flattened())
}
