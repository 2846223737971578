//! Measurements.

mod extraction;
pub(super) mod oracle;
mod stretch;
mod triangles;
