//! Verdicts of `octagloss compare --fail-above` and `bake --verify`: what was judged, and what was not.

use super::compare_parts::PartErrors;
use super::comparison::Comparison;
use super::console;
use super::measures::is_from;
use anyhow::{Context as _, bail};
use octagloss_core::analysis::channels::{Greatest, Relative};
use octagloss_core::common::finite::finite;
use serde::Serialize;

/// The judged errors of a bake.
#[derive(Debug, Serialize)]
pub(super) struct Verdict {
    /// Roughness from which it judges.
    pub(super) from: f64,
    pub(super) judged: Vec<Judged>,
    /// Parts without a verdict, and why.
    pub(super) not_judged: Vec<String>,
}

/// A judged error.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Judged {
    /// Such as `level 3` or `look-ups at roughness 0.6429`.
    pub(super) what: String,
    /// `relRMSE`; `L1`, the mean absolute error over the mean, of mirrors: rounding to half floats alone
    /// makes the RMS error of a sun of a few texels several per cent of the mean.
    measure: &'static str,
    /// Error of luminance.
    #[serde(serialize_with = "finite")]
    pub(super) luminance: f64,
    /// The greatest error of luminance and channels.
    #[serde(flatten)]
    pub(super) greatest: Greatest,
}

impl Judged {
    fn new(what: String, errors: Relative) -> Self {
        Self { what, measure: "relRMSE", luminance: errors.luminance, greatest: errors.greatest() }
    }
}

impl Verdict {
    /// Judges errors of levels, look-ups and parts, from the roughness `from` on. Not measured were the
    /// levels `sharp`, which are sharper than that, and `not_judged`.
    pub(super) fn new(
        comparison: &Comparison,
        from: f64,
        mut sharp: Vec<usize>,
        mut not_judged: Vec<String>,
    ) -> Self {
        let mut judged = Vec::new();
        let is_judged = |roughness: f64| is_from(from, roughness);
        for errors in &comparison.levels {
            if is_judged(errors.roughness) {
                judged.push(Judged::new(format!("level {}", errors.level), errors.rmse));
            } else {
                sharp.push(errors.level);
            }
        }
        let look_ups = comparison.delivered.iter().flat_map(|delivered| &delivered.roughnesses);
        for error in look_ups.filter(|error| is_judged(error.roughness)) {
            let at = format!("roughness {:.4}", error.roughness);
            judged.push(Judged::new(format!("look-ups at {at}"), error.rmse));
            if let Some(near) = error.near_sun {
                judged.push(Judged::new(format!("look-ups near the sun at {at}"), near));
            }
        }
        for part in &comparison.parts {
            match &part.errors {
                PartErrors::Texels(errors) if part.part == "sheen" && !is_judged(errors.roughness) => {}
                PartErrors::Texels(errors) if ["mirror", "skybox"].contains(&part.part) => {
                    judged.push(Judged { measure: "L1", ..Judged::new(part.name(), errors.mean()) });
                }
                PartErrors::Texels(errors) => judged.push(Judged::new(part.name(), errors.rmse)),
                PartErrors::Harmonics { rmse, .. } => judged.push(Judged::new(part.name(), *rmse)),
            }
        }
        if !sharp.is_empty() {
            sharp.sort_unstable();
            not_judged.insert(0, format!("{} (sharper than --from {from})", levels(&sharp)));
        }
        Self { from, judged, not_judged }
    }

    /// The judged error that is greatest.
    pub(super) fn worst(&self) -> Option<&Judged> {
        let key = |judged: &Judged| {
            let error = judged.greatest.error;
            if error.is_nan() { f64::INFINITY } else { error }
        };
        self.judged.iter().max_by(|a, b| key(a).total_cmp(&key(b)))
    }

    /// Fails if an error is above `limit`, or nothing was judged.
    pub(super) fn check(&self, limit: f64) -> anyhow::Result<()> {
        let worst = self.worst().context("nothing could be judged")?;
        // NaN fails, too.
        let fails = |judged: &&Judged| judged.greatest.error.is_nan() || judged.greatest.error > limit;
        let more = match self.judged.iter().filter(fails).count() {
            0 => return Ok(()),
            1 => String::new(),
            count => format!(", and {} of {} others are", count - 1, self.judged.len() - 1),
        };
        let (Judged { what, measure, .. }, Greatest { error, of }) = (worst, worst.greatest);
        bail!("{measure} {error:.6} ({of}) of {what} is above {limit}{more}")
    }

    /// Says in one line what was not judged, also when only errors are printed.
    pub(super) fn tell(&self, name: &str) {
        if !self.not_judged.is_empty() {
            console::tell(&format!("{name}: not judged: {}", self.not_judged.join("; ")));
        }
    }
}

/// Words for the levels of these numbers, in order.
pub(super) fn levels(numbers: &[usize]) -> String {
    match numbers {
        [] => "no level".to_owned(),
        [one] => format!("level {one}"),
        [first, .., last] if last - first + 1 == numbers.len() => format!("levels {first} to {last}"),
        _ => {
            let names: Vec<String> = numbers.iter().map(ToString::to_string).collect();
            format!("levels {}", names.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(errors: &[f64]) -> Verdict {
        let of =
            |error: &f64| Judged::new("it".to_owned(), Relative { luminance: 0.0, channels: [*error; 3] });
        Verdict { from: 0.0, judged: errors.iter().map(of).collect(), not_judged: Vec::new() }
    }

    #[test]
    fn errors_above_the_limit_and_no_number_fail() {
        assert!(verdict(&[0.01, 0.05]).check(0.05).is_ok());
        assert!(verdict(&[0.01, 0.050_001]).check(0.05).is_err());
        assert!(verdict(&[0.01, f64::NAN, 0.02]).check(0.05).is_err());
        assert!(verdict(&[]).check(0.05).is_err());
    }

    #[test]
    fn runs_of_levels_are_named_by_their_ends() {
        assert_eq!(levels(&[3]), "level 3");
        assert_eq!(levels(&[1, 2, 3]), "levels 1 to 3");
        assert_eq!(levels(&[1, 3]), "levels 1, 3");
    }
}
