//! Seamless bilinear look-up in a cube level: faces have a border of their neighbours' texels.

use crate::chain::Level;
use crate::environment::Rgb;
use crate::sphere::cube::{self, Face};
use glam::DVec3;

/// A level's faces, each with a border of one texel.
#[derive(Clone, Debug)]
pub struct SeamlessLevel {
    size: usize,
    /// Six faces of (size + 2)^2 texels.
    bordered: Vec<Rgb>,
}

impl SeamlessLevel {
    /// Copies `level` and adds borders: the neighbour's texel across an edge, the mean of the three adjacent
    /// texels at a corner, as in Vulkan's cube filtering.
    #[must_use]
    pub fn new(level: &Level) -> Self {
        let (n, side) = (level.size() as usize, level.size() as usize + 2);
        let mut bordered = vec![[0.0; 3]; 6 * side * side];
        for face in Face::ALL {
            let to = &mut bordered[face.index() * side * side..][..side * side];
            for (j, line) in level.face(face).chunks_exact(n).enumerate() {
                to[(j + 1) * side + 1..][..n].copy_from_slice(line);
            }
            for k in 0..n {
                for (x, y) in [(0, k + 1), (n + 1, k + 1), (k + 1, 0), (k + 1, n + 1)] {
                    to[y * side + x] = neighbour(level, face, x, y);
                }
            }
            for (x, y) in [(0, 0), (n + 1, 0), (0, n + 1), (n + 1, n + 1)] {
                let (inner_x, inner_y) = (x.clamp(1, n), y.clamp(1, n));
                let meet = [to[inner_y * side + inner_x], to[inner_y * side + x], to[y * side + inner_x]];
                to[y * side + x] = [0, 1, 2].map(|c| meet.iter().map(|t| t[c]).sum::<f32>() / 3.0);
            }
        }
        Self { size: n, bordered }
    }

    /// Radiance in `direction` (any length but zero), bilinear between the four nearest texel centres.
    #[must_use]
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        let (face, s, t) = cube::cube_from_direction(direction);
        let side = self.size + 2;
        let texels = &self.bordered[face.index() * side * side..][..side * side];
        // Texel 0 of the bordered face has its centre half a texel outside.
        let place = |s: f64| {
            let x = (s + 1.0) / 2.0 * self.size as f64 + 0.5;
            let low = (x.floor() as usize).min(self.size);
            (low, (x - low as f64) as f32)
        };
        let ((x, fx), (y, fy)) = (place(s), place(t));
        let at = |x: usize, y: usize| texels[y * side + x];
        let mix = |a: f32, b: f32, f: f32| a * (1.0 - f) + b * f;
        [0, 1, 2].map(|c| {
            mix(mix(at(x, y)[c], at(x + 1, y)[c], fx), mix(at(x, y + 1)[c], at(x + 1, y + 1)[c], fx), fy)
        })
    }
}

/// The texel of the adjacent face at position (`x`, `y`) on the border of the bordered `face`.
fn neighbour(level: &Level, face: Face, x: usize, y: usize) -> Rgb {
    let n = level.size() as usize;
    // Just outside the face, close enough not to shift along the edge.
    let outside = |k: usize| match k {
        0 => -1.0 - 1e-9,
        k if k == n + 1 => 1.0 + 1e-9,
        k => (k as f64 - 0.5) / n as f64 * 2.0 - 1.0,
    };
    let (other, s, t) = cube::cube_from_direction(cube::cube_point(face, outside(x), outside(y)));
    let texel = |s: f64| (((s + 1.0) / 2.0 * n as f64) as usize).min(n - 1);
    level.face(other)[texel(t) * n + texel(s)]
}
