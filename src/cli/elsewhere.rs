//! Subcommands that this program does not have: prints the command that runs them.

use super::outcome::{Outcome, usage};
use super::shell::listed;
use clap::Args as ClapArgs;
use std::ffi::OsString;

/// Arguments of the command to run.
#[derive(Debug, ClapArgs)]
pub(super) struct ElsewhereArgs {
    /// Arguments of the subcommand
    #[arg(value_name = "ARGUMENTS", trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

impl ElsewhereArgs {
    /// Names the `command` that has them; `place` says where it is.
    pub(super) fn refuse(&self, place: &str, command: &str) -> Outcome {
        usage(format!("{place} run: cargo run --release {command}{}", listed(&self.arguments)))
    }
}
