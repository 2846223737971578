//! Maps of the sphere that triangles are drawn into.

/// A map with its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectMap {
    /// The octahedral map in its quadratic layout, see [`crate::sphere::octahedral`].
    Octahedral {
        /// Pixels along an edge.
        size: u32,
    },
    /// The octahedral map in its rectangular layout, two squares side by side, see
    /// [`crate::sphere::octahedral_rectangular`].
    Rectangular {
        /// Pixels along an edge of either square.
        size: u32,
    },
    /// Six faces, see [`crate::sphere::cube`].
    Cube {
        /// Pixels along an edge of a face.
        size: u32,
    },
}

impl DirectMap {
    /// Pixels along an edge of a square or face.
    #[must_use]
    pub const fn size(self) -> u32 {
        match self {
            Self::Octahedral { size } | Self::Rectangular { size } | Self::Cube { size } => size,
        }
    }

    /// Squares side by side in an image.
    #[must_use]
    pub const fn squares(self) -> u32 {
        match self {
            Self::Rectangular { .. } => 2,
            Self::Octahedral { .. } | Self::Cube { .. } => 1,
        }
    }

    /// Images: the faces of a cube.
    #[must_use]
    pub const fn layers(self) -> u32 {
        match self {
            Self::Cube { .. } => 6,
            Self::Octahedral { .. } | Self::Rectangular { .. } => 1,
        }
    }

    /// Whether the map is a cube.
    #[must_use]
    pub const fn is_cube(self) -> bool {
        matches!(self, Self::Cube { .. })
    }

    /// Pixels of all images, for sizes that textures have.
    #[must_use]
    pub const fn pixels(self) -> u32 {
        self.squares() * self.layers() * self.size() * self.size()
    }
}
