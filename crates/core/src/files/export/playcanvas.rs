//! PlayCanvas's environment atlas: panoramas of every level in one image, as RGBP in PNG.
//!
//! src/scene/shader-lib/glsl/chunks of playcanvas 2.23: common/frag/envAtlas.js (rectangles, with a seam of
//! 1/512 of the atlas on every side), lit/frag/reflectionEnv.js (levels from roughness 0 to 1 in steps of
//! 1/5, and a chain of mipmaps of the sharpest for minification), lit/frag/ambient.js (a panorama of
//! irradiance over pi), common/frag/spherical.js (u = 1/2 + atan2(x, z)/2 pi, v downwards). The reader
//! negates x before every look-up.

use crate::common::error::Result;
use crate::common::parallel;
use crate::files::format::rgbd::png_bytes;
use crate::files::format::rgbp::rgbp_from_rgb;
use crate::light::chain::Level;
use crate::light::chain_lookup::SeamlessLevel;
use crate::light::environment::Rgb;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Edge of the atlas in the units of [`Rect`].
const EDGE: u32 = 512;

/// A panorama's place in the atlas, in 1/[`EDGE`] of its edge.
#[derive(Clone, Copy)]
struct Rect {
    x: u32,
    y: u32,
    width: u32,
}

impl Rect {
    /// Level `level` of roughness, below the mirror's panorama.
    const fn rough(level: u32) -> Self {
        Self { x: 0, y: EDGE - (EDGE >> level), width: EDGE >> level }
    }

    /// Level `level` of the mirror's mipmaps, right of the others.
    const fn shiny(level: u32) -> Self {
        Self { x: EDGE - (EDGE >> level), ..Self::rough(level) }
    }
}

const AMBIENT: Rect = Rect { x: 128, y: 384, width: 64 };
/// Mipmaps of the mirror that look-ups reach.
const SHINY: u32 = 6;

/// Encodes the atlas of `levels` and `irradiance`, cubes flipped for the reader, of a size and a number of
/// levels that [`crate::files::target::TargetPlan::check_levels`] takes.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for an atlas that PNG cannot hold.
pub(crate) fn atlas_bytes(levels: &[Level], irradiance: &Level) -> Result<Vec<u8>> {
    let size = levels.first().map_or(0, Level::size);
    let mut atlas = AtlasImage { edge: 2 * size, texels: vec![[0.0; 3]; (4 * size * size) as usize] };
    for (level, number) in levels.iter().zip(0..).skip(1) {
        atlas.draw(Rect::rough(number), level, 1);
    }
    for number in 0..SHINY {
        // The cube has twice the texels of the panorama, and the smaller ones average its area.
        atlas.draw(Rect::shiny(number), &levels[0], 2 << number);
    }
    atlas.draw(AMBIENT, irradiance, 1);
    let codes: Vec<[u8; 4]> = atlas.texels.iter().map(|texel| rgbp_from_rgb(*texel)).collect();
    png_bytes(atlas.edge, &codes)
}

struct AtlasImage {
    /// Texels along an edge.
    edge: u32,
    texels: Vec<Rgb>,
}

impl AtlasImage {
    /// Draws the panorama of `level` into `rect`, with `samples` x `samples` look-ups a texel. The seam
    /// around it continues around the sphere and over the poles.
    fn draw(&mut self, rect: Rect, level: &Level, samples: u32) {
        let lookup = SeamlessLevel::new(level);
        let scale = f64::from(self.edge) / f64::from(EDGE);
        let [x, y, width] = [rect.x, rect.y, rect.width].map(|length| length * self.edge / EDGE);
        // The part inside the seam is the sphere.
        let share = |place: f64, length: u32| (place - scale) / (f64::from(length) - 2.0 * scale);
        let sample = |texel: u32, at: u32| f64::from(texel) + (f64::from(at) + 0.5) / f64::from(samples);
        let weight = f64::from(samples * samples).recip();
        let rows = self.texels.chunks_exact_mut(self.edge as usize).skip(y as usize);
        parallel::for_each(rows.take(width as usize / 2).enumerate(), |(row, texels)| {
            for column in 0..width {
                let mut sum = DVec3::ZERO;
                for at in 0..samples * samples {
                    let u = share(sample(column, at % samples), width);
                    let v = share(sample(row as u32, at / samples), width / 2);
                    sum += weight * DVec3::from(lookup.radiance(direction(u, v)));
                }
                texels[(x + column) as usize] = sum.as_vec3().to_array();
            }
        });
    }
}

/// The direction that the reader looks up at (`u`, `v`).
fn direction(u: f64, v: f64) -> DVec3 {
    let (longitude, latitude) = ((u - 0.5) * TAU, (0.5 - v) * PI);
    let (sin, cos) = longitude.sin_cos();
    DVec3::new(sin * latitude.cos(), latitude.sin(), cos * latitude.cos())
}
