//! Pictures of bakes for viewing.

pub mod cube_sampler;
pub mod exposure;
pub(super) mod font;
pub mod preview;
