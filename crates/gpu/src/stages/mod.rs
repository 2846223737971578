//! Compute passes, one file a stage.

pub mod adaptive;
pub mod box_filter;
pub mod build_pyramid;
pub mod cells;
pub mod copy;
pub mod fixed_point;
pub mod lamp;
mod least;
pub mod oem;
pub mod pyramid;
pub mod reflection;
pub mod reparameterise;
pub mod sat_f32;
pub mod sat_hensley;
pub mod sat_scan;
