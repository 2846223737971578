//! The command-line program; see the module `cli` of the library.

use std::process::ExitCode;

/// Licences of the crates in the program. `release/build` writes the file and sets the cfg for this crate.
#[cfg(octagloss_licenses)]
const LICENSES: Option<&str> = Some(include_str!(env!("OCTAGLOSS_LICENSES")));
#[cfg(not(octagloss_licenses))]
const LICENSES: Option<&str> = None;

fn main() -> ExitCode {
    octagloss::run_program(LICENSES)
}
