//! RGBD: eight bits a channel in gamma 2.2, divided by a fourth; and PNG images of such texels.
//!
//! Babylon.js, packages/dev/core/src/Shaders/ShadersInclude/helperFunctions.fx, `fromRGBD`: radiance is
//! (code/255)^2.2 / (divisor/255). Divisors from 1/255 to 1 hold radiance up to 255.

use crate::common::error::{Result, wrong};
use crate::files::io::ldr::png_of;
use crate::light::environment::Rgb;
use png::ColorType;
use std::sync::LazyLock;

/// Maximum of a channel in RGBD.
pub const RGBD_MAX: f32 = 255.0;

const GAMMA: f64 = 2.2;

/// Encodes `rgb` in RGBD, each channel clamped to [0, [`RGBD_MAX`]]: the largest divisor that keeps the
/// brightest channel below 1, codes rounded to nearest.
pub fn rgbd_from_rgb(rgb: Rgb) -> [u8; 4] {
    let clamped = rgb.map(|c| f64::from(c.clamp(0.0, RGBD_MAX)));
    let greatest = clamped[0].max(clamped[1]).max(clamped[2]).max(1.0);
    let divisor = (255.0 / greatest).floor().max(1.0);
    let [r, g, b] = clamped.map(|c| CODES.nearest(c * divisor / 255.0));
    [r, g, b, divisor as u8]
}

static CODES: LazyLock<Codes> = LazyLock::new(Codes::new);

/// Codes of numbers in [0, 1], found without a power for each.
struct Codes {
    /// The least number of every code above 0.
    least: [f64; 255],
    /// The code of the least number of every step; a step hardly ever has two.
    first: Vec<u8>,
}

impl Codes {
    /// The leading bits of a number that make a step: 128 an octave. Below [`Self::DARKEST`] all codes are 0.
    const SHIFT: u32 = 52 - 7;
    const DARKEST: f64 = 1.0 / 1_048_576.0;

    fn new() -> Self {
        let least = std::array::from_fn(|k| ((k as f64 + 0.5) / 255.0).powf(GAMMA));
        let number = |step: u64| f64::from_bits(step << Self::SHIFT);
        let steps = Self::DARKEST.to_bits() >> Self::SHIFT..=1_f64.to_bits() >> Self::SHIFT;
        let code = |step| least.partition_point(|least| *least <= number(step)) as u8;
        Self { first: steps.map(code).collect(), least }
    }

    fn nearest(&self, number: f64) -> u8 {
        // NaN is dark, too.
        let number = number.max(Self::DARKEST);
        let step = (number.to_bits() >> Self::SHIFT) - (Self::DARKEST.to_bits() >> Self::SHIFT);
        let mut code = self.first[step as usize];
        while self.least.get(usize::from(code)).is_some_and(|least| *least <= number) {
            code += 1;
        }
        code
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_rounded_powers() {
        let expected = |number: f64| (number.powf(GAMMA.recip()) * 255.0).round() as u8;
        for number in
            (0..=1_000_000).map(|k| f64::from(k) / 1e6).chain([1e-300, 1e-7, 1.1e-6, 1.2e-6, f64::NAN])
        {
            assert_eq!(CODES.nearest(number), expected(number), "{number}");
        }
        for (code, least) in (1..).zip(CODES.least) {
            let beside = [least * (1.0 - 1e-9), least * (1.0 + 1e-9)].map(|number| CODES.nearest(number));
            assert_eq!(beside, [code - 1, code], "around {least}");
        }
    }
}
