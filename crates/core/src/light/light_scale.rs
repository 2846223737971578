//! Scales each environment by a power of two, so that float32 holds everything computed from its light.
//!
//! Float32 ranges from 2^-149 to 2^128, and radiance may use all of it. Energies are radiance times solid
//! angles down to 2^-24, kernels reach 2^41, and both are multiplied and summed: very dim light would become
//! subnormal, very bright light infinite. A reflector therefore multiplies the source by 2^k before it builds
//! its tables, and multiplies its answers and bounds by 2^-k. Products with powers of two are exact, so light
//! of ordinary brightness gives the same answers with any k; it keeps k = 0.

use crate::common::parallel;
use crate::light::environment::{Environment, Rgb};
use crate::lobe::filter::Answer;
use std::borrow::Cow;

/// Light up to 2^60 is unscaled; brighter light is scaled so that its peak lies below this. The energy of the
/// whole sphere times the greatest kernel, 2^105 together, leaves room for sums.
const BRIGHTEST: i32 = 60;

/// Light from 2^-60 on is unscaled.
const DIMMEST: i32 = -60;

/// Scaled light below 2^-90 becomes 0. It is 2^149 times dimmer than the peak, and its energies are near
/// those that [`crate::cpu::cells`] omits.
const FLUSHED: i32 = -90;

/// The scale of one environment's light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightScale {
    /// k: light is multiplied by 2^k.
    exponent: i32,
    /// The greatest radiance of any channel in the source.
    greatest: f32,
}

/// 2^`exponent`, a normal number.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + i64::from(exponent)) as u64) << 52)
}

/// floor(log2(`value`)) of a positive float32.
fn log2_floor(value: f32) -> i32 {
    (f64::from(value).to_bits() >> 52) as i32 - 1023
}

impl LightScale {
    /// The scale for `environment`; k is 0 for ordinary or black light.
    pub fn new(environment: &Environment) -> Self {
        // Bit patterns of non-negative floats sort like their values. Zeros wrap to the greatest pattern.
        let range = |chunk: &[Rgb]| {
            chunk.as_flattened().iter().fold((0, u32::MAX), |(most, least): (u32, u32), channel| {
                let bits = channel.to_bits();
                (most.max(bits), least.min(bits.wrapping_sub(1)))
            })
        };
        let ranges = parallel::map(environment.texels().chunks(1 << 16), range);
        let (most, least) = ranges.into_iter().fold((0, u32::MAX), |a, b| (a.0.max(b.0), a.1.min(b.1)));
        if most == 0 {
            return Self::default();
        }
        let (greatest, least) = (f32::from_bits(most), f32::from_bits(least.wrapping_add(1)));
        let ordinary =
            f64::from(greatest) <= power_of_two(BRIGHTEST) && f64::from(least) >= power_of_two(DIMMEST);
        let exponent = if ordinary { 0 } else { BRIGHTEST - 1 - log2_floor(greatest) };
        Self { exponent, greatest }
    }

    /// k.
    pub const fn exponent(self) -> i32 {
        self.exponent
    }

