//! KTX2 output: cube maps with their levels.

use super::file::{TextureShape, ktx2_file};
use crate::common::error::{Error, Result};
use crate::files::format::Pixel;
use crate::files::format::texel_bytes::texel_bytes;
use crate::files::io::cube_file::{CubeFile, check_sizes};
use crate::light::chain::Chain;
use ktx2::Format;

/// Key of each level's roughness, comma-separated, level 0 first.
pub const ROUGHNESS_KEY: &str = "octaglossRoughness";

/// Encodes `chain` as a KTX2 cube map: RGBA16F, RGBA32F (alpha 1), RGB9E5, R11G11B10F or BC6H. `metadata` are
/// further text key/value pairs.
///
/// # Errors
/// [`Error::Parameter`] for a chain without levels or whose sizes do not halve, and for keys that are empty,
/// duplicated, contain a NUL, or are reserved ("KTX", "ktx").
pub fn ktx2_bytes(chain: &Chain, pixel: Pixel, metadata: &[(String, String)]) -> Result<CubeFile> {
    let size = check_sizes("KTX2", chain)?;
    let roughness = roughness_text(chain.levels.iter().map(|level| level.roughness));
    let mut pairs = vec![(ROUGHNESS_KEY, roughness.as_str())];
    pairs.extend(metadata.iter().map(|(key, value)| (key.as_str(), value.as_str())));
    let flat = TextureShape::flat(format_of(pixel)?, [size; 2], chain.levels.len());
    let shape = TextureShape { faces: 6, ..flat };
    let bytes = ktx2_file(&shape, &pairs, |index| {
        let level = &chain.levels[index];
        texel_bytes(level.size(), &level.texels, pixel)
    })?;
    Ok(CubeFile::new(bytes, &chain.levels, pixel))
}

/// The value of [`ROUGHNESS_KEY`].
pub(in crate::files::io) fn roughness_text(roughness: impl Iterator<Item = f64>) -> String {
    roughness.map(|r| r.to_string()).collect::<Vec<_>>().join(",")
}

/// Vulkan format of a pixel format.
pub(in crate::files::io) fn format_of(pixel: Pixel) -> Result<Format> {
    let unsupported = || Error::Parameter(format!("ktx2 files cannot hold {}", pixel.name()));
    pixel.vulkan().ok_or_else(unsupported)
}
