//! File formats that hold a whole cube chain.

use crate::format::Pixel;

/// A file format that holds a whole cube chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Container {
    /// KTX 2, Zstandard.
    Ktx2,
    /// KTX 1, plain.
    Ktx1,
    /// DDS with the DX10 header.
    Dds,
    /// OpenEXR, a part for each face of each level.
    Exr,
}

impl Container {
    /// Name on the command line, and the files' extension.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ktx2 => "ktx2",
            Self::Ktx1 => "ktx",
            Self::Dds => "dds",
            Self::Exr => "exr",
        }
    }

    /// Whether files of this kind can hold `pixel`.
    #[must_use]
    pub fn holds(self, pixel: Pixel) -> bool {
        match self {
            Self::Ktx2 | Self::Dds => pixel != Pixel::Rgbd,
            Self::Ktx1 => !matches!(pixel, Pixel::Bc6h | Pixel::Rgbd),
            Self::Exr => matches!(pixel, Pixel::F16 | Pixel::F32),
        }
    }
}

/// What an `.env` begins with.
pub const ENV_MAGIC: [u8; 8] = [0x86, 0x16, 0x87, 0x96, 0xf6, 0xd6, 0x96, 0x36];
