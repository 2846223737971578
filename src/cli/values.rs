//! Option values: choices, their meanings, and parsers.

use crate::MAX_DEGREES;
use octagloss_core::files::recipe::text::number;
pub(super) use octagloss_core::lobe::filter::parsed as filter;

/// Number of texels to compare per level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Texels {
    Some(usize),
    All,
}

/// Parses a number in a range.
pub fn within([least, most]: [f64; 2]) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| {
        Some(number(text)?)
            .filter(|value| (least..=most).contains(value))
            .ok_or_else(|| format!("must be between {least} and {most}"))
    }
}

/// Parses degrees about the vertical axis.
pub fn turn(text: &str) -> Result<f64, String> {
    within([-MAX_DEGREES, MAX_DEGREES])(text)
}

pub fn finite(text: &str) -> Result<f64, String> {
    Some(number(text)?).filter(|value| value.is_finite()).ok_or_else(|| "must be finite".to_owned())
}

/// Parses a factor for the radiance.
pub fn scale(text: &str) -> Result<f64, String> {
    Some(finite(text)?).filter(|value| *value > 0.0).ok_or_else(|| "must be above 0".to_owned())
}

pub fn roughness(text: &str) -> Result<f64, String> {
    within([0.0, 1.0])(text)
}

/// Parses a share or a percentage: 0.05 or 5%.
pub fn threshold(text: &str) -> Result<f64, String> {
    let share = match text.strip_suffix('%') {
        Some(percentage) => finite(percentage.trim_end())? / 100.0,
        None => finite(text)?,
    };
    Some(share).filter(|value| *value >= 0.0).ok_or_else(|| "must not be negative".to_owned())
}

/// Parses a percentage, or a share below 1: a bare 5 would be 500 %.
pub fn percentage(text: &str) -> Result<f64, String> {
    match threshold(text) {
        Ok(share) if share >= 1.0 && !text.ends_with('%') => Err(format!("write {text}%, or a share")),
        parsed => parsed,
    }
}

pub fn texels(text: &str) -> Result<Texels, String> {
    match text {
        "all" => Ok(Texels::All),
        _ => match text.parse() {
            Ok(count) if count > 0 => Ok(Texels::Some(count)),
            _ => Err("must be a number above 0, or all".to_owned()),
        },
    }
}
