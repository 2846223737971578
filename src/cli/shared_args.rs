//! Arguments shared by several subcommands.

use crate::cli::values::EngineArg;
use clap::Args as ClapArgs;

/// Maximum of --threads.
pub(super) const MAX_THREADS: i64 = 256;

/// Options of the engine.
#[derive(Clone, Debug, ClapArgs)]
#[command(next_help_heading = "Engine")]
pub(super) struct EngineArgs {
    /// Engine: auto, cpu or gpu [default: auto]
    ///
    /// auto uses a hardware GPU if there is one, else the CPU, and prints the choice.
    #[arg(long, value_name = "ENGINE", default_value = "auto")]
    #[arg(hide_default_value = true, hide_possible_values = true)]
    pub(super) engine: EngineArg,
    /// GPU, by a part of its name
    ///
    /// octagloss info --adapters lists them.
    #[arg(long, value_name = "NAME")]
    pub(super) adapter: Option<String>,
    /// Threads, 1 to 256 [default: one per core]
    ///
    /// Does not affect the result.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_THREADS))]
    pub(super) threads: Option<u32>,
}
