//! Pixel formats, containers, and texel encodings.

pub mod bc6h;
mod codes;
pub mod container;
mod level_name;
mod output_layout;
pub mod overflow;
mod pixel;
pub mod r11g11b10;
pub mod rgbd;
pub mod rgbp;
pub(crate) mod texel_bytes;

pub use level_name::{LevelName, Shown};
pub use output_layout::OutputLayout;
pub use pixel::*;
