//! Several images in one OpenEXR file: as parts, or as the levels of a tiled MIP map.
//!
//! "OpenEXR File Layout" and "Technical Introduction to OpenEXR" (openexr.com): parts share their display
//! window, chunks store their part number, and a MIP map halves down to one pixel.

use super::write::{Attribute, Block, Image, Samples, attributes, header_bytes, preamble, push_blocks};
use crate::common::error::{Result, wrong};
use crate::files::format::Pixel;
use crate::files::io::ktx2::write::{ROUGHNESS_KEY, roughness_text};
use crate::light::chain::Level;
use crate::light::environment::{Layout, Rgb};
/// Flags of the version field.
const TILED: u32 = 0x200;
const SEVERAL_PARTS: u32 = 0x1000;

/// Edge of a tile.
const TILE: u32 = 64;

/// One image of a multi-part file.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// Its name, non-empty and unique.
    pub name: String,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Row-major.
    pub texels: &'a [Rgb],
    /// Its header attributes, in order.
    pub attributes: Vec<(String, Attribute)>,
}

/// Encodes an EXR file of `parts`: scan lines in ZIP blocks of half floats (clamped to their maximum) or
/// floats. The display window is that of the largest part.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for no parts, empty or duplicate names, texels that do not fill
/// their image, and pixel formats that EXR does not support.
pub(crate) fn exr_parts_bytes(parts: &[Part<'_>], pixel: Pixel) -> Result<Vec<u8>> {
    let display = (
        parts.iter().map(|part| part.width).max().unwrap_or(0),
        parts.iter().map(|part| part.height).max().unwrap_or(0),
    );
    if parts.is_empty() {
        return wrong("an EXR file needs at least one part");
    }
    let mut out = preamble(SEVERAL_PARTS);
    let mut blocks = Vec::new();
    for (index, part) in (0..).zip(parts) {
        let double = parts[..index as usize].iter().any(|other| other.name == part.name);
        if part.name.is_empty() || double {
            return wrong(format!("{:?} cannot be the name of an EXR part, or is a duplicate", part.name));
        }
        let image =
            Image { width: part.width, height: part.height, samples: Samples::Rgb(part.texels), pixel };
        image.check()?;
        let own = image.scan_line_blocks(&[index]);
        let required: [(&str, &str, &[u8]); 3] = [
            ("name", "string", part.name.as_bytes()),
            ("type", "string", b"scanlineimage"),
            ("chunkCount", "int", &(own.len() as i32).to_le_bytes()),
        ];
        header_bytes(&image, display, &required, &part.attributes, &mut out);
        blocks.extend(own);
    }
    // An empty header ends the list.
    out.push(0);
    push_blocks(&blocks, &mut out);
    Ok(out)
}

/// Encodes a tiled EXR file with the MIP levels `levels`, panoramas whose sides halve, rounded down, to one
/// texel, with each level's roughness and `metadata` in attributes.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for other levels, and for pixel formats that EXR does not
/// support.
pub(crate) fn mips_bytes(levels: &[Level], pixel: Pixel, metadata: &[(String, String)]) -> Result<Vec<u8>> {
    let Some(Layout::Panorama { width, height }) = levels.first().map(|level| level.layout) else {
        return wrong("a lat-long MIP map is made of panoramas");
    };
    let needed = width.max(height).checked_ilog2().map_or(0, |log2| log2 as usize + 1);
    if levels.len() != needed {
        return wrong(format!(
            "a MIP map of {width}x{height} has {needed} levels, not {}; omit `levels`",
            levels.len()
        ));
    }
    let images: Vec<Image<'_>> = (0_u32..)
        .zip(levels)
        .map(|(number, level)| {
            let side = |full: u32| (full >> number).max(1);
            Image { width: side(width), height: side(height), samples: Samples::Rgb(&level.texels), pixel }
        })
        .collect();
    images.iter().try_for_each(Image::check)?;
    let roughness = roughness_text(levels.iter().map(|level| level.roughness));
    let roughness = (ROUGHNESS_KEY.to_owned(), roughness);
    let attributes = attributes(None, std::iter::once(roughness).chain(metadata.iter().cloned()));
    let mut out = preamble(TILED);
    // Tile edges, then the mode: MIP levels, sizes rounded down.
    let tiles: Vec<u8> = TILE.to_le_bytes().into_iter().chain(TILE.to_le_bytes()).chain([1]).collect();
    header_bytes(&images[0], (width, height), &[("tiles", "tiledesc", &tiles)], &attributes, &mut out);
    let mut blocks = Vec::new();
    for (level, image) in (0_i32..).zip(&images) {
        let span = |tile: u32, side: u32| (tile * TILE) as usize..((tile + 1) * TILE).min(side) as usize;
        for (y, x) in (0..image.height.div_ceil(TILE))
            .flat_map(|y| (0..image.width.div_ceil(TILE)).map(move |x| (y, x)))
        {
            blocks.push(Block {
                image: *image,
                place: vec![x as i32, y as i32, level, level],
                columns: span(x, image.width),
                rows: span(y, image.height),
            });
        }
    }
    push_blocks(&blocks, &mut out);
    Ok(out)
}
