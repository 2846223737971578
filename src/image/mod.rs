//! Pictures of bakes for viewing.

pub mod drawing;
pub mod error_sheet;
pub mod exposure;
mod faces;
pub mod oem_mips;
pub mod preview;
pub(crate) mod tone;