    /// `environment` with its light multiplied by 2^k.
    pub fn scaled(self, environment: &Environment) -> Cow<'_, Environment> {
        if self.exponent == 0 {
            return Cow::Borrowed(environment);
        }
        let texels = environment.texels();
        let texels = parallel::values(texels.len(), |index| self.scaled_texel(texels[index]));
        Cow::Owned(environment.with_texels(texels))
    }

    /// `texel` multiplied by 2^k.
    #[inline]
    pub(crate) fn scaled_texel(self, texel: Rgb) -> Rgb {
        if self.exponent == 0 {
            return texel;
        }
        let (scale, least) = (power_of_two(self.exponent), power_of_two(FLUSHED));
        texel.map(|value| {
            let scaled = f64::from(value) * scale;
            if scaled < least { 0.0 } else { scaled as f32 }
        })
    }

    /// Converts radiance of the scaled light to radiance of the source.
    pub fn radiance(self, scaled: Rgb) -> Rgb {
        if self.exponent == 0 {
            return scaled;
        }
        let back = power_of_two(-self.exponent);
        // A mean of radiance never exceeds the greatest radiance. Limit rounding and a filter's overshoot,
        // which could overflow near f32::MAX.
        scaled.map(|value| ((f64::from(value) * back) as f32).min(self.greatest))
    }

    /// Converts an answer for the scaled light to one for the source.
    pub fn answer(self, scaled: Answer) -> Answer {
        if self.exponent == 0 {
            return scaled;
        }
        let radiance = self.radiance(scaled.radiance);
        let bound = scaled.bound.map(|bound| {
            let back = power_of_two(-self.exponent);
            // Add the loss from the limit of radiance, the loss from flushing (a mean of at most this, except
            // for the uneven weights of coarse OEMs), and the loss from rounding to a subnormal number.
            let cut = (0..3)
                .map(|c| f64::from(scaled.radiance[c]) * back - f64::from(radiance[c]))
                .fold(0.0, f64::max);
            let flushed = 4.0 * power_of_two(FLUSHED) * back;
            let rounded = f64::from(f32::from_bits(1));
            bound.map(|bound| rounded_up(f64::from(bound) * back + cut + flushed + rounded))
        });
        Answer { radiance, bound }
    }

    /// Converts energies of the scaled light, in double precision, to energies of the source.
    pub fn energies(self, scaled: [f64; 3]) -> [f64; 3] {
        scaled.map(|value| value * power_of_two(-self.exponent))
    }
}

/// The least float32 that is not below `value`; at most the greatest finite one.
pub(crate) fn rounded_up(value: f64) -> f32 {
    let nearest = (value as f32).min(f32::MAX);
    if f64::from(nearest) < value && nearest < f32::MAX { nearest.next_up() } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::environment::{Layout, of_sound};
    use crate::lobe::filter::Bound;

    fn scale(values: &[f32]) -> (LightScale, Vec<f32>) {
        let size = values.len() as u32;
        let texels = values.iter().map(|value| [*value; 3]).collect();
        let layout = Layout::Panorama { width: size, height: 1 };
        let environment = of_sound(layout, texels).expect("valid");
        let scale = LightScale::new(&environment);
        (scale, scale.scaled(&environment).texels().iter().map(|texel| texel[0]).collect())
    }

    #[test]
    fn ordinary_light_is_left_as_it_is() {
        for values in [&[0.0, 0.0][..], &[1.0, 0.0], &[1e18, 1e-18], &[65504.0, 1e-3, 1e-10]] {
            let (scale, scaled) = scale(values);
            assert_eq!((scale.exponent(), &scaled[..]), (0, values));
        }
    }

    #[test]
    fn extreme_light_comes_back_as_it_was() {
        for values in [&[1e-45, 0.0][..], &[1e-40, 1e-44], &[f32::MAX, 1.0], &[1e-30, 2e-30], &[1.0, 1e-38]] {
            let (scale, scaled) = scale(values);
            assert_ne!(scale.exponent(), 0, "{values:?}");
            let peak = scaled.iter().copied().fold(0.0, f32::max);
            assert_eq!(log2_floor(peak), BRIGHTEST - 1, "{values:?}");
            assert!(scaled.iter().all(|value| *value == 0.0 || log2_floor(*value) >= FLUSHED));
            let back: Vec<f32> = scaled.iter().map(|value| scale.radiance([*value; 3])[0]).collect();
            assert_eq!(back, values);
        }
    }

    #[test]
    fn light_far_below_the_peak_is_flushed_and_the_bound_says_so() {
        let (scale, scaled) = scale(&[1e20, 1e-30]);
        assert_eq!(scaled[1], 0.0);
        let black = scale.answer(Answer { radiance: [0.0; 3], bound: Some(Bound::default()) });
        assert!(black.bound.is_some_and(|bound| (1e-30..1e-20).contains(&bound.luminance)), "{black:?}");
    }

    #[test]
    fn radiance_stays_below_the_source_s_greatest() {
        let (scale, scaled) = scale(&[f32::MAX, 0.0]);
        let over = scale.answer(Answer { radiance: [1.01 * scaled[0]; 3], bound: Some(Bound::default()) });
        assert_eq!(over.radiance, [f32::MAX; 3]);
        // The bound includes the part that was cut off.
        assert!(
            over.bound.is_some_and(|bound| bound.luminance.is_finite() && bound.luminance > 3.3e36),
            "{over:?}"
        );
    }
}
