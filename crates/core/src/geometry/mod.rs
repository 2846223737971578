//! Geometry that both engines use: overlaps of texels, texels' spread, solid angles.

pub mod bordered;
pub mod conversion;
pub(crate) mod energy;
pub mod exact;
pub mod footprints;
pub mod light;
pub mod overlap;
pub(crate) mod panorama_row;
pub mod quadrant;
pub mod resample;
pub mod solid_angles;
pub mod source_texels;
pub mod tent;
pub mod tiling;
pub(crate) mod tint;
