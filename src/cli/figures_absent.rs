//! `octagloss analyze --plot` in a build without the feature `plot`: prints the command that runs it.

use super::figures_args::FigureArgs;
use super::outcome::{Outcome, usage};
use super::shell::quoted;

pub(super) fn run(_: &FigureArgs) -> Outcome {
    let arguments: String =
        std::env::args_os().skip(1).map(|argument| format!(" {}", quoted(&argument))).collect();
    usage(format!(
        "figures are not part of this build; run: cargo run --release --features plot --{arguments}"
    ))
}
