//! The tier for shaders: fitted tables, their fit, and point emitters.

pub mod emitters;
pub mod fit;
pub mod tables;
