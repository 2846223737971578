//! DDS output: cube maps with their levels and the DX10 header, laid out by the `ddsfile` crate.
//!
//! "Programming Guide for DDS" (Microsoft): faces in order, each with all its levels.

use crate::common::error::{Error, Result, wrong};
use crate::files::format::Pixel;
use crate::files::format::texel_bytes::texel_bytes;
use crate::files::io::cube_file::{CubeFile, check_sizes};
use crate::files::target::Flip;
use crate::light::chain::Chain;
use ddsfile::{AlphaMode, Caps2, D3D10ResourceDimension, Dds, NewDxgiParams};

/// A DDS cube map of `chain`: RGBA16F, RGBA32F, RGB9E5, R11G11B10F or BC6H (unsigned).
///
/// # Errors
/// [`Error::Parameter`] for a chain without levels or whose sizes do not halve.
pub(crate) fn dds_bytes(chain: &Chain, pixel: Pixel) -> Result<CubeFile> {
    let size = check_sizes("DDS", chain)?;
    let Some(format) = pixel.dxgi() else {
        return wrong(format!("dds files cannot hold {}", pixel.name()));
    };
    let failed = |error: ddsfile::Error| Error::Parameter(format!("a DDS cube of {size}: {error}"));
    let mut dds = Dds::new_dxgi(NewDxgiParams {
        height: size,
        width: size,
        depth: None,
        format,
        mipmap_levels: Some(chain.levels.len() as u32),
        array_layers: Some(6),
        // The crate sets only the DX10 header's flag; older readers use these.
        caps2: Some(Caps2::CUBEMAP | Caps2::CUBEMAP_ALLFACES),
        is_cubemap: true,
        resource_dimension: D3D10ResourceDimension::Texture2D,
        alpha_mode: AlphaMode::Opaque,
    })
    .map_err(failed)?;
    let levels: Vec<Vec<u8>> =
        chain.levels.iter().map(|level| texel_bytes(level.size(), &level.texels, pixel)).collect();
    dds.data.clear();
    for face in 0..6 {
        for level in &levels {
            let length = level.len() / 6;
            dds.data.extend(&level[face * length..][..length]);
        }
    }
    let mut bytes = Vec::with_capacity(dds.data.len() + 148);
    dds.write(&mut bytes).map_err(failed)?;
    Ok(CubeFile::new(bytes, &chain.levels, pixel))
}

/// Offset of `dwReserved1`, eleven words that no reader uses, after the magic number and seven words.
const MARK_AT: usize = 32;

/// The program's mark, followed by the flip's name. Other encoders store their names there too.
const MARK: &[u8; 4] = b"OCTG";

/// Writes the program's mark and `flip` into the reserved words of a file's header.
pub(in crate::files::io) fn mark_flip(file: &mut [u8], flip: Flip) {
    file[MARK_AT..][..4].copy_from_slice(MARK);
    let word = &mut file[MARK_AT + 4..][..4];
    word.fill(0);
    word[..flip.name().len()].copy_from_slice(flip.name().as_bytes());
}

/// Reads the flip from the program's mark.
pub(in crate::files::io) fn marked_flip(file: &[u8]) -> Option<Flip> {
    let word = file.get(MARK_AT..)?.strip_prefix(MARK)?.get(..4)?;
    Flip::named(std::str::from_utf8(word).ok()?.trim_end_matches('\0'))
}
