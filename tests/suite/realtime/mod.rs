//! The real-time tier for shaders.

pub(super) mod emitters;
pub(super) mod fitted;
