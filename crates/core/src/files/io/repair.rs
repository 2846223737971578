//! Rejects, or repairs and counts, invalid radiance: NaN, Inf and negative values.

use crate::common::error::{Error, Result};
use crate::common::percent::share_matters;
use crate::light::environment::{LUMINANCE, Layout, Rgb};
use std::path::Path;

/// Repairs made to a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Repairs {
    /// Negative values (channels of texels) set to 0.
    pub negative: u64,
    /// NaN values set to 0.
    pub nan: u64,
    /// Infinite values set to their largest finite neighbour (minus infinity: to 0).
    pub infinite: u64,
    /// Energy of the negative values over that of the positive ones, as luminance times solid angle.
    pub negative_energy_share: f64,
}

impl Repairs {
    /// Whether anything was repaired.
    #[must_use]
    pub const fn any(&self) -> bool {
        self.negative + self.nan + self.infinite > 0
    }

    /// Whether to warn: for any NaN or Inf, and for negative values whose energy does not round to 0.00 %.
    /// Smaller energies show in no pixel format.
    #[must_use]
    pub(crate) fn matters(&self) -> bool {
        self.nan + self.infinite > 0 || share_matters(self.negative_energy_share)
    }
}

impl std::fmt::Display for Repairs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut parts = Vec::new();
        if self.negative > 0 {
            let share = match 100.0 * self.negative_energy_share {
                percent if percent < 0.005 => "less than 0.01 %".to_owned(),
                percent => format!("{percent:.2} %"),
            };
            parts.push(format!("{} negative values ({share} of the energy)", self.negative));
        }
        if self.nan > 0 {
            parts.push(format!("{} NaN values", self.nan));
        }
        if self.infinite > 0 {
            parts.push(format!("{} infinite values", self.infinite));
        }
        f.write_str(&parts.join(", "))
    }
}

/// Whether all texels are valid, the common case, in one pass that vectorises.
pub(super) fn is_sound(texels: &[Rgb]) -> bool {
    // The bits of finite non-negative values are less than those of infinity; -0 is a harmless false alarm.
    let worst = texels.as_flattened().iter().fold(0, |worst, value| worst.max(value.to_bits()));
    worst < f32::INFINITY.to_bits()
}

/// Rejects or repairs NaN and Inf in rows of `width` texels.
pub(super) fn non_finite(
    path: &Path,
    texels: &mut [Rgb],
    width: u32,
    sanitize: bool,
    repairs: &mut Repairs,
) -> Result<()> {
    // The common case in one pass that vectorises: no exponent is all ones.
    const EXPONENT: u32 = 0x7f80_0000;
    let worst = texels.as_flattened().iter().fold(0, |worst, value| worst.max(value.to_bits() & EXPONENT));
    if worst != EXPONENT {
        return Ok(());
    }
    let width = width as usize;
    if !sanitize {
        let at = texels.iter().position(|texel| texel.iter().any(|value| !value.is_finite()));
        let at = at.expect("one was just seen");
        let channel = texels[at].iter().position(|value| !value.is_finite()).expect("one was just seen");
        let coordinate = |k: usize| u32::try_from(k).expect("sides are u32");
        return Err(Error::NonFinite {
            path: path.to_owned(),
            x: coordinate(at % width),
            y: coordinate(at / width),
            channel: ['R', 'G', 'B'][channel],
            value: texels[at][channel],
        });
    }
    for channel in 0..3 {
        if !sanitize_channel(texels, width, channel, repairs) {
            let name = ['R', 'G', 'B'][channel];
            let message =
                format!("its channel {name} has Inf and no finite value to repair it with; render it again");
            return Err(Error::input(path, message));
        }
    }
    Ok(())
}

