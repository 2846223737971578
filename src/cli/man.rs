//! `octagloss man`: writes manual pages.

use super::console::Console;
use super::outcome::{Outcome, print_bytes};
use crate::Error;
use crate::files::Existing;
use clap::{Args as ClapArgs, Command};
use clap_mangen::Man;
use octagloss_core::files::io::output::{self, Output};
use std::fs;
use std::path::PathBuf;

#[derive(Debug, ClapArgs)]
pub(super) struct ManArgs {
    /// Write all pages to FOLDER, one per subcommand
    ///
    /// octagloss.1, octagloss-bake.1 and so on. Without it, prints the main page to standard output.
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
    /// Replace pages that exist
    #[arg(long)]
    force: bool,
}

pub(super) fn run(args: &ManArgs, mut program: Command) -> Outcome {
    // Set the subcommands' full names.
    program.build();
    let Some(folder) = &args.output else { return print_bytes(&page(&program)?) };
    let shown = program.get_subcommands().filter(|command| !command.is_hide_set());
    let commands = std::iter::once(&program).chain(shown);
    let pages = commands
        .map(|command| {
            let name = command.get_display_name().unwrap_or(command.get_name());
            Ok((folder.join(format!("{name}.1")), page(command)?))
        })
        .collect::<Outcome<Vec<(PathBuf, Vec<u8>)>>>()?;
    fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
    let outputs: Vec<_> = pages.iter().map(|(path, page)| (path.clone(), Output::File(&page[..]))).collect();
    output::commit(output::stage_all(&outputs, Existing::by_force(args.force))?)?;
    let (count, folder) = (pages.len(), folder.display());
    Console::new(args.quiet).note(&format!("{folder}: {count} manual pages; man -l shows one"));
    Ok(())
}

/// Renders the page of `command`.
fn page(command: &Command) -> Outcome<Vec<u8>> {
    let mut page = Vec::new();
    // The page footer shows the version, which only the root command has.
    let command = command.clone().version(env!("CARGO_PKG_VERSION"));
    Man::new(command).render(&mut page)?;
    Ok(page)
}
