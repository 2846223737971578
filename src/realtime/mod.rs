//! The tier for shaders: fitted tables and point emitters.

pub mod emitters;
pub mod tables;
