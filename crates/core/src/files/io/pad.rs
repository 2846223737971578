//! Paddings of panoramas that are not 2:1.
use crate::common::names::named;

/// Padding of a panorama that is not 2:1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Pad {
    /// Black, without light.
    Black,
    /// Repeats the outermost rows (or columns).
    Edge,
}

named!(Pad { Black = "black", Edge = "edge" });
