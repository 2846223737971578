//! Encodes a bake as the files of each target.

pub(crate) mod babylon;
pub mod files;
pub(crate) mod gltf;
pub mod lights;
pub(crate) mod playcanvas;
pub mod produce;
pub(crate) mod pyramid;
pub mod report;
pub mod write;
