//! Measurements.

pub(super) mod oracle;
mod stretch;
mod triangles;
