//! DDS files with the DX10 header: RGBA16F, RGBA32F, RGB9E5 and R11G11B10F cubes and 2D images, their level 0.

use super::picture::{Content, Picture, Source, TEXEL_BYTES};
use super::pixels::rgb_from_rgb9e5;
use super::r11g11b10::rgb_from_r11g11b10;
use crate::environment::Rgb;
use crate::error::Result;
use ddsfile::{Dds, DxgiFormat, MiscFlag};
use half::f16;

/// Level 0 as a picture.
pub(super) fn decode_level0(source: &Source<'_>) -> Result<Picture> {
    // The crate keeps a copy of the file's bytes.
    source.check_memory(1, 1, source.bytes.len() as u64)?;
    let dds = Dds::read(source.bytes).map_err(|error| source.decoder_error("DDS", &error))?;
    let Some(extended) = &dds.header10 else {
        return Err(source.error("a DDS file without the DX10 header; save it with a DXGI format"));
    };
    let (name, texel_bytes) = match extended.dxgi_format {
        DxgiFormat::R16G16B16A16_Float => ("RGBA16F", 8),
        DxgiFormat::R32G32B32A32_Float => ("RGBA32F", 16),
        DxgiFormat::R9G9B9E5_SharedExp => ("RGB9E5", 4),
        DxgiFormat::R11G11B10_Float => ("R11G11B10F", 4),
        other => {
            return Err(source.error(format!(
                "its pixels are {other:?}; RGBA16F, RGBA32F, RGB9E5 and R11G11B10F can be read"
            )));
        }
    };
    let (width, height) = (dds.header.width, dds.header.height);
    let levels = dds.header.mip_map_count.unwrap_or(1).max(1);
    let is_cube = extended.misc_flag.contains(MiscFlag::TEXTURECUBE);
    if extended.array_size > 1 || dds.header.depth.is_some_and(|depth| depth > 1) {
        return Err(
            source.error(format!("{} textures in one; a single one can be read", extended.array_size))
        );
    }
    if is_cube && width != height {
        return Err(source.error(format!("cube faces of {width}x{height} are not square")));
    }
    let faces: u32 = if is_cube { 6 } else { 1 };
    source.check_memory(width, height, u64::from(faces) * (TEXEL_BYTES + texel_bytes))?;
    if levels > width.max(height).ilog2() + 1 {
        return Err(source.error(format!("{levels} levels are more than {width}x{height} can have")));
    }
    // Each face with its levels, the largest first.
    let pixels = |level: u32| u64::from((width >> level).max(1)) * u64::from((height >> level).max(1));
    let stride = (0..levels).map(|level| pixels(level) * texel_bytes).sum::<u64>();
    if u64::from(faces) * stride > dds.data.len() as u64 {
        return Err(source.error(format!(
            "truncated: {faces} faces of {levels} levels take {} bytes, {} are there; copy it anew",
            u64::from(faces) * stride,
            dds.data.len()
        )));
    }
    let first = (pixels(0) * texel_bytes) as usize;
    let texels = (0..faces as usize)
        .flat_map(|face| dds.data[face * stride as usize..][..first].chunks_exact(texel_bytes as usize))
        .map(|texel| rgb_from(extended.dxgi_format, texel))
        .collect();
    Ok(Picture {
        width,
        height: faces * height,
        texels,
        content: if is_cube { Content::Cube } else { Content::Image },
        format: format!("DDS {}, {name}, {levels} levels", if is_cube { "cube" } else { "2D" }),
        warnings: Vec::new(),
    })
}

fn rgb_from(format: DxgiFormat, texel: &[u8]) -> Rgb {
    let word = |at: usize| u32::from_le_bytes(texel[at..at + 4].try_into().expect("four bytes"));
    match format {
        DxgiFormat::R16G16B16A16_Float => {
            [0, 2, 4].map(|at| f16::from_le_bytes([texel[at], texel[at + 1]]).to_f32())
        }
        DxgiFormat::R32G32B32A32_Float => [0, 4, 8].map(|at| f32::from_bits(word(at))),
        DxgiFormat::R11G11B10_Float => rgb_from_r11g11b10(word(0)),
        _ => rgb_from_rgb9e5(word(0)),
    }
}
