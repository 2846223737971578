//! KTX 2 files.

pub mod lookup_table;
pub(super) mod read;
pub mod write;
mod zstandard;
