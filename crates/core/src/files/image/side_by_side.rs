//! Two bakes side by side: spheres of each and of the reference, and the errors of both in one false colour.

use super::exposure::LogAverage;
use crate::analysis::channels::{Relative, shown_errors};
use crate::common::percent::percent;
use crate::light::environment::Rgb;
use glam::{DVec2, DVec3};
use octagloss_drawing::bitmap::Bitmap;
use octagloss_drawing::page::{BAR_WIDTH, colour_bar, page};
use octagloss_drawing::scale::RELATIVE_ERROR;
use octagloss_drawing::scene::{Anchor, Frame, Scene};
use octagloss_drawing::style::{Colour, GAP, INK, LABEL, LINE, MARGIN, PAPER, SMALL, SOFT, mix};
use octagloss_drawing::tone::display;

/// Pixels along an edge of a sphere's tile.
pub const TILE: u32 = 176;
/// Radius of a sphere in tiles.
const RADIUS: f64 = 0.49;
/// Samples along an edge of a pixel at a sphere's silhouette.
const SAMPLES: u32 = 4;
/// Pixels above a row for its name.
const HEAD: f64 = 28.0;
/// Pixels below a row of errors for its figures.
const FOOT: f64 = LINE * SMALL + 6.0;
/// Displayed value of the spheres' log-average luminance.
const GREY: f64 = 0.12;
/// The light that a sphere reflects comes from this side of the sun's, in degrees about the vertical.
const SIDEWAYS: f64 = 38.0;

/// A column of the picture: one roughness.
#[derive(Clone, Debug)]
pub struct Column {
    /// Perceptual roughness.
    pub roughness: f64,
    /// Radiance of the exact lobes along [`directions`].
    pub reference: Vec<Rgb>,
    /// Radiance of the look-ups of each bake along them.
    pub bakes: [Vec<[f64; 3]>; 2],
    /// RMS errors of each bake over the whole sphere of directions.
    pub errors: [Relative; 2],
}

/// Directions that the pixels of a sphere reflect to an orthographic camera, row by row; pixels outside take
/// those of the silhouette. A `sun` is reflected beside the middle.
pub fn directions(sun: Option<DVec3>) -> Vec<DVec3> {
    let behind = match sun.map(|sun| DVec3::new(sun.x, 0.0, sun.z).normalize_or_zero()) {
        Some(sun) if sun != DVec3::ZERO => {
            let (sin, cos) = SIDEWAYS.to_radians().sin_cos();
            DVec3::new(cos * sun.x - sin * sun.z, 0.0, sin * sun.x + cos * sun.z)
        }
        _ => DVec3::NEG_X,
    };
    // Looks along -behind with +Y up.
    let right = (-behind).cross(DVec3::Y);
    let place = |k: u32| ((f64::from(k) + 0.5) / f64::from(TILE) - 0.5) / RADIUS;
    let direction = |i: u32, j: u32| {
        let mut at = DVec2::new(place(i), -place(j));
        if at.length() > 1.0 {
            at = at.normalize();
        }
        let depth = (1.0 - at.length_squared()).max(0.0).sqrt();
        let normal = at.x * right + at.y * DVec3::Y + depth * behind;
        (2.0 * normal.dot(behind) * normal - behind).normalize()
    };
    (0..TILE).flat_map(|j| (0..TILE).map(move |i| (i, j))).map(|(i, j)| direction(i, j)).collect()
}

