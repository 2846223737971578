//! Radiance above a pixel format's maximum: clamped, compressed, or rejected.

use crate::common::error::{Result, wrong};
use crate::common::names::named;
use crate::files::format::Pixel;
use crate::light::chain::Level;
use crate::light::environment::{LUMINANCE, Layout, Rgb};
use crate::sphere::cube::Face;

/// Treatment of a texel with a channel above a pixel format's maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Overflow {
    /// Clamp each channel separately: bright colours turn white.
    #[default]
    Clamp,
    /// Scale the texel down, which keeps its colour: see [`compressed`].
    Compress,
    /// Fail.
    Error,
}

/// Start of compression, as a share of the maximum.
const KNEE: f64 = 0.25;

/// Maps a maximum channel of `value` for a format with the maximum `most`: identity up to `most`/4, then a
/// slope that falls from 1, always below `most`. Strictly increasing up to rounding.
pub fn compressed(value: f64, most: f64) -> f64 {
    let knee = KNEE * most;
    if value <= knee {
        return value;
    }
    // A hyperbola through the knee with slope 1 and the asymptote `most`.
    let room = most - knee;
    let above = value - knee;
    knee + room * above / (room + above)
}

/// Share of the luminance energy of `level` that clamping in `pixel` removes; 0 if nothing is clamped.
pub fn clamped_share(level: &Level, pixel: Pixel) -> f64 {
    let Level { layout, texels, .. } = level;
    if pixel.clamped(texels) == 0 {
        return 0.0;
    }
    let (mut lost, mut whole) = (0.0, 0.0);
    for (at, texel) in texels.iter().enumerate() {
        let solid_angle = layout.solid_angle_at(at);
        for (value, weight) in texel.iter().zip(LUMINANCE) {
            let energy = solid_angle * f64::from(weight);
            whole += energy * f64::from(*value);
            lost += energy * f64::from((value - pixel.max()).max(0.0));
        }
    }
    lost / whole
}

named!(Overflow { Clamp = "clamp", Compress = "compress", Error = "error" });

impl Overflow {
    /// Prepares `level`, the level `index` of a bake, for `pixel`; returns the number of compressed texels.
    /// Leaves a level within the format's maximum unchanged, and every level for [`Overflow::Clamp`], which
    /// the writers perform.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for [`Overflow::Error`] if a texel is too bright; names the
    /// texel.
    pub(crate) fn apply(self, index: usize, level: &mut Level, pixel: Pixel) -> Result<u64> {
        let Level { layout, texels, .. } = level;
        let most = pixel.max();
        let greatest = |texel: &Rgb| texel.iter().copied().fold(0.0, f32::max);
        match self {
            Self::Clamp => Ok(0),
            _ if pixel.clamped(texels) == 0 => Ok(0),
            Self::Compress => {
                let mut count = 0;
                for texel in texels.iter_mut() {
                    let value = greatest(texel);
                    let share = compressed(f64::from(value), f64::from(most)) / f64::from(value);
                    if share < 1.0 {
                        *texel = texel.map(|channel| (f64::from(channel) * share) as f32);
                        count += 1;
                    }
                }
                Ok(count)
            }
            Self::Error => {
                let first = texels.iter().position(|texel| greatest(texel) > most).unwrap_or_default();
                let (image, i, j) = layout.place(first);
                let face = match layout {
                    Layout::Cube { .. } => format!("face {} ", Face::ALL[image as usize].short_name()),
                    Layout::Panorama { .. } | Layout::Octahedral { .. } => String::new(),
                };
                wrong(format!(
                    "level {index} {face}pixel ({i}, {j}) is {:?} and {pixel} holds up to {most}; `pixel` \
                     f32 keeps it, `overflow` compress scales it down",
                    texels[first]
                ))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(bright: [f32; 3]) -> Level {
        let mut texels = vec![[1.0, 2.0, 3.0]; 24];
        texels[9] = bright;
        Level::cube(2, 0.5, texels)
    }

    #[test]
    fn compressed_texels_keep_their_colour_and_their_order() {
        let mut before = 0.0;
        for step in 0..400 {
            let value = 1.06_f64.powi(step);
            let after = compressed(value, 65504.0);
            assert!(after > before && after < 65504.0 && after <= value, "{value}: {after} after {before}");
            assert!(value > 16_376.0 || after == value, "{value} is below the knee");
            before = after;
        }
        let mut bright = level([2e5, 1e5, 0.0]);
        assert_eq!(Overflow::Compress.apply(1, &mut bright, Pixel::F16).unwrap(), 1);
        let [red, green, blue] = bright.texels[9];
        assert!(red < 65504.0 && (red / green - 2.0).abs() < 1e-5 && blue == 0.0, "{:?}", bright.texels[9]);
        assert_eq!(bright.texels[8], [1.0, 2.0, 3.0]);
    }

    #[test]
    fn what_clamping_takes_is_a_share_of_the_energy() {
        let mut level = Level::cube(2, 0.5, vec![[1.0; 3]; 24]);
        assert_eq!(clamped_share(&level, Pixel::F16), 0.0);
        level.texels[5] = [2.0 * Pixel::F16.max(); 3];
        // The texels of a face of four are alike: 65504 of 2 * 65504 + 23.
        let expected = 65504.0 / (2.0 * 65504.0 + 23.0);
        let share = clamped_share(&level, Pixel::F16);
        assert!((share / expected - 1.0).abs() < 1e-6, "{share}");
        assert_eq!(clamped_share(&level, Pixel::F32), 0.0);
    }

    #[test]
    fn levels_that_fit_stay_as_they_are() {
        let fits = level([60_000.0, 1.0, 1.0]);
        for overflow in [Overflow::Clamp, Overflow::Compress, Overflow::Error] {
            let mut same = fits.clone();
            assert_eq!(overflow.apply(0, &mut same, Pixel::F16).unwrap(), 0);
            assert_eq!(same, fits);
        }
        let mut wide = level([1e9; 3]);
        assert_eq!(Overflow::Error.apply(0, &mut wide, Pixel::F32).unwrap(), 0);
    }

    #[test]
    fn the_error_names_the_texel_and_the_remedy() {
        let error =
            Overflow::Error.apply(3, &mut level([1.0, 7e4, 1.0]), Pixel::F16).unwrap_err().to_string();
        assert!(error.starts_with("level 3 face py pixel (1, 0) is [1.0, 70000.0, 1.0]"), "{error}");
        assert!(error.contains("f16 holds up to 65504") && error.contains("`overflow` compress"), "{error}");
    }
}
