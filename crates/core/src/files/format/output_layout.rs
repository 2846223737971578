//! Layout of a bake's levels in files.

use crate::common::names::named;
use crate::light::environment::Map;

/// Layout of a bake's levels in files: `--out-layout`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum OutputLayout {
    /// Cube faces: one file if the container holds a chain, else six images a level.
    #[default]
    Faces,
    /// An image a level, the faces in a horizontal cross, 4:3.
    Cross,
    /// An image a level, the faces in a vertical cross, 3:4.
    CrossVertical,
    /// An image a level, the faces in a row, 6:1.
    Strip,
    /// An image a level, the faces in a column, 1:6.
    StripVertical,
    /// An image a level, each a panorama.
    Equirect,
    /// An image a level, each an octahedral square.
    Octahedral,
    /// One EXR file, a part a face.
    Parts,
    /// One EXR file, a panorama with MIP levels.
    Mips,
}

named!(OutputLayout {
    Faces = "faces",
    Cross = "cross",
    CrossVertical = "cross-vertical",
    Strip = "strip",
    StripVertical = "strip-vertical",
    Equirect = "equirect",
    Octahedral = "octahedral",
    Parts = "parts",
    Mips = "mips",
});

impl OutputLayout {
    /// The map of its levels.
    #[must_use]
    pub const fn map(self) -> Map {
        match self {
            Self::Equirect | Self::Mips => Map::Panorama,
            Self::Octahedral => Map::Octahedral,
            _ => Map::Cube,
        }
    }
}
