//! The CPU engine, one file per stage.

pub mod leaves;
pub mod reparameterise;
pub mod sat_scan;

pub mod adaptive;
pub mod box_filter;
pub mod cells;
pub(crate) mod footprints;
pub mod mirror;
mod range;
pub mod reflection;
pub mod reflector;
pub(crate) mod subtexel;
pub mod table_bytes;
