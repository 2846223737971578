//! `octagloss reader`: prints shader code that reads outputs, and writes the table of anisotropic
//! reflections.

use super::console::Console;
use super::outcome::{Outcome, check_output, print, usage, write_output};
use crate::reflectance::anisotropic_table;
use clap::{Args as ClapArgs, ValueEnum};
use octagloss_core::files::io::pyramid_write::check_size;
use octagloss_core::files::target::PyramidMap;
use octagloss_shaders::reader;
use std::path::PathBuf;

#[derive(Debug, ClapArgs)]
pub(super) struct ReaderArgs {
    /// pyramid or oem
    ///
    /// The target whose files are read. pyramid: octagloss_radiance, octagloss_irradiance, octagloss_reflect
    /// and octagloss_albedo. oem: the levels of --target oem.
    #[arg(value_name = "TARGET", default_value = "pyramid", hide_possible_values = true)]
    target: Readable,
    /// Map of the pyramid: octahedral or cube
    ///
    /// That of `bake --map`. [default: octahedral]
    #[arg(long, value_name = "MAP", hide_possible_values = true)]
    map: Option<PyramidMap>,
    /// wgsl, glsl, hlsl or msl
    #[arg(long, value_name = "LANGUAGE", hide_possible_values = true, required_unless_present = "rows")]
    language: Option<Language>,
    /// Write the table of anisotropic reflections to FILE.ktx2
    ///
    /// A texture of three dimensions, RGBA16F, 2.0 MB, the same for all pyramids of one size and map.
    /// Shaders that call octagloss_reflect with anisotropy, or octagloss_albedo_along, bind it as
    /// octagloss_rows.
    #[arg(long, value_name = "FILE", conflicts_with = "language")]
    rows: Option<PathBuf>,
    /// Size of the pyramids that --rows is for [default: 512]
    #[arg(long, value_name = "TEXELS", requires = "rows")]
    size: Option<u32>,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
    /// Replace a file that exists
    #[arg(long, requires = "rows")]
    force: bool,
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

/// Texels along an edge of the maps of pyramids, without another choice.
const DEFAULT_SIZE: u32 = 512;

pub(super) fn run(args: &ReaderArgs) -> Outcome {
    let Some(path) = &args.rows else {
        return print_reader(args, args.language.expect("required without --rows"));
    };
    if matches!(args.target, Readable::Oem) {
        return usage("the target oem has no table of reflections; --rows is for pyramids");
    }
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ktx2")) {
        return usage(format!("--rows writes KTX2, not {}; name it *.ktx2", path.display()));
    }
    let size = args.size.unwrap_or(DEFAULT_SIZE);
    if let Err(error) = check_size(size) {
        return usage(format!("--size: {error}"));
    }
    let existing = check_output(path, args.force)?;
    let map = args.map.unwrap_or_default();
    let bytes = anisotropic_table(size, map)?;
    write_output(path, existing, &bytes)?;
    let (path, count) = (path.display(), bytes.len());
    Console::new(args.quiet).note(&format!("{path}: {count} bytes for {map} pyramids of {size}"));
    Ok(())
}

fn print_reader(args: &ReaderArgs, language: Language) -> Outcome {
    let stem = match (args.target, args.map) {
        (Readable::Pyramid, Some(PyramidMap::Cube)) => "pyramid_cube",
        (Readable::Pyramid, _) => "pyramid",
        (Readable::Oem, None) => "oem",
        (Readable::Oem, Some(_)) => return usage("--map is for pyramids; omit it, or the target oem"),
    };
    let extension = match language {
        Language::Wgsl => "wgsl",
        Language::Glsl => "glsl",
        Language::Hlsl => "hlsl",
        Language::Msl => "metal",
    };
    match reader(&format!("{stem}.{extension}")) {
        Some(code) => print(&code),
        None => usage("the target oem has no reader in msl; choose wgsl, glsl or hlsl"),
    }
}
