//! Figures of the maps of the sphere, and charts: drawn once, written as PNG and as SVG.
//!
//! [`catalogue`] lists the figures of `octagloss analyze --plot`, [`chart::Chart`] draws series over two
//! axes. Equal inputs give equal files. PNG text uses the embedded font Ubuntu Light; SVG names it and falls
//! back to the reader's sans-serif.

mod border;
pub mod catalogue;
pub mod chart;
pub mod figure;
mod globe;
mod layout;
mod lobes;
mod look;
mod lookup;
mod page;
mod panorama;
mod render;
mod sampling;
mod scene;
mod seam;
mod sheet;
mod stretch;
mod unfolding;

pub use look::{ANISOTROPY, Colour, ColourScale, RELATIVE_SOLID_ANGLE};
pub use scene::Frame;
