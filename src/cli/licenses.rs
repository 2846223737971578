//! `octagloss licenses`: prints the licences of the crates in the program.

use super::outcome::{Failure, Outcome, print};
use anyhow::anyhow;

/// Prints `licenses`; fails in a program that was built without them.
pub(super) fn run(licenses: Option<&str>) -> Outcome {
    let absent = || {
        Failure::Failed(anyhow!(
            "this program contains no licences of other crates: they are in THIRD-PARTY-LICENSES.txt of the \
             release, and in the programs that release/build builds"
        ))
    };
    print(licenses.ok_or_else(absent)?)
}
