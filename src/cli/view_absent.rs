//! `octagloss view` in a build without the feature `view`: prints the command that runs it.

use super::outcome::{Outcome, usage};
use super::shell::listed;
use clap::Args as ClapArgs;
use std::ffi::OsString;

/// Arguments of the command to run.
#[derive(Debug, ClapArgs)]
pub(super) struct ViewArgs {
    /// Arguments of the viewer
    #[arg(value_name = "ARGUMENTS", trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

pub(super) fn run(args: &ViewArgs) -> Outcome {
    usage(format!(
        "view is not part of this build; run: cargo run --release --features view -- view{}",
        listed(&args.arguments)
    ))
}
