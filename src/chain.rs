//! Prefiltered chains: what a bake makes, and what the writers and readers of `io` carry.

use crate::environment::{Layout, Rgb};
use crate::sphere::cube::Face;

/// One level: six faces of `size` x `size` texels.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeLevel {
    /// Texels along an edge of a face.
    pub size: u32,
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
    /// Linear radiance, row-major, the faces one after the other in the order of [`Face::ALL`].
    pub texels: Vec<Rgb>,
    /// The certified error bound of each texel in absolute luminance, same order; `None` where the filter has
    /// none.
    pub bounds: Option<Vec<f32>>,
}

impl CubeLevel {
    /// The texels of one face, row-major.
    #[must_use]
    pub fn face(&self, face: Face) -> &[Rgb] {
        let area = self.size as usize * self.size as usize;
        &self.texels[face.index() * area..][..area]
    }
}

/// One level as a single image: a panorama or an octahedral square.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageLevel {
    /// How its texels cover the sphere.
    pub layout: Layout,
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
    /// Linear radiance, row-major.
    pub texels: Vec<Rgb>,
}

/// Levels from the sharpest to the roughest.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeChain {
    /// At least one; level l has max(1, size >> l) texels along an edge.
    pub levels: Vec<CubeLevel>,
}

/// A level to be baked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rung {
    /// Its texels.
    pub layout: Layout,
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
}
