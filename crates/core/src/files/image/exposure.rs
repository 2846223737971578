//! Exposure of pictures: automatic or a number.

use crate::light::environment::{Environment, Rgb, exact_luminance};
use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

/// Exposure of a picture. Baked files never depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Exposure {
    /// Brings the log-average luminance of the environment to middle grey (Reinhard et al. 2002, equation 1).
    /// A contact sheet chooses from what its spheres show instead.
    #[default]
    Auto,
    /// Multiplies by this power of two.
    Ev(f64),
}

/// The range of [`Exposure::Ev`].
pub const RANGE: std::ops::RangeInclusive<f64> = -40.0..=40.0;

/// Displayed value of the log-average luminance.
const MIDDLE_GREY: f64 = 0.18;

/// Limit of automatic exposures in either direction; wider than the range of float32 radiance.
const MAX: f64 = 160.0;

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
pub fn of_environment(environment: &Environment) -> f64 {
    let mut average = LogAverage::new(environment.texels().iter());
    environment.for_each_texel(|_, solid_angle, rgb| average.add(solid_angle, rgb));
    average.exposure(MIDDLE_GREY)
}

/// Exposure of a picture and its compression of highlights: Reinhard et al. 2002, equation 4, of the
/// brightest channel. It keeps hue, and only the brightest light becomes white.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rolloff {
    /// The exposure in powers of two.
    pub(crate) ev: f64,
    /// The exposure as a factor.
    factor: f64,
    /// Exposed radiance that is shown as 1.
    white: f64,
}

/// Exposed radiance of the median: shown as a third of white.
const MEDIAN: f64 = 0.5;

/// Greatest exposed radiance of the 95th percentile: shown as four fifths of white.
const BRIGHT: f64 = 4.0;

/// Most that bright lights darken the median, as a factor.
const DARKENED: f64 = 8.0;

impl Rolloff {
    /// For a picture that shows about `radiances`. Automatic exposures bring their median to a third of
    /// white, but darken it as far as the brightest twentieth needs.
    pub(crate) fn new(radiances: &[Rgb], exposure: Exposure) -> Self {
        let mut shown: Vec<f64> = radiances.iter().map(brightest).collect();
        shown.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| shown.get((share * (shown.len() - 1) as f64) as usize).copied().unwrap_or(0.0);
        let [median, bright, most] =
            [0.5, 0.95, 1.0].map(|share| if shown.is_empty() { 0.0 } else { at(share) });
        let by_median = MEDIAN / median;
        let factor = match (median > 0.0, bright > 0.0, most > 0.0) {
            (true, ..) => by_median.min((BRIGHT / bright).max(by_median / DARKENED)),
            (_, true, _) => BRIGHT / bright,
            (_, _, true) => BRIGHT / most,
            _ => 1.0,
        };
        let ev = exposure.ev(factor.log2().clamp(-MAX, MAX));
        let factor = ev.exp2();
        Self { ev, factor, white: (most * factor).max(BRIGHT) }
    }

    /// Display values in [0, 1], linear, of `radiance`.
    pub(crate) fn shown(&self, radiance: Rgb) -> Rgb {
        let x = brightest(&radiance) * self.factor;
        if x == 0.0 {
            return [0.0; 3];
        }
        let compressed = ((1.0 + x / self.white.powi(2)) / (1.0 + x)).min(1.0 / x) * self.factor;
        radiance.map(|c| (f64::from(c) * compressed) as f32)
    }
}

/// The greatest channel.
fn brightest(radiance: &Rgb) -> f64 {
    radiance.iter().map(|c| f64::from(*c)).fold(0.0, f64::max)
}

/// Mean of logarithms of luminance.
pub(super) struct LogAverage {
    /// Threshold of black: twenty stops below the brightest.
    least: f64,
    sum: f64,
    weights: f64,
}

impl LogAverage {
    pub(super) fn new<'a>(texels: impl Iterator<Item = &'a Rgb>) -> Self {
        let brightest = texels.map(|texel| exact_luminance(*texel)).fold(0.0, f64::max);
        Self { least: brightest * 1e-6, sum: 0.0, weights: 0.0 }
    }

    pub(super) fn add(&mut self, weight: f64, rgb: Rgb) {
        self.sum += weight * exact_luminance(rgb).max(self.least).ln();
        self.weights += weight;
    }

    /// The exposure that shows the mean as `grey`, in powers of two.
    pub(super) fn exposure(&self, grey: f64) -> f64 {
        if self.least == 0.0 {
            return 0.0;
        }
        (grey / (self.sum / self.weights).exp()).log2().clamp(-MAX, MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::{Exposure, Rolloff, of_environment};
    use crate::light::environment::{Environment, Layout};

    #[test]
    fn an_even_light_is_shown_as_middle_grey() {
        for radiance in [1e-40_f32, 1e-6, 0.18, 3.0, 3e38] {
            let texels = vec![[radiance; 3]; 6 * 16];
            let environment =
                Environment::new(Layout::Cube { size: 4 }, texels.clone()).expect("sound texels");
            let shown = f64::from(radiance) * of_environment(&environment).exp2();
            assert!((shown - 0.18).abs() < 1e-6, "{radiance} is shown as {shown}");
            let [shown, ..] = Rolloff::new(&texels, Exposure::Auto).shown(texels[0]);
            assert!((shown - 1.0 / 3.0).abs() < 0.02, "{radiance} is shown as {shown} in a contact sheet");
        }
        let black = Environment::new(Layout::Cube { size: 1 }, vec![[0.0; 3]; 6]).expect("sound texels");
        assert_eq!(of_environment(&black), 0.0);
        for none in [&[][..], &[[0.0; 3]]] {
            assert_eq!(Rolloff::new(none, Exposure::Auto).shown([0.0; 3]), [0.0; 3]);
        }
    }

    #[test]
    fn highlights_keep_their_hue_and_only_the_brightest_becomes_white() {
        // A dark room, a tenth of it a window a hundred times as bright, and a lamp.
        let room = |k: usize| match k {
            999 => [4000.0, 2000.0, 1000.0],
            900.. => [5.0, 4.0, 2.0],
            _ => [0.05; 3],
        };
        let texels: Vec<[f32; 3]> = (0..1000).map(room).collect();
        let rolloff = Rolloff::new(&texels, Exposure::Auto);
        let [wall, window, lamp] = [0, 950, 999].map(|k| rolloff.shown(texels[k]));
        assert!(wall[0] > 0.03 && window[0] > 10.0 * wall[0] && window[0] < 0.9, "{wall:?} {window:?}");
        assert!((lamp[0] - 1.0).abs() < 1e-3 && (lamp[0] / lamp[1] - 2.0).abs() < 1e-3, "{lamp:?}");
        assert!((window[0] / window[2] - 2.5).abs() < 1e-3, "{window:?}");
        // A fixed exposure is used as it is, and nothing exceeds white.
        let bright = Rolloff::new(&texels, Exposure::Ev(20.0));
        assert_eq!(bright.ev, 20.0);
        assert!(texels.iter().all(|texel| bright.shown(*texel).iter().all(|c| *c <= 1.0)));
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
