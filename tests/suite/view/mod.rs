//! The viewer.

pub(super) mod meshes;
