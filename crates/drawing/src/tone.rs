//! From radiance to the bytes of a picture.

use super::style::Colour;

/// Tone-maps radiance to [0, 1], linear: Narkowicz 2016, "ACES filmic tone mapping curve".
pub fn tone_mapped(radiance: [f32; 3], exposure: f64) -> [f32; 3] {
    radiance.map(|c| {
        // The curve saturates here; larger squares could overflow.
        let x = (f64::from(c) * exposure).min(1e4) as f32;
        ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0)
    })
}

/// Converts linear display values in [0, 1] to 8-bit sRGB.
pub fn srgb(linear: [f32; 3]) -> Colour {
    linear.map(|c| (srgb_from_linear(c.clamp(0.0, 1.0)) * 255.0).round() as u8)
}

/// The sRGB transfer function (IEC 61966-2-1): encodes a linear value in [0, 1].
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Radiance to 8-bit sRGB as every picture shows it; `exposure` is a factor.
pub fn display(radiance: [f32; 3], exposure: f64) -> Colour {
    srgb(tone_mapped(radiance, exposure))
}
