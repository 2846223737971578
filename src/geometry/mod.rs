//! Geometry that both engines use: overlaps of texels, texels' spread, solid angles.

pub mod bordered;
pub mod footprints;
pub mod overlap;
pub mod resample;
pub mod solid_angles;
pub(crate) mod source_texels;
pub mod tent;
pub(crate) mod tiling;
