//! Takes the brightest lights out of the levels; look-ups add their lobes exactly.
//!
//! A few Gaussians are off by 1 to 2 % of a lobe's peak. Under a sun that is several percent of the mean. So
//! the brightest 8 blocks of texels are clamped to the radiance of the ninth, and their excess becomes suns.
//! As a block's brightness approaches that of the others its sun vanishes: blocks may change from frame to
//! frame without a visible step, and a constant sky has no suns.

use super::Octaves;
use crate::lobe;
use crate::oem::Oem;
use crate::sphere::octahedral::{direction_from_oct, octahedron_from_oct, texel_centre};
use glam::{DVec3, Vec3A};
use rayon::prelude::*;
use std::f32::consts::FRAC_1_PI;

/// Most suns.
pub const COUNT: usize = 8;

/// Blocks along an edge of the finest grid.
pub const FINEST: u32 = 128;

/// A sun: the light that a block has above the others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sun {
    /// Mean direction, a unit vector in the map's space.
    pub direction: Vec3A,
    /// Mean squared distance of its light from there, on the unit sphere.
    pub spread: f32,
    /// Radiance times solid angle.
    pub energy: Vec3A,
}

/// The brightest lights of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suns {
    /// The suns; those that are not needed have no energy.
    pub suns: [Sun; COUNT],
    /// What the greatest channel of the rest is clamped to.
    pub clamp: f32,
    /// The greatest radiance of any channel.
    pub greatest: f32,
}

/// What a block is judged by.
fn brightness([r, g, b, w]: [f32; 4]) -> f32 {
    r.max(g).max(b) / w
}

impl Suns {
    /// The suns of `oem`.
    #[must_use]
    pub fn of(oem: &Oem) -> Self {
        let inner = oem.size().inner;
        let side = inner.min(FINEST);
        let block = inner / side;
        let texels = |k: u32| {
            let corner = [k % side * block, k / side * block];
            (0..block * block).map(move |texel| [corner[0] + texel % block, corner[1] + texel / block])
        };
        let brightest = |k| texels(k).map(|[x, y]| brightness(oem.texel(x, y))).fold(0.0, f32::max);
        let mut blocks: Vec<(f32, u32)> =
            (0..side * side).into_par_iter().map(|k| (brightest(k), k)).collect();
        let brighter = |a: &(f32, u32), b: &(f32, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
        let (chosen, &mut (clamp, _), _) = blocks.select_nth_unstable_by(COUNT, brighter);
        chosen.sort_unstable_by(brighter);
        let mut suns = [Sun::default(); COUNT];
        for (sun, (_, k)) in suns.iter_mut().zip(&*chosen) {
            let above = texels(*k).map(|[x, y]| {
                let texel = oem.texel(x, y);
                let given = 1.0 - kept(brightness(texel), clamp);
                ([x, y], [texel[0], texel[1], texel[2]].map(|energy| f64::from(given * energy)))
            });
            *sun = Sun::of(inner, above.filter(|(_, energy)| energy.iter().sum::<f64>() > 0.0));
        }
        Self { suns, clamp, greatest: chosen[0].0 }
    }
}

/// The share of a texel that stays in the map.
#[must_use]
pub(crate) fn kept(brightness: f32, clamp: f32) -> f32 {
    if brightness > clamp { clamp / brightness } else { 1.0 }
}

impl Sun {
    /// The sun of some texels' energies.
    fn of(inner: u32, texels: impl Iterator<Item = ([u32; 2], [f64; 3])> + Clone) -> Self {
        let (mut energy, mut mean) = (DVec3::ZERO, DVec3::ZERO);
        for ([x, y], own) in texels.clone() {
            energy += DVec3::from_array(own);
            mean += own.iter().sum::<f64>() * direction_from_oct(texel_centre(inner, x, y));
        }
        if mean == DVec3::ZERO {
            return Self::default();
        }
        let direction = mean.normalize();
        let apart: f64 = texels
            .map(|([x, y], own)| {
                let centre = direction_from_oct(texel_centre(inner, x, y));
                own.iter().sum::<f64>() * (centre.distance_squared(direction) + texel_spread(inner, x, y))
            })
            .sum();
        Self {
            direction: direction.as_vec3a(),
            spread: (apart / energy.element_sum()) as f32,
            energy: energy.as_vec3a(),
        }
    }

    /// Its light in a GGX lobe of `alpha` around the unit vector `direction`; `share` is 1 over the lobe's
    /// integral.
    ///
    /// A light of variance v around its mean is evaluated there by a lobe of alpha^2 + v / 2: near its centre
    /// GGX is 1 - d^2 / 2 alpha^2 of its peak at the distance d.
    pub(crate) fn glossy(&self, alpha: f32, share: f32, direction: Vec3A) -> Vec3A {
        let s = self.direction.distance_squared(direction) / 4.0;
        if s >= 0.5 {
            return Vec3A::ZERO;
        }
        let widened = (alpha * alpha + self.spread / 2.0).min(1.0);
        self.energy * (lobe::ggx(f64::from(widened), f64::from(s)) as f32 * share)
    }

    /// Its irradiance on a surface with the unit `normal`, over pi.
    pub(crate) fn diffuse(&self, normal: Vec3A) -> Vec3A {
        self.energy * (FRAC_1_PI * self.direction.dot(normal).max(0.0))
    }
}

/// Mean squared distance on the sphere of a texel's points from its centre, from the map's derivative there:
/// (4 |p|^2 - (|x| - |y|)^2 - (|z| - |y|)^2) / (12 |p|^4) for a texel of width 1, p on the octahedron.
fn texel_spread(inner: u32, x: u32, y: u32) -> f64 {
    let p = octahedron_from_oct(texel_centre(inner, x, y));
    let [x, y, z] = p.abs().to_array();
    let squared = p.length_squared();
    let width = 2.0 / f64::from(inner);
    width * width * (4.0 * squared - (x - y).powi(2) - (z - y).powi(2)) / (12.0 * squared * squared)
}

/// 1 over the integral of GGX at `roughness`.
pub(crate) fn lobe_share(octaves: Octaves, roughness: f64) -> f64 {
    let alpha = (roughness * roughness).max(0.5 * octaves.mirror_width());
    1.0 / lobe::ggx_integral(alpha)
}
