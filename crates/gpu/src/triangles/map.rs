//! Maps of the sphere that triangles are drawn into.

/// A map with its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectMap {
    /// The octahedral map in its quadratic layout, see [`octagloss_core::sphere::octahedral`].
    Octahedral {
        /// Pixels along an edge.
        size: u32,
    },
    /// The octahedral map in its rectangular layout, two squares side by side, see
    /// [`octagloss_core::sphere::octahedral_rectangular`].
    Rectangular {
        /// Pixels along an edge of either square.
        size: u32,
    },
    /// Six faces, see [`octagloss_core::sphere::cube`].
    Cube {
        /// Pixels along an edge of a face.
        size: u32,
    },
    /// Two panels, one above the other, see [`octagloss_core::sphere::tennis_ball`].
    TennisBall {
        /// Pixels across a panel, which is three times as long.
        size: u32,
    },
}

impl DirectMap {
    /// Pixels along an edge of a square or face, or across a panel.
    pub const fn size(self) -> u32 {
        match self {
            Self::Octahedral { size }
            | Self::Rectangular { size }
            | Self::Cube { size }
            | Self::TennisBall { size } => size,
        }
    }

    /// Squares of an image side by side, and one below the other.
    pub const fn cells(self) -> [u32; 2] {
        match self {
            Self::Rectangular { .. } => [2, 1],
            Self::TennisBall { .. } => [3, 2],
            Self::Octahedral { .. } | Self::Cube { .. } => [1, 1],
        }
    }

    /// Squares of an image side by side.
    pub const fn squares(self) -> u32 {
        self.cells()[0]
    }

    /// Images: the faces of a cube.
    pub const fn layers(self) -> u32 {
        match self {
            Self::Cube { .. } => 6,
            Self::Octahedral { .. } | Self::Rectangular { .. } | Self::TennisBall { .. } => 1,
        }
    }

    /// Whether the map is a cube.
    pub const fn is_cube(self) -> bool {
        matches!(self, Self::Cube { .. })
    }

    /// Whether the map is octahedral.
    pub const fn is_octahedral(self) -> bool {
        matches!(self, Self::Octahedral { .. } | Self::Rectangular { .. })
    }

    /// Pixels of all images, for sizes that textures have.
    pub const fn pixels(self) -> u32 {
        let [columns, rows] = self.cells();
        columns * rows * self.layers() * self.size() * self.size()
    }
}
