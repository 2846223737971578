//! The CPU engine, one file per stage.

pub mod leaves;
pub mod reparameterise;
pub mod sat_scan;

pub mod adaptive;
pub mod blur;
pub mod box_filter;
pub mod cells;
pub(crate) mod fitted;
pub mod mirror;
pub(crate) mod subtexel;
