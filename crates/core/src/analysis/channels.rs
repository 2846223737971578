//! Errors of light, of luminance and of every channel: luminance alone hides a wrong hue.
//!
//! An error of a channel is relative to that channel's mean; a channel that is nearly black is measured
//! against the luminance.

use crate::common::finite::finite;
use crate::light::environment::{Rgb, exact_luminance};
use glam::DVec3;
use serde::Serialize;

/// A channel whose mean is below this share of the luminance is nearly black.
const NEARLY_BLACK: f64 = 0.01;

/// Names of luminance and the channels.
const NAMES: [&str; 4] = ["luminance", "red", "green", "blue"];

/// Relative errors of luminance and of red, green and blue; in JSON, root mean square errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Relative {
    /// Error of luminance, over its mean.
    #[serde(rename = "rel_rmse", serialize_with = "finite")]
    pub luminance: f64,
    /// Errors of red, green and blue, each over its own mean; over that of luminance for a channel that is
    /// nearly black.
    #[serde(rename = "channel_rel_rmse", serialize_with = "finite")]
    pub channels: [f64; 3],
}

/// The greatest of several relative errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Greatest {
    /// The relative error.
    #[serde(serialize_with = "finite")]
    pub error: f64,
    /// `luminance`, `red`, `green` or `blue`.
    pub of: &'static str,
}

impl Relative {
    /// The greatest error, luminance's included; NaN is greater than any.
    pub fn greatest(&self) -> Greatest {
        let all = [self.luminance, self.channels[0], self.channels[1], self.channels[2]];
        greatest(all.into_iter().zip(NAMES))
    }

    /// The greatest error of a channel.
    pub fn worst_channel(&self) -> Greatest {
        greatest(self.channels.into_iter().zip(NAMES.into_iter().skip(1)))
    }
}

fn greatest(errors: impl Iterator<Item = (f64, &'static str)>) -> Greatest {
    let worse = |worst: Greatest, (error, of): (f64, &'static str)| {
        if error > worst.error || (error.is_nan() && !worst.error.is_nan()) {
            Greatest { error, of }
        } else {
            worst
        }
    };
    errors.fold(Greatest { error: -1.0, of: NAMES[0] }, worse)
}

/// What errors of luminance and of each channel are relative to, for light of this mean.
pub(crate) fn scales(mean: [f64; 3]) -> [f64; 4] {
    let luminance = exact_luminance(mean);
    let scale = |channel: f64| if channel >= NEARLY_BLACK * luminance { channel } else { luminance };
    let [r, g, b] = mean.map(scale);
    [luminance, r, g, b]
}

/// |error| over `scale`; if that is 0, 0 for no error and 1 for any.
pub(crate) fn relative(error: f64, scale: f64) -> f64 {
    if scale > 0.0 {
        error.abs() / scale
    } else if error == 0.0 {
        0.0
    } else {
        1.0
    }
}

/// The errors of luminance and channels `over` their scales for light of `mean`.
pub fn relative_to(over: [f64; 4], mean: [f64; 3]) -> Relative {
    let scales = scales(mean);
    let [luminance, r, g, b] = std::array::from_fn(|k| relative(over[k], scales[k]));
    Relative { luminance, channels: [r, g, b] }
}

/// Differences of luminance and of each channel.
pub(crate) fn differences(got: [f64; 3], expected: [f64; 3]) -> [f64; 4] {
    let [r, g, b] = std::array::from_fn(|c| got[c] - expected[c]);
    [exact_luminance(got) - exact_luminance(expected), r, g, b]
}

/// Errors as pictures show them: |difference| / (reference + 0.001 of its mean) at each place, of luminance
/// or the channel where it is greatest.
pub(crate) fn shown_errors(got: impl Iterator<Item = [f64; 3]>, reference: &[Rgb]) -> Vec<f64> {
    let mut mean = [0.0; 3];
    for texel in reference {
        mean = [0, 1, 2].map(|c| mean[c] + f64::from(texel[c]) / reference.len() as f64);
    }
    let floor = scales(mean).map(|scale| 1e-3 * scale);
    let error = |(got, expected): ([f64; 3], &Rgb)| {
        let expected = expected.map(f64::from);
        let (off, over) = (differences(got, expected), scales(expected));
        let share = |k: usize| if off[k] == 0.0 { 0.0 } else { off[k].abs() / (over[k] + floor[k]) };
        (0..4).map(share).fold(0.0, f64::max)
    };
    got.zip(reference).map(error).collect()
}

/// Weighted sums of errors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ErrorSums {
    weight: f64,
    squares: [f64; 4],
    distances: [f64; 4],
    greatest: [f64; 4],
    whole: DVec3,
}

