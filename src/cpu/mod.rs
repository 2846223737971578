//! The CPU engine: one file a stage.

pub mod overlap;
pub mod reparameterise;
pub mod sat_scan;
