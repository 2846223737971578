//! Reads KTX2 files: RGBA16F, RGBA32F, RGB9E5, R11G11B10F and BC6H cubes and 2D images with mips,
//! uncompressed or zstd.

use super::write::ROUGHNESS_KEY;
use super::zstandard;
use crate::chain::{Chain, Level};
use crate::environment::Rgb;
use crate::error::Result;
use crate::format::bc6h;
use crate::format::r11g11b10::rgb_from_r11g11b10;
use crate::format::rgb_from_rgb9e5;
use crate::io::layout::Content;
use crate::io::map_header::MapHeader;
use crate::io::picture::{Picture, Stored};
use crate::io::provenance::Provenance;
use crate::io::source::{Source, TEXEL_BYTES};
use half::slice::HalfFloatSliceExt as _;
use ktx2::{Format, SupercompressionScheme};
use std::borrow::Cow;

/// A parsed file with a valid header.
struct KtxFile<'a> {
    source: Source<'a>,
    reader: ktx2::Reader<&'a [u8]>,
    width: u32,
    height: u32,
    pixel: Pixel,
    is_cube: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::io) enum Pixel {
    Rgba16F,
    Rgba32F,
    Rgb9E5,
    R11G11B10F,
    Bc6h { signed: bool },
}

impl Pixel {
    /// Bytes of an image of `width` x `height`.
    pub(in crate::io) fn bytes(self, width: u32, height: u32) -> usize {
        let texel = match self {
            Self::Rgba16F => 8,
            Self::Rgba32F => 16,
            Self::Rgb9E5 | Self::R11G11B10F => 4,
            Self::Bc6h { .. } => return bc6h::image_length(width, height),
        };
        width as usize * height as usize * texel
    }

    pub(in crate::io) const fn name(self) -> &'static str {
        match self {
            Self::Rgba16F => "RGBA16F",
            Self::Rgba32F => "RGBA32F",
            Self::Rgb9E5 => "RGB9E5",
            Self::R11G11B10F => "R11G11B10F",
            Self::Bc6h { .. } => "BC6H",
        }
    }
}

/// Decodes level 0.
pub(in crate::io) fn decode_level0(source: &Source<'_>) -> Result<Picture> {
    let container = KtxFile::open(source)?;
    let map = if container.is_cube { None } else { MapHeader::of_texts(source, &|key| container.text(key))? };
    Ok(Picture {
        width: container.width,
        height: if container.is_cube { 6 * container.width } else { container.height },
        texels: container.level(0)?,
        content: if container.is_cube { Content::Cube } else { Content::Image },
        map,
        format: container.format(),
        warnings: Vec::new(),
        provenance: container.provenance()?,
    })
}

/// Decodes every level of a cube with its roughness.
pub(in crate::io) fn decode_chain(source: &Source<'_>) -> Result<Stored> {
    if !source.bytes.starts_with(&ktx2::MAGIC) {
        return Err(source.error("not a KTX2 file; a chain is a KTX2 cube or a level folder"));
    }
    let container = KtxFile::open(source)?;
    if !container.is_cube {
        return Err(source.error("it holds a 2D image; a chain is a cube"));
    }
    let roughness = parse_roughness(source, &|key| container.text(key), container.reader.levels().len())?;
    let levels = (0u32..)
        .zip(roughness)
        .map(|(level, roughness)| {
            let size = (container.width >> level).max(1);
            let texels = container.level(level as usize)?;
            crate::io::picture::check_finite(source.path, level, size, &texels)?;
            Ok(Level::cube(size, roughness, texels))
        })
        .collect::<Result<_>>()?;
    let (provenance, format) = (container.provenance()?, container.format());
    Ok(Stored { chain: Chain { levels }, provenance, format, warnings: Vec::new() })
}

impl<'a> KtxFile<'a> {
    /// Such as `KTX2 cube, RGBA16F, 9 levels`.
    fn format(&self) -> String {
        let kind = if self.is_cube { "cube" } else { "2D" };
        format!("KTX2 {kind}, {}, {} levels", self.pixel.name(), self.reader.levels().len())
    }

    /// Origin recorded in the key/value pairs.
    fn provenance(&self) -> Result<Provenance> {
        Provenance::of_texts(&|key| self.text(key)).map_err(|message| self.source.error(message))
    }

