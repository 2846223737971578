//! KTX 2 files.

pub(super) mod file;
pub mod lookup_table;
pub(super) mod read;
pub mod write;
pub(super) mod zstandard;
