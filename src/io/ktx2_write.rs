//! KTX2 output: cube maps with their levels, Zstandard supercompression (scheme 2), one thread, the same bytes always.
//!
//! Khronos KTX File Format Specification 2.0, sections 3 (structure), 4 (fields) and 5.1 (key/value data).

use super::cube_write::check_sizes;
use super::exr_write::SOFTWARE;
use super::output::{self, Existing};
use super::pixels::Pixel;
use super::texel_bytes::texel_bytes;
use crate::chain::CubeChain;
use crate::error::{Error, Result};
use ktx2::dfd::{Basic, Block};
use ktx2::{Format, Header, Index, LevelIndex, SupercompressionScheme};
use std::path::Path;

/// zstd's own default. On half-float faces of a real panorama level 1 is three times as fast and leaves 14 % more
/// bytes, level 19 takes sixty times as long and leaves 11 % fewer.
const ZSTD_LEVEL: i32 = 3;

/// The key that lists each level's roughness, comma-separated, the sharpest first.
pub const ROUGHNESS_KEY: &str = "octaglossRoughness";

/// A KTX2 file in memory.
#[derive(Clone, Debug)]
pub struct Ktx2 {
    /// The file.
    pub bytes: Vec<u8>,
    /// Texels with a channel that was clamped to the pixel format's greatest value, a level each.
    pub clamped: Vec<u64>,
}

/// Writes `chain` as a KTX2 cube map to `path`, whole or not at all; see [`ktx2_bytes`].
///
/// Returns the texels clamped, a level each.
///
/// # Errors
/// As [`ktx2_bytes`] and [`output::write_file`].
pub fn write_ktx2(
    path: &Path,
    existing: Existing,
    chain: &CubeChain,
    pixel: Pixel,
    metadata: &[(String, String)],
) -> Result<Vec<u64>> {
    output::check_file(path, existing)?;
    let ktx2 = ktx2_bytes(chain, pixel, metadata)?;
    output::write_file(path, existing, |file| file.write_all(&ktx2.bytes))?;
    Ok(ktx2.clamped)
}

/// A KTX2 cube map of `chain`: RGBA16F, RGBA32F (alpha 1), RGB9E5, R11G11B10F or BC6H. `metadata` are further key/value pairs, text.
///
/// # Errors
/// [`Error::Parameter`] for a chain without levels or whose sizes do not halve, and for keys that are empty, double,
/// hold a NUL, or are reserved ("KTX", "ktx").
pub fn ktx2_bytes(chain: &CubeChain, pixel: Pixel, metadata: &[(String, String)]) -> Result<Ktx2> {
    let size = check_sizes("KTX2", chain)?;
    let format = match pixel {
        Pixel::F16 => Format::R16G16B16A16_SFLOAT,
        Pixel::F32 => Format::R32G32B32A32_SFLOAT,
        Pixel::Rgb9e5 => Format::E5B9G9R9_UFLOAT_PACK32,
        Pixel::R11g11b10 => Format::B10G11R11_UFLOAT_PACK32,
        Pixel::Bc6h => Format::BC6H_UFLOAT_BLOCK,
    };
    let (basic, type_size) = Basic::from_format(format).expect("the crate knows these five");
    let block = Block::Basic(basic).to_vec();
    let dfd_bytes = [&(block.len() as u32 + 4).to_le_bytes()[..], &block].concat();
    let kvd_bytes = key_value_bytes(chain, metadata)?;

    let dfd_at = Header::LENGTH + chain.levels.len() * LevelIndex::LENGTH;
    let kvd_at = dfd_at + dfd_bytes.len();
    let header = Header {
        format: Some(format),
        type_size,
        pixel_width: size,
        pixel_height: size,
        pixel_depth: 0,
        layer_count: 0,
        face_count: 6,
        level_count: chain.levels.len() as u32,
        supercompression_scheme: Some(SupercompressionScheme::Zstandard),
        index: Index {
            dfd_byte_offset: dfd_at as u32,
            dfd_byte_length: dfd_bytes.len() as u32,
            kvd_byte_offset: kvd_at as u32,
            kvd_byte_length: kvd_bytes.len() as u32,
            sgd_byte_offset: 0,
            sgd_byte_length: 0,
        },
    };
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(dfd_at, 0);
    bytes.extend(dfd_bytes);
    bytes.extend(kvd_bytes);

    // The index runs from the largest level to the smallest, the data the other way; supercompressed levels need no
    // alignment (section 3.9.7).
    for (index, level) in chain.levels.iter().enumerate().rev() {
        let texels = texel_bytes(level.size, &level.texels, pixel);
        let data = zstd::bulk::compress(&texels, ZSTD_LEVEL)
            .map_err(|e| Error::Parameter(format!("zstd failed on level {index}: {e}")))?;
        let entry = LevelIndex {
            byte_offset: bytes.len() as u64,
            byte_length: data.len() as u64,
            uncompressed_byte_length: texels.len() as u64,
        };
        bytes[Header::LENGTH + index * LevelIndex::LENGTH..][..LevelIndex::LENGTH]
            .copy_from_slice(&entry.as_bytes());
        bytes.extend(data);
    }
    let clamped = chain.levels.iter().map(|level| pixel.clamped(&level.texels)).collect();
    Ok(Ktx2 { bytes, clamped })
}

/// Pairs in the order of their keys, each padded to four bytes; values are text and end in NUL.
fn key_value_bytes(chain: &CubeChain, metadata: &[(String, String)]) -> Result<Vec<u8>> {
    let roughness: Vec<String> = chain.levels.iter().map(|level| level.roughness.to_string()).collect();
    let mut pairs = vec![
        // Faces are stored row by row, to the right and down.
        ("KTXorientation", "rd".to_owned()),
        ("KTXwriter", SOFTWARE.to_owned()),
        (ROUGHNESS_KEY, roughness.join(",")),
    ];
    for (key, value) in metadata {
        if key.is_empty() || key.contains('\0') || key.to_ascii_lowercase().starts_with("ktx") {
            return Err(Error::Parameter(format!("{key:?} cannot be a key of KTX2 metadata")));
        }
        pairs.push((key, value.clone()));
    }
    pairs.sort();
    if let Some(double) = pairs.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err(Error::Parameter(format!("the KTX2 metadata has {:?} twice", double[0].0)));
    }
    let mut bytes = Vec::new();
    for (key, value) in pairs {
        bytes.extend((key.len() as u32 + 1 + value.len() as u32 + 1).to_le_bytes());
        for text in [key, &value] {
            bytes.extend(text.as_bytes());
            bytes.push(0);
        }
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    Ok(bytes)
}