impl ErrorSums {
    /// Adds `got` where `expected` is right.
    pub(crate) fn add(&mut self, weight: f64, got: [f64; 3], expected: [f64; 3]) {
        for (k, error) in differences(got, expected).into_iter().enumerate() {
            self.squares[k] += weight * error * error;
            self.distances[k] += weight * error.abs();
            // NaN stays.
            if error.is_nan() || error.abs() > self.greatest[k] {
                self.greatest[k] = error.abs();
            }
        }
        self.whole += weight * DVec3::from(expected);
        self.weight += weight;
    }

    fn over_mean(&self, errors: [f64; 4]) -> Relative {
        relative_to(errors, (self.whole / self.weight).to_array())
    }

    /// Root mean square errors over the mean.
    pub(crate) fn rel_rmse(&self) -> Relative {
        self.over_mean(self.squares.map(|sum| (sum / self.weight).sqrt()))
    }

    /// Mean absolute errors over the mean.
    pub(crate) fn l1(&self) -> Relative {
        self.over_mean(self.distances.map(|sum| sum / self.weight))
    }

    /// Greatest absolute errors over the mean.
    pub(crate) fn greatest(&self) -> Relative {
        self.over_mean(self.greatest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_hue_is_an_error_of_its_channels() {
        let mut sums = ErrorSums::default();
        for light in [[1.0, 1.0, 1.0], [3.0, 3.0, 3.0]] {
            // Luminance .2126 * .2 - .7152 * .059452 = 0.
            let wrong = [light[0] + 0.2, light[1] - 0.2 * 0.2126 / 0.7152, light[2]];
            sums.add(1.0, wrong, light);
        }
        let errors = sums.rel_rmse();
        assert!(errors.luminance < 1e-9, "{errors:?}");
        assert!((errors.channels[0] - 0.1).abs() < 1e-9 && errors.channels[2] == 0.0, "{errors:?}");
        assert_eq!((errors.greatest().of, errors.worst_channel().of), ("red", "red"));
    }

    #[test]
    fn a_nearly_black_channel_is_measured_against_luminance() {
        let expected = [0.0, 1.0, 0.006];
        let mut sums = ErrorSums::default();
        sums.add(1.0, [0.1, 1.0, 0.012], expected);
        let errors = sums.rel_rmse();
        let luminance = exact_luminance(expected);
        assert!((errors.channels[0] - 0.1 / luminance).abs() < 1e-12, "{errors:?}");
        assert!((errors.channels[2] - 0.006 / luminance).abs() < 1e-12, "{errors:?}");
        // Without any light an error is everything.
        let mut black = ErrorSums::default();
        black.add(1.0, [0.0, 1e-9, 0.0], [0.0; 3]);
        assert_eq!(black.l1().channels, [0.0, 1.0, 0.0]);
    }

    #[test]
    fn what_is_no_number_is_the_greatest_error() {
        let errors = Relative { luminance: 3.0, channels: [0.1, f64::NAN, 7.0] };
        assert!(errors.greatest().error.is_nan());
        assert_eq!(errors.greatest().of, "green");
        let mut sums = ErrorSums::default();
        sums.add(1.0, [f64::NAN, 1.0, 1.0], [1.0; 3]);
        sums.add(1.0, [1.0; 3], [1.0; 3]);
        assert!(sums.greatest().channels[0].is_nan() && sums.rel_rmse().greatest().error.is_nan());
    }
}