    fn open(source: &Source<'a>) -> Result<Self> {
        // The parser does not check all offset sums for overflow; its panics are caught.
        let reader = ktx2::Reader::new(source.bytes).map_err(|error| match error {
            ktx2::ParseError::UnexpectedEnd => source.error(format!(
                "truncated: the KTX2 data ends after {} bytes; copy it again",
                source.bytes.len()
            )),
            other => source.error(format!("not a readable KTX2 file: {other}")),
        })?;
        let header = reader.header();
        let pixel = match header.format {
            Some(Format::R16G16B16A16_SFLOAT) => Pixel::Rgba16F,
            Some(Format::R32G32B32A32_SFLOAT) => Pixel::Rgba32F,
            Some(Format::E5B9G9R9_UFLOAT_PACK32) => Pixel::Rgb9E5,
            Some(Format::B10G11R11_UFLOAT_PACK32) => Pixel::R11G11B10F,
            Some(Format::BC6H_UFLOAT_BLOCK) => Pixel::Bc6h { signed: false },
            Some(Format::BC6H_SFLOAT_BLOCK) => Pixel::Bc6h { signed: true },
            other => {
                let name =
                    other.map_or_else(|| "a universal texture".to_owned(), |format| format!("{format:?}"));
                return Err(source.error(format!(
                    "its pixels are {name}; RGBA16F, RGBA32F, RGB9E5, R11G11B10F and BC6H can be read"
                )));
            }
        };
        match header.supercompression_scheme {
            None | Some(SupercompressionScheme::Zstandard) => {}
            Some(other) => {
                return Err(source.error(format!("supercompressed by {other:?}; zstd and none can be read")));
            }
        }
        if header.pixel_depth > 1 || header.layer_count > 1 {
            return Err(source.error(format!(
                "{} layers of depth {}; one flat layer can be read",
                header.layer_count.max(1),
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
        if reader.levels().len() > 32 {
            return Err(
                source.error(format!("{} levels; 32 are the most there can be", reader.levels().len()))
            );
        }
        // Level 0 takes its decompressed bytes and its texels; all mips together take a third of that.
        let faces = if is_cube { 6 } else { 1 };
        let mips = if reader.levels().len() > 1 { 2 } else { 1 };
        // Blocks take one byte a texel, at most four times that in partial blocks.
        let stored = if matches!(pixel, Pixel::Bc6h { .. }) { 4 } else { pixel.bytes(1, 1) as u64 };
        source.check_memory(width, height, faces * (mips * TEXEL_BYTES + stored))?;
        Ok(Self { source: *source, reader, width, height, pixel, is_cube })
    }

    /// Decodes the texels of one level, face by face.
    fn level(&self, level: usize) -> Result<Vec<Rgb>> {
        let side = |full: u32| (full >> level).max(1);
        let (width, height) = (side(self.width), side(self.height));
        let faces = if self.is_cube { 6 } else { 1 };
        let image = self.pixel.bytes(width, height);
        let expected = faces * image;
        let stored = self.reader.levels().nth(level).expect("the caller counts levels").data;
        let zstd = self.reader.header().supercompression_scheme.is_some();
        let bytes = if zstd {
            Cow::Owned(zstandard::decompress(stored, expected).map_err(|error| {
                self.source.error(format!("level {level} is corrupt: {error}; copy the file again"))
            })?)
        } else {
            Cow::Borrowed(stored)
        };
        if bytes.len() != expected {
            return Err(self.source.error(format!(
                "level {level} holds {} bytes, {width}x{height} pixels take {expected}; copy the file again",
                bytes.len()
            )));
        }
        let mut texels = match self.pixel {
            Pixel::Bc6h { signed } => bytes
                .chunks_exact(image)
                .flat_map(|blocks| bc6h::rgb_from_bc6h(width, height, signed, blocks))
                .collect(),
            pixel => texels_from(pixel, &bytes),
        };
        if !self.is_cube && self.is_bottom_up() {
            texels = texels.chunks_exact(width as usize).rev().flatten().copied().collect();
        }
        Ok(texels)
    }

    /// Whether rows run upwards (`KTXorientation` `ru`), as in OpenGL.
    fn is_bottom_up(&self) -> bool {
        self.reader
            .key_value_data()
            .any(|(key, value)| key == "KTXorientation" && value.get(1) == Some(&b'u'))
    }

    /// The text value of `key`.
    fn text(&self, key: &str) -> Option<String> {
        let (_, value) = self.reader.key_value_data().find(|(name, _)| *name == key)?;
        Some(String::from_utf8_lossy(value.split(|&byte| byte == 0).next().unwrap_or_default()).into_owned())
    }
}

/// Parses the roughness of each of `levels` levels from the keys of a file.
pub(in crate::io) fn parse_roughness(
    source: &Source<'_>,
    text: &dyn Fn(&str) -> Option<String>,
    levels: usize,
) -> Result<Vec<f64>> {
    let Some(text) = text(ROUGHNESS_KEY) else {
        return Err(source.error(format!(
            "it has no roughness of its levels (key {ROUGHNESS_KEY}); octagloss bake writes it"
        )));
    };
    let parsed: Option<Vec<f64>> =
        text.split(',').map(|word| word.trim().parse().ok().filter(|r| (0.0..=1.0).contains(r))).collect();
    match parsed {
        Some(roughness) if roughness.len() == levels => Ok(roughness),
        _ => Err(source
            .error(format!("{ROUGHNESS_KEY} is not {levels} numbers in [0, 1], one a level; bake it again"))),
    }
}

pub(in crate::io) fn texels_from(pixel: Pixel, bytes: &[u8]) -> Vec<Rgb> {
    match pixel {
        Pixel::Rgba16F => bytes
            .as_chunks::<8>()
            .0
            .iter()
            .map(|texel| {
                let half = |c: usize| half::f16::from_le_bytes([texel[2 * c], texel[2 * c + 1]]);
                let halves = [half(0), half(1), half(2), half(3)];
                let mut floats = [0.0; 4];
                halves.as_slice().convert_to_f32_slice(&mut floats);
                [floats[0], floats[1], floats[2]]
            })
            .collect(),
        Pixel::Rgba32F => bytes
            .as_chunks::<16>()
            .0
            .iter()
            .map(|texel| {
                let channel =
                    |c: usize| f32::from_le_bytes(texel[4 * c..4 * c + 4].try_into().expect("4 bytes"));
                [channel(0), channel(1), channel(2)]
            })
            .collect(),
        // The caller handles blocks.
        Pixel::Rgb9E5 | Pixel::R11G11B10F | Pixel::Bc6h { .. } => {
            let rgb_from = if pixel == Pixel::Rgb9E5 { rgb_from_rgb9e5 } else { rgb_from_r11g11b10 };
            bytes.as_chunks::<4>().0.iter().map(|texel| rgb_from(u32::from_le_bytes(*texel))).collect()
        }
    }
}
