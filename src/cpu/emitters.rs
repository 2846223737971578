//! The brightest cells of an OEM, taken out of it: what the real-time tier answers one by one.
//!
//! No few boxes have the shape of a lobe, and under a sun their every corner is seen. But light from a place that is small against the
//! lobe needs none: it is the lobe's own value there. So the brightest cells of a grid give away what they have above the brightest
//! of the others, and what is left has neither suns nor lamps, but the whole of everything else. That is no approximation: energy
//! is given away, not lost, and a lobe over the rest and over the emitters is the lobe over both.
//!
//! As a cell nears the brightness of the others its emitter nears nothing: which cells they are may change from frame to frame and
//! from texel to texel, without a step. An even sky has none.

use crate::lobe;
use crate::oem::Oem;
use crate::sphere::octahedral::{direction_from_oct, octahedron_from_oct};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// How many cells give away what they have above the next. A sun needs a few; of rooms with many lamps and windows twice as many
/// would hold more (at roughness 0.2 four boxes' worst panorama is off by 0.08 instead of 0.11), and every lobe pays for each.
pub const COUNT: usize = 127;

/// Cells along an edge of the grid, of an OEM of as many texels at least: 256, between a third and a half of the sharpest fitted
/// lobe's width at half maximum.
pub const GRID: u32 = 256;

/// Texels along an edge of a cell of an OEM of `inner` texels, a power of two.
#[must_use]
pub(crate) fn block(inner: u32) -> u32 {
    (inner / GRID).max(1)
}

/// Light from one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// Where it comes from on the mean: a unit vector of the OEM's space.
    pub direction: DVec3,
    /// Mean squared distance from there, on the unit sphere.
    pub spread: f64,
    /// Radiance times solid angle.
    pub energy: [f64; 3],
}

/// The emitters of `oem`, brightest first, and what they leave of it.
///
/// The OEM is a power of two wide, and at least 16 texels.
#[must_use]
pub fn taken_out(oem: &Oem) -> (Vec<Emitter>, Oem) {
    let inner = oem.size().inner;
    let block = block(inner);
    let side = inner / block;
    let texels_of = |cell: u32| {
        let corner = (cell % side * block, cell / side * block);
        (0..block * block).map(move |k| (corner.0 + k % block, corner.1 + k / block))
    };
    // The channels' sum, as radiance: a quarter of it, lest three overflow.
    let brightness = |cell: u32| {
        let [energy, solid_angle] = texels_of(cell).fold([0.0_f32; 2], |[energy, solid_angle], (x, y)| {
            let [r, g, b, w] = oem.texel(x, y);
            [energy + (r + g + b), solid_angle + w]
        });
        0.25 * energy / solid_angle
    };
    let mut cells: Vec<(f32, u32)> =
        (0..side * side).into_par_iter().map(|cell| (brightness(cell), cell)).collect();
    let (brightest, &mut (most, _), _) =
        cells.select_nth_unstable_by(COUNT, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    brightest.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));

    let mut rest: Vec<[f32; 4]> = (0..inner).flat_map(|y| oem.row(y)).copied().collect();
    let mut emitters = Vec::new();
    for &(brightness, cell) in brightest.iter().filter(|(brightness, _)| *brightness > most) {
        let kept = most / brightness;
        let given = f64::from(1.0 - kept);
        emitters.push(emitter(inner, texels_of(cell).map(|(x, y)| (x, y, oem.texel(x, y))), given));
        for (x, y) in texels_of(cell) {
            for energy in &mut rest[(y * inner + x) as usize][..3] {
                *energy *= kept;
            }
        }
    }
    (emitters, Oem::from_square(oem.size(), rest))
}

/// The share `given` of some texels of an OEM of `inner`, as one emitter.
fn emitter(inner: u32, texels: impl Iterator<Item = (u32, u32, [f32; 4])> + Clone, given: f64) -> Emitter {
    let width = 2.0 / f64::from(inner);
    let places = texels.clone().map(|(x, y, _)| (DVec2::new(f64::from(x), f64::from(y)) + 0.5) * width - 1.0);
    let energies = texels.map(|(_, _, [r, g, b, _])| [r, g, b].map(|energy| given * f64::from(energy)));
    let mut energy = [0.0; 3];
    let mut mean = DVec3::ZERO;
    for (uv, own) in places.clone().zip(energies.clone()) {
        for (sum, own) in energy.iter_mut().zip(own) {
            *sum += own;
        }
        mean += own.iter().sum::<f64>() * direction_from_oct(uv);
    }
    let direction = mean.normalize();
    let apart: f64 = places
        .zip(energies)
        .map(|(uv, own)| {
            own.iter().sum::<f64>()
                * (direction_from_oct(uv).distance_squared(direction) + width * width * texel_spread(uv))
        })
        .sum();
    Emitter { direction, spread: apart / energy.iter().sum::<f64>(), energy }
}

/// Mean squared distance on the sphere from the middle of a texel of width 1 at `uv`, by the map's derivative there: (4 |p|^2 -
/// (|x| - |y|)^2 - (|z| - |y|)^2) / (12 |p|^4), p being the point of the octahedron.
fn texel_spread(uv: DVec2) -> f64 {
    let p = octahedron_from_oct(uv);
    let [x, y, z] = p.abs().to_array();
    let squared = p.length_squared();
    (4.0 * squared - (x - y).powi(2) - (z - y).powi(2)) / (12.0 * squared * squared)
}

impl Emitter {
    /// Radiance of a GGX lobe of `alpha` around `direction`, a unit vector; `integral` is the lobe's over the sphere.
    ///
    /// What is spread around a place by a variance v is seen as from the place itself by a lobe of alpha^2 + v/2: near its middle
    /// GGX is 1 - d^2 / 2 alpha^2 of its peak, d the distance, and its peak is as 1 / alpha^2.
    #[must_use]
    pub fn radiance(&self, alpha: f64, integral: f64, direction: DVec3) -> [f64; 3] {
        let s = self.direction.distance_squared(direction) / 4.0;
        if s >= 0.5 {
            return [0.0; 3];
        }
        let widened = (alpha * alpha + self.spread / 2.0).min(1.0);
        let value = lobe::ggx(widened, s) / integral;
        self.energy.map(|energy| energy * value)
    }
}
