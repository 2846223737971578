//! Shared test code.

pub(super) mod bounds;
pub(super) mod common;
pub(super) mod inputs;
pub(super) mod meshes;
pub(super) mod mutation;
pub(super) mod oem_oracle;
pub(super) mod triangle_oracle;
pub(super) mod written;
