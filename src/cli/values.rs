//! Option values: choices, their meanings, and parsers.

use crate::Map;
use crate::environment::MAX_DEGREES;
pub(super) use crate::filter::parsed as filter;
pub(super) use crate::sh::window::parsed as sh_window;
use crate::target::{Diffuse, Naming, TARGETS, Target, TargetPlan};
use clap::ValueEnum;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum EngineArg {
    /// A hardware GPU if there is one, else the CPU
    Auto,
    /// The CPU, all cores
    Cpu,
    /// A GPU or a software adapter
    Gpu,
}

/// Number of texels to compare per level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Texels {
    Some(usize),
    All,
}

/// Parses a target's name.
pub(super) fn target(text: &str) -> Result<&'static Target, String> {
    Target::named(text).ok_or_else(|| {
        let names: Vec<_> = TARGETS.iter().map(|target| target.name).collect();
        format!("there are {}", names.join(", "))
    })
}

/// Help text of `--target`, with each target's options and files.
pub(super) fn target_help() -> String {
    let mut text = "Presets for engines, comma-separated\n\nExplicit options override the preset. OUT is a \
                    folder with the target's files and report.json, one subfolder per target for several. \
                    All targets share one octahedral map."
        .to_owned();
    for target in &TARGETS {
        let tested = match target.verified {
            Some(reader) => format!("tested with {reader}"),
            None => "untested in its engine".to_owned(),
        };
        text += &format!("\n\n{}: {} ({tested})\n{}\nFiles:", target.name, target.reader, expansion(target));
        for (path, _) in TargetPlan::new(target).files(&Naming { name: "NAME", levels: 1, bounded: &[] }) {
            text += &format!(" {path}");
        }
    }
    text
}

/// The options that `target` expands to.
fn expansion(target: &Target) -> String {
    let mut text = String::new();
    if target.has_container() {
        text += &format!("--format {} --pixel {} ", target.container.name(), target.pixel.name());
    }
    text += &format!("--size {} ", target.size);
    if target.map != Map::Panorama {
        text += &format!("--levels {} --ladder {} ", target.levels(target.size), target.ladder.name());
    }
    if target.map == Map::Cube {
        text += &format!("--flip {} ", target.flip.name());
    }
    text += &format!("--diffuse {}", target.diffuse.name());
    if matches!(target.diffuse, Diffuse::Cube | Diffuse::Both) {
        text += &format!(" --irradiance {}", target.irradiance_size);
    }
    if target.has_sheen() {
        text += ", and the same levels with --lobe charlie";
    }
    text
}

/// Parses a file name without folders.
pub(super) fn file_name(text: &str) -> Result<String, String> {
    if text.is_empty() || text.starts_with('.') || text.contains(['/', '\\', '\0']) {
        return Err("must be a file name without folders or a leading dot".to_owned());
    }
    Ok(text.to_owned())
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "not a number".to_owned())
}

/// Parses a number in a range.
pub(super) fn within([least, most]: [f64; 2]) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| {
        Some(number(text)?)
            .filter(|value| (least..=most).contains(value))
            .ok_or_else(|| format!("must be between {least} and {most}"))
    }
}

/// Parses degrees about the vertical axis.
pub(super) fn turn(text: &str) -> Result<f64, String> {
    within([-MAX_DEGREES, MAX_DEGREES])(text)
}

pub(super) fn finite(text: &str) -> Result<f64, String> {
    Some(number(text)?).filter(|value| value.is_finite()).ok_or_else(|| "must be finite".to_owned())
}

/// Parses a factor for the radiance.
pub(super) fn scale(text: &str) -> Result<f64, String> {
    Some(finite(text)?).filter(|value| *value > 0.0).ok_or_else(|| "must be above 0".to_owned())
}

pub(super) fn roughness(text: &str) -> Result<f64, String> {
    within([0.0, 1.0])(text)
}

/// Parses a share or a percentage: 0.05 or 5%.
pub(super) fn threshold(text: &str) -> Result<f64, String> {
    let share = match text.strip_suffix('%') {
        Some(percentage) => finite(percentage.trim_end())? / 100.0,
        None => finite(text)?,
    };
    Some(share).filter(|value| *value >= 0.0).ok_or_else(|| "must not be negative".to_owned())
}

/// Parses a percentage, or a share below 1: a bare 5 would be 500 %.
pub(super) fn percentage(text: &str) -> Result<f64, String> {
    match threshold(text) {
        Ok(share) if share >= 1.0 && !text.ends_with('%') => Err(format!("write {text}%, or a share")),
        parsed => parsed,
    }
}

pub(super) fn texels(text: &str) -> Result<Texels, String> {
    match text {
        "all" => Ok(Texels::All),
        _ => match text.parse() {
            Ok(count) if count > 0 => Ok(Texels::Some(count)),
            _ => Err("must be a number above 0, or all".to_owned()),
        },
    }
}

#[cfg(all(test, feature = "view"))]
mod tests {
    use crate::gpu::direct::Method;
    use crate::view::scene::Proxy;
    use crate::view::{Object, Tone};
    use clap::ValueEnum;
    use std::fmt::Display;
    use std::str::FromStr;

    fn check<T: ValueEnum + Display + FromStr<Err = String> + PartialEq + std::fmt::Debug>() {
        for value in T::value_variants() {
            let option = value.to_possible_value().expect("not skipped");
            assert_eq!(option.get_name(), value.to_string());
            assert_eq!(option.get_name().parse::<T>().as_ref(), Ok(value));
        }
    }

    #[test]
    fn names_are_those_of_the_options() {
        check::<Method>();
        check::<Object>();
        check::<Proxy>();
        check::<Tone>();
        assert_eq!("cone".parse::<Proxy>(), Err("must be none, box or sphere".to_owned()));
    }
}
