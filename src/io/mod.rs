//! Files: one codec a file, thin over its crate, and outputs that appear whole or not at all.

pub mod environment_write;
pub mod exr_write;
pub mod hdr_write;
pub mod ktx2_write;
pub mod output;
pub mod pixels;
pub mod png_write;
