//! Pixel formats of outputs and conversions to them: rounded to nearest, clamped, counted.

use super::r11g11b10::R11G11B10_MAX;
use super::rgbd::RGBD_MAX;
use super::rgbp::RGBP_MAX;
use crate::common::names::named;
use crate::common::vector::Extremes as _;
use crate::light::environment::Rgb;
use half::f16;
use half::slice::HalfFloatSliceExt as _;

/// Maximum finite half float.
pub const HALF_MAX: f32 = 65504.0;

/// Maximum of a channel in RGB9E5: (511/512) * 2^16.
pub const RGB9E5_MAX: f32 = 65408.0;

/// Maximum of a channel in RGBE.
pub(crate) const RGBE_MAX: f32 = (255.0 / 256.0) * (1_u128 << 127) as f32;

/// Pixel format.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Pixel {
    /// Half float, clamped at [`HALF_MAX`].
    #[default]
    F16,
    /// Float, exact.
    F32,
    /// Three 9-bit mantissas and a shared 5-bit exponent, clamped at [`RGB9E5_MAX`].
    Rgb9e5,
    /// Unsigned floats of 11, 11 and 10 bits, clamped at `super::r11g11b10::R11G11B10_MAX`.
    #[cfg_attr(feature = "cli", value(name = "r11g11b10f"))]
    R11g11b10,
    /// Blocks of 4 x 4 texels in BC6H, unsigned, clamped at [`HALF_MAX`].
    Bc6h,
    /// Eight bits a channel and a divisor, clamped at [`super::rgbd::RGBD_MAX`]; in PNG images only.
    #[cfg_attr(feature = "cli", value(skip))]
    Rgbd,
    /// Eight bits a channel of the square root and a scale, clamped at [`super::rgbp::RGBP_MAX`]; in PNG
    /// images only.
    #[cfg_attr(feature = "cli", value(skip))]
    Rgbp,
    /// Three 8-bit mantissas and a shared 8-bit exponent, clamped at `RGBE_MAX`; in .hdr images only.
    #[cfg_attr(feature = "cli", value(skip))]
    Rgbe,
    /// [`Pixel::F16`], or [`Pixel::F32`] for an image that is too bright or too dim for half floats: see
    /// [`Pixel::stored`].
    #[cfg_attr(feature = "cli", value(skip))]
    Auto,
}

named!(Pixel {
    F16 = "f16",
    F32 = "f32",
    Rgb9e5 = "rgb9e5",
    R11g11b10 = "r11g11b10f",
    Bc6h = "bc6h",
    Rgbd = "rgbd",
    Rgbp = "rgbp",
    Rgbe = "rgbe",
    Auto = "auto",
});

impl Pixel {
    /// Formats to choose from; others belong to containers of one format.
    pub const CHOICES: [Self; 5] = [Self::F16, Self::F32, Self::Rgb9e5, Self::R11g11b10, Self::Bc6h];

    /// Maximum of a channel.
    #[must_use]
    pub const fn max(self) -> f32 {
        match self {
            Self::F16 | Self::Bc6h => HALF_MAX,
            Self::F32 | Self::Auto => f32::MAX,
            Self::Rgb9e5 => RGB9E5_MAX,
            Self::R11g11b10 => R11G11B10_MAX,
            Self::Rgbd => RGBD_MAX,
            Self::Rgbp => RGBP_MAX,
            Self::Rgbe => RGBE_MAX,
        }
    }

    /// Largest value of a channel that becomes 0 in this format, regardless of the other channels.
    #[must_use]
    pub const fn rounded_to_zero(self) -> f32 {
        match self {
            // Half of the smallest step, which rounds to even.
            Self::F16 | Self::Bc6h => 1.0 / (1_u32 << 25) as f32,
            Self::F32 | Self::Auto => 0.0,
            // Below half of the smallest step.
            Self::Rgb9e5 => f32::from_bits((1.0 / (1_u32 << 25) as f32).to_bits() - 1),
            Self::R11g11b10 => 1.0 / (1_u32 << 21) as f32,
            // Below (0.5/255)^2.2.
            Self::Rgbd => 1.1e-6,
            // Below (0.5/255)^2.
            Self::Rgbp => 3.8e-6,
            // The largest subnormal number.
            Self::Rgbe => f32::from_bits(0x007f_ffff),
        }
    }

