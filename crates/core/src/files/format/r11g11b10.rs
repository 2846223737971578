//! R11G11B10F: three unsigned floats in 32 bits, with five bits of exponent each and 6, 6 and 5 of mantissa.

use crate::light::environment::Rgb;

/// Maximum common to all three channels: (1 + 31/32) * 2^15, that of blue.
pub(crate) const R11G11B10_MAX: f32 = 64512.0;

/// Packs `rgb`, red in the lowest bits: rounded to nearest, ties to even, each channel clamped to [0,
/// `R11G11B10_MAX`].
///
/// Vulkan 1.3, "Unsigned 11-Bit Floating-Point Numbers" and "Unsigned 10-Bit Floating-Point Numbers".
pub fn r11g11b10_from_rgb([r, g, b]: Rgb) -> u32 {
    small_float(r, 6) | small_float(g, 6) << 11 | small_float(b, 5) << 22
}

/// Decodes R11G11B10F; exact.
pub fn rgb_from_r11g11b10(packed: u32) -> Rgb {
    let channel = |shift: u32, mantissa_bits: u32| {
        let bits = (packed >> shift) & ((32 << mantissa_bits) - 1);
        let (exponent, mantissa) = (bits >> mantissa_bits, bits & ((1 << mantissa_bits) - 1));
        let implied = if exponent == 0 { 0 } else { 1 << mantissa_bits };
        let scale = (exponent.max(1).cast_signed() - 15 - mantissa_bits.cast_signed()) as f32;
        (implied + mantissa) as f32 * scale.exp2()
    };
    [channel(0, 6), channel(11, 6), channel(22, 5)]
}

/// 2^23: of numbers from there on, sums are rounded to integers, ties to even.
const WHOLE: f32 = 8_388_608.0;

/// Encodes `value` with five bits of exponent, bias 15, and `mantissa_bits`.
fn small_float(value: f32, mantissa_bits: u32) -> u32 {
    let value = value.clamp(0.0, R11G11B10_MAX);
    // floor(log2) from the bits; subnormal numbers share the spacing of the smallest normal number.
    let exponent = ((value.to_bits() >> 23) as i32 - 127).max(-14);
    let scale = f32::from_bits(((127 + mantissa_bits.cast_signed() - exponent) as u32) << 23);
    let steps = (value * scale + WHOLE).to_bits() - WHOLE.to_bits();
    // A mantissa that rounds up to the next power of two carries into the exponent.
    ((exponent + 14) as u32 * (1 << mantissa_bits)) + steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_comes_back_and_values_between_go_to_the_nearer() {
        for (shift, mantissa_bits, channel) in [(0, 6, 0), (11, 6, 1), (22, 5, 2)] {
            let codes = 31 << mantissa_bits;
            let value = |code: u32| rgb_from_r11g11b10(code << shift)[channel];
            for code in 0..codes {
                if value(code) > R11G11B10_MAX {
                    continue;
                }
                let mut rgb = [0.0; 3];
                rgb[channel] = value(code);
                assert_eq!(r11g11b10_from_rgb(rgb), code << shift, "{rgb:?}");
                if code + 1 < codes && value(code + 1) <= R11G11B10_MAX {
                    let gap = value(code + 1) - value(code);
                    for (part, expected) in [(0.49, code), (0.51, code + 1), (0.5, (code + 1) & !1)] {
                        rgb[channel] = value(code) + part * gap;
                        assert_eq!(r11g11b10_from_rgb(rgb), expected << shift, "{part} above {code}");
                    }
                }
            }
        }
    }

    #[test]
    fn out_of_range_is_clamped() {
        assert_eq!(rgb_from_r11g11b10(r11g11b10_from_rgb([1e9, f32::MAX, 7e4])), [R11G11B10_MAX; 3]);
        assert_eq!(r11g11b10_from_rgb([-1.0, 0.0, 1e-9]), 0);
        // One half in each channel: exponent 14, mantissa 0.
        assert_eq!(r11g11b10_from_rgb([0.5; 3]), 14 << 6 | (14 << 6) << 11 | (14 << 5) << 22);
    }
}
