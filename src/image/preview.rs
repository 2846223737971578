//! Preview pictures: a contact sheet of lit spheres over the roughness ladder, and the error of one level in
//! false colour. 8-bit sRGB, deterministic.

use crate::chain::{Chain, Level};
use crate::chain_lookup::SeamlessLevel;
use crate::environment::{Environment, Layout, Rgb, exact_luminance};
use crate::error::{Error, Result};
use crate::geometry::overlap::{Space, Target, mean_radiances};
use crate::image::exposure::{self, Exposure};
use crate::image::font;
use crate::io::layout::CROSS_CELLS;
use crate::sphere::cube::Face;
use glam::DVec3;
use image::{Rgb as Pixel, RgbImage};
use rayon::prelude::*;
use std::borrow::Cow;

/// Pixels along an edge of a sphere's tile.
const TILE: u32 = 240;
/// Pixels along an edge of a face in the cross below it; a cross is as wide as a tile.
const FACE: u32 = TILE / 4;
const GAP: u32 = 10;
const LABEL: u32 = 26;
/// Rows above a sheet that has a name.
const TITLE: u32 = 36;
/// Spheres in a row.
const COLUMNS: u32 = 5;
/// Samples along an edge of a pixel.
const SAMPLES: u32 = 3;
const PAPER: Pixel<u8> = Pixel([24, 24, 26]);
const TEXT: Pixel<u8> = Pixel([225, 225, 225]);

/// Distance of the camera from the sphere in radii, towards -X; it looks along +X.
const CAMERA_DISTANCE: f64 = 3.4;
/// Tangent of half the angle of view: the sphere fills about four fifths of its tile.
const HALF_VIEW: f64 = 0.385;
/// Roughness of the backdrop level; the nearest level is used.
const BACKDROP_ROUGHNESS: f64 = 0.35;

/// Draws the contact sheet of a chain, its levels resampled to cubes: for each level a mirror sphere, shaded
/// by one look-up in that level, in front of a blurred backdrop, with the level's six faces as a cross below.
/// The camera looks along +X, the centre of a panorama; the sphere reflects the scene behind the camera.
/// Crosses show face images as stored in files.
///
/// # Errors
/// [`Error::Parameter`] for a chain without levels.
pub fn contact_sheet(chain: &Chain, exposure: Exposure) -> Result<RgbImage> {
    let cubes = chain.levels.iter().map(as_cube).collect::<Result<Vec<_>>>()?;
    let distance = |level: &Level| (level.roughness - BACKDROP_ROUGHNESS).abs();
    let Some(backdrop) = cubes.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
        return Err(Error::Parameter("a preview needs at least one level".to_owned()));
    };
    let backdrop = SeamlessLevel::new(backdrop);
    let exposure = exposure.ev(exposure::of_level(&cubes[0])).exp2();
    let count = cubes.len() as u32;
    let (columns, rows) = (count.min(COLUMNS), count.div_ceil(COLUMNS));
    let cell_height = LABEL + TILE + GAP + 3 * FACE + GAP;
    let mut sheet = RgbImage::from_pixel(columns * (TILE + GAP) + GAP, rows * cell_height + GAP, PAPER);
    for ((level, own), index) in cubes.iter().zip(&chain.levels).zip(0..) {
        let (x, y) = (GAP + index % COLUMNS * (TILE + GAP), GAP + index / COLUMNS * cell_height);
        draw_text(&mut sheet, x, y, 2, &format!("R {:.3}", level.roughness));
        let size = own.size().to_string();
        draw_text(&mut sheet, x + TILE - 2 * font::text_width(&size), y, 2, &size);
        draw_sphere(&mut sheet, x, y + LABEL, level, &backdrop, exposure);
        draw_cross(&mut sheet, x, y + LABEL + TILE + GAP, FACE, level, |texel| display(texel, exposure));
    }
    Ok(sheet)
}

/// Stacks named sheets, each below its name.
#[must_use]
pub fn stacked(sheets: &[(&str, RgbImage)]) -> RgbImage {
    let width = sheets.iter().map(|(_, sheet)| sheet.width()).max().unwrap_or(1);
    let height: u32 = sheets.iter().map(|(_, sheet)| TITLE + sheet.height()).sum();
    let mut all = RgbImage::from_pixel(width, height.max(1), PAPER);
    let mut top = 0;
    for (name, sheet) in sheets {
        draw_text(&mut all, GAP, top + GAP, 3, name);
        image::imageops::replace(&mut all, sheet, 0, i64::from(top + TITLE));
        top += TITLE + sheet.height();
    }
    all
}

