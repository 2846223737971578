//! KTX 1 output: cube maps with their levels, as Filament reads them.
//!
//! "KTX File Format Specification" (Khronos, version 1.0), and Filament's libs/image/src/Ktx1Bundle.cpp and
//! libs/ktxreader/src/Ktx1Reader.cpp for the further requirements of its reader.

use crate::common::error::{Error, Result, wrong};
use crate::files::format::Pixel;
use crate::files::format::texel_bytes::texel_bytes;
use crate::files::io::cube_file::{CubeFile, check_sizes};
use crate::files::io::key_values::key_value_bytes;
use crate::files::io::ktx2::write::{ROUGHNESS_KEY, roughness_text};
use crate::light::chain::Chain;

/// Magic number.
pub(in crate::files::io) const MAGIC: [u8; 12] = *b"\xabKTX 11\xbb\r\n\x1a\n";

/// Encodes `chain` as a KTX 1 cube map: R11G11B10F, RGB9E5, RGBA16F or RGBA32F. `metadata` are text key/value
/// pairs.
///
/// # Errors
/// [`Error::Parameter`] for a chain without levels or whose sizes do not halve, for BC6H, and for keys that
/// are empty, duplicated or contain a NUL.
pub fn ktx1_bytes(chain: &Chain, pixel: Pixel, metadata: &[(String, String)]) -> Result<CubeFile> {
    let size = check_sizes("KTX", chain)?;
    let Some(gl) = pixel.gl() else {
        return wrong(format!(
            "KTX 1 does not support {}; use ktx2 or dds, or r11g11b10f, rgb9e5, f16 or f32",
            pixel.name()
        ));
    };
    let roughness = roughness_text(chain.levels.iter().map(|level| level.roughness));
    let metadata = metadata.iter().map(|(key, value)| (key.as_str(), value.as_str()));
    let pairs: Vec<_> = metadata.chain([(ROUGHNESS_KEY, roughness.as_str())]).collect();
    let pairs = key_value_bytes("KTX", &pairs)?;
    let mut bytes = MAGIC.to_vec();
    let header = [
        0x0403_0201, // little endian
        gl.kind,
        gl.kind_bytes,
        gl.format,
        gl.internal,
        gl.format,
        size,
        size,
        0, // depth
        0, // array elements: not an array
        6,
        chain.levels.len() as u32,
        pairs.len() as u32,
    ];
    bytes.extend(header.iter().flat_map(|word: &u32| word.to_le_bytes()));
    bytes.extend(pairs);
    for (index, level) in chain.levels.iter().enumerate() {
        let texels = texel_bytes(level.size(), &level.texels, pixel);
        // For a non-array cube imageSize is that of one face. Texels are multiples of four bytes, so there is
        // no padding.
        let face = u32::try_from(texels.len() / 6).map_err(|_| {
            Error::Parameter(format!("level {index} is larger than the 4 GiB a KTX face may have"))
        })?;
        bytes.extend(face.to_le_bytes());
        bytes.extend(texels);
    }
    Ok(CubeFile::new(bytes, &chain.levels, pixel))
}
