//! Look-up tables as 2D KTX2 files: RG16F or RGBA16F, one level, Zstandard.

use super::write::halves_file;
use crate::common::error::{Result, wrong};
use ktx2::Format;

/// Channels of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// Red and green: RG16F.
    Two,
    /// Red, green, blue and an alpha of 1: RGBA16F.
    Four,
}

/// Encodes a table of `size` x `size` row-major texels as a KTX2 file. Half floats are clamped to their
/// maximum; `description` is stored under the key `octaglossContent`.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if the texels do not fill the table, or the description
/// contains a NUL.
pub fn table_bytes(size: u32, texels: &[[f32; 3]], channels: Channels, description: &str) -> Result<Vec<u8>> {
    if texels.is_empty() || texels.len() != size as usize * size as usize || description.contains('\0') {
        return wrong(format!("a table of {size}x{size} cannot hold {} texels", texels.len()));
    }
    let (format, values): (_, Vec<f32>) = match channels {
        Channels::Two => (Format::R16G16_SFLOAT, texels.iter().flat_map(|[r, g, _]| [*r, *g]).collect()),
        Channels::Four => {
            (Format::R16G16B16A16_SFLOAT, texels.iter().flat_map(|[r, g, b]| [*r, *g, *b, 1.0]).collect())
        }
    };
    halves_file(format, [size, size, 0], &values, description)
}
