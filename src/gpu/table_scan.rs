//! The pass that scans an exact table, chosen by a [`Scan`].

use super::sat_hensley::SatHensley;
use super::sat_scan::SatScan;
use super::{Context, OemPlanes, SatPlanes, Stage};
use crate::error::{Error, Result};
use crate::sat::Scan;

/// Pipelines of one scan. All give the same words.
#[derive(Clone, Debug)]
pub enum TableScan {
    /// Tiles, in four dispatches.
    Blocks(SatScan),
    /// Recursive doubling.
    Hensley(SatHensley),
}

impl TableScan {
    /// Compiles the passes of `scan`.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for the serial scan, [`Error::Parameter`] for an invalid radix.
    pub fn new(context: &Context, scan: Scan) -> Result<Self> {
        scan.check()?;
        match scan {
            Scan::Blocks => Ok(Self::Blocks(SatScan::new(context))),
            Scan::Hensley { radix } => Ok(Self::Hensley(SatHensley::new(context, radix))),
            Scan::Serial => Err(Error::Unsupported { what: "the serial scan".to_owned() }),
        }
    }

    /// These passes if they are those of `scan`, else its own.
    ///
    /// # Errors
    /// Those of [`TableScan::new`].
    pub(crate) fn or_of(&self, context: &Context, scan: Scan) -> Result<Self> {
        match (self, scan) {
            (Self::Blocks(_), Scan::Blocks) => Ok(self.clone()),
            (Self::Hensley(own), Scan::Hensley { radix }) if own.radix() == radix => Ok(self.clone()),
            _ => Self::new(context, scan),
        }
    }

    /// Stage that writes the table of `oem` to `sat`, whose exponents must be filled.
    #[must_use]
    pub fn stage(&self, context: &Context, oem: &OemPlanes, sat: &SatPlanes) -> Stage {
        match self {
            Self::Blocks(scan) => scan.stage(context, oem, sat),
            Self::Hensley(scan) => scan.stage(context, oem, sat),
        }
    }

    /// [`TableScan::stage`] for the residual map of fitted lobes.
    pub(super) fn stage_of_the_rest(&self, context: &Context, rest: &OemPlanes, sat: &SatPlanes) -> Stage {
        let label = match self {
            Self::Blocks(_) => "sat_scan of the rest",
            Self::Hensley(_) => "sat_hensley of the rest",
        };
        self.stage(context, rest, sat).labelled(label)
    }
}
