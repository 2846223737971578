//! Pictures of bakes for viewing.

pub mod error_sheet;
pub mod exposure;
mod faces;
pub mod oem_mips;
pub mod preview;
pub mod side_by_side;
