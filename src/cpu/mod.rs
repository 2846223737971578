//! The CPU engine: one file a stage.

pub mod overlap;
pub mod reparameterise;
pub mod sat_scan;

pub mod adaptive;
pub mod cells;
pub mod kernel;
mod subtexel;
pub mod tent;
pub(crate) mod bake_level;
pub mod box_filter;
pub mod mirror;
