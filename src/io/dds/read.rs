//! DDS files with the DX10 header: RGBA16F, RGBA32F, RGB9E5, R11G11B10F and BC6H cubes and 2D images.

use super::write::marked_flip;
use crate::chain::{Chain, Level};
use crate::environment::Rgb;
use crate::error::Result;
use crate::format::bc6h;
use crate::format::r11g11b10::rgb_from_r11g11b10;
use crate::format::rgb_from_rgb9e5;
use crate::io::layout::Content;
use crate::io::picture::{Picture, Stored};
use crate::io::provenance::Provenance;
use crate::io::source::{Source, TEXEL_BYTES};
use ddsfile::{Dds, DxgiFormat, MiscFlag};
use half::f16;

/// Decodes level 0.
pub(in crate::io) fn decode_level0(source: &Source<'_>) -> Result<Picture> {
    let texture = Texture::open(source)?;
    let Texture { width, height, is_cube, .. } = texture;
    Ok(Picture {
        width,
        height: texture.faces() * height,
        texels: texture.level(0),
        content: if is_cube { Content::Cube } else { Content::Image },
        map: None,
        format: texture.format_name(),
        warnings: Vec::new(),
        provenance: provenance(source),
    })
}

/// Decodes every level of a cube. The file does not store their `roughness`.
pub(in crate::io) fn decode_chain(source: &Source<'_>, roughness: &[f64]) -> Result<Stored> {
    let texture = Texture::open(source)?;
    if !texture.is_cube {
        return Err(source.error("it holds a 2D image; a chain is a cube"));
    }
    if roughness.len() != texture.levels as usize {
        return Err(source.error(format!(
            "it has {} levels, its report lists {}; bake it again",
            texture.levels,
            roughness.len()
        )));
    }
    let levels = (0..texture.levels)
        .zip(roughness)
        .map(|(level, roughness)| {
            let (size, texels) = ((texture.width >> level).max(1), texture.level(level));
            crate::io::picture::check_finite(source.path, level, size, &texels)?;
            Ok(Level::cube(size, *roughness, texels))
        })
        .collect::<Result<_>>()?;
    let format = texture.format_name();
    Ok(Stored { chain: Chain { levels }, provenance: provenance(source), format, warnings: Vec::new() })
}

/// Reads the flip from the writer's mark.
fn provenance(source: &Source<'_>) -> Provenance {
    Provenance { flip: marked_flip(source.bytes), ..Provenance::default() }
}

/// A file with a valid header and complete texels.
struct Texture {
    dds: Dds,
    format: DxgiFormat,
    name: &'static str,
    width: u32,
    height: u32,
    levels: u32,
    is_cube: bool,
}

impl Texture {
    fn open(source: &Source<'_>) -> Result<Self> {
        // The crate copies the file's bytes.
        source.check_memory(1, 1, source.bytes.len() as u64)?;
        let dds = Dds::read(source.bytes).map_err(|error| source.decoder_error("DDS", &error))?;
        let Some(extended) = &dds.header10 else {
            return Err(source.error("a DDS file without the DX10 header; save it with a DXGI format"));
        };
        let format = extended.dxgi_format;
        let name = match format {
            DxgiFormat::R16G16B16A16_Float => "RGBA16F",
            DxgiFormat::R32G32B32A32_Float => "RGBA32F",
            DxgiFormat::R9G9B9E5_SharedExp => "RGB9E5",
            DxgiFormat::R11G11B10_Float => "R11G11B10F",
            DxgiFormat::BC6H_UF16 | DxgiFormat::BC6H_SF16 => "BC6H",
            other => {
                return Err(source.error(format!(
                    "its pixels are {other:?}; RGBA16F, RGBA32F, RGB9E5, R11G11B10F and BC6H can be read"
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
        // A texel takes at most 16 bytes, a texel of a partial block at most four.
        source.check_memory(width, height, u64::from(faces) * (TEXEL_BYTES + 16))?;
        if levels > width.max(height).ilog2() + 1 {
            return Err(source.error(format!("{levels} levels are more than {width}x{height} can have")));
        }
        let texture = Self { dds, format, name, width, height, levels, is_cube };
        let needed = u64::from(faces) * texture.offset(levels) as u64;
        if needed > texture.dds.data.len() as u64 {
            return Err(source.error(format!(
                "truncated: {faces} faces of {levels} levels take {needed} bytes, it has {}; copy it again",
                texture.dds.data.len()
            )));
        }
        Ok(texture)
    }

    /// Such as `DDS cube, BC6H, 9 levels`.
    fn format_name(&self) -> String {
        let kind = if self.is_cube { "cube" } else { "2D" };
        format!("DDS {kind}, {}, {} levels", self.name, self.levels)
    }

    const fn faces(&self) -> u32 {
        if self.is_cube { 6 } else { 1 }
    }

    fn sides(&self, level: u32) -> (u32, u32) {
        ((self.width >> level).max(1), (self.height >> level).max(1))
    }

    const fn texel_bytes(&self) -> usize {
        match self.format {
            DxgiFormat::R16G16B16A16_Float => 8,
            DxgiFormat::R32G32B32A32_Float => 16,
            _ => 4,
        }
    }

    const fn is_blocks(&self) -> bool {
        matches!(self.format, DxgiFormat::BC6H_UF16 | DxgiFormat::BC6H_SF16)
    }

    /// Bytes of one image of a level.
    fn bytes(&self, level: u32) -> usize {
        let (width, height) = self.sides(level);
        if self.is_blocks() {
            bc6h::image_length(width, height)
        } else {
            width as usize * height as usize * self.texel_bytes()
        }
    }

    /// Offset of a level in its face's bytes; each face stores its levels, the largest first.
    fn offset(&self, level: u32) -> usize {
        (0..level).map(|level| self.bytes(level)).sum()
    }

    /// Decodes the texels of a level, face by face.
    fn level(&self, level: u32) -> Vec<Rgb> {
        let (width, height) = self.sides(level);
        let face = |face: u32| {
            let start = face as usize * self.offset(self.levels) + self.offset(level);
            let bytes = &self.dds.data[start..start + self.bytes(level)];
            if self.is_blocks() {
                bc6h::rgb_from_bc6h(width, height, self.format == DxgiFormat::BC6H_SF16, bytes)
            } else {
                bytes.chunks_exact(self.texel_bytes()).map(|texel| rgb_from(self.format, texel)).collect()
            }
        };
        (0..self.faces()).flat_map(face).collect()
    }
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
