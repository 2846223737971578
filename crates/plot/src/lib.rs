//! Charts and figures, drawn once and written as PNG and as SVG. Equal inputs give equal files. The drawing
//! is that of all pictures; SVG names the same font and falls back to the reader's sans-serif.

#![doc(hidden)]
#![allow(missing_docs, reason = "only crates of this workspace use it")]

pub mod chart;
pub mod figure;
pub mod look;
mod png;
mod svg;
pub mod ticks;
