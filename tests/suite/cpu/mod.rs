//! The stages of the CPU engine.

pub(super) mod adaptive;
mod continuity;
pub(super) mod extremes;
pub(super) mod lights;
mod reflections;
