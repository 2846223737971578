//! Light over the sphere: environments, chains of levels, octahedral maps (OEM) and their summed-area tables
//! (SAT), spherical harmonics.

pub mod chain;
pub mod chain_lookup;
pub mod environment;
pub mod light_scale;
pub mod oem;
pub mod sat;
pub mod sh;
pub mod synth;
