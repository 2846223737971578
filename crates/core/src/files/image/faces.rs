//! Levels as stored, in a drawing.

use crate::files::io::layout::CROSS_CELLS;
use crate::light::chain::Level;
use crate::light::environment::Rgb;
use crate::sphere::cube::Face;
use glam::DVec2;
use octagloss_drawing::bitmap::Bitmap;
use octagloss_drawing::scene::{Frame, Scene};
use octagloss_drawing::style::Colour;

/// Lines around pictures: seen beside white paper, beside black and beside white texels.
const OUTLINE: Colour = [136, 142, 151];

/// Corners of the unfolded faces' outline, in faces.
const CROSS: [[f64; 2]; 12] = [
    [1.0, 0.0],
    [2.0, 0.0],
    [2.0, 1.0],
    [4.0, 1.0],
    [4.0, 2.0],
    [2.0, 2.0],
    [2.0, 3.0],
    [1.0, 3.0],
    [1.0, 2.0],
    [0.0, 2.0],
    [0.0, 1.0],
    [1.0, 1.0],
];

/// Draws the six stored faces, each `face` pixels wide, unfolded with +Z in the middle, from `low` on, with
/// an outline.
pub(super) fn draw_cross(
    scene: &mut Scene,
    low: DVec2,
    face: u32,
    level: &Level,
    colour: impl Fn(Rgb) -> Colour,
) {
    let edge = f64::from(face);
    for of in Face::ALL {
        let pixels = shrunk(level.face(of), (level.size(), level.size()), (face, face), &colour);
        let (column, row) = CROSS_CELLS[of.index()];
        let corner = low + DVec2::new(f64::from(column), f64::from(row)) * edge;
        scene.picture_at(corner, corner + edge, pixels);
    }
    let corners = CROSS.map(|corner| low.round() + DVec2::from(corner) * edge);
    scene.outline(corners, 1.0, OUTLINE);
}

/// Draws `pixels` at `low`, with an outline.
pub(super) fn draw_outlined(scene: &mut Scene, low: DVec2, pixels: Bitmap) {
    let high = low + DVec2::new(f64::from(pixels.width()), f64::from(pixels.height()));
    scene.picture_at(low, high, pixels);
    scene.outline(Frame::new(low.round(), high.round()).corners(), 1.0, OUTLINE);
}

/// `texels` of an image of `from` (columns, rows) as `to` pixels. A pixel over several texels shows their
/// mean.
pub(super) fn shrunk(
    texels: &[Rgb],
    from: (u32, u32),
    to: (u32, u32),
    colour: impl Fn(Rgb) -> Colour,
) -> Bitmap {
    let span = |k: u32, from: u32, to: u32| {
        let edge = |k: u32| (u64::from(k) * u64::from(from) / u64::from(to)) as usize;
        edge(k)..edge(k + 1).max(edge(k) + 1)
    };
    Bitmap::from_fn(to.0, to.1, |i, j| {
        let across = span(i, from.0, to.0);
        let covered =
            span(j, from.1, to.1).flat_map(|y| across.clone().map(move |x| texels[y * from.0 as usize + x]));
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for texel in covered {
            sum = [0, 1, 2].map(|c| sum[c] + f64::from(texel[c]));
            count += 1.0;
        }
        colour(sum.map(|c| (c / count) as f32))
    })
}
