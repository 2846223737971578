//! KTX 1 files: little-endian RGBA16F, RGBA32F, RGB9E5 and R11G11B10F cubes with mips, read as `bake` and
//! cmgen write them, and written as Filament reads them.
//!
//! "KTX File Format Specification" (Khronos, version 1.0), which no maintained crate reads, and Filament's
//! libs/image/src/Ktx1Bundle.cpp and libs/ktxreader/src/Ktx1Reader.cpp for the further requirements of its
//! reader.

use crate::common::error::{Error, Result, wrong};
use crate::files::format::Pixel;
use crate::files::format::texel_bytes::texel_bytes;
use crate::files::io::cube_write::check_sizes;
use crate::files::io::key_values::{key_value_bytes, value_of};
use crate::files::io::ktx2::write::{ROUGHNESS_KEY, roughness_text};
use crate::files::io::picture::{Source, TEXEL_BYTES};
use crate::files::io::texture::{Texture, image_bytes};
use crate::files::io::{LoadedChain, cmgen};
use crate::light::chain::Level;

/// Key of the harmonics that cmgen writes.
const CMGEN_KEY: &str = "sh";

/// Header words after the magic number.
const WORDS: usize = 13;

/// The harmonics in Filament's key, as text.
pub(super) fn harmonics(source: &Source<'_>) -> Result<Option<String>> {
    Ok(value_of(&open(source)?.pairs, CMGEN_KEY).map(str::to_owned))
}

/// Decodes every level with its roughness. A file with cmgen's key and several levels, but no roughness, is
/// taken for one that cmgen wrote.
pub(super) fn decode_chain(source: &Source<'_>) -> Result<LoadedChain> {
    let texture = open(source)?;
    let (count, has) = (texture.levels, |key| value_of(&texture.pairs, key).is_some());
    if has(ROUGHNESS_KEY) || !has(CMGEN_KEY) || count == 1 {
        return texture.chain(texture.roughness()?);
    }
    let chain = texture.chain(cmgen::roughness(count as u32, texture.width))?;
    Ok(LoadedChain { provenance: cmgen::provenance(), warnings: vec![cmgen::warning(count)], ..chain })
}

/// Parses the header and finds all levels.
pub(super) fn open<'a>(source: &Source<'a>) -> Result<Texture<'a>> {
    let mut rest = Rest { source, bytes: source.bytes.get(MAGIC.len()..).unwrap_or_default() };
    let mut words = [0_u32; WORDS];
    for word in &mut words {
        *word = rest.word()?;
    }
    let [order, kind, _, format, internal, _, width, height, depth, layers, faces, levels, pairs] = words;
    if order != 0x0403_0201 {
        return Err(source.error("a big-endian KTX file; convert it to little-endian"));
    }
    // Filament and cmgen write the internal format of R11G11B10F as the type.
    let kind = if (internal, kind) == (0x8c3a, 0x8c3b) { internal } else { kind };
    let is_stored = |pixel: &Pixel| {
        pixel.gl().is_some_and(|gl| (gl.internal, gl.kind, gl.format) == (internal, kind, format))
    };
    let Some(pixel) = Pixel::ALL.into_iter().find(is_stored) else {
        return Err(source.error(format!(
            "its pixels are glInternalFormat {internal:#06x} of glType {kind:#06x}; RGBA16F, RGBA32F, RGB9E5 \
             and R11G11B10F can be read from KTX"
        )));
    };
    if faces != 6 || width != height || depth > 1 || layers > 0 {
        return Err(source.error(format!(
            "{width}x{height}, depth {depth}, {layers} layers of {faces} faces; a single cube can be read \
             from KTX"
        )));
    }
    source.check_memory(width, 1, 0)?;
    let levels = levels.max(1);
    if levels > width.ilog2() + 1 {
        return Err(source.error(format!("{levels} levels are more than a cube of {width} can have")));
    }
    source.check_memory(width, height, 6 * 2 * TEXEL_BYTES)?;
    let pairs = pairs_of(source, rest.take(pairs as usize)?)?;
    let mut stored: Vec<&[u8]> = Vec::new();
    for level in 0..levels {
        let size = (width >> level).max(1);
        let face = image_bytes(pixel, size, size);
        let said = rest.word()?;
        if said as usize != face {
            return Err(source.error(format!(
                "level {level} has faces of {said} bytes; {size}x{size} pixels take {face}, copy it again"
            )));
        }
        // Pixels are multiples of four bytes, so there is no padding.
        stored.push(rest.take(6 * face)?);
    }
    Ok(Texture {
        source: *source,
        container: "KTX",
        pixel,
        is_signed: false,
        width,
        height,
        layers: 1,
        is_cube: true,
        is_bottom_up: false,
        levels: stored.len(),
        pairs,
        images: Box::new(move |level, visit| {
            visit(stored[level]);
            Ok(())
        }),
    })
}

/// The unread bytes.
struct Rest<'s, 'a> {
    source: &'s Source<'a>,
    bytes: &'a [u8],
}

impl<'a> Rest<'_, 'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let Some((taken, rest)) = self.bytes.split_at_checked(count) else {
            return Err(self.source.truncated("KTX"));
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

/// Magic number.
pub(super) const MAGIC: [u8; 12] = *b"\xabKTX 11\xbb\r\n\x1a\n";

/// Encodes `levels` as a KTX 1 cube map: R11G11B10F, RGB9E5, RGBA16F or RGBA32F. `metadata` are text
/// key/value pairs.
///
/// # Errors
/// [`Error::Parameter`] for no levels or sizes that do not halve, for BC6H, and for keys that are empty,
/// duplicated or contain a NUL.
pub fn ktx1_bytes(levels: &[Level], pixel: Pixel, metadata: &[(String, String)]) -> Result<Vec<u8>> {
    let size = check_sizes("KTX", levels)?;
    let Some(gl) = pixel.gl() else {
        return wrong(format!(
            "KTX 1 does not support {}; use ktx2 or dds, or r11g11b10f, rgb9e5, f16 or f32",
            pixel.name()
        ));
    };
    let roughness = roughness_text(levels.iter().map(|level| level.roughness));
    let metadata = metadata.iter().map(|(key, value)| (key.as_str(), value.as_str()));
    let pairs: Vec<_> = metadata.chain([(ROUGHNESS_KEY, roughness.as_str())]).collect();
    let pairs = key_value_bytes("KTX", &pairs)?;
    let images = levels.iter().map(|level| 4 + 6 * image_bytes(pixel, level.size(), level.size()));
    let mut bytes = Vec::with_capacity(MAGIC.len() + 4 * WORDS + pairs.len() + images.sum::<usize>());
    bytes.extend(MAGIC);
    let header = [
        0x0403_0201, // little endian
        gl.kind,
        gl.kind_bytes,
        gl.format,
        gl.internal,
        gl.format,
        size,
        size,
        0, // depth
        0, // array elements: not an array
        6,
        levels.len() as u32,
        pairs.len() as u32,
    ];
    bytes.extend(header.iter().flat_map(|word: &u32| word.to_le_bytes()));
    bytes.extend(pairs);
    for (index, level) in levels.iter().enumerate() {
        let texels = texel_bytes(level.size(), &level.texels, pixel);
        // For a non-array cube imageSize is that of one face. Texels are multiples of four bytes, so there is
        // no padding.
        let face = u32::try_from(texels.len() / 6).map_err(|_| {
            Error::Parameter(format!("level {index} is larger than the 4 GiB a KTX face may have"))
        })?;
        bytes.extend(face.to_le_bytes());
        bytes.extend(texels);
    }
    Ok(bytes)
}
