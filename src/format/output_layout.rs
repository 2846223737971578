//! Layout of a bake's levels in files.

use crate::environment::Map;

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

impl OutputLayout {
    /// Every layout.
    pub const ALL: [Self; 9] = [
        Self::Faces,
        Self::Cross,
        Self::CrossVertical,
        Self::Strip,
        Self::StripVertical,
        Self::Equirect,
        Self::Octahedral,
        Self::Parts,
        Self::Mips,
    ];

    /// Name on the command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Faces => "faces",
            Self::Cross => "cross",
            Self::CrossVertical => "cross-vertical",
            Self::Strip => "strip",
            Self::StripVertical => "strip-vertical",
            Self::Equirect => "equirect",
            Self::Octahedral => "octahedral",
            Self::Parts => "parts",
            Self::Mips => "mips",
        }
    }

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
