//! PNG and JPEG files.

pub(super) mod read;
pub mod write;
