//! OpenEXR files.

mod deflate;
pub mod parts;
pub(super) mod read;
pub mod write;