/// Sets NaN and minus infinity to 0, and infinity to the largest finite value in the nearest ring of
/// neighbours that has one. Returns whether every infinity was repaired.
fn sanitize_channel(texels: &mut [Rgb], width: usize, channel: usize, repairs: &mut Repairs) -> bool {
    let height = texels.len() / width;
    // Values propagate inwards from the rim of each region, one ring a round; each texel is set once.
    let mut rim: Vec<usize> = (0..texels.len()).filter(|&at| !texels[at][channel].is_finite()).collect();
    let (infinite, dark): (Vec<usize>, Vec<usize>) =
        rim.iter().partition(|&&at| texels[at][channel] == f32::INFINITY);
    let nan = dark.iter().filter(|&&at| texels[at][channel].is_nan()).count();
    repairs.nan += nan as u64;
    repairs.infinite += (infinite.len() + dark.len() - nan) as u64;

    let around = |at: usize| {
        let span = |k: usize, count: usize| k.saturating_sub(1)..=(k + 1).min(count - 1);
        let columns = span(at % width, width);
        span(at / width, height).flat_map(move |row| columns.clone().map(move |column| row * width + column))
    };
    let largest_around = |texels: &[Rgb], at: usize| {
        around(at).map(|near| texels[near][channel]).filter(|value| value.is_finite()).reduce(f32::max)
    };
    // Each round visits only the rim: its cost is that of the texels it sets and their neighbours, not of the
    // region.
    while !rim.is_empty() {
        let settled: Vec<(usize, f32)> = rim
            .iter()
            .filter(|&&at| !texels[at][channel].is_finite())
            .filter_map(|&at| largest_around(texels, at).map(|value| (at, value)))
            .collect();
        if settled.is_empty() {
            // The whole channel has no finite value.
            if !infinite.is_empty() {
                return false;
            }
            break;
        }
        rim.clear();
        for &(at, value) in &settled {
            texels[at][channel] = value;
        }
        let near = settled.iter().flat_map(|(at, _)| around(*at));
        rim.extend(near.filter(|near| !texels[*near][channel].is_finite()));
        rim.sort_unstable();
        rim.dedup();
    }
    for at in dark {
        texels[at][channel] = 0.0;
    }
    for at in infinite {
        texels[at][channel] = texels[at][channel].max(0.0);
    }
    true
}

/// Sets negative values to 0, counts them and weighs their energy, with the relative solid angle of each
/// texel, against that of the rest.
pub(super) fn negative(texels: &mut [Rgb], mut density: impl FnMut(usize) -> f64, repairs: &mut Repairs) {
    // No early exit, so that the loop vectorises.
    if !texels.as_flattened().iter().fold(false, |any, value| any | (*value < 0.0)) {
        return;
    }
    let (mut below, mut above) = (0.0, 0.0);
    for (index, texel) in texels.iter_mut().enumerate() {
        let weight = density(index);
        for (value, luminance) in texel.iter_mut().zip(LUMINANCE) {
            let energy = weight * f64::from(luminance) * f64::from(*value);
            if *value < 0.0 {
                below -= energy;
                repairs.negative += 1;
                *value = 0.0;
            } else {
                above += energy;
            }
        }
    }
    repairs.negative_energy_share = if above > 0.0 { below / above } else { 1.0 };
}

/// Approximate relative solid angle of texel `index` of an environment, evaluated at its centre.
pub(super) fn density(layout: Layout, index: usize) -> f64 {
    let (image, i, j) = layout.place(index);
    layout.direction_within(image, f64::from(i) + 0.5, f64::from(j) + 0.5).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_repairs_that_show_are_worth_a_warning() {
        let negative = |share| Repairs { negative: 3, negative_energy_share: share, ..Repairs::default() };
        assert!(!negative(4.9e-5).matters() && negative(5.1e-5).matters());
        assert!(Repairs { nan: 1, ..negative(0.0) }.matters());
        assert!(Repairs { infinite: 1, ..negative(0.0) }.matters());
        assert_eq!(negative(1e-9).to_string(), "3 negative values (less than 0.01 % of the energy)");
        assert_eq!(negative(5.1e-5).to_string(), "3 negative values (0.01 % of the energy)");
    }

    #[test]
    fn infinity_takes_the_largest_finite_neighbour_and_grows() {
        let inf = f32::INFINITY;
        let mut texels: Vec<Rgb> = [1.0, 7.0, inf, inf, inf, f32::NAN].map(|r| [r, 0.0, 0.0]).to_vec();
        let mut repairs = Repairs::default();
        non_finite(Path::new("a"), &mut texels, 6, true, &mut repairs).unwrap();
        let red: Vec<f32> = texels.iter().map(|texel| texel[0]).collect();
        assert_eq!(red, [1.0, 7.0, 7.0, 7.0, 7.0, 0.0], "grown from the left, NaN dark");
        assert_eq!((repairs.nan, repairs.infinite), (1, 3), "counted");
    }

    #[test]
    fn all_infinite_is_an_error() {
        let mut texels = vec![[f32::INFINITY, 1.0, f32::NEG_INFINITY]; 12];
        let mut repairs = Repairs::default();
        let repaired = non_finite(Path::new("a"), &mut texels, 4, true, &mut repairs);
        let error = repaired.expect_err("nothing to repair it by");
        assert!(error.to_string().starts_with("a: its channel R has Inf"), "{error}");
    }
}
