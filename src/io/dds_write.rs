//! DDS output: cube maps with their levels and the DX10 header, laid out by the `ddsfile` crate.
//!
//! "Programming Guide for DDS" (Microsoft): faces one after the other, each with all its levels.

use super::cube_write::{CubeFile, check_sizes};
use super::pixels::Pixel;
use super::texel_bytes::texel_bytes;
use crate::chain::CubeChain;
use crate::error::{Error, Result};
use ddsfile::{AlphaMode, Caps2, D3D10ResourceDimension, Dds, DxgiFormat, NewDxgiParams};

/// A DDS cube map of `chain`: RGBA16F, RGBA32F, RGB9E5, R11G11B10F or BC6H (unsigned).
///
/// # Errors
/// [`Error::Parameter`] for a chain without levels or whose sizes do not halve.
pub fn dds_bytes(chain: &CubeChain, pixel: Pixel) -> Result<CubeFile> {
    let size = check_sizes("DDS", chain)?;
    let format = match pixel {
        Pixel::F16 => DxgiFormat::R16G16B16A16_Float,
        Pixel::F32 => DxgiFormat::R32G32B32A32_Float,
        Pixel::Rgb9e5 => DxgiFormat::R9G9B9E5_SharedExp,
        Pixel::R11g11b10 => DxgiFormat::R11G11B10_Float,
        Pixel::Bc6h => DxgiFormat::BC6H_UF16,
        Pixel::Rgbd => return Err(Error::Parameter("dds files cannot hold rgbd".to_owned())),
    };
    let failed = |error: ddsfile::Error| Error::Parameter(format!("a DDS cube of {size}: {error}"));
    let mut dds = Dds::new_dxgi(NewDxgiParams {
        height: size,
        width: size,
        depth: None,
        format,
        mipmap_levels: Some(chain.levels.len() as u32),
        array_layers: Some(6),
        // The crate sets the DX10 header's flag alone; older readers go by these.
        caps2: Some(Caps2::CUBEMAP | Caps2::CUBEMAP_ALLFACES),
        is_cubemap: true,
        resource_dimension: D3D10ResourceDimension::Texture2D,
        alpha_mode: AlphaMode::Opaque,
    })
    .map_err(failed)?;
    let levels: Vec<Vec<u8>> =
        chain.levels.iter().map(|level| texel_bytes(level.size, &level.texels, pixel)).collect();
    dds.data.clear();
    for face in 0..6 {
        for level in &levels {
            let length = level.len() / 6;
            dds.data.extend(&level[face * length..][..length]);
        }
    }
    let mut bytes = Vec::with_capacity(dds.data.len() + 148);
    dds.write(&mut bytes).map_err(failed)?;
    Ok(CubeFile::new(bytes, chain, pixel))
}
