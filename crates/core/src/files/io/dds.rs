//! DDS files with the DX10 header: RGBA16F, RGBA32F, RGB9E5, R11G11B10F and BC6H cubes and 2D images, read;
//! cubes with their levels, written, laid out by the `ddsfile` crate.
//!
//! "Programming Guide for DDS" (Microsoft): faces in order, each with all its levels.

use crate::common::error::{Error, Result, wrong};
use crate::files::format::Pixel;
use crate::files::format::texel_bytes::texel_bytes;
use crate::files::io::LoadedChain;
use crate::files::io::cube_write::check_sizes;
use crate::files::io::picture::{Source, TEXEL_BYTES};
use crate::files::io::provenance::FLIP_KEY;
use crate::files::io::texture::{READABLE, Texture, image_bytes};
use crate::files::target::Flip;
use crate::light::chain::Level;
use ddsfile::{AlphaMode, Caps2, D3D10ResourceDimension, Dds, DxgiFormat, MiscFlag, NewDxgiParams};

/// Decodes every level of a cube. The file does not store their `roughness`.
pub(super) fn decode_chain(source: &Source<'_>, roughness: &[f64]) -> Result<LoadedChain> {
    let texture = open(source)?;
    if texture.is_cube && roughness.len() != texture.levels {
        return Err(source.error(format!(
            "it has {} levels, its report lists {}; bake it again",
            texture.levels,
            roughness.len()
        )));
    }
    texture.chain(roughness.iter().copied())
}

/// Parses the header and checks that all texels are there.
pub(super) fn open<'a>(source: &Source<'a>) -> Result<Texture<'a>> {
    // The crate copies the file's bytes.
    source.check_memory(1, 1, source.bytes.len() as u64)?;
    let dds = Dds::read(source.bytes).map_err(|error| source.decoder_error("DDS", &error))?;
    let Some(extended) = &dds.header10 else {
        return Err(source.error("a DDS file without the DX10 header; save it with a DXGI format"));
    };
    let is_signed = extended.dxgi_format == DxgiFormat::BC6H_SF16;
    let stored = if is_signed { DxgiFormat::BC6H_UF16 } else { extended.dxgi_format };
    let known = |pixel: &Pixel| pixel.in_textures().is_some_and(|own| own.dxgi == stored);
    let Some(pixel) = Pixel::ALL.into_iter().find(known) else {
        return Err(source.error(format!("its pixels are {stored:?}; {READABLE}")));
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
    // A texel takes at most 16 bytes, a texel of a partial block at most four.
    source.check_memory(width, height, u64::from(faces) * (TEXEL_BYTES + 16))?;
    if levels > width.max(height).ilog2() + 1 {
        return Err(source.error(format!("{levels} levels are more than {width}x{height} can have")));
    }
    // Each face stores its levels, the largest first.
    let end = move |level: u32| -> usize {
        (0..level).map(|k| image_bytes(pixel, (width >> k).max(1), (height >> k).max(1))).sum()
    };
    let (levels, face_bytes) = (levels as usize, end(levels));
    let needed = u64::from(faces) * face_bytes as u64;
    if needed > dds.data.len() as u64 {
        return Err(source.error(format!(
            "truncated: {faces} faces of {levels} levels take {needed} bytes, it has {}; copy it again",
            dds.data.len()
        )));
    }
    let flip = marked_flip(source.bytes);
    let images = move |level: usize, visit: &mut dyn FnMut(&[u8])| {
        let (from, to) = (end(level as u32), end(level as u32 + 1));
        dds.data.chunks_exact(face_bytes).take(faces as usize).for_each(|face| visit(&face[from..to]));
        Ok(())
    };
    Ok(Texture {
        source: *source,
        container: "DDS",
        pixel,
        is_signed,
        width,
        height,
        layers: 1,
        is_cube,
        is_bottom_up: false,
        levels,
        // The flip is in the writer's mark.
        pairs: flip.map(|flip| (FLIP_KEY.to_owned(), flip.name().to_owned())).into_iter().collect(),
        images: Box::new(images),
    })
}

/// A DDS cube map of `levels`, flipped by `flip`: RGBA16F, RGBA32F, RGB9E5, R11G11B10F or BC6H (unsigned).
///
/// # Errors
/// [`Error::Parameter`] for no levels or sizes that do not halve.
pub(super) fn dds_bytes(levels: &[Level], pixel: Pixel, flip: Flip) -> Result<Vec<u8>> {
    let size = check_sizes("DDS", levels)?;
    let Some(format) = pixel.in_textures().map(|own| own.dxgi) else {
        return wrong(format!("dds files cannot hold {}", pixel.name()));
    };
    let failed = |error: ddsfile::Error| Error::Parameter(format!("a DDS cube of {size}: {error}"));
    let mut dds = Dds::new_dxgi(NewDxgiParams {
        height: size,
        width: size,
        depth: None,
        format,
        mipmap_levels: Some(levels.len() as u32),
        array_layers: Some(6),
        // The crate sets only the DX10 header's flag; older readers use these.
        caps2: Some(Caps2::CUBEMAP | Caps2::CUBEMAP_ALLFACES),
        is_cubemap: true,
        resource_dimension: D3D10ResourceDimension::Texture2D,
        alpha_mode: AlphaMode::Opaque,
    })
    .map_err(failed)?;
    let levels: Vec<Vec<u8>> =
        levels.iter().map(|level| texel_bytes(level.size(), &level.texels, pixel)).collect();
    dds.data.clear();
    for face in 0..6 {
        for level in &levels {
            let length = level.len() / 6;
            dds.data.extend(&level[face * length..][..length]);
        }
    }
    let mut bytes = Vec::with_capacity(dds.data.len() + 148);
    dds.write(&mut bytes).map_err(failed)?;
    let (mark, word) = bytes[MARK_AT..].split_at_mut(MARK.len());
    mark.copy_from_slice(MARK);
    word[..4].fill(0);
    word[..flip.name().len()].copy_from_slice(flip.name().as_bytes());
    Ok(bytes)
}

/// Offset of `dwReserved1`, eleven words that no reader uses, after the magic number and seven words.
const MARK_AT: usize = 32;

/// The program's mark, followed by the flip's name. Other encoders store their names there too.
const MARK: &[u8; 4] = b"OCTG";

/// Reads the flip from the program's mark.
fn marked_flip(file: &[u8]) -> Option<Flip> {
    let word = file.get(MARK_AT..)?.strip_prefix(MARK)?.get(..4)?;
    Flip::named(std::str::from_utf8(word).ok()?.trim_end_matches('\0'))
}
