//! `octagloss synth`: the environments that the examples use.

use super::args::SynthArgs;
use super::talk::{self, Talk};
use super::{Outcome, print, usage};
use octagloss::io::environment_write::write_environment;
use octagloss::io::output::{self, Existing};
use octagloss::synth::{RECIPES, synth};
use std::fmt::Write as _;
use std::path::PathBuf;

pub(super) fn run(args: SynthArgs) -> Outcome {
    if args.list {
        let mut text = String::new();
        for recipe in RECIPES {
            writeln!(text, "{:<12} {}", recipe.name, recipe.purpose).expect("a string takes all");
        }
        return print(&text);
    }
    let name = args.name.unwrap_or_default();
    let Some(recipe) = RECIPES.into_iter().find(|recipe| recipe.name == name) else {
        let names = RECIPES.map(|recipe| recipe.name).join(", ");
        return usage(format!("there is no environment {name:?}; there are {names}"));
    };
    let path = args.output.unwrap_or_else(|| PathBuf::from(recipe.file_name));
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    if !extension.is_some_and(|extension| extension == "exr" || extension == "hdr") {
        return usage(format!("-o {} must end in .exr or .hdr", path.display()));
    }
    let existing = if args.force { Existing::Replace } else { Existing::Keep };
    output::check_file(&path, existing)?;
    write_environment(&path, existing, &synth(recipe.name)?, recipe.purpose)?;
    let bytes = std::fs::metadata(&path).map_or(0, |metadata| metadata.len());
    Talk::new(args.quiet).note(&format!("{}: {}", path.display(), talk::bytes(bytes)));
    Ok(())
}
