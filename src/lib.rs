//! Glossy reflections of any roughness from one spherical summed-area table.

pub mod bake;
pub mod chain;
pub mod cpu;
pub mod environment;
pub mod error;
pub mod lobe;
pub mod oem;
pub mod oracle;
pub mod reflector;
pub mod sat;
pub mod sat_f32;
pub mod sh;
pub mod sphere;

pub use environment::{Environment, Layout, Rgb};
pub use error::{Error, Result};
