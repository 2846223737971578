//! Geometry that both engines use: overlaps of texels, texels' spread, solid angles.

pub mod bordered;
pub mod conversion;
pub(crate) mod energy;
pub mod exact;
pub mod footprints;
pub mod light;
pub mod overlap;
pub(crate) mod panorama_row;
pub(crate) mod quadrant;
pub mod resample;
pub mod solid_angles;
pub(crate) mod source_texels;
pub mod tent;
pub(crate) mod tiling;
pub(crate) mod tint;
