//! Figures of the maps of the sphere, and charts: drawn once, written as PNG and as SVG.
//!
//! [`catalogue`] lists the figures of `octagloss analyze --plot`, [`chart::Chart`] draws series over two
//! axes. Equal inputs give equal files. `image::drawing` has their style and draws them as PNG; SVG names the
//! same font and falls back to the reader's sans-serif.

mod axes;
mod border;
pub mod catalogue;
pub mod chart;
mod content;
pub mod figure;
mod globe;
mod layout;
mod lobes;
mod look;
mod lookup;
mod panorama;
mod png;
mod sampling;
mod seam;
mod sheet;
mod stretch;
mod svg;
mod ticks;
mod unfolding;
