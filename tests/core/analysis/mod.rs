//! Measurements.

mod extraction;
pub(super) mod oracle;
