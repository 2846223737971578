//! Reads KTX 1 files: little-endian RGBA16F, RGBA32F, RGB9E5 and R11G11B10F cubes with mips, as written by
//! `bake` and cmgen.
//!
//! "KTX File Format Specification" (Khronos, version 1.0). No maintained crate reads it.

use super::write::MAGIC;
use crate::chain::{Chain, Level};
use crate::environment::Rgb;
use crate::error::Result;
use crate::io::cmgen;
use crate::io::key_values::value_of;
use crate::io::ktx2::read::{Pixel, parse_roughness, texels_from};
use crate::io::ktx2::write::ROUGHNESS_KEY;
use crate::io::layout::Content;
use crate::io::picture::{Picture, Stored, check_finite};
use crate::io::provenance::Provenance;
use crate::io::source::{Source, TEXEL_BYTES};

/// Key of the harmonics that cmgen writes.
const CMGEN_KEY: &str = "sh";

/// Header words after the magic number.
const WORDS: usize = 13;

/// A parsed file with all its levels.
struct Texture<'a> {
    source: Source<'a>,
    pixel: Pixel,
    size: u32,
    pairs: Vec<(String, String)>,
    /// The six faces of each level.
    levels: Vec<&'a [u8]>,
}

/// Decodes level 0.
pub(in crate::io) fn decode_level0(source: &Source<'_>) -> Result<Picture> {
    let texture = Texture::open(source)?;
    Ok(Picture {
        width: texture.size,
        height: 6 * texture.size,
        texels: texture.level(0),
        content: Content::Cube,
        map: None,
        format: texture.format(),
        warnings: Vec::new(),
        provenance: texture.provenance()?,
    })
}

/// The harmonics in Filament's key, as text.
pub(in crate::io) fn harmonics(source: &Source<'_>) -> Result<Option<String>> {
    Ok(Texture::open(source)?.text(CMGEN_KEY))
}

/// Decodes every level with its roughness; takes a file with cmgen's key and several levels, but without
/// their roughness, for its.
pub(in crate::io) fn decode_chain(source: &Source<'_>) -> Result<Stored> {
    let texture = Texture::open(source)?;
    let count = texture.levels.len();
    let of_cmgen = texture.text(ROUGHNESS_KEY).is_none() && texture.text(CMGEN_KEY).is_some() && count > 1;
    let roughness = if of_cmgen {
        cmgen::roughness(count as u32, texture.size).collect()
    } else {
        parse_roughness(source, &|key| texture.text(key), count)?
    };
    let mut levels = Vec::new();
    for (level, roughness) in (0u32..).zip(roughness) {
        let (size, texels) = ((texture.size >> level).max(1), texture.level(level as usize));
        check_finite(source.path, level, size, &texels)?;
        levels.push(Level::cube(size, roughness, texels));
    }
    let provenance = if of_cmgen { cmgen::provenance() } else { texture.provenance()? };
    let warnings = if of_cmgen { vec![cmgen::warning(count)] } else { Vec::new() };
    Ok(Stored { chain: Chain { levels }, provenance, format: texture.format(), warnings })
}

impl<'a> Texture<'a> {
    fn open(source: &Source<'a>) -> Result<Self> {
        let mut rest = Rest { source, bytes: source.bytes.get(MAGIC.len()..).unwrap_or_default() };
        let mut words = [0_u32; WORDS];
        for word in &mut words {
            *word = rest.word()?;
        }
        let [order, kind, _, format, internal, _, width, height, depth, layers, faces, levels, pairs] = words;
        if order != 0x0403_0201 {
            return Err(source.error("a big-endian KTX file; convert it to little-endian"));
        }
        let pixel = match (internal, kind, format) {
            // Filament and cmgen write the internal format as the type.
            (0x8c3a, 0x8c3a | 0x8c3b, 0x1907) => Pixel::R11G11B10F,
            (0x8c3d, 0x8c3e, 0x1907) => Pixel::Rgb9E5,
            (0x881a, 0x140b, 0x1908) => Pixel::Rgba16F,
            (0x8814, 0x1406, 0x1908) => Pixel::Rgba32F,
            _ => {
                return Err(source.error(format!(
                    "its pixels are glInternalFormat {internal:#06x} of glType {kind:#06x}; RGBA16F, \
                     RGBA32F, RGB9E5 and R11G11B10F can be read from KTX"
                )));
            }
        };
        if faces != 6 || width != height || depth > 1 || layers > 0 {
            return Err(source.error(format!(
                "{width}x{height}, depth {depth}, {layers} layers of {faces} faces; a single cube can be \
                 read from KTX"
            )));
        }
        source.check_memory(width, 1, 0)?;
        let levels = levels.max(1);
        if levels > width.ilog2() + 1 {
            return Err(source.error(format!("{levels} levels are more than a cube of {width} can have")));
        }
        source.check_memory(width, height, 6 * 2 * TEXEL_BYTES)?;
        let pairs = pairs_of(source, rest.take(pairs as usize)?)?;
        let mut stored = Vec::new();
        for level in 0..levels {
            let size = (width >> level).max(1);
            let face = pixel.bytes(size, size);
            let said = rest.word()?;
            if said as usize != face {
                return Err(source.error(format!(
                    "level {level} has faces of {said} bytes; {size}x{size} pixels take {face}, copy it again"
                )));
            }
            // Pixels are multiples of four bytes, so there is no padding.
            stored.push(rest.take(6 * face)?);
        }
        Ok(Self { source: *source, pixel, size: width, pairs, levels: stored })
    }

    fn level(&self, level: usize) -> Vec<Rgb> {
        texels_from(self.pixel, self.levels[level])
    }

    fn text(&self, key: &str) -> Option<String> {
        value_of(&self.pairs, key)
    }

    fn provenance(&self) -> Result<Provenance> {
        Provenance::of_texts(&|key| self.text(key)).map_err(|message| self.source.error(message))
    }

    /// Such as `KTX cube, R11G11B10F, 5 levels`.
    fn format(&self) -> String {
        format!("KTX cube, {}, {} levels", self.pixel.name(), self.levels.len())
    }
}

/// The unread bytes.
struct Rest<'s, 'a> {
    source: &'s Source<'a>,
    bytes: &'a [u8],
}

impl<'a> Rest<'_, 'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let Some((taken, rest)) = self.bytes.split_at_checked(count) else {
            let length = self.source.bytes.len();
            return Err(self
                .source
                .error(format!("truncated: the KTX data ends after {length} bytes; copy it again")));
        };
        self.bytes = rest;
        Ok(taken)
    }

    fn word(&mut self) -> Result<u32> {
        Ok(u32::from_le_bytes(self.take(4)?.try_into().expect("four bytes")))
    }
}

/// Parses key/value pairs, each preceded by its length and padded to four bytes.
fn pairs_of<'a>(source: &Source<'a>, bytes: &'a [u8]) -> Result<Vec<(String, String)>> {
    let mut rest = Rest { source, bytes };
    let mut pairs = Vec::new();
    while !rest.bytes.is_empty() {
        let length = rest.word()? as usize;
        let pair = rest.take(length)?;
        rest.take((length.next_multiple_of(4) - length).min(rest.bytes.len()))?;
        let mut texts = pair.splitn(2, |byte| *byte == 0).map(|text| String::from_utf8_lossy(text));
        if let (Some(key), Some(value)) = (texts.next(), texts.next()) {
            pairs.push((key.into_owned(), value.trim_end_matches('\0').to_owned()));
        }
    }
    Ok(pairs)
}
