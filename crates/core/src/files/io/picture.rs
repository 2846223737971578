//! Output of the decoders.

use super::map_header::MapHeader;
use super::provenance::Provenance;
use crate::common::error::{Error, Result};
use crate::light::environment::{Layout, Rgb};
use crate::sphere::cube::Face;
use std::path::Path;

/// Decoded pixels: linear RGB, Rec. 709 primaries, unchecked.
#[derive(Clone, Debug, Default)]
pub(super) struct Picture {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Row-major, from the top left.
    pub(super) texels: Vec<Rgb>,
    /// Whether it is six faces, stacked vertically; else an image whose layout is not known yet.
    pub(super) is_cube: bool,
    /// The map that the header names.
    pub(super) map: Option<MapHeader>,
    /// The encoding in words.
    pub(super) format: String,
    pub(super) warnings: Vec<String>,
    /// Origin and orientation recorded in the file; not yet applied to the texels.
    pub(super) provenance: Provenance,
}

/// Size and roughness in the header of a level's image.
pub(super) struct LevelHeader {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) roughness: Option<f64>,
}

/// Rejects NaN and Inf in a level of a chain.
pub(super) fn check_finite(path: &Path, level: u32, size: u32, texels: &[Rgb]) -> Result<()> {
    let Some(at) = texels.iter().position(|texel| texel.iter().any(|value| !value.is_finite())) else {
        return Ok(());
    };
    let (face, i, j) = Layout::Cube { size }.place(at);
    Err(Error::input(
        path,
        format!(
            "level {level} face {} pixel ({i}, {j}) is {:?}; bake it again",
            Face::ALL[face as usize].short_name(),
            texels[at]
        ),
    ))
}
