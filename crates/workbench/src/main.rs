//! The workbench: measurements and figures for who works on octagloss. The examples beside it fit tables and
//! measure errors.

mod analyze;
mod args;
mod draw;
mod figures_args;
mod house;
mod lobes;

use clap::{Parser, Subcommand};
use octagloss::cli::execute;
use std::process::ExitCode;

/// Measures what octagloss is built on
#[derive(Debug, Parser)]
#[command(name = "octagloss-workbench", version, max_term_width = 80, help_expected = true)]
#[command(disable_help_subcommand = true, subcommand_required = true, arg_required_else_help = true)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Measure maps of the sphere
    Analyze(args::AnalyzeArgs),
    /// Draw the crates of the workspace and what each uses
    House(house::HouseArgs),
}

fn main() -> ExitCode {
    execute(|args: Args| match args.command {
        Command::Analyze(args) => analyze::run(&args),
        Command::House(args) => house::run(&args),
    })
}
