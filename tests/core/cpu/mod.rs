//! The stages of the CPU engine.

pub(super) mod adaptive;
mod continuity;
mod reflections;
