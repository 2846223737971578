//! OpenEXR output: single-part scan lines, half or float, ZIP.
//!
//! This module writes the container itself, after "OpenEXR File Layout" (openexr.com). The `exr` crate
//! compresses by miniz_oxide at a fixed level, which takes three to four times as long and makes larger
//! files. It also writes attributes in hash map order, so that equal inputs give different bytes. Its reader
//! accepts these files.

use super::deflate::Deflater;
use crate::common::error::{Result, wrong};
use crate::common::parallel;
use crate::files::format::{Pixel, push_halves};
use crate::light::environment::Rgb;
use std::ops::Range;

/// Rows of a ZIP block.
const BLOCK_ROWS: usize = 16;

/// Blocks compressed in parallel before they are joined; bounds memory.
const BLOCKS_AT_ONCE: usize = 64;

/// Program name and version in outputs.
pub const SOFTWARE: &str = concat!("octagloss ", env!("CARGO_PKG_VERSION"));

/// The value of a header attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// A `float`.
    Float(f32),
    /// A `string`.
    Text(String),
}

/// The attribute of a level's `roughness`, if there is one, and those of text `pairs`.
pub(in crate::files) fn attributes(
    roughness: Option<f64>,
    pairs: impl IntoIterator<Item = (impl Into<String>, impl Into<String>)>,
) -> Vec<(String, Attribute)> {
    let roughness = roughness.map(|r| ("roughness".to_owned(), Attribute::Float(r as f32)));
    let pairs = pairs.into_iter().map(|(key, text)| (key.into(), Attribute::Text(text.into())));
    roughness.into_iter().chain(pairs).collect()
}

/// Samples of a file.
#[derive(Clone, Copy, Debug)]
pub enum Samples<'a> {
    /// Channels R, G and B.
    Rgb(&'a [Rgb]),
    /// The single channel Y.
    Luminance(&'a [f32]),
}

/// Encodes an EXR file of `width` x `height` row-major samples with `attributes` in the given order. Half
/// floats are clamped to their maximum.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if the samples do not fill the image, a side is zero or above
/// 2^31, or EXR does not support `pixel`.
pub fn exr_bytes(
    width: u32,
    height: u32,
    samples: Samples<'_>,
    pixel: Pixel,
    attributes: &[(String, Attribute)],
) -> Result<Vec<u8>> {
    let image = Image { width, height, samples, pixel };
    image.check()?;
    let mut out = preamble(0);
    header_bytes(&image, (width, height), &[], attributes, &mut out);
    push_blocks(&image.scan_line_blocks(&[]), &mut out);
    Ok(out)
}

/// Magic number and version 2 with `flags`: names up to 31 bytes; without flags a single part of scan lines.
pub(super) fn preamble(flags: u32) -> Vec<u8> {
    [20_000_630_u32, 2 | flags].iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// Samples and their storage.
#[derive(Clone, Copy)]
pub(super) struct Image<'a> {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) samples: Samples<'a>,
    pub(super) pixel: Pixel,
}

impl Image<'_> {
    pub(super) fn check(&self) -> Result<()> {
        let Self { width, height, samples, pixel } = *self;
        let count = match samples {
            Samples::Rgb(texels) => texels.len(),
            Samples::Luminance(values) => values.len(),
        };
        let area = width as usize * height as usize;
        if count == 0 || count != area || i32::try_from(width.max(height)).is_err() {
            return wrong(format!("an EXR file of {width}x{height} cannot hold {count} samples"));
        }
        match pixel {
            Pixel::F16 | Pixel::F32 => Ok(()),
            _ => wrong(format!("EXR does not support {}; use f16 or f32", pixel.name())),
        }
    }

    /// Bytes of all channels of a pixel.
    const fn pixel_bytes(&self) -> usize {
        let sample = if matches!(self.pixel, Pixel::F32) { 4 } else { 2 };
        match self.samples {
            Samples::Rgb(_) => 3 * sample,
            Samples::Luminance(_) => sample,
        }
    }
}

/// Samples that are compressed together.
pub(super) struct Block<'a> {
    pub(super) image: Image<'a>,
    /// Numbers before the block in the file: part, then first row, or column and row of a tile and its level.
    pub(super) place: Vec<i32>,
    pub(super) columns: Range<usize>,
    pub(super) rows: Range<usize>,
}

impl<'a> Image<'a> {
    /// The blocks of an image in scan lines; `part` is its number in a file of several.
    pub(super) fn scan_line_blocks(self, part: &[i32]) -> Vec<Block<'a>> {
        let (columns, height) = (self.width as usize, self.height as usize);
        let block = |first: usize| Block {
            image: self,
            place: part.iter().copied().chain([first as i32]).collect(),
            columns: 0..columns,
            rows: first..(first + BLOCK_ROWS).min(height),
        };
        (0..height).step_by(BLOCK_ROWS).map(block).collect()
    }
}

