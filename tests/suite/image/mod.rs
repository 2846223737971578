//! Image output.

mod oem_mips;
pub(super) mod preview;
