//! `octagloss-workbench analyze --plot`: draws figures of the maps into a folder.

use super::figures_args::FigureArgs;
use octagloss::cli::console::{self, Console};
use octagloss::cli::outcome::{Failure, Outcome, usage};
use octagloss::cli::output::check_folder_name;
use octagloss_core::files::io::output::{self, Existing, Output};
use octagloss_plot::figure::Form;
use octagloss_workbench::figures::catalogue::{Entry, FigureContent, entries, kinds};
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

pub(super) fn run(args: &FigureArgs) -> Outcome {
    let folder = args.output.as_ref().expect("clap requires it");
    check_folder_name(folder, "")?;
    let console = Console::new(args.quiet);
    let entries = chosen(args)?;
    check_options(args, &entries)?;
    let content = content(args, &console)?;
    let existing = Existing::by_force(args.force);
    // Check the outputs before drawing.
    output::recover(folder);
    let is_new = !folder.exists();
    let path = |entry: &Entry, form: Form| format!("{}.{}", entry.name(), form.name());
    if is_new {
        output::check_folder(folder, existing)?;
    } else {
        for (entry, form) in entries.iter().flat_map(|entry| Form::ALL.map(|form| (entry, form))) {
            output::check_file(&folder.join(path(entry, form)), existing)?;
        }
    }
    let bar = console.bar("figures");
    let done = AtomicU64::new(0);
    let draw = |entry: &Entry| -> octagloss_core::common::error::Result<Vec<(String, Vec<u8>)>> {
        let figure = entry.draw(&content)?;
        let files = Form::ALL.map(|form| (path(entry, form), figure.bytes(form)));
        bar.at(done.fetch_add(1, Ordering::Relaxed) + 1, entries.len() as u64);
        Ok(files.into())
    };
    let files: Vec<Vec<(String, Vec<u8>)>> = entries.par_iter().map(draw).collect::<Result<_, _>>()?;
    drop(bar);
    let files: Vec<(String, Vec<u8>)> = files.into_iter().flatten().collect();
    let outputs: Vec<(PathBuf, Output<'_>)> = if is_new {
        let inside = files.iter().map(|(name, bytes)| (name.clone(), &bytes[..])).collect();
        vec![(folder.clone(), Output::Folder(inside))]
    } else {
        files.iter().map(|(name, bytes)| (folder.join(name), Output::File(bytes))).collect()
    };
    output::commit(output::stage_all(&outputs, existing)?)?;
    for (name, bytes) in &files {
        console.note(&format!("{}: {}", folder.join(name).display(), console::bytes(bytes.len() as u64)));
    }
    Ok(())
}

/// The figures selected by `--map` and `--figure`.
fn chosen(args: &FigureArgs) -> Outcome<Vec<Entry>> {
    let all = entries();
    for name in &args.figure {
        if !all.iter().any(|entry| is_called(entry, name)) {
            let kinds = kinds().collect::<Vec<_>>().join(", ");
            return usage(format!(
                "unknown figure {name:?}; choose one of {kinds}, or a figure of one map, such as layout-cube"
            ));
        }
    }
    let of_map = |entry: &Entry| {
        args.map.is_empty() || entry.map.is_some_and(|map| args.map.iter().any(|name| name == map.name))
    };
    let named =
        |entry: &Entry| args.figure.is_empty() || args.figure.iter().any(|name| is_called(entry, name));
    let chosen: Vec<Entry> = all.into_iter().filter(|entry| of_map(entry) && named(entry)).collect();
    if chosen.is_empty() {
        return usage(format!(
            "--figure {} is not a figure of --map {}; omit one of them",
            args.figure.join(" --figure "),
            args.map.join(" --map ")
        ));
    }
    Ok(chosen)
}

fn is_called(entry: &Entry, name: &str) -> bool {
    entry.kind == name || entry.name() == name
}

/// Rejects options of figures that are not drawn.
fn check_options(args: &FigureArgs, entries: &[Entry]) -> Outcome {
    let options = [
        ("border", "size", args.size.map(|size| size.to_string())),
        ("border", "border", args.border.map(|border| border.to_string())),
        ("panorama", "panorama", args.panorama.as_ref().map(|path| path.display().to_string())),
    ];
    for (kind, option, value) in options {
        if let Some(value) = value
            && !entries.iter().any(|entry| entry.kind == kind)
        {
            return usage(format!(
                "--{option} {value} is for the figure {kind}, which is not drawn; omit it or add --figure \
                 {kind}"
            ));
        }
    }
    Ok(())
}

/// Content of the figures.
fn content(args: &FigureArgs, console: &Console) -> Outcome<FigureContent> {
    let mut content = FigureContent::new()?;
    content.size = args.size.unwrap_or(content.size);
    content.border = args.border.unwrap_or(content.border.min(content.size));
    content.check().map_err(|error| Failure::Usage(error.to_string()))?;
    if let Some((path, environment)) = args.panorama.as_ref().zip(args.environment(console)?) {
        content.panorama = environment;
        content.panorama_name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    }
    Ok(content)
}
