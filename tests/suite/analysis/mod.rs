//! Measurements.

pub(super) mod oracle;
