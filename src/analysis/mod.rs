//! Measurements: exhaustive integration, comparison, statistics, the sun, the float32 table.

pub mod compare;
pub mod oracle;
pub mod sat_f32;
pub mod statistics;
pub mod sun;
