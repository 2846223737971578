//! Look-up tables as 2D KTX2 files: RG16F or RGBA16F, one level, Zstandard.

use super::exr_write::SOFTWARE;
use super::pixels::push_halves;
use crate::error::{Error, Result};
use ktx2::dfd::{Basic, Block};
use ktx2::{Format, Header, Index, LevelIndex, SupercompressionScheme};

/// Which channels a table has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// Red and green: RG16F.
    Two,
    /// All three and an alpha of 1: RGBA16F.
    Four,
}

/// A KTX2 file of a table of `size` x `size` row-major texels, half floats clamped at their greatest value;
/// `description` goes under the key `octaglossContent`.
///
/// # Errors
/// [`Error::Parameter`] where the texels do not fill the table, or the description holds a NUL.
pub fn table_bytes(size: u32, texels: &[[f32; 3]], channels: Channels, description: &str) -> Result<Vec<u8>> {
    if texels.is_empty() || texels.len() != size as usize * size as usize || description.contains('\0') {
        return Err(Error::Parameter(format!(
            "a table of {size}x{size} cannot hold {} texels",
            texels.len()
        )));
    }
    let (format, values): (_, Vec<f32>) = match channels {
        Channels::Two => (Format::R16G16_SFLOAT, texels.iter().flat_map(|[r, g, _]| [*r, *g]).collect()),
        Channels::Four => {
            (Format::R16G16B16A16_SFLOAT, texels.iter().flat_map(|[r, g, b]| [*r, *g, *b, 1.0]).collect())
        }
    };
    let mut data = Vec::with_capacity(values.len() * 2);
    push_halves(&values, &mut data);
    let packed = zstd::bulk::compress(&data, 0).map_err(|e| Error::Parameter(format!("zstd failed: {e}")))?;

    let (basic, type_size) = Basic::from_format(format).expect("the crate knows both");
    let block = Block::Basic(basic).to_vec();
    let dfd = [&(block.len() as u32 + 4).to_le_bytes()[..], &block].concat();
    let mut pairs = Vec::new();
    for (key, value) in [("KTXorientation", "rd"), ("KTXwriter", SOFTWARE), ("octaglossContent", description)]
    {
        pairs.extend((key.len() as u32 + value.len() as u32 + 2).to_le_bytes());
        pairs.extend([key.as_bytes(), &[0], value.as_bytes(), &[0]].concat());
        pairs.resize(pairs.len().next_multiple_of(4), 0);
    }
    let dfd_at = Header::LENGTH + LevelIndex::LENGTH;
    let kvd_at = dfd_at + dfd.len();
    let header = Header {
        format: Some(format),
        type_size,
        pixel_width: size,
        pixel_height: size,
        pixel_depth: 0,
        layer_count: 0,
        face_count: 1,
        level_count: 1,
        supercompression_scheme: Some(SupercompressionScheme::Zstandard),
        index: Index {
            dfd_byte_offset: dfd_at as u32,
            dfd_byte_length: dfd.len() as u32,
            kvd_byte_offset: kvd_at as u32,
            kvd_byte_length: pairs.len() as u32,
            sgd_byte_offset: 0,
            sgd_byte_length: 0,
        },
    };
    let level = LevelIndex {
        byte_offset: (kvd_at + pairs.len()) as u64,
        byte_length: packed.len() as u64,
        uncompressed_byte_length: data.len() as u64,
    };
    Ok([&header.as_bytes()[..], &level.as_bytes(), &dfd, &pairs, &packed].concat())
}
