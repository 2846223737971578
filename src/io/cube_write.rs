//! Cube chains as single files: which containers there are, and what they have in common.

use super::exr_parts::{Part, exr_parts_bytes};
use super::exr_write::Attribute;
use super::pixels::Pixel;
use super::{dds_write, ktx1_write, ktx2_write};
use crate::chain::{CubeChain, CubeLevel};
use crate::error::{Error, Result};
use crate::sphere::cube::Face;

/// A file format that holds a whole cube chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Container {
    /// KTX 2, Zstandard.
    Ktx2,
    /// KTX 1, plain.
    Ktx1,
    /// DDS with the DX10 header.
    Dds,
    /// OpenEXR, a part for each face of each level.
    Exr,
}

impl Container {
    /// Name on the command line, and the files' extension.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ktx2 => "ktx2",
            Self::Ktx1 => "ktx",
            Self::Dds => "dds",
            Self::Exr => "exr",
        }
    }

    /// Whether files of this kind can hold `pixel`.
    #[must_use]
    pub fn holds(self, pixel: Pixel) -> bool {
        match self {
            Self::Ktx2 | Self::Dds => pixel != Pixel::Rgbd,
            Self::Ktx1 => !matches!(pixel, Pixel::Bc6h | Pixel::Rgbd),
            Self::Exr => matches!(pixel, Pixel::F16 | Pixel::F32),
        }
    }
}

/// A file in memory.
#[derive(Clone, Debug)]
pub struct CubeFile {
    /// The file.
    pub bytes: Vec<u8>,
    /// Texels with a channel that was clamped to the pixel format's greatest value, a level each.
    pub clamped: Vec<u64>,
}

impl CubeFile {
    pub(super) fn new(bytes: Vec<u8>, chain: &CubeChain, pixel: Pixel) -> Self {
        let clamped = chain.levels.iter().map(|level| pixel.clamped(&level.texels)).collect();
        Self { bytes, clamped }
    }
}

/// `chain` in `container` and `pixel`. `metadata` are key/value pairs, text; DDS has no place for them.
///
/// # Errors
/// [`Error::Parameter`] for a chain without levels or whose sizes do not halve, a pixel format that the container
/// cannot hold ([`Container::holds`]), and for impossible keys.
pub fn cube_bytes(
    container: Container,
    chain: &CubeChain,
    pixel: Pixel,
    metadata: &[(String, String)],
) -> Result<CubeFile> {
    match container {
        Container::Ktx2 => ktx2_write::ktx2_bytes(chain, pixel, metadata),
        Container::Ktx1 => ktx1_write::ktx1_bytes(chain, pixel, metadata),
        Container::Dds => dds_write::dds_bytes(chain, pixel),
        Container::Exr => exr_bytes(chain, pixel, metadata),
    }
}

/// `chain` as an EXR file with parts `m0_px`, `m0_nx`, ..., which tell their roughness and `metadata`.
fn exr_bytes(chain: &CubeChain, pixel: Pixel, metadata: &[(String, String)]) -> Result<CubeFile> {
    check_sizes("EXR", chain)?;
    let attributes = |level: &CubeLevel| {
        let text = metadata.iter().map(|(key, text)| (key.clone(), Attribute::Text(text.clone())));
        let roughness = ("roughness".to_owned(), Attribute::Float(level.roughness as f32));
        std::iter::once(roughness).chain(text).collect()
    };
    let parts: Vec<Part<'_>> = chain
        .levels
        .iter()
        .enumerate()
        .flat_map(|(index, level)| Face::ALL.map(|face| (index, level, face)))
        .map(|(index, level, face)| Part {
            name: format!("m{index}_{}", face.short_name()),
            width: level.size,
            height: level.size,
            texels: level.face(face),
            attributes: attributes(level),
        })
        .collect();
    Ok(CubeFile::new(exr_parts_bytes(&parts, pixel)?, chain, pixel))
}

/// The edge of level 0 of a chain that a file of `format` can hold: sizes halve, every face is whole.
pub(super) fn check_sizes(format: &str, chain: &CubeChain) -> Result<u32> {
    let Some(first) = chain.levels.first() else {
        return Err(Error::Parameter(format!("a {format} file needs at least one level")));
    };
    let most = first.size.checked_ilog2().map_or(0, |log2| log2 as usize + 1);
    if chain.levels.len() > most {
        return Err(Error::Parameter(format!(
            "{} levels are more than the {most} that {format} allows a cube of {}",
            chain.levels.len(),
            first.size
        )));
    }
    for (index, level) in chain.levels.iter().enumerate() {
        let size = first.size >> index;
        if level.size != size || level.texels.len() != 6 * size as usize * size as usize {
            return Err(Error::Parameter(format!(
                "level {index} of a {format} cube of {} must have 6 faces of {size}, not {} texels in faces of {}",
                first.size,
                level.texels.len(),
                level.size
            )));
        }
    }
    Ok(first.size)
}
