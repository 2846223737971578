//! `octagloss synth`: writes the examples' environments.

use super::args::SynthArgs;
use super::console::{self, Console};
use super::outcome::{Outcome, check_output, print, usage, write_output};
use octagloss_core::files::io::environment_write::environment_bytes;
use octagloss_core::light::synth::{RECIPES, synth};
use std::path::{Path, PathBuf};

pub(super) fn run(args: SynthArgs) -> Outcome {
    if args.list {
        let mut text = String::new();
        let width = RECIPES.iter().map(|recipe| recipe.name.len()).max().unwrap_or(0);
        for recipe in RECIPES {
            text += &format!("{:<width$} {}\n", recipe.name, recipe.purpose);
        }
        return print(&text);
    }
    let name = args.name.unwrap_or_default();
    let Some(recipe) = RECIPES.into_iter().find(|recipe| recipe.name == name) else {
        let names = RECIPES.map(|recipe| recipe.name).join(", ");
        return usage(format!("unknown environment {name:?}; choose one of {names}"));
    };
    let path = args.output.unwrap_or_else(|| PathBuf::from(recipe.file_name));
    // Standard output uses the recipe's default format.
    let named = if path.as_os_str() == "-" { Path::new(recipe.file_name) } else { &path };
    let extension = named.extension().map(|extension| extension.to_ascii_lowercase());
    if !extension.is_some_and(|extension| extension == "exr" || extension == "hdr") {
        return usage(format!("-o {} must end in .exr or .hdr", path.display()));
    }
    let existing = check_output(&path, args.force)?;
    let bytes = environment_bytes(named, &synth(recipe.name)?, recipe.purpose)?;
    write_output(&path, existing, &bytes)?;
    Console::new(args.quiet).note(&format!("{}: {}", path.display(), console::bytes(bytes.len() as u64)));
    Ok(())
}
