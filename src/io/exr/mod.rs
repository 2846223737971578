//! OpenEXR files.

pub(super) mod deflate;
pub mod parts;
pub(super) mod read;
pub mod write;
