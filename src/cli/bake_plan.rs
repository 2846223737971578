//! Plans of `bake`: its options, and what the output's name says.

use super::args::BakeArgs;
use super::console::with_options;
use super::outcome::{Outcome, usage};
use super::output::{FOREIGN, SunFile, check_folder_name, extension, named_format, names_folder};
use crate::export::plan::{BakePlan, PlanOptions};
use crate::format::container::Container;
use crate::target::TargetPlan;
use std::path::Path;

/// One plan per target, or one plan without a target. `several` inputs need an output folder.
pub(super) fn plans(args: &BakeArgs, several: bool) -> Outcome<Vec<BakePlan>> {
    args.table.check_scan(args.filter)?;
    if args.target.is_empty() {
        return Ok(vec![untargeted(args, several)?]);
    }
    let mut plans: Vec<BakePlan> = Vec::new();
    for target in &args.target {
        if plans.iter().any(|other| other.plan.target == *target) {
            return usage(format!("--target names {} twice", target.name));
        }
        plans.push(planned(options(args).targeted(target))?);
    }
    if let Some(path) = &args.output {
        if path.as_os_str() == "-" {
            return usage("-o - needs an output of one file, but --target writes a folder; name it with -o");
        }
        check_folder_name(path, ", or omit --target to write one file")?;
    }
    Ok(plans)
}

/// The requested files about the sun.
pub(super) fn sun_files(args: &BakeArgs) -> Vec<SunFile> {
    let extracts = args.input.extract_sun.is_some();
    let asked = [(SunFile::Sun, extracts), (SunFile::Gltf, extracts), (SunFile::Sunless, args.sunless)];
    asked.into_iter().filter_map(|(file, asked)| asked.then_some(file)).collect()
}

/// The library's options; its errors are about usage.
fn options(args: &BakeArgs) -> PlanOptions {
    PlanOptions {
        size: args.size,
        levels: args.levels,
        ladder: args.ladder,
        chain: args.chain,
        lobe: args.lobe,
        filter: args.filter,
        container: args.format,
        out_layout: args.out_layout,
        pixel: args.pixel,
        irradiance: args.irradiance,
        skybox: args.skybox,
        sh_order: args.sh_order,
        sh_window: args.sh_window,
        flip: args.flip,
        diffuse: args.diffuse,
        bounds: args.bounds,
        oem_size: args.table.oem_size,
        border: args.table.border,
        scan: args.table.scan,
    }
}

fn planned(plan: crate::Result<BakePlan>) -> Outcome<BakePlan> {
    match plan {
        Ok(plan) => {
            let warning = plan.warning.as_deref().map(with_options);
            Ok(BakePlan { warning, ..plan })
        }
        Err(error) => usage(error.to_string()),
    }
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
        (args.irradiance.is_some(), "--irradiance"),
        (args.skybox.is_some(), "--skybox"),
        (args.bounds, "--bounds"),
        (args.input.extract_sun.is_some(), "--extract-sun"),
        (args.verify.is_some(), "--verify"),
    ];
    match others.into_iter().find(|(asked, _)| *asked) {
        Some((_, option)) => usage(format!(
            "-o - writes only one file, to standard output; omit {option} or name a file with -o"
        )),
        None => Ok(()),
    }
}

/// The plan without a target, in the given format, else in that of the output's extension.
fn untargeted(args: &BakeArgs, several: bool) -> Outcome<BakePlan> {
    let container = container(args, several)?;
    let plan = planned(PlanOptions { container, ..options(args) }.untargeted())?;
    if let Some(path) = args.output.as_deref().filter(|_| !plan.plan.is_single()) {
        let name = plan.plan.container.name();
        let remedy = format!(" (with --format {name}), and --out-layout parts writes one .exr file");
        check_folder_name(path, &remedy)?;
    }
    Ok(plan)
}

/// The given format, else that of the output's extension.
fn container(args: &BakeArgs, several: bool) -> Outcome<Option<Container>> {
    let file = args.output.as_deref().filter(|path| !names_folder(path));
    let named = file.and_then(named_format);
    let output = || args.output.as_deref().unwrap_or(Path::new("")).display().to_string();
    let foreign = file.and_then(extension).filter(|name| FOREIGN.contains(&name.as_str()));
    if let Some(foreign) = foreign {
        return usage(format!(
            "the output {} has the unsupported extension .{foreign}; use ktx2, ktx, dds, exr or hdr",
            output()
        ));
    }
    if let (true, Some(_)) = (several, named) {
        return usage(format!("several inputs need an output folder; {} names a file", output()));
    }
    match (args.format, named) {
        (Some(said), Some(named)) if said != named => usage(format!(
            "--format {} and the output {} contradict each other; omit one",
            said.name(),
            output()
        )),
        (said, named) => Ok(said.or(named)),
    }
}
