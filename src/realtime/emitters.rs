//! Extracts the brightest cells of an OEM as point emitters for the real-time tier.
//!
//! A few boxes do not have the shape of a lobe, and under a sun each of their corners is visible. A source
//! that is small compared with the lobe needs no boxes: its contribution is the lobe's own value there.
//! Therefore each of the N brightest cells of a grid is clamped to the radiance of the (N+1)-th; the excess
//! becomes a point emitter. The residual map has neither suns nor lamps. Energy is conserved: the lobe over
//! the residual map plus the lobe over the emitters is the lobe over both.
//!
//! As a cell's brightness approaches that of the others, its emitter vanishes: the set of emitters may change
//! from frame to frame without a visible step. A constant sky has none.

use crate::lobe;
use crate::oem::Oem;
use crate::sphere::octahedral::{direction_from_oct, octahedron_from_oct};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Greatest number of emitters. A sun needs a few. Rooms with many lamps and windows would gain from twice as
/// many (the worst panorama of four boxes at roughness 0.2 would have an error of 0.08 instead of 0.11), but
/// every lobe pays for each emitter.
pub const COUNT: usize = 127;

/// Cells along an edge of the grid, if the OEM has as many texels. A cell is between a third and a half of
/// the sharpest fitted lobe's full width at half maximum.
pub const GRID: u32 = 256;

/// Texels along an edge of a cell of an OEM of `inner` texels, a power of two.
#[must_use]
pub(crate) fn block(inner: u32) -> u32 {
    (inner / GRID).max(1)
}

/// A point emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// Mean direction, a unit vector in the OEM's space.
    pub direction: DVec3,
    /// Mean squared distance of its light from that direction, on the unit sphere.
    pub spread: f64,
    /// Radiance times solid angle.
    pub energy: [f64; 3],
}

/// Extracts emitters; returns them, brightest first, with the residual map.
///
/// The size of the OEM must be a power of two and at least 16 texels.
#[must_use]
pub fn extracted(oem: &Oem) -> (Vec<Emitter>, Oem) {
    let inner = oem.size().inner;
    let block = block(inner);
    let side = inner / block;
    let texels_of = |cell: u32| {
        let corner = (cell % side * block, cell / side * block);
        (0..block * block).map(move |k| (corner.0 + k % block, corner.1 + k / block))
    };
    // A quarter of the sum of the channels' radiance, so that the sum does not overflow.
    let brightness = |cell: u32| {
        let [energy, solid_angle] = texels_of(cell).fold([0.0_f32; 2], |[energy, solid_angle], (x, y)| {
            let [r, g, b, w] = oem.texel(x, y);
            [energy + (r + g + b), solid_angle + w]
        });
        0.25 * energy / solid_angle
    };
    let mut cells: Vec<(f32, u32)> =
        (0..side * side).into_par_iter().map(|cell| (brightness(cell), cell)).collect();
    let brighter = |a: &(f32, u32), b: &(f32, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    let (brightest, &mut (most, _), _) = cells.select_nth_unstable_by(COUNT, brighter);
    brightest.sort_unstable_by(brighter);

    let mut rest: Vec<[f32; 4]> = oem.square().copied().collect();
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

/// Makes an emitter from the share `given` of the energy of some texels of an OEM of size `inner`.
fn emitter(inner: u32, texels: impl Iterator<Item = (u32, u32, [f32; 4])> + Clone, given: f64) -> Emitter {
    let width = 2.0 / f64::from(inner);
    let centres =
        texels.clone().map(|(x, y, _)| (DVec2::new(f64::from(x), f64::from(y)) + 0.5) * width - 1.0);
    let energies = texels.map(|(_, _, [r, g, b, _])| [r, g, b].map(|energy| given * f64::from(energy)));
    let mut energy = [0.0; 3];
    let mut mean = DVec3::ZERO;
    for (uv, own) in centres.clone().zip(energies.clone()) {
        for (sum, own) in energy.iter_mut().zip(own) {
            *sum += own;
        }
        mean += own.iter().sum::<f64>() * direction_from_oct(uv);
    }
    let direction = mean.normalize();
    let apart: f64 = centres
        .zip(energies)
        .map(|(uv, own)| {
            own.iter().sum::<f64>()
                * (direction_from_oct(uv).distance_squared(direction) + width * width * texel_spread(uv))
        })
        .sum();
    Emitter { direction, spread: apart / energy.iter().sum::<f64>(), energy }
}

/// Mean squared distance on the sphere from the centre of a texel of width 1 at `uv`, from the map's
/// derivative there: (4 |p|^2 - (|x| - |y|)^2 - (|z| - |y|)^2) / (12 |p|^4), with p the point of the
/// octahedron.
fn texel_spread(uv: DVec2) -> f64 {
    let p = octahedron_from_oct(uv);
    let [x, y, z] = p.abs().to_array();
    let squared = p.length_squared();
    (4.0 * squared - (x - y).powi(2) - (z - y).powi(2)) / (12.0 * squared * squared)
}

impl Emitter {
    /// Radiance of a GGX lobe of `alpha` around the unit vector `direction`; `integral` is the lobe's
    /// integral over the sphere.
    ///
    /// A source with variance v around its mean is evaluated at its mean by a lobe of alpha^2 + v/2: near its
    /// centre GGX is 1 - d^2 / 2 alpha^2 of its peak at the distance d, and its peak is proportional to 1 /
    /// alpha^2.
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