/// Appends the table of offsets, and `blocks`.
pub(super) fn push_blocks(blocks: &[Block<'_>], out: &mut Vec<u8>) {
    let mut entry = out.len();
    out.resize(entry + 8 * blocks.len(), 0);
    let packer = || (Deflater::new(), Vec::new());
    for blocks in blocks.chunks(BLOCKS_AT_ONCE) {
        let packed =
            parallel::map_with(blocks, packer, |(deflater, scratch), block| block.packed(deflater, scratch));
        for bytes in packed {
            let offset = out.len() as u64;
            out[entry..][..8].copy_from_slice(&offset.to_le_bytes());
            entry += 8;
            out.extend(bytes);
        }
    }
}

impl Block<'_> {
    /// Its place, length and compressed samples.
    fn packed(&self, deflater: &mut Deflater, scratch: &mut Vec<u8>) -> Vec<u8> {
        let Self { image, place, columns, rows } = self;
        let mut raw = Vec::with_capacity(rows.len() * columns.len() * image.pixel_bytes());
        for row in rows.clone() {
            let start = row * image.width as usize;
            push_row(image.samples, start + columns.start..start + columns.end, image.pixel, &mut raw);
        }
        let mut out: Vec<u8> = place.iter().flat_map(|word| word.to_le_bytes()).collect();
        let size_at = out.len();
        out.extend([0; 4]);
        zip_block(&raw, deflater, scratch, &mut out);
        let size = (out.len() - size_at - 4) as i32;
        out[size_at..][..4].copy_from_slice(&size.to_le_bytes());
        out
    }
}

/// Appends one row, channel by channel in the order of their names: B, G, R.
fn push_row(samples: Samples<'_>, row: Range<usize>, pixel: Pixel, out: &mut Vec<u8>) {
    let mut push = |values: &[f32]| match pixel {
        Pixel::F32 => out.extend(values.iter().flat_map(|v| v.to_le_bytes())),
        _ => push_halves(values, out),
    };
    match samples {
        Samples::Luminance(values) => push(&values[row]),
        Samples::Rgb(texels) => {
            for channel in [2, 1, 0] {
                let values: Vec<f32> = texels[row.clone()].iter().map(|t| t[channel]).collect();
                push(&values);
            }
        }
    }
}

/// Appends `raw` with EXR's ZIP compression: even bytes, then odd bytes, delta-encoded, then zlib; stored raw
/// if that is not smaller.
fn zip_block(raw: &[u8], deflater: &mut Deflater, scratch: &mut Vec<u8>, out: &mut Vec<u8>) {
    scratch.clear();
    scratch.extend(raw.iter().step_by(2));
    scratch.extend(raw.iter().skip(1).step_by(2));
    for at in (1..scratch.len()).rev() {
        scratch[at] = scratch[at].wrapping_sub(scratch[at - 1]).wrapping_add(128);
    }
    let start = out.len();
    // One byte less than raw: without a gain the block stays raw.
    out.resize(start + raw.len() - 1, 0);
    match deflater.deflate(scratch, &mut out[start..]) {
        Some(size) => out.truncate(start + size),
        None => {
            out.truncate(start);
            out.extend(raw);
        }
    }
}

/// Appends the header of `image` in a display window of `display` columns and rows: the common attributes,
/// those its kind requires (`required`: name, type and value), and `attributes`.
pub(super) fn header_bytes(
    image: &Image<'_>,
    display: (u32, u32),
    required: &[(&str, &str, &[u8])],
    attributes: &[(String, Attribute)],
    out: &mut Vec<u8>,
) {
    let Image { width, height, samples, pixel } = *image;
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        for text in [name, kind] {
            out.extend(text.as_bytes());
            out.push(0);
        }
        out.extend((value.len() as i32).to_le_bytes());
        out.extend(value);
    };

    let names: &[&str] = match samples {
        Samples::Rgb(_) => &["B", "G", "R"],
        Samples::Luminance(_) => &["Y"],
    };
    let kind: i32 = if pixel == Pixel::F32 { 2 } else { 1 };
    let mut channels = Vec::new();
    for name in names {
        channels.extend(name.as_bytes());
        channels.push(0);
        // Sample type, perceptual linearity and three reserved bytes, sampling in x and in y.
        for word in [kind, 0, 1, 1] {
            channels.extend(word.to_le_bytes());
        }
    }
    channels.push(0);
    let window = |(width, height): (u32, u32)| -> Vec<u8> {
        [0, 0, width as i32 - 1, height as i32 - 1].iter().flat_map(|v: &i32| v.to_le_bytes()).collect()
    };

    attribute("channels", "chlist", &channels);
    attribute("compression", "compression", &[3]);
    attribute("dataWindow", "box2i", &window((width, height)));
    attribute("displayWindow", "box2i", &window(display));
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1_f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1_f32.to_le_bytes());
    attribute("software", "string", SOFTWARE.as_bytes());
    for (name, kind, value) in required {
        attribute(name, kind, value);
    }
    for (name, value) in attributes {
        match value {
            Attribute::Float(value) => attribute(name, "float", &value.to_le_bytes()),
            Attribute::Text(text) => attribute(name, "string", text.as_bytes()),
        }
    }
    out.push(0);
}