/// Resamples `level` to a cube whose faces have as many texels as a quarter of the horizon.
fn as_cube(level: &Level) -> Result<Cow<'_, Level>> {
    if let Layout::Cube { .. } = level.layout {
        return Ok(Cow::Borrowed(level));
    }
    let size = level.layout.face_edge();
    let environment = Environment::new(level.layout, level.texels.clone())?;
    let texels = mean_radiances(&environment, Target::Cube(size), Space::World)?;
    Ok(Cow::Owned(Level::cube(size, level.roughness, texels)))
}

/// Colour range of [`error_picture`]: relative errors from 0.01 % to 100 %, on a log scale.
const ERROR_RANGE: (f64, f64) = (1e-4, 1.0);

/// Draws the relative error of each texel of `level` against `reference`, as an unfolded cross in false
/// colour over a legend: |difference of luminance| / (luminance of the reference + 0.001 of its mean).
///
/// # Errors
/// [`Error::Parameter`] if the two differ in size.
pub fn error_picture(level: &Level, reference: &Level) -> Result<RgbImage> {
    if level.size() != reference.size() || level.texels.len() != reference.texels.len() || level.size() == 0 {
        return Err(Error::Parameter(format!(
            "cannot compare a level of {} with one of {}",
            level.size(),
            reference.size()
        )));
    }
    let total: f64 = reference.texels.iter().map(|t| exact_luminance(*t)).sum();
    let floor = 1e-3 * total / reference.texels.len() as f64;
    let mut errors = level.clone();
    for (error, expected) in errors.texels.iter_mut().zip(&reference.texels) {
        let expected_luminance = exact_luminance(*expected);
        let difference = (exact_luminance(*error) - expected_luminance).abs();
        let relative = if difference == 0.0 { 0.0 } else { difference / (expected_luminance + floor) };
        *error = [relative as f32; 3];
    }
    // Faces of at least 96 pixels, with whole pixels a texel.
    let face = level.size() * 96_u32.div_ceil(level.size());
    let (width, legend) = (4 * face + 2 * GAP, 54);
    let mut picture = RgbImage::from_pixel(width, 3 * face + 3 * GAP + legend, PAPER);
    draw_cross(&mut picture, GAP, GAP, face, &errors, |texel| error_colour(f64::from(texel[0])));

    let (left, top) = (GAP, 3 * face + 2 * GAP);
    let bar = width - 2 * GAP;
    let (low, high) = (ERROR_RANGE.0.ln(), ERROR_RANGE.1.ln());
    for x in 0..bar {
        let colour = error_colour((low + (high - low) * f64::from(x) / f64::from(bar - 1)).exp());
        for y in 0..16 {
            picture.put_pixel(left + x, top + y, colour);
        }
    }
    for (tick, text) in (0_u32..).zip(["0.01%", "0.1%", "1%", "10%", "100%"]) {
        let room = bar - font::text_width(text);
        draw_text(&mut picture, left + tick * room / 4, top + 22, 1, text);
    }
    draw_text(&mut picture, left, top + 38, 1, "RELATIVE ERROR OF LUMINANCE");
    Ok(picture)
}

/// Tone-maps radiance to [0, 1], linear: Narkowicz 2016, "ACES filmic tone mapping curve".
fn tone_mapped(radiance: Rgb, exposure: f64) -> Rgb {
    radiance.map(|c| {
        // The curve saturates here; larger squares could overflow.
        let x = (f64::from(c) * exposure).min(1e4) as f32;
        ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0)
    })
}

/// Converts linear display values in [0, 1] to 8-bit sRGB (IEC 61966-2-1).
fn srgb(linear: Rgb) -> Pixel<u8> {
    Pixel(linear.map(|c| {
        let c = c.clamp(0.0, 1.0);
        let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    }))
}

/// Radiance to 8-bit sRGB as every picture shows it; `exposure` is a factor.
pub(crate) fn display(radiance: Rgb, exposure: f64) -> Pixel<u8> {
    srgb(tone_mapped(radiance, exposure))
}

