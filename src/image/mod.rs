//! Pictures of bakes for people to look at.

pub mod cube_sampler;
pub mod exposure;
pub(super) mod font;
pub mod preview;
