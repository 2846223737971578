//! `octagloss licenses`: prints the licences of the crates in the program.

use super::outcome::{Outcome, failed, print};

/// Prints `licenses`; fails in a program that was built without them.
pub(super) fn run(licenses: Option<&str>) -> Outcome {
    match licenses {
        Some(licenses) => print(licenses),
        None => failed(
            "this program contains no licences of other crates: they are in THIRD-PARTY-LICENSES.txt of the \
             release, and in the programs that release/build builds",
        ),
    }
}