    /// Storage format of an image of `texels`: resolves [`Pixel::Auto`].
    #[must_use]
    pub fn stored(self, texels: &[Rgb]) -> Self {
        match self {
            Self::Auto => {
                // Too dim if half floats lose precision even at the brightest texel.
                let brighter = |most: Rgb, texel: &Rgb| std::array::from_fn(|c| most[c].at_least(texel[c]));
                let brightest = texels.iter().fold([0.0; 3], brighter).into_iter().fold(0.0, f32::max);
                let dim = brightest > 0.0 && brightest < f16::MIN_POSITIVE.to_f32();
                if dim || brightest > Self::F16.max() { Self::F32 } else { Self::F16 }
            }
            other => other,
        }
    }

    /// Number of `texels` with a channel above the maximum.
    #[must_use]
    pub fn clamped(self, texels: &[Rgb]) -> u64 {
        let most = self.max();
        let is_clamped = |[r, g, b]: &&Rgb| (*r > most) | (*g > most) | (*b > most);
        // Most levels have none, which is seen without branches.
        let blocks = texels.chunks(256).filter(|block| {
            block.as_flattened().iter().fold(0, |any, value| any | u32::from(*value > most)) > 0
        });
        blocks.map(|block| block.iter().filter(is_clamped).count() as u64).sum()
    }

    /// Number of `texels` with a channel that becomes 0.
    #[must_use]
    pub fn vanishing(self, texels: &[Rgb]) -> u64 {
        let vanishes = |channel: &f32| *channel > 0.0 && *channel <= self.rounded_to_zero();
        texels.iter().filter(|texel| texel.iter().any(vanishes)).count() as u64
    }
}

/// Appends `values` to `out` as little-endian half floats: rounded to nearest, ties to even, at most
/// [`HALF_MAX`].
pub fn push_halves(values: &[f32], out: &mut Vec<u8>) {
    const BATCH: usize = 256;
    let mut floats = [0.0; BATCH];
    let mut halves = [f16::ZERO; BATCH];
    for batch in values.chunks(BATCH) {
        let (floats, halves) = (&mut floats[..batch.len()], &mut halves[..batch.len()]);
        for (float, value) in floats.iter_mut().zip(batch) {
            *float = value.min(HALF_MAX);
        }
        halves.convert_from_f32_slice(floats);
        out.extend(halves.iter().flat_map(|h| h.to_le_bytes()));
    }
}

/// Encodes `rgb` in RGB9E5, each channel clamped to [0, [`RGB9E5_MAX`]]: red in the lowest bits, the exponent
/// in the highest.
///
/// The algorithm of OpenGL 4.6 section 8.5.2 and Vulkan's "RGB to shared exponent conversion", with the
/// exponent read from the float instead of a logarithm.
pub fn rgb9e5_from_rgb(rgb: Rgb) -> u32 {
    const MANTISSA_BITS: i32 = 9;
    const BIAS: i32 = 15;
    let clamped = rgb.map(|c| f64::from(c.clamp(0.0, RGB9E5_MAX)));
    let greatest = clamped[0].max(clamped[1]).max(clamped[2]);
    // floor(log2(greatest)); zero gives -1023 and is clamped to the smallest exponent, like all values below
    // 2^-16.
    let log2 = (greatest.to_bits() >> 52) as i32 - 1023;
    let round = |value: f64, exponent: i32| {
        (value * f64::from(BIAS + MANTISSA_BITS - exponent).exp2() + 0.5).floor() as u32
    };
    let mut exponent = log2.max(-BIAS - 1) + 1 + BIAS;
    // The largest mantissa may round up to 2^9, which requires the next exponent.
    if round(greatest, exponent) == 1 << MANTISSA_BITS {
        exponent += 1;
    }
    let [r, g, b] = clamped.map(|c| round(c, exponent));
    r | g << 9 | b << 18 | (exponent as u32) << 27
}

/// Decodes RGB9E5; exact.
pub fn rgb_from_rgb9e5(packed: u32) -> Rgb {
    let scale = ((packed >> 27) as f32 - 24.0).exp2();
    [0, 9, 18].map(|shift| ((packed >> shift) & 0x1ff) as f32 * scale)
}
