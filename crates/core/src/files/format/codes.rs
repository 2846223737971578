//! Names of the pixel formats in the graphics APIs, by which the containers record them.

use super::Pixel;
use ddsfile::DxgiFormat;
use ktx2::Format;

/// OpenGL's enums of a pixel format, for a KTX 1 header.
pub(crate) struct GlFormat {
    /// `glType`.
    pub(crate) kind: u32,
    /// `glTypeSize`.
    pub(crate) kind_bytes: u32,
    /// `glFormat`, which is `glBaseInternalFormat` as well.
    pub(crate) format: u32,
    /// `glInternalFormat`.
    pub(crate) internal: u32,
}

const GL_RGB: u32 = 0x1907;
const GL_RGBA: u32 = 0x1908;

/// A pixel format in KTX2 and DDS files.
pub(crate) struct TextureFormat {
    /// Its name in messages.
    pub(crate) name: &'static str,
    /// Bytes of a texel, or of a block of BC6H.
    pub(crate) bytes: usize,
    /// Vulkan's format, for KTX2.
    pub(crate) vulkan: Format,
    /// Direct3D's format, for DDS.
    pub(crate) dxgi: DxgiFormat,
}

impl Pixel {
    /// Its format in textures; `None` if it has none.
    pub(crate) const fn in_textures(self) -> Option<TextureFormat> {
        let (name, bytes, vulkan, dxgi) = match self {
            Self::F16 => ("RGBA16F", 8, Format::R16G16B16A16_SFLOAT, DxgiFormat::R16G16B16A16_Float),
            Self::F32 => ("RGBA32F", 16, Format::R32G32B32A32_SFLOAT, DxgiFormat::R32G32B32A32_Float),
            Self::Rgb9e5 => ("RGB9E5", 4, Format::E5B9G9R9_UFLOAT_PACK32, DxgiFormat::R9G9B9E5_SharedExp),
            Self::R11g11b10 => {
                ("R11G11B10F", 4, Format::B10G11R11_UFLOAT_PACK32, DxgiFormat::R11G11B10_Float)
            }
            Self::Bc6h => ("BC6H", 16, Format::BC6H_UFLOAT_BLOCK, DxgiFormat::BC6H_UF16),
            Self::Rgbd | Self::Rgbp | Self::Rgbe | Self::Auto => return None,
        };
        Some(TextureFormat { name, bytes, vulkan, dxgi })
    }

    /// OpenGL's format, for KTX 1; `None` if it has none, or none without compression.
    pub(crate) const fn gl(self) -> Option<GlFormat> {
        let (kind, kind_bytes, format, internal) = match self {
            // GL_HALF_FLOAT, GL_RGBA16F.
            Self::F16 => (0x140b, 2, GL_RGBA, 0x881a),
            // GL_FLOAT, GL_RGBA32F.
            Self::F32 => (0x1406, 4, GL_RGBA, 0x8814),
            // GL_UNSIGNED_INT_5_9_9_9_REV, GL_RGB9_E5.
            Self::Rgb9e5 => (0x8c3e, 4, GL_RGB, 0x8c3d),
            // Filament and cmgen use the internal format as the type, not GL_UNSIGNED_INT_10F_11F_11F_REV
            // (Ktx1Reader.cpp, toPixelDataType).
            Self::R11g11b10 => (0x8c3a, 4, GL_RGB, 0x8c3a),
            Self::Bc6h | Self::Rgbd | Self::Rgbp | Self::Rgbe | Self::Auto => return None,
        };
        Some(GlFormat { kind, kind_bytes, format, internal })
    }
}
