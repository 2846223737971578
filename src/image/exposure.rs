//! Exposure of pictures: automatic or a number.

use crate::chain::Level;
use crate::environment::{Environment, Rgb, exact_luminance};
use crate::sphere::cube::{self, Face};
use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

/// Exposure of a picture. Baked files never depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Exposure {
    /// Brings the log-average luminance of the environment to middle grey (Reinhard et al. 2002, equation 1).
    #[default]
    Auto,
    /// Multiplies by this power of two.
    Ev(f64),
}

/// The range of [`Exposure::Ev`].
pub(crate) const RANGE: std::ops::RangeInclusive<f64> = -40.0..=40.0;

/// Displayed value of the log-average luminance.
const MIDDLE_GREY: f64 = 0.18;

/// Limit of automatic exposures in either direction; wider than the range of float32 radiance.
const MOST: f64 = 160.0;

impl Exposure {
    /// The exposure in powers of two; `automatic` is the value of [`Exposure::Auto`].
    #[must_use]
    pub fn ev(self, automatic: f64) -> f64 {
        match self {
            Self::Auto => automatic,
            Self::Ev(ev) => ev,
        }
    }
}

impl Display for Exposure {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Ev(ev) => ev.fmt(f),
        }
    }
}

/// Parses the output of [`Display`].
impl FromStr for Exposure {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        text.parse()
            .ok()
            .filter(|ev| RANGE.contains(ev))
            .map(Self::Ev)
            .ok_or_else(|| format!("must be auto or a number from {} to {} EV", RANGE.start(), RANGE.end()))
    }
}

/// The automatic exposure for `environment`, in powers of two.
#[must_use]
pub(crate) fn of_environment(environment: &Environment) -> f64 {
    let mut average = LogAverage::new(environment.texels());
    environment.for_each_texel(|_, solid_angle, rgb| average.add(solid_angle, rgb));
    average.exposure()
}

/// The automatic exposure for `level`, in powers of two.
#[must_use]
pub fn of_level(level: &Level) -> f64 {
    let mut average = LogAverage::new(&level.texels);
    let n = level.size();
    for face in Face::ALL {
        for (texel, at) in (0..).zip(level.face(face)).map(|(at, texel)| (texel, at)) {
            average.add(cube::texel_solid_angle(n, at % n, at / n), *texel);
        }
    }
    average.exposure()
}

/// Mean of logarithms of luminance.
struct LogAverage {
    /// Threshold of black: twenty stops below the brightest.
    least: f64,
    sum: f64,
    weights: f64,
}

impl LogAverage {
    fn new(texels: &[Rgb]) -> Self {
        let brightest = texels.iter().map(|texel| exact_luminance(*texel)).fold(0.0, f64::max);
        Self { least: brightest * 1e-6, sum: 0.0, weights: 0.0 }
    }

    fn add(&mut self, weight: f64, rgb: Rgb) {
        self.sum += weight * exact_luminance(rgb).max(self.least).ln();
        self.weights += weight;
    }

    fn exposure(&self) -> f64 {
        if self.least == 0.0 {
            return 0.0;
        }
        (MIDDLE_GREY / (self.sum / self.weights).exp()).log2().clamp(-MOST, MOST)
    }
}

#[cfg(test)]
mod tests {
    use super::{Exposure, of_environment, of_level};
    use crate::chain::Level;
    use crate::environment::{Environment, Layout};

    #[test]
    fn an_even_light_is_shown_as_middle_grey() {
        for radiance in [1e-40_f32, 1e-6, 0.18, 3.0, 3e38] {
            let texels = vec![[radiance; 3]; 6 * 16];
            let level = Level::cube(4, 0.0, texels.clone());
            let environment = Environment::new(Layout::Cube { size: 4 }, texels).expect("sound texels");
            let ev = of_level(&level);
            assert!((ev - of_environment(&environment)).abs() < 1e-9, "one rule");
            let shown = f64::from(radiance) * ev.exp2();
            assert!((shown - 0.18).abs() < 1e-6, "{radiance} is shown as {shown}");
        }
        let black = Level::cube(1, 0.0, vec![[0.0; 3]; 6]);
        assert_eq!(of_level(&black), 0.0);
    }

    #[test]
    fn texts_are_auto_or_numbers_in_range() {
        assert_eq!("auto".parse(), Ok(Exposure::Auto));
        assert_eq!("-1.5".parse(), Ok(Exposure::Ev(-1.5)));
        for exposure in [Exposure::Auto, Exposure::Ev(2.25)] {
            assert_eq!(exposure.to_string().parse(), Ok(exposure));
        }
        for text in ["", "Auto", "nan", "inf", "41", "1ev"] {
            let error = text.parse::<Exposure>().expect_err(text);
            assert!(error.contains("auto or a number from -40 to 40 EV"), "{error}");
        }
    }
}
