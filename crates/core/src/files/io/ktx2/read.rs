//! Reads KTX2 files: RGBA16F, RGBA32F, RGB9E5, R11G11B10F and BC6H cubes and 2D images with mips,
//! uncompressed or zstd.

use super::zstandard;
use crate::common::error::Result;
use crate::files::format::Pixel;
use crate::files::io::key_values::value_of;
use crate::files::io::picture::{Source, TEXEL_BYTES};
use crate::files::io::pyramid_write::KEY as PYRAMID_KEY;
use crate::files::io::texture::{READABLE, Texture, image_bytes};
use crate::pyramid::SQUARES;
use ktx2::{Format, SupercompressionScheme};
use std::borrow::Cow;

/// Parses the header.
pub(in crate::files::io) fn open<'a>(source: &Source<'a>) -> Result<Texture<'a>> {
    // The parser does not check all offset sums for overflow; its panics are caught.
    let reader = ktx2::Reader::new(source.bytes).map_err(|error| match error {
        ktx2::ParseError::UnexpectedEnd => source.truncated("KTX2"),
        other => source.error(format!("not a readable KTX2 file: {other}")),
    })?;
    let header = reader.header();
    let is_signed = header.format == Some(Format::BC6H_SFLOAT_BLOCK);
    let stored = if is_signed { Some(Format::BC6H_UFLOAT_BLOCK) } else { header.format };
    let known = |pixel: &Pixel| pixel.in_textures().is_some_and(|own| Some(own.vulkan) == stored);
    let Some(pixel) = Pixel::ALL.into_iter().find(known) else {
        let name = stored.map_or_else(|| "a universal texture".to_owned(), |format| format!("{format:?}"));
        return Err(source.error(format!("its pixels are {name}; {READABLE}")));
    };
    if let Some(other) =
        header.supercompression_scheme.filter(|own| *own != SupercompressionScheme::Zstandard)
    {
        return Err(source.error(format!("supercompressed by {other:?}; zstd and none can be read")));
    }
    let layers = header.layer_count.max(1);
    let has_light = reader.key_value_data().any(|(key, _)| key == PYRAMID_KEY);
    if header.pixel_depth > 1 || (layers > 1 && !(has_light && header.face_count == 1 && layers == SQUARES)) {
        return Err(source.error(format!(
            "{layers} layers of depth {}; one flat layer and pyramids can be read",
            header.pixel_depth.max(1)
        )));
    }
    let (width, height) = (header.pixel_width, header.pixel_height);
    let is_cube = match header.face_count {
        1 => false,
        6 if width == height => true,
        6 => return Err(source.error(format!("cube faces of {width}x{height} are not square"))),
        other => return Err(source.error(format!("{other} faces; 1 (2D) and 6 (cube) can be read"))),
    };
    let levels = reader.levels().len();
    if levels > 32 {
        return Err(source.error(format!("{levels} levels; 32 are the most there can be")));
    }
    // Level 0 takes its decompressed bytes and its texels; all mips together take a third of that.
    let faces = if is_cube { 6 } else { u64::from(layers) };
    let mips = if levels > 1 { 2 } else { 1 };
    // Blocks take one byte a texel, at most four times that in partial blocks.
    let stored = if pixel == Pixel::Bc6h { 4 } else { image_bytes(pixel, 1, 1) as u64 };
    source.check_memory(width, height, faces * (mips * TEXEL_BYTES + stored))?;

    let pair = |(key, value): (&str, &[u8])| {
        let text = value.split(|byte| *byte == 0).next().unwrap_or_default();
        (key.to_owned(), String::from_utf8_lossy(text).into_owned())
    };
    let pairs: Vec<(String, String)> = reader.key_value_data().map(pair).collect();
    // Rows run upwards (`ru`) in OpenGL.
    let is_upwards = value_of(&pairs, "KTXorientation").is_some_and(|value| value.get(1..2) == Some("u"));
    let source = *source;
    let images = move |level: usize, visit: &mut dyn FnMut(&[u8])| {
        let side = |full: u32| (full >> level).max(1);
        let (width, height) = (side(width), side(height));
        let expected = faces as usize * image_bytes(pixel, width, height);
        let stored = reader.levels().nth(level).expect("the caller counts levels").data;
        let bytes = match header.supercompression_scheme {
            Some(_) => Cow::Owned(zstandard::decompress(stored, expected).map_err(|error| {
                source.error(format!("level {level} is corrupt: {error}; copy the file again"))
            })?),
            None => Cow::Borrowed(stored),
        };
        if bytes.len() != expected {
            return Err(source.error(format!(
                "level {level} holds {} bytes, {width}x{height} pixels take {expected}; copy the file again",
                bytes.len()
            )));
        }
        visit(&bytes);
        Ok(())
    };
    Ok(Texture {
        source,
        container: "KTX2",
        pixel,
        is_signed,
        width,
        height,
        layers,
        is_cube,
        is_bottom_up: is_upwards && !is_cube,
        levels,
        pairs,
        images: Box::new(images),
    })
}
