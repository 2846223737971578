//! The KTX2 container: header, level index, data format descriptor, key/value data, and levels in Zstandard
//! (scheme 2).
//!
//! Khronos KTX File Format Specification 2.0, sections 3 (structure), 4 (fields) and 5.1 (key/value data).

use super::zstandard;
use crate::common::error::{Error, Result, wrong};
use crate::files::format::texel_bytes::texel_bytes;
use crate::files::format::{Pixel, push_halves};
use crate::files::io::cube_write::check_sizes;
use crate::files::io::exr::write::SOFTWARE;
use crate::files::io::key_values::key_value_bytes;
use crate::light::chain::Level;
use ktx2::dfd::{Basic, Block};
use ktx2::{Format, Header, Index, LevelIndex, SupercompressionScheme};

/// Key of each level's roughness, comma-separated, level 0 first.
pub const ROUGHNESS_KEY: &str = "octaglossRoughness";

/// Encodes `levels` as a KTX2 cube map: RGBA16F, RGBA32F (alpha 1), RGB9E5, R11G11B10F or BC6H. `metadata`
/// are further text key/value pairs.
///
/// # Errors
/// [`Error::Parameter`] for no levels or sizes that do not halve, and for keys that are empty, duplicated,
/// contain a NUL, or are reserved ("KTX", "ktx").
pub fn ktx2_bytes(levels: &[Level], pixel: Pixel, metadata: &[(String, String)]) -> Result<Vec<u8>> {
    let size = check_sizes("KTX2", levels)?;
    let roughness = roughness_text(levels.iter().map(|level| level.roughness));
    let mut pairs = vec![(ROUGHNESS_KEY, roughness.as_str())];
    pairs.extend(metadata.iter().map(|(key, value)| (key.as_str(), value.as_str())));
    let flat = TextureShape::flat(format_of(pixel)?, [size; 2], levels.len());
    let shape = TextureShape { faces: 6, ..flat };
    ktx2_file(&shape, &pairs, |index| {
        let level = &levels[index];
        texel_bytes(level.size(), &level.texels, pixel)
    })
}

/// The value of [`ROUGHNESS_KEY`].
pub(in crate::files::io) fn roughness_text(roughness: impl Iterator<Item = f64>) -> String {
    roughness.map(|r| r.to_string()).collect::<Vec<_>>().join(",")
}

/// Vulkan format of a pixel format.
pub(in crate::files::io) fn format_of(pixel: Pixel) -> Result<Format> {
    let unsupported = || Error::Parameter(format!("ktx2 files cannot hold {}", pixel.name()));
    pixel.in_textures().map(|own| own.vulkan).ok_or_else(unsupported)
}

/// Header fields of a file.
pub(in crate::files::io) struct TextureShape {
    pub(in crate::files::io) format: Format,
    pub(in crate::files::io) width: u32,
    pub(in crate::files::io) height: u32,
    /// Of a texture of three dimensions; 0 of others.
    pub(in crate::files::io) depth: u32,
    /// Images of an array; 0 for no array.
    pub(in crate::files::io) layers: u32,
    /// 6 for a cube, else 1.
    pub(in crate::files::io) faces: u32,
    pub(in crate::files::io) levels: usize,
}

impl TextureShape {
    /// One flat image.
    pub(in crate::files::io) const fn flat(format: Format, [width, height]: [u32; 2], levels: usize) -> Self {
        Self { format, width, height, depth: 0, layers: 0, faces: 1, levels }
    }
}

/// Encodes one image of halves, `[width, height, depth]`, which holds `content`.
///
/// # Errors
/// As [`ktx2_file`].
pub(in crate::files::io) fn halves_file(
    format: Format,
    [width, height, depth]: [u32; 3],
    values: &[f32],
    content: &str,
) -> Result<Vec<u8>> {
    let mut data = Vec::with_capacity(2 * values.len());
    push_halves(values, &mut data);
    let shape = TextureShape { depth, ..TextureShape::flat(format, [width, height], 1) };
    ktx2_file(&shape, &[("octaglossContent", content)], |_| data.clone())
}

/// Encodes a KTX2 file of `shape`. `texels` returns the bytes of each level; `pairs` are further text
/// key/value pairs. Single-threaded and deterministic.
///
/// # Errors
/// [`Error::Parameter`] for keys that are empty, duplicated, contain a NUL, or are reserved ("KTX", "ktx").
pub(in crate::files::io) fn ktx2_file(
    shape: &TextureShape,
    pairs: &[(&str, &str)],
    texels: impl Fn(usize) -> Vec<u8>,
) -> Result<Vec<u8>> {
    let TextureShape { format, width, height, depth, layers, faces, levels } = *shape;
    let (basic, type_size) = Basic::from_format(format).expect("the crate knows what is written");
    let block = Block::Basic(basic).to_vec();
    let dfd_bytes = [&(block.len() as u32 + 4).to_le_bytes()[..], &block].concat();
    let kvd_bytes = metadata_bytes(pairs)?;

    let dfd_at = Header::LENGTH + levels * LevelIndex::LENGTH;
    let kvd_at = dfd_at + dfd_bytes.len();
    let header = Header {
        format: Some(format),
        type_size,
        pixel_width: width,
        pixel_height: height,
        pixel_depth: depth,
        layer_count: layers,
        face_count: faces,
        level_count: levels as u32,
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

    // The index is ordered from the largest level to the smallest, the data in reverse. Supercompressed
    // levels need no alignment (section 3.9.7).
    for index in (0..levels).rev() {
        let texels = texels(index);
        let data = zstandard::compress(&texels)
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
    Ok(bytes)
}

/// Encodes the pairs and the writer's own in key order.
fn metadata_bytes(pairs: &[(&str, &str)]) -> Result<Vec<u8>> {
    if let Some((key, _)) = pairs.iter().find(|(key, _)| key.to_ascii_lowercase().starts_with("ktx")) {
        return wrong(format!("{key:?} cannot be a key of KTX2 metadata"));
    }
    // Images are stored left to right, top to bottom.
    let mut all = vec![("KTXorientation", "rd"), ("KTXwriter", SOFTWARE)];
    all.extend(pairs);
    all.sort_unstable();
    key_value_bytes("KTX2", &all)
}
