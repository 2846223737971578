//! The drawing that previews, error pictures, legends of the viewer and charts share: one look, one font.
//!
//! A [`Scene`](scene::Scene) lists shapes and lines of text in pixels; `raster` draws it, and `plot` also
//! writes it as SVG. [`style`] has colours, sizes and margins, [`scale`] the colour scales, `page` titles and
//! colour bars.

#![doc(hidden)]
#![allow(missing_docs, reason = "only crates of this workspace use it")]

pub mod bitmap;
pub mod font;
pub mod page;
pub mod path;
pub mod raster;
pub mod scale;
pub mod scene;
pub mod style;
pub mod tone;
