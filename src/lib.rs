//! Glossy reflections of any roughness from one spherical summed-area table.

pub mod bake;
pub mod chain;
pub mod compare;
pub mod cpu;
pub mod environment;
pub mod error;
mod font;
pub mod io;
pub mod lobe;
pub mod oem;
pub mod oracle;
pub mod preview;
pub mod reflector;
pub mod report;
pub mod sat;
pub mod sat_f32;
pub mod seamless;
pub mod sh;
pub mod sphere;
pub mod sun;
pub mod survey;
pub mod synth;

pub use environment::{Environment, Layout, Rgb};
pub use error::{Error, Result};
