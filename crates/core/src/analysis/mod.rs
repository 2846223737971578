//! Measurements: exhaustive integration, comparison, statistics, the sun and its extraction, the float32
//! table, maps of spheres.

pub mod channels;
pub mod compare;
pub mod delivered;
pub mod extraction;
pub mod oracle;
pub mod sat_f32;
pub mod statistics;
pub mod sun;
pub mod typical;
