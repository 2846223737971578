//! The CPU engine: one file a stage.

pub mod overlap;
pub mod reparameterise;
pub mod sat_scan;

pub mod adaptive;
pub(crate) mod bake_level;
pub mod blur;
pub mod box_filter;
pub mod cells;
pub mod emitters;
pub(crate) mod fitted;
pub mod kernel;
pub mod mirror;
mod subtexel;
pub mod tent;
