//! `octagloss reader`: prints shader code that reads outputs.

use super::outcome::{Outcome, print};
use crate::target::READERS;
use clap::{Args as ClapArgs, ValueEnum};

#[derive(Debug, ClapArgs)]
pub(super) struct ReaderArgs {
    /// pyramid or oem
    ///
    /// The target whose files are read. pyramid: octagloss_radiance, octagloss_irradiance, octagloss_reflect
    /// and octagloss_albedo. oem: the levels of --target oem.
    #[arg(value_name = "TARGET", default_value = "pyramid", hide_possible_values = true)]
    target: Readable,
    /// wgsl, glsl, hlsl or msl
    #[arg(long, value_name = "LANGUAGE", hide_possible_values = true)]
    language: Language,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Readable {
    Pyramid,
    Oem,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Language {
    Wgsl,
    Glsl,
    Hlsl,
    #[value(alias = "metal")]
    Msl,
}

pub(super) fn run(args: &ReaderArgs) -> Outcome {
    let stem = match args.target {
        Readable::Pyramid => "pyramid",
        Readable::Oem => "oem",
    };
    let extension = match args.language {
        Language::Wgsl => "wgsl",
        Language::Glsl => "glsl",
        Language::Hlsl => "hlsl",
        Language::Msl => "metal",
    };
    let name = format!("{stem}.{extension}");
    match READERS.iter().find(|(own, _)| *own == name) {
        Some((_, code)) => print(code),
        None => super::outcome::usage("the target oem has no reader in msl; choose wgsl, glsl or hlsl"),
    }
}
