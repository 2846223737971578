//! Prefiltered chains, produced by a bake and read and written by `io`.

use crate::common::names::named;
use crate::light::environment::{Layout, Rgb};
use crate::sphere::cube::Face;

/// One level of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Mapping of its texels to the sphere.
    pub layout: Layout,
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
    /// Linear radiance, row-major; cube faces in the order of [`Face::ALL`].
    pub texels: Vec<Rgb>,
    /// Certified error bound of each texel, absolute luminance, in texel order; `None` if the filter has
    /// none.
    pub bounds: Option<Vec<f32>>,
}

impl Level {
    /// A cube level with faces of `size` x `size` texels and no bounds. [`crate::bake::Bake::write`] checks
    /// the number of texels, as of any level.
    #[must_use]
    pub const fn cube(size: u32, roughness: f64, texels: Vec<Rgb>) -> Self {
        Self { layout: Layout::Cube { size }, roughness, texels, bounds: None }
    }

    /// Texels along an edge of a face or square; the height of a panorama.
    #[must_use]
    pub const fn size(&self) -> u32 {
        self.layout.sides().1
    }

    /// The texels of one face of a cube, row-major; empty where the level has fewer texels.
    #[must_use]
    pub fn face(&self, face: Face) -> &[Rgb] {
        let area = self.size() as usize * self.size() as usize;
        self.texels.get(face.index() * area..).and_then(|rest| rest.get(..area)).unwrap_or_default()
    }
}

/// Content of the texels of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum ChainKind {
    /// The lobe of the level's roughness along each texel's direction.
    Sampled,
    /// Values whose trilinear look-ups are nearest the lobes, also between texels and levels.
    Solved,
    /// Sampled levels up to a roughness of a third, solved ones above.
    Mixed,
}

/// Roughness up to which the levels of a mixed chain are sampled. Between sharper levels of a linear ladder
/// the lobe's peak changes by more than an order of magnitude: solved values would trade error at the levels
/// for error between them. A third, rounded up for roughnesses that files store as float32.
const SHARP: f64 = 0.334;

named!(ChainKind { Sampled = "sampled", Solved = "solved", Mixed = "mixed" });

impl ChainKind {
    /// Index of the first solved level of levels with `roughness`, sharpest first; their number if none is.
    /// Level 0 is never solved, and the first glossy level of a mixed chain never is.
    pub fn first_solved(self, roughness: impl ExactSizeIterator<Item = f64>) -> usize {
        let count = roughness.len();
        match self {
            Self::Sampled => count,
            Self::Solved => count.min(1),
            Self::Mixed => {
                (0..).zip(roughness).position(|(level, r)| level > 1 && r > SHARP).unwrap_or(count)
            }
        }
    }
}

/// Levels ordered from sharpest to roughest.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// At least one; level l has max(1, size >> l) texels along an edge.
    pub levels: Vec<Level>,
}

/// Layout and roughness of a level to bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelSpec {
    /// Its texel layout.
    pub layout: Layout,
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
}
