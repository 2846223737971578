//! `octagloss analyze --plot` in a build without the feature `plot`: prints the command that runs it.

use super::figures_args::FigureArgs;
use super::outcome::{Outcome, usage};
use super::shell::own_arguments;

pub(super) fn run(_: &FigureArgs) -> Outcome {
    usage(format!(
        "figures are not part of this build; run: cargo run --release --features plot --{}",
        own_arguments()
    ))
}
