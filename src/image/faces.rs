//! The faces of a cube in a drawing.

use super::drawing::scene::Scene;
use crate::chain::Level;
use crate::environment::Rgb;
use crate::io::layout::CROSS_CELLS;
use crate::sphere::cube::Face;
use glam::DVec2;
use image::{Rgb as Pixel, RgbImage};

/// Draws the six stored faces, each `face` pixels wide, unfolded with +Z in the middle, from `low` on. A
/// pixel over several texels shows their mean.
pub(super) fn draw_cross(
    scene: &mut Scene,
    low: DVec2,
    face: u32,
    level: &Level,
    colour: impl Fn(Rgb) -> Pixel<u8>,
) {
    let n = level.size() as usize;
    let span = |k: u32| {
        let edge = |k: u32| k as usize * n / face as usize;
        edge(k)..edge(k + 1).max(edge(k) + 1)
    };
    for of in Face::ALL {
        let texels = level.face(of);
        let pixels = RgbImage::from_fn(face, face, |i, j| {
            let covered = span(j).flat_map(|y| span(i).map(move |x| texels[y * n + x]));
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for texel in covered {
                sum = [0, 1, 2].map(|c| sum[c] + f64::from(texel[c]));
                count += 1.0;
            }
            colour(sum.map(|c| (c / count) as f32))
        });
        let (column, row) = CROSS_CELLS[of.index()];
        let corner = low + DVec2::new(f64::from(column), f64::from(row)) * f64::from(face);
        scene.picture_at(corner, corner + f64::from(face), pixels);
    }
}
