//! Image output.

mod error_sheet;
pub(super) mod oem_mips;
pub(super) mod preview;
mod side_by_side;
