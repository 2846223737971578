//! Figures of the maps of the sphere: drawn once, written as PNG and as SVG. Equal inputs give equal files.
//!
//! [`catalogue`] lists the figures of `octagloss-workbench analyze --plot`; `octagloss_plot` draws charts and
//! writes all as PNG and SVG, in the style of `octagloss_drawing`.

mod axes;
mod border;
pub mod catalogue;
mod content;
mod globe;
mod layout;
mod lobes;
mod lookup;
mod panorama;
mod sampling;
mod seam;
mod sheet;
mod stretch;
mod unfolding;
