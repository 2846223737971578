//! The line on standard error after a bake.

use super::console;
use super::shell::listed;
use crate::Map;
use crate::files::Container;
use crate::recipes::{BakePlan, Report};
use octagloss_core::common::percent::percent;
use std::path::Path;

/// Outputs, their size, the time, and the typical error of reflections. `main` is the output file or folder,
/// `None` for standard output; `bytes` are those of the written files, without pictures.
pub(super) fn written(
    main: Option<&Path>,
    plans: &[BakePlan],
    reports: &[Report],
    bytes: u64,
    seconds: f64,
) -> String {
    let main = main.map_or_else(|| "standard output".to_owned(), |path| path.display().to_string());
    let what = match plans {
        [plan] if !plan.plan.is_targeted() => levels(plan, &reports[0]),
        [plan] => format!("files for {}, {}", plan.plan.target.name, levels(plan, &reports[0])),
        plans => {
            let names: Vec<_> = plans.iter().map(|plan| plan.plan.target.name).collect();
            format!("files for {}", names.join(", "))
        }
    };
    let errors = reports.iter().filter_map(|report| report.typical_error);
    let error = errors.reduce(f64::max).map_or_else(String::new, |error| {
        let typical = if plans.len() == 1 { "typical error" } else { "typical error at most" };
        format!(", {typical} {}", percent(error))
    });
    let (engine, bytes) = (&reports[0].engine, console::bytes(bytes));
    format!("{main}: {what}, {bytes}, in {seconds:.2} s on {engine}{error}")
}

/// Suggested next command, for the input and the output `main`, which is the input for standard output.
pub(super) fn next(main: &Path, input: &Path, plans: &[BakePlan]) -> String {
    let mut steps = Vec::new();
    if cfg!(feature = "view") {
        // A bake that this program reads is shown as engines show it.
        let shown = if is_readable(plans) { main } else { input };
        steps.push(format!("octagloss view{}", listed([shown])));
    }
    steps.push(
        match plans {
            [plan] if !plan.plan.is_targeted() => "bake with --target ENGINE for an engine's own files",
            _ => concat!("load it as in ", env!("CARGO_PKG_REPOSITORY"), "/blob/main/docs/engines.md"),
        }
        .to_owned(),
    );
    format!("next: {}", steps.join(", or "))
}

/// The levels of a plan's bake in a few words.
fn levels(plan: &BakePlan, report: &Report) -> String {
    let (size, count) = (plan.settings.size, report.levels.len());
    let map = match plan.settings.map {
        Map::Cube => format!("cube {size}"),
        Map::Panorama => format!("panorama {}x{size}", 2 * u64::from(size)),
        Map::Octahedral => format!("octahedral square {size}"),
    };
    if count == 1 { map } else { format!("{map}, {count} levels") }
}

/// Whether `octagloss view` shows the levels of the output of `plans`.
fn is_readable(plans: &[BakePlan]) -> bool {
    let [BakePlan { plan, settings, .. }] = plans else { return false };
    // The roughness of a DDS file's levels is in its report only, which `--json` prints instead.
    settings.map == Map::Cube && plan.target.has_container() && plan.container != Container::Dds
}
