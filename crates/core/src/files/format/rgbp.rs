//! RGBP: eight bits a channel of the square root, and a fourth for its scale from 1 to 8.
//!
//! PlayCanvas, src/scene/shader-lib/glsl/chunks/common/frag/decode.js, `decodeRGBP`: radiance is
//! (code/255 (8 - 7 scale/255))^2.

use crate::light::environment::Rgb;

/// Maximum of a channel in RGBP.
pub const RGBP_MAX: f32 = 64.0;

/// Encodes `rgb` in RGBP, each channel clamped to [0, [`RGBP_MAX`]]: the smallest scale that keeps the
/// brightest channel below 1, codes rounded to nearest.
pub fn rgbp_from_rgb(rgb: Rgb) -> [u8; 4] {
    let roots = rgb.map(|c| f64::from(c.clamp(0.0, RGBP_MAX)).sqrt());
    let greatest = roots[0].max(roots[1]).max(roots[2]).max(1.0);
    let scale = ((8.0 - greatest) / 7.0 * 255.0).floor();
    let [r, g, b] = roots.map(|root| (root / (8.0 - 7.0 * scale / 255.0) * 255.0).round() as u8);
    [r, g, b, scale as u8]
}
