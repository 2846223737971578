//! Pictures of bakes for viewing.

pub mod exposure;
pub(super) mod font;
pub mod oem_mips;
pub mod preview;
