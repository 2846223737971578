//! The command-line program; see the module `cli` of the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    octagloss::internals::cli::main()
}
