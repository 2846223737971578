//! `octagloss compare`: measures a bake against its source or another bake.

use super::args::CompareArgs;
use super::compare_sources::Sources;
use super::comparison::{against_bake, against_source, bake_in};
use super::console::Console;
use super::input::{self, file_name, read_bake};
use super::measures::Measures;
use super::outcome::{
    Outcome, check_not_input, check_output, check_png, on_threads, print, print_json, usage,
};
use super::{compare_many, compare_pair, look_ups};
use crate::files::Existing;
use crate::read::InputLayout;
use crate::{Chain, Layout, Level};
use octagloss_core::analysis::compare::{LevelErrors, grid_of};
use octagloss_core::files::image::error_sheet::error_sheet;
use octagloss_core::files::io::ldr::write_png;
use octagloss_drawing::scene::Scene;

pub(super) fn run(args: CompareArgs) -> Outcome {
    let console = Console::new(args.quiet);
    let existing = Existing::by_force(args.force);
    let inputs = || [&args.bake].into_iter().chain(&args.against);
    if let Some(path) = &args.picture {
        check_png("--picture", path)?;
        check_not_input(path, inputs())?;
        check_output(path, args.force)?;
    }
    if let Some(path) = &args.chart {
        check_not_input(path, inputs().chain(&args.overlay))?;
        look_ups::check_chart(path, args.force)?;
    }
    if let Err(error) = std::fs::metadata(&args.bake) {
        return Err(crate::Error::io(&args.bake, error).into());
    }
    let is_one = args.against.len() == 1 || args.input.layout == InputLayout::Faces;
    on_threads(args.threads, || {
        if compare_many::is_folder_of_bakes(&args.bake) {
            compare_many::run(&args, &console)
        } else if is_one {
            if args.from.is_some() && args.fail_above.is_none() {
                return usage("--from says what --fail-above judges; add --fail-above, or omit --from");
            }
            run_one(&args, existing, &console)
        } else {
            compare_pair::run(&args, existing, &console)
        }
    })
}

/// Compares one bake with its source or another bake.
fn run_one(args: &CompareArgs, existing: Existing, console: &Console) -> Outcome {
    let bake = bake_in(&args.bake, console)?;
    let is_cube = |level: &Level| matches!(level.layout, Layout::Cube { .. });
    if args.picture.is_some() && !bake.chain.levels.iter().all(is_cube) {
        return usage(format!("--picture shows cubes; {} is not one", args.bake.display()));
    }
    let measures = Measures::new(args, args.fail_above.map(|_| args.from.unwrap_or(0.0)));
    let reference = if args.against.len() == 1 { read_bake(&args.against[0])? } else { None };
    let comparison = match reference {
        Some(reference) => against_bake(args, &bake, &reference, measures.from)?,
        None => {
            let files = input::single_source(args.against.clone(), &args.input)?;
            let sources = Sources::new(files, &args.input, args.lobe, console);
            against_source(&measures, &args.bake, &bake, &sources)?
        }
    };
    if let Some(path) = &args.picture {
        write_png(path, existing, &picture(args, &bake.chain, &comparison.levels)?.picture())?;
    }
    #[cfg(feature = "plot")]
    if let (Some(path), Some(delivered)) = (&args.chart, &comparison.delivered) {
        let overlays = comparison.overlays.iter().map(|overlay| (&overlay.bake[..], &overlay.delivered));
        let curves: Vec<_> = [(&comparison.bake[..], delivered)].into_iter().chain(overlays).collect();
        look_ups::draw_chart(path, existing, &curves, &args.against[0])?;
    }
    if args.json {
        print_json(&comparison)?;
    } else {
        print(&comparison.text())?;
    }
    if let Some((verdict, limit)) = comparison.verdict.as_ref().zip(args.fail_above) {
        verdict.tell(&comparison.bake);
        verdict.check(limit)?;
    }
    Ok(())
}

/// The sheet of the errors of the levels.
fn picture(args: &CompareArgs, bake: &Chain, levels: &[LevelErrors]) -> crate::Result<Scene> {
    let pairs = levels.iter().filter_map(|errors| {
        let size = errors.reference.as_ref()?.size();
        Some((errors, grid_of(&bake.levels[errors.level], size)))
    });
    let pairs: Vec<(&LevelErrors, Level)> = pairs.collect();
    error_sheet(&format!("Errors of {}", file_name(&args.bake)), &file_name(&args.against[0]), &pairs)
}
