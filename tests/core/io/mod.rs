//! Readers and writers.

pub(super) mod bc6h;
pub(super) mod containers;
pub(super) mod fuzz;
pub(super) mod ktx2_write;
pub(super) mod oem_file;
pub(super) mod output;
pub(super) mod read;
pub(super) mod write;