/// Radiance that the camera sees at `x`, `y` in [-1, 1], to the right and down: the sphere's reflection or
/// the backdrop.
fn seen(x: f64, y: f64, level: &SeamlessLevel<'_>, backdrop: &SeamlessLevel<'_>) -> Rgb {
    // Looking along +X with +Y up, +Z is to the right.
    let ray = DVec3::new(1.0, -y * HALF_VIEW, x * HALF_VIEW).normalize();
    let camera = DVec3::new(-CAMERA_DISTANCE, 0.0, 0.0);
    let along = -camera.dot(ray);
    let discriminant = 1.0 - (camera + along * ray).length_squared();
    if discriminant < 0.0 {
        return backdrop.radiance(ray).map(|c| c as f32);
    }
    let normal = camera + (along - discriminant.sqrt()) * ray;
    level.radiance(ray - 2.0 * ray.dot(normal) * normal).map(|c| c as f32)
}

fn draw_sphere(
    sheet: &mut RgbImage,
    left: u32,
    top: u32,
    level: &Level,
    backdrop: &SeamlessLevel<'_>,
    exposure: f64,
) {
    let level = SeamlessLevel::new(level);
    let side = f64::from(TILE * SAMPLES);
    let place = |k: u32| (f64::from(k) + 0.5) / side * 2.0 - 1.0;
    let pixel = |i: u32, j: u32| {
        // Tone-map before averaging, so that one bright sample does not dominate a pixel.
        let mut sum = [0.0; 3];
        for (y, x) in (0..SAMPLES).flat_map(|y| (0..SAMPLES).map(move |x| (y, x))) {
            let radiance = seen(place(i * SAMPLES + x), place(j * SAMPLES + y), &level, backdrop);
            let mapped = tone_mapped(radiance, exposure);
            for (sum, c) in sum.iter_mut().zip(mapped) {
                *sum += c;
            }
        }
        srgb(sum.map(|c| c / (SAMPLES * SAMPLES) as f32))
    };
    let tile: Vec<Vec<Pixel<u8>>> =
        (0..TILE).into_par_iter().map(|j| (0..TILE).map(|i| pixel(i, j)).collect()).collect();
    for (line, j) in tile.into_iter().zip(0..) {
        for (colour, i) in line.into_iter().zip(0..) {
            sheet.put_pixel(left + i, top + j, colour);
        }
    }
}

/// Draws the six stored faces, each `face_pixels` wide, unfolded with +Z in the middle. A pixel over several
/// texels shows their mean.
fn draw_cross(
    picture: &mut RgbImage,
    left: u32,
    top: u32,
    face_pixels: u32,
    level: &Level,
    colour: impl Fn(Rgb) -> Pixel<u8>,
) {
    let n = level.size() as usize;
    let span = |k: u32| {
        let edge = |k: u32| k as usize * n / face_pixels as usize;
        edge(k)..edge(k + 1).max(edge(k) + 1)
    };
    for face in Face::ALL {
        let (column, row) = CROSS_CELLS[face.index()];
        let texels = level.face(face);
        for (j, i) in (0..face_pixels).flat_map(|j| (0..face_pixels).map(move |i| (j, i))) {
            let covered = span(j).flat_map(|y| span(i).map(move |x| texels[y * n + x]));
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for texel in covered {
                sum = [0, 1, 2].map(|c| sum[c] + f64::from(texel[c]));
                count += 1.0;
            }
            let mean = sum.map(|c| (c / count) as f32);
            picture.put_pixel(left + column * face_pixels + i, top + row * face_pixels + j, colour(mean));
        }
    }
}

fn draw_text(picture: &mut RgbImage, left: u32, top: u32, scale: u32, text: &str) {
    for y in 0..font::GLYPH_HEIGHT * scale {
        for x in 0..font::text_width(text) * scale {
            if font::is_inked(text, x / scale, y / scale) && left + x < picture.width() {
                picture.put_pixel(left + x, top + y, TEXT);
            }
        }
    }
}

/// Colour of a relative error: black for 0, then blue over red to pale yellow. Perceived lightness is linear
/// in the logarithm (a spiral in Ottosson's OKLab, 2020).
fn error_colour(error: f64) -> Pixel<u8> {
    if error <= 0.0 {
        return Pixel([0; 3]);
    }
    let (low, high) = (ERROR_RANGE.0.ln(), ERROR_RANGE.1.ln());
    let t = ((error.ln() - low) / (high - low)).clamp(0.0, 1.0);
    let lightness = 0.22 + 0.74 * t;
    let hue = (265.0 + 205.0 * t).to_radians();
    let chroma = 0.04 + 0.13 * (t * std::f64::consts::PI).sin();
    let (a, b) = (chroma * hue.cos(), chroma * hue.sin());
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    srgb(
        [
            4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
            -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
            -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
        ]
        .map(|c| c as f32),
    )
}
