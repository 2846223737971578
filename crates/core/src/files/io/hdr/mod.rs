//! Radiance files.

pub(super) mod read;
mod scanlines;
pub mod write;
