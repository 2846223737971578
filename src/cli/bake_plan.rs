//! Plans of `bake`: its recipe, and what the output's name says.

use super::args::BakeArgs;
use super::console::with_options;
use super::outcome::{Outcome, or_usage, refuse_given, usage};
use super::output::{FOREIGN, check_folder_name, extension, names_folder};
use crate::files::Container;
use crate::recipes::{BakePlan, Recipe};
use crate::targets::TargetPlan;
use std::path::Path;

/// One plan per target, or one plan without a target. `several` inputs need an output folder.
pub(super) fn plans(args: &BakeArgs, several: bool) -> Outcome<Vec<BakePlan>> {
    let is_targeted = !args.recipe.target.is_empty();
    let format = if is_targeted { args.recipe.format } else { container(args, several)? };
    let recipe = Recipe { format, preview: args.preview.is_some(), ..args.recipe.clone() };
    let mut plans = or_usage(recipe.plans())?;
    for plan in &mut plans {
        plan.warning = plan.warning.as_deref().map(with_options);
    }
    let first = &plans[0].plan;
    if let Some(path) = &args.output {
        if is_targeted && path.as_os_str() == "-" {
            return usage("-o - needs an output of one file, but --target writes a folder; name it with -o");
        }
        if is_targeted {
            check_folder_name(path, ", or omit --target to write one file")?;
        } else if !first.is_single() {
            let name = first.container.name();
            let remedy = format!(" (with --format {name}), and --out-layout parts writes one .exr file");
            check_folder_name(path, &remedy)?;
        }
    }
    Ok(plans)
}

/// Rejects options and formats that cannot go to standard output.
pub(super) fn check_stdout(args: &BakeArgs, plan: &TargetPlan, several: bool) -> Outcome {
    if several {
        return usage("-o - takes one input; name a folder with -o for several");
    }
    if !plan.is_single() {
        return usage(
            "-o - needs an output of one file: ktx2, ktx, dds, or exr with --out-layout parts or mips; name \
             a folder with -o",
        );
    }
    let others = [
        (args.json, "--json"),
        (args.skip_unchanged, "--skip-unchanged"),
        (args.preview.is_some(), "--preview"),
        (args.recipe.irradiance.is_some(), "--irradiance"),
        (args.recipe.skybox.is_some(), "--skybox"),
        (args.recipe.bounds, "--bounds"),
        (args.recipe.input.extract_sun.is_some(), "--extract-sun"),
        (args.verify.is_some(), "--verify"),
    ];
    refuse_given(&others, |option| {
        format!("-o - writes only one file, to standard output; omit {option} or name a file with -o")
    })
}

/// The given format, else that of the output's extension.
fn container(args: &BakeArgs, several: bool) -> Outcome<Option<Container>> {
    let file = args.output.as_deref().filter(|path| !names_folder(path));
    let named = file.and_then(Container::of_path);
    let output = args.output.as_deref().unwrap_or(Path::new("")).display();
    let foreign = file.and_then(extension).filter(|name| FOREIGN.contains(&name.as_str()));
    if let Some(foreign) = foreign {
        return usage(format!(
            "the output {output} has the unsupported extension .{foreign}; use ktx2, ktx, dds, exr or hdr"
        ));
    }
    if let (true, Some(_)) = (several, named) {
        return usage(format!("several inputs need an output folder; {output} names a file"));
    }
    match (args.recipe.format, named) {
        (Some(said), Some(named)) if said != named => {
            usage(format!("--format {said} and the output {output} contradict each other; omit one"))
        }
        (said, named) => Ok(said.or(named)),
    }
}