/// Draws the bakes called `names` against `against`: a row of spheres for each, for the reference, and for
/// the relative errors of each: |difference| / (reference + 0.001 of its mean) of luminance or the channel
/// where it is greatest.
pub fn side_by_side(names: [&str; 2], against: &str, columns: &[Column]) -> Scene {
    let tile = f64::from(TILE);
    let cell = tile + GAP;
    let width = 2.0 * MARGIN + BAR_WIDTH + cell * columns.len() as f64 - GAP;
    let row = HEAD + tile + GAP / 2.0;
    let (spheres, errors) = (3.0 * row, 2.0 * (row + FOOT));
    let ev = exposure(columns);
    let caption = format!(
        "Each sphere mirrors one roughness by the look-up of a renderer, between texels and levels; the \
         reference is exact lobes of {against}. Errors: |difference| / (reference + 0.001 of its mean), of \
         luminance or the channel where it is greatest; black is none. Below: root mean square over 20000 \
         directions, over the mean, of luminance and of the worst channel. Exposure {}\u{a0}EV.",
        format!("{ev:+.2}").replace('-', "\u{2212}")
    );
    let title = format!("{} and {}", names[0], names[1]);
    let (mut scene, body) = page(width, HEAD + spheres + errors, &title, &caption);
    let left = body.low.x + BAR_WIDTH;
    let column_at = |k: usize| left + cell * k as f64;
    for (k, column) in columns.iter().enumerate() {
        let at = DVec2::new(column_at(k) + tile / 2.0, body.low.y + LABEL);
        scene.text(at, &format!("roughness {:.3}", column.roughness), LABEL, Anchor::Middle, INK);
    }
    let factor = ev.exp2();
    let mut top = body.low.y + HEAD;
    let mut row_of = |scene: &mut Scene, name: &str, shade: &dyn Fn(&Column, usize) -> Colour| {
        scene.text(DVec2::new(left, top + LABEL), name, LABEL, Anchor::Start, SOFT);
        for (k, column) in columns.iter().enumerate() {
            let low = DVec2::new(column_at(k), top + HEAD);
            scene.picture_at(low, low + tile, disc(|pixel| shade(column, pixel)));
        }
        top += row;
        top
    };
    for bake in [0, 1] {
        row_of(&mut scene, names[bake], &|column, pixel| {
            display(column.bakes[bake][pixel].map(|c| c as f32), factor)
        });
    }
    let bottom = row_of(&mut scene, "reference", &|column, pixel| display(column.reference[pixel], factor));
    let mut greatest = 0.0_f64;
    for bake in [0, 1] {
        let errors: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| shown_errors(column.bakes[bake].iter().copied(), &column.reference))
            .collect();
        greatest = errors.iter().flatten().copied().fold(greatest, f64::max);
        let low = bottom + (row + FOOT) * bake as f64;
        let name = format!("error of {}", names[bake]);
        scene.text(DVec2::new(left, low + LABEL), &name, LABEL, Anchor::Start, SOFT);
        for (k, (column, errors)) in columns.iter().zip(&errors).enumerate() {
            let at = DVec2::new(column_at(k), low + HEAD);
            scene.picture_at(at, at + tile, disc(|pixel| RELATIVE_ERROR.colour(errors[pixel])));
            let worst = column.errors[bake].worst_channel();
            let luminance = percent(column.errors[bake].luminance);
            let text = format!("lum. {luminance}, {} {}", worst.of, percent(worst.error));
            let at = DVec2::new(at.x + tile / 2.0, at.y + tile + LINE * SMALL);
            scene.text(at, &text, SMALL, Anchor::Middle, INK);
        }
    }
    let bar =
        Frame::new(DVec2::new(body.low.x, bottom + HEAD), DVec2::new(left, bottom + errors - GAP / 2.0));
    colour_bar(&mut scene, &bar, &RELATIVE_ERROR, "relative error", [RELATIVE_ERROR.range()[0], greatest]);
    scene
}

/// A disc on paper; `shade` gives the colour of a pixel.
fn disc(shade: impl Fn(usize) -> Colour) -> Bitmap {
    Bitmap::from_fn(TILE, TILE, |i, j| {
        let place = |k: u32, part: u32| {
            let offset = (f64::from(part) + 0.5) / f64::from(SAMPLES);
            (f64::from(k) + offset) / f64::from(TILE) - 0.5
        };
        let samples = (0..SAMPLES).flat_map(|y| (0..SAMPLES).map(move |x| (x, y)));
        let inside = samples.filter(|(x, y)| place(i, *x).hypot(place(j, *y)) < RADIUS).count();
        let share = inside as f64 / f64::from(SAMPLES * SAMPLES);
        mix(PAPER, shade((j * TILE + i) as usize), share)
    })
}

/// The exposure that shows the log-average luminance of the reference's spheres as a dark grey, in powers of
/// two: a highlight is brighter.
fn exposure(columns: &[Column]) -> f64 {
    let all = || columns.iter().flat_map(|column| &column.reference);
    let mut average = LogAverage::new(all());
    all().for_each(|rgb| average.add(1.0, *rgb));
    average.exposure(GREY)
}
