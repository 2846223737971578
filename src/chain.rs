//! Prefiltered chains: what a bake makes, and what the writers and readers of `io` carry.

use crate::environment::{Layout, Rgb};
use crate::sphere::cube::Face;

/// One level of a chain: its texels and what they are.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// How its texels cover the sphere.
    pub layout: Layout,
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
    /// Linear radiance, row-major; the faces of a cube one after the other in the order of [`Face::ALL`].
    pub texels: Vec<Rgb>,
    /// The certified error bound of each texel in absolute luminance, same order; `None` where the filter has
    /// none.
    pub bounds: Option<Vec<f32>>,
}

impl Level {
    /// A cube with faces of `size` x `size` texels and no bounds.
    #[must_use]
    pub const fn cube(size: u32, roughness: f64, texels: Vec<Rgb>) -> Self {
        Self { layout: Layout::Cube { size }, roughness, texels, bounds: None }
    }

    /// Texels along an edge of a face or square; the height of a panorama.
    #[must_use]
    pub const fn size(&self) -> u32 {
        self.layout.sides().1
    }

    /// The texels of one face of a cube, row-major.
    #[must_use]
    pub fn face(&self, face: Face) -> &[Rgb] {
        let area = self.size() as usize * self.size() as usize;
        &self.texels[face.index() * area..][..area]
    }
}

/// What the texels of a chain are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum ChainKind {
    /// Lobes along the texels' directions, of the level's roughness.
    #[default]
    Sampled,
    /// Values whose trilinear look-ups are nearest the lobes, between texels and levels as well.
    Solved,
}

impl ChainKind {
    /// Name on the command line, in reports and in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sampled => "sampled",
            Self::Solved => "solved",
        }
    }

    /// The kind called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        [Self::Sampled, Self::Solved].into_iter().find(|kind| kind.name() == name)
    }
}

/// Levels from the sharpest to the roughest.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// At least one; level l has max(1, size >> l) texels along an edge.
    pub levels: Vec<Level>,
}

/// Texels and roughness of a level to be baked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelSpec {
    /// Its texels.
    pub layout: Layout,
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
}
