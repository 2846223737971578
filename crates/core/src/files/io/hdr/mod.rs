//! Radiance files.

pub(super) mod read;
pub mod write;
