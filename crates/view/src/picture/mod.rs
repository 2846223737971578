//! Pictures: what is on the GPU, and the passes that draw it.

pub(crate) mod frame;
pub(crate) mod levels;
pub(crate) mod light;
pub(crate) mod mip_levels;
pub(crate) mod model;
pub(crate) mod present;
pub(crate) mod renderer;
pub(crate) mod resources;
pub(crate) mod roughness_map;
pub mod screenshot;
pub(crate) mod truth;
