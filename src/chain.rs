//! Prefiltered chains, produced by a bake and read and written by `io`.

use crate::environment::{Layout, Rgb};
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
    /// Creates a cube level with faces of `size` x `size` texels and no bounds.
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
