//! Image output.

mod drawing;
mod error_sheet;
mod oem_mips;
pub(super) mod preview;
mod side_by_side;
