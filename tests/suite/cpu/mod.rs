//! The stages of the CPU engine.

pub(super) mod adaptive;
pub(super) mod extremes;
pub(super) mod lights;
