//! Textures in KTX, KTX2 and DDS files: what their readers share.

use super::LoadedChain;
use super::key_values::value_of;
use super::ktx2::write::ROUGHNESS_KEY;
use super::map_header::MapHeader;
use super::picture::{Picture, Source, check_finite};
use super::pyramid_write::KEY as PYRAMID_KEY;
use crate::common::error::Result;
use crate::files::format::r11g11b10::rgb_from_r11g11b10;
use crate::files::format::{Pixel, bc6h, rgb_from_rgb9e5};
use crate::light::chain::{Chain, Level};
use crate::light::environment::Rgb;
use half::slice::HalfFloatSliceExt as _;

/// The pixels that can be read from KTX2 and DDS, for messages.
pub(super) const READABLE: &str = "RGBA16F, RGBA32F, RGB9E5, R11G11B10F and BC6H can be read";

/// A file with a valid header.
pub(super) struct Texture<'a> {
    pub(super) source: Source<'a>,
    /// `KTX`, `KTX2` or `DDS`.
    pub(super) container: &'static str,
    pub(super) pixel: Pixel,
    /// Whether blocks of BC6H are signed.
    pub(super) is_signed: bool,
    pub(super) width: u32,
    pub(super) height: u32,
    /// Images of an array: those of a pyramid, else one.
    pub(super) layers: u32,
    pub(super) is_cube: bool,
    /// Whether the rows of a 2D image run upwards.
    pub(super) is_bottom_up: bool,
    pub(super) levels: usize,
    pub(super) pairs: Vec<(String, String)>,
    /// Calls a function with the bytes of a level's images in order, of several at once or of each.
    pub(super) images: Box<ForImages<'a>>,
}

type ForImages<'a> = dyn Fn(usize, &mut dyn FnMut(&[u8])) -> Result<()> + 'a;

/// Bytes of an image of `width` x `height` pixels.
pub(super) fn image_bytes(pixel: Pixel, width: u32, height: u32) -> usize {
    let edge = if pixel == Pixel::Bc6h { bc6h::BLOCK } else { 1 };
    let blocks = (width as usize).div_ceil(edge) * (height as usize).div_ceil(edge);
    blocks * pixel.in_textures().expect("textures have it").bytes
}

fn words(bytes: &[u8]) -> impl Iterator<Item = u32> {
    bytes.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word))
}

impl Texture<'_> {
    /// Decodes level 0.
    pub(super) fn picture(&self) -> Result<Picture> {
        let Self { source, width, height, is_cube, .. } = self;
        if self.is_pyramid() {
            return Err(
                source.error("a pyramid is for look-ups and is no environment; compare and info read it")
            );
        }
        Ok(Picture {
            width: *width,
            height: if *is_cube { 6 * width } else { *height },
            texels: self.level(0)?,
            is_cube: *is_cube,
            map: if *is_cube { None } else { MapHeader::of_pairs(source, &self.pairs)? },
            format: self.format(),
            provenance: source.provenance(&self.pairs)?,
            ..Picture::default()
        })
    }

    /// Decodes every level of a cube, of these roughnesses.
    pub(super) fn chain(&self, roughness: impl IntoIterator<Item = f64>) -> Result<LoadedChain> {
        self.check_is_cube()?;
        let level = |(level, roughness): (u32, f64)| {
            let (size, texels) = ((self.width >> level).max(1), self.level(level as usize)?);
            check_finite(self.source.path, level, size, &texels)?;
            Ok(Level::cube(size, roughness, texels))
        };
        self.loaded((0..).zip(roughness).map(level).collect::<Result<_>>()?)
    }

    /// The chain of `levels` with what the file says of it.
    pub(super) fn loaded(&self, levels: Vec<Level>) -> Result<LoadedChain> {
        Ok(LoadedChain {
            chain: Chain { levels },
            provenance: self.source.provenance(&self.pairs)?,
            format: self.format(),
            path: self.source.path.to_owned(),
            warnings: Vec::new(),
        })
    }

    fn check_is_cube(&self) -> Result<()> {
        if self.is_cube { Ok(()) } else { Err(self.source.error("it holds a 2D image; a chain is a cube")) }
    }

    /// The roughness of each level by the file's keys.
    ///
    /// # Errors
    /// If it is no cube, since flat images have none, or lacks them.
    pub(super) fn roughness(&self) -> Result<Vec<f64>> {
        self.check_is_cube()?;
        let Some(text) = value_of(&self.pairs, ROUGHNESS_KEY) else {
            return Err(self.source.error(format!(
                "it has no roughness of its levels (key {ROUGHNESS_KEY}); octagloss bake writes it"
            )));
        };
        let number = |word: &str| word.trim().parse().ok().filter(|r| (0.0..=1.0).contains(r));
        match text.split(',').map(number).collect::<Option<Vec<f64>>>() {
            Some(roughness) if roughness.len() == self.levels => Ok(roughness),
            _ => Err(self.source.error(format!(
                "{ROUGHNESS_KEY} is not {} numbers in [0, 1], one a level; bake it again",
                self.levels
            ))),
        }
    }

    /// Whether it is a pyramid.
    pub(super) fn is_pyramid(&self) -> bool {
        value_of(&self.pairs, PYRAMID_KEY).is_some()
    }

    /// Such as `KTX2 cube, RGBA16F, 9 levels`.
    fn format(&self) -> String {
        let kind = match (self.is_cube, self.is_pyramid()) {
            (true, false) => "cube",
            (true, true) => "pyramid on a cube",
            (false, false) => "2D",
            (false, true) => "pyramid",
        };
        let pixel = self.pixel.in_textures().expect("textures have it").name;
        format!("{} {kind}, {pixel}, {} levels", self.container, self.levels)
    }

    /// Decodes the texels of one level, face by face.
    pub(super) fn level(&self, level: usize) -> Result<Vec<Rgb>> {
        let side = |full: u32| (full >> level).max(1);
        let (width, height) = (side(self.width), side(self.height));
        let mut texels = Vec::new();
        (self.images)(level, &mut |bytes| match self.pixel {
            Pixel::F16 => texels.extend(bytes.as_chunks::<8>().0.iter().map(|texel| {
                let halves = [0, 2, 4, 6].map(|at| half::f16::from_le_bytes([texel[at], texel[at + 1]]));
                let mut floats = [0.0; 4];
                halves.as_slice().convert_to_f32_slice(&mut floats);
                [floats[0], floats[1], floats[2]]
            })),
            Pixel::F32 => texels.extend(bytes.as_chunks::<16>().0.iter().map(|texel| {
                let words = texel.as_chunks::<4>().0;
                [0, 1, 2].map(|c| f32::from_le_bytes(words[c]))
            })),
            Pixel::Bc6h => {
                for blocks in bytes.chunks_exact(image_bytes(self.pixel, width, height)) {
                    texels.extend(bc6h::rgb_from_bc6h(width, height, self.is_signed, blocks));
                }
            }
            Pixel::Rgb9e5 => texels.extend(words(bytes).map(rgb_from_rgb9e5)),
            Pixel::R11g11b10 => texels.extend(words(bytes).map(rgb_from_r11g11b10)),
            Pixel::Rgbd | Pixel::Rgbp | Pixel::Rgbe | Pixel::Auto => unreachable!("no textures have it"),
        })?;
        if self.is_bottom_up {
            texels = texels.chunks_exact(width as usize).rev().flatten().copied().collect();
        }
        Ok(texels)
    }
}
