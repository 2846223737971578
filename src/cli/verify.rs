//! `octagloss bake --verify`: judges outputs as `compare --fail-above` does.

use super::args::BakeArgs;
use super::compare_sources::Sources;
use super::comparison::{against_source, bake_in};
use super::console::Console;
use super::input::InputFiles;
use super::measures::Measures;
use super::outcome::{Outcome, failed, usage};
use crate::files::OutputLayout;
use crate::recipes::BakePlan;
use crate::targets::Content;
use octagloss_core::common::percent::percent;
use std::path::PathBuf;

/// Roughness from which default bakes are made for look-ups of a few per cent.
const FROM: f64 = 0.6;

/// Refuses outputs that `compare` cannot read, and a run without outputs.
pub(super) fn check_plans(plans: &[BakePlan], dry_run: bool) -> Outcome {
    if dry_run {
        return usage("--verify judges what was written, but --dry-run writes nothing; omit one");
    }
    for BakePlan { plan, .. } in plans {
        let is_own =
            |content: Content| matches!(content, Content::Env | Content::Glb | Content::Atlas | Content::Oem);
        if plan.target.files.iter().any(|file| is_own(file.content)) {
            let name = plan.target.name;
            return usage(format!("--verify cannot read the files of the target {name}; omit --verify"));
        }
        if plan.layout == OutputLayout::Mips {
            return usage("--verify cannot read the levels of --out-layout mips; omit --verify");
        }
    }
    Ok(())
}

/// Judges the bakes in `outputs` of `source` by `limit`, the greatest relative error.
pub(super) fn check(
    outputs: &[PathBuf],
    source: &InputFiles,
    limit: f64,
    args: &BakeArgs,
    label: &str,
    console: &Console,
) -> Outcome {
    let from = args.from.unwrap_or(FROM);
    let measures = Measures { from: Some(from), ..Measures::default() };
    let sources = Sources::new(source.clone(), &args.recipe.input, None, console);
    for output in outputs {
        let bake = bake_in(output, console)?;
        let comparison = against_source(&measures, output, &bake, &sources)?;
        let Some(verdict) = &comparison.verdict else { continue };
        let name = output.display();
        verdict.tell(&format!("{label}{name}"));
        if let Err(error) = verdict.check(limit) {
            return failed(format!("{name}: {error:#}; the output stays, for you to look at"));
        }
        if let Some(worst) = verdict.worst() {
            console.note(&format!(
                "{label}{name}: verified: at most {} off ({}, {}), from roughness {from} on",
                percent(worst.greatest.error),
                worst.greatest.of,
                worst.what,
            ));
        }
    }
    Ok(())
}
