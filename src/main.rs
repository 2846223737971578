//! The command-line program: parses, checks and runs one subcommand of [`octagloss`].

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
