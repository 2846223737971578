//! The pass that scans an exact table, chosen by a [`Scan`]. All give the same words.

use super::{sat_hensley, sat_scan};
use crate::{Context, OemPlanes, SatPlanes, Stage};
use octagloss_core::common::error::{Error, Result};
use octagloss_core::light::sat::Scan;

/// Stage that writes the table of `oem` to `sat`, whose exponents must be filled.
///
/// # Errors
/// [`Error::Unsupported`] for the serial scan, [`Error::Parameter`] for an invalid radix.
pub fn stage(context: &Context, scan: Scan, oem: &OemPlanes, sat: &SatPlanes) -> Result<Stage> {
    scan.check()?;
    match scan {
        Scan::Blocks => Ok(sat_scan::stage(context, oem, sat)),
        Scan::Hensley { radix } => Ok(sat_hensley::stage(context, radix, oem, sat)),
        Scan::Serial => Err(Error::Unsupported { what: "the serial scan".to_owned() }),
    }
}
