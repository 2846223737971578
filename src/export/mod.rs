//! Encodes a bake as the files of each target.

pub(crate) mod babylon;
pub mod files;
pub(crate) mod gltf;
pub mod lights;
pub mod plan;
pub(crate) mod playcanvas;
pub mod stored;
pub mod write;
