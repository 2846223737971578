//! Draws scenes as pixels: every shape by the exact share of each pixel that it covers.

use super::bitmap::Bitmap;
use super::font::text_path;
use super::path::Path;
use super::scene::{Item, Scene, Text};
use super::style::{Colour, PAPER};
use ab_glyph_rasterizer::{Point, Rasterizer, point};
use glam::DVec2;

impl Scene {
    /// The scene as a picture.
    pub fn picture(&self) -> Bitmap {
        let mut picture = Bitmap::filled(self.width, self.height, PAPER);
        for item in &self.items {
            draw(&mut picture, item);
        }
        picture
    }
}

fn draw(picture: &mut Bitmap, item: &Item) {
    let mut path = Path::default();
    let ink = match item {
        Item::Polygon { points, fill } => {
            path.polygon(points);
            fill
        }
        Item::Line { points, width, colour } => {
            path.stroke(points, *width);
            colour
        }
        Item::Disc { centre, radius, fill } => {
            path.disc(*centre, *radius);
            fill
        }
        Item::Text(text) => {
            path = outline(text);
            &text.colour
        }
        Item::Picture { low, high, pixels } => return stretch(picture, *low, *high, pixels),
    };
    fill(picture, &path, *ink);
}

fn outline(text: &Text) -> Path {
    let (left, _) = text.span();
    text_path(&text.text, text.em, |at| {
        let along = at.x + left;
        if text.upwards { text.at - DVec2::new(at.y, along) } else { text.at + DVec2::new(along, -at.y) }
    })
}

/// Fills `path`, blending its edges in sRGB.
fn fill(picture: &mut Bitmap, path: &Path, colour: Colour) {
    if path.pieces.is_empty() {
        return;
    }
    let points = || path.pieces.iter().flatten();
    let low = points().copied().fold(DVec2::INFINITY, DVec2::min).floor();
    let high = points().copied().fold(DVec2::NEG_INFINITY, DVec2::max).ceil();
    // One pixel around, for the rasteriser carries an edge's rest to the next pixel.
    let (low, high) = (low - 1.0, high + 1.0);
    let [width, height] = (high - low).to_array().map(|side| side as usize);
    let mut mask = Rasterizer::new(width, height);
    let at = |place: DVec2| -> Point { point((place.x - low.x) as f32, (place.y - low.y) as f32) };
    for [from, control, to] in &path.pieces {
        mask.draw_quad(at(*from), at(*control), at(*to));
    }
    let (left, top) = (low.x as i64, low.y as i64);
    mask.for_each_pixel_2d(|x, y, share| {
        let (x, y) = (i64::from(x) + left, i64::from(y) + top);
        let inside =
            (0..i64::from(picture.width())).contains(&x) && (0..i64::from(picture.height())).contains(&y);
        if inside && share > 1e-3 {
            let pixel = picture.pixel_mut(x as u32, y as u32);
            *pixel = super::style::mix(*pixel, colour, f64::from(share.min(1.0)));
        }
    });
}

/// Samples along a pixel's edge of a stretched picture.
const SAMPLES: u32 = 4;

/// Draws `pixels` over the rectangle from `low` to `high`, each as a rectangle, to whole pixels of `picture`.
fn stretch(picture: &mut Bitmap, low: DVec2, high: DVec2, pixels: &Bitmap) {
    let (low, high) = (low.round(), high.round());
    let [width, height] = (high - low).max(DVec2::ONE).to_array().map(|side| side as u32);
    let (left, top) = (low.x as i64, low.y as i64);
    if (pixels.width(), pixels.height()) == (width, height) {
        return picture.put(pixels, left, top);
    }
    // Sources of the samples across and down.
    let sources = |to: u32, from: u32| -> Vec<u32> {
        let place = |k: u32| (2 * u64::from(k) + 1) * u64::from(from) / (2 * u64::from(to * SAMPLES));
        (0..to * SAMPLES).map(|k| place(k) as u32).collect()
    };
    let (across, down) = (sources(width, pixels.width()), sources(height, pixels.height()));
    let stretched = Bitmap::from_fn(width, height, |x, y| {
        let mut sum = [0_u32; 3];
        for v in &down[(SAMPLES * y) as usize..(SAMPLES * (y + 1)) as usize] {
            for u in &across[(SAMPLES * x) as usize..(SAMPLES * (x + 1)) as usize] {
                let pixel = pixels.pixel(*u, *v);
                sum = std::array::from_fn(|c| sum[c] + u32::from(pixel[c]));
            }
        }
        let count = SAMPLES * SAMPLES;
        sum.map(|sum| ((sum + count / 2) / count) as u8)
    });
    picture.put(&stretched, left, top);
}
