//! Paddings of panoramas that are not 2:1.

/// Padding of a panorama that is not 2:1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Pad {
    /// Black, without light.
    Black,
    /// Repeats the outermost rows (or columns).
    Edge,
}

impl Pad {
    /// Every padding.
    pub const ALL: [Self; 2] = [Self::Black, Self::Edge];

    /// Name on the command line and in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Black => "black",
            Self::Edge => "edge",
        }
    }
}
