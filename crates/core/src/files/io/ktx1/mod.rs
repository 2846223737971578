//! KTX 1 files.

pub(super) mod read;
pub mod write;
