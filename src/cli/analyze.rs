//! `octagloss analyze`, whose measurements are in the workbench: prints the command that runs them.

use super::outcome::{Outcome, usage};
use super::shell::listed;
use clap::Args as ClapArgs;
use std::ffi::OsString;

/// Arguments of the command to run.
#[derive(Debug, ClapArgs)]
pub(super) struct AnalyzeArgs {
    /// Arguments of the measurement
    #[arg(value_name = "ARGUMENTS", trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

pub(super) fn run(args: &AnalyzeArgs) -> Outcome {
    usage(format!(
        "analyze is in the workbench; in a checkout of the sources run: cargo run --release \
         -p octagloss-workbench -- analyze{}",
        listed(&args.arguments)
    ))
}
