//! A bake as files: what each target's files hold, as bytes.

pub(crate) mod babylon;
pub mod files;
pub(crate) mod gltf;
pub mod write;
