//! Files: pixels and containers, readers and writers, pictures, targets, and what a recipe makes of a source.

pub mod export;
pub mod format;
pub mod image;
pub mod io;
pub mod recipe;
pub mod target;
