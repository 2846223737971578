//! Contact sheets: lit spheres over the roughness ladder, labelled. 8-bit sRGB, deterministic.

use super::drawing::page::page;
use super::drawing::scene::{Anchor, Scene};
use super::drawing::style::{GAP, INK, LABEL, MARGIN, PAPER, SMALL, SOFT};
use super::faces::draw_cross;
use super::tone::{display, srgb, tone_mapped};
use crate::chain::{Chain, Level};
use crate::chain_lookup::SeamlessLevel;
use crate::environment::{Environment, Layout, Rgb};
use crate::error::{Error, Result};
use crate::geometry::overlap::{Space, Target, mean_radiances};
use crate::image::exposure::{self, Exposure};
use glam::{DVec2, DVec3};
use image::{Rgb as Pixel, RgbImage};
use rayon::prelude::*;
use std::borrow::Cow;

/// Pixels along an edge of a sphere's tile.
const TILE: u32 = 240;
/// Pixels along an edge of a face in the cross below it; a cross is as wide as a tile.
const FACE: u32 = TILE / 4;
/// Pixels between a tile and its cross.
const BETWEEN: f64 = 10.0;
/// Pixels above a tile for its labels.
const LABELS: f64 = 24.0;
/// Spheres in a row.
const COLUMNS: usize = 5;
/// Samples along an edge of a pixel.
const SAMPLES: u32 = 3;

/// Distance of the camera from the sphere in radii, towards -X; it looks along +X.
const CAMERA_DISTANCE: f64 = 3.4;
/// Tangent of half the angle of view: the sphere fills about four fifths of its tile.
const HALF_VIEW: f64 = 0.385;
/// Roughness of the backdrop level; the nearest level is used.
const BACKDROP_ROUGHNESS: f64 = 0.35;

/// Description of the chain on a contact sheet.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin<'a> {
    /// Name of the environment or its file.
    pub name: &'a str,
    /// Target of the bake; empty for none.
    pub target: &'a str,
}

/// Draws the contact sheet of a chain, its levels resampled to cubes: for each level a mirror sphere, shaded
/// by one look-up in that level, in front of a blurred backdrop, with the level's six faces as a cross below.
/// The camera looks along +X, the centre of a panorama; the sphere reflects the scene behind the camera.
/// Crosses show face images as stored in files.
///
/// # Errors
/// [`Error::Parameter`] for a chain without levels.
pub fn contact_sheet(chain: &Chain, origin: Origin<'_>, exposure: Exposure) -> Result<Scene> {
    let cubes = chain.levels.iter().map(as_cube).collect::<Result<Vec<_>>>()?;
    let distance = |level: &Level| (level.roughness - BACKDROP_ROUGHNESS).abs();
    let Some(backdrop) = cubes.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
        return Err(Error::Parameter("a preview needs at least one level".to_owned()));
    };
    let backdrop = SeamlessLevel::new(backdrop);
    let ev = exposure.ev(exposure::of_level(&cubes[0]));
    let factor = ev.exp2();
    let (tile, cross) = (f64::from(TILE), f64::from(3 * FACE));
    let cell = DVec2::new(tile + GAP, LABELS + tile + BETWEEN + cross + GAP);
    let (columns, rows) = (cubes.len().min(COLUMNS), cubes.len().div_ceil(COLUMNS));
    let extent = DVec2::new(columns as f64, rows as f64) * cell - GAP;
    let caption = caption(origin, exposure, ev);
    let (mut scene, body) = page(extent.x + 2.0 * MARGIN, extent.y, origin.name, &caption);
    for (index, (level, own)) in cubes.iter().zip(&chain.levels).enumerate() {
        let place = DVec2::new((index % COLUMNS) as f64, (index / COLUMNS) as f64);
        let low = body.low + place * cell;
        let baseline = low.y + LABEL;
        let head = format!("roughness {:.3}", level.roughness);
        scene.text(DVec2::new(low.x, baseline), &head, LABEL, Anchor::Start, INK);
        scene.text(DVec2::new(low.x + tile, baseline), &sides(own), SMALL, Anchor::End, SOFT);
        let corner = low + DVec2::new(0.0, LABELS);
        scene.picture_at(corner, corner + tile, sphere(level, &backdrop, factor));
        let corner = corner + DVec2::new(0.0, tile + BETWEEN);
        draw_cross(&mut scene, corner, FACE, level, |texel| display(texel, factor));
    }
    Ok(scene)
}

fn caption(Origin { target, .. }: Origin<'_>, exposure: Exposure, ev: f64) -> String {
    let target = if target.is_empty() { String::new() } else { format!("Target {target}. ") };
    let automatic = if exposure == Exposure::Auto { ", automatic" } else { "" };
    let ev = format!("{ev:+.2}").replace('-', "\u{2212}");
    format!("{target}Exposure {ev}\u{a0}EV{automatic}. Spheres mirror one level each; its faces stand below.")
}

/// Texels of a level.
fn sides(level: &Level) -> String {
    let (width, height) = level.layout.sides();
    match level.layout {
        Layout::Cube { size } => format!("6 \u{d7} {size}\u{b2}"),
        _ => format!("{width} \u{d7} {height}"),
    }
}

/// Stacks sheets.
#[must_use]
pub fn stacked(sheets: &[Scene]) -> RgbImage {
    let width = sheets.iter().map(|sheet| sheet.width).max().unwrap_or(1);
    let height: u32 = sheets.iter().map(|sheet| sheet.height).sum();
    let mut all = RgbImage::from_pixel(width, height.max(1), Pixel(PAPER));
    let mut top = 0;
    for sheet in sheets {
        image::imageops::replace(&mut all, &sheet.picture(), 0, top);
        top += i64::from(sheet.height);
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

/// Renders the tile of `level`; `exposure` is a factor.
fn sphere(level: &Level, backdrop: &SeamlessLevel<'_>, exposure: f64) -> RgbImage {
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
    let rows: Vec<Vec<Pixel<u8>>> =
        (0..TILE).into_par_iter().map(|j| (0..TILE).map(|i| pixel(i, j)).collect()).collect();
    RgbImage::from_fn(TILE, TILE, |i, j| rows[j as usize][i as usize])
}
