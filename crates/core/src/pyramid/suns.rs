//! Takes the brightest lights out of the levels; look-ups add their lobes exactly.
//!
//! A few Gaussians are off by 1 to 2 % of a lobe's peak. Under a sun that is several percent of the mean. So
//! the brightest 8 blocks of texels are clamped to the radiance of the ninth, and their excess becomes suns.
//! As a block's brightness approaches that of the others its sun vanishes: blocks may change from frame to
//! frame without a visible step, and a constant sky has no suns.

use super::Octaves;
use crate::light::oem::Oem;
use crate::lobe;
use crate::sphere::octahedral::{direction_from_oct, octahedron_from_oct, texel_centre};
use glam::{DVec3, Vec3A};
use rayon::prelude::*;
use std::f32::consts::FRAC_1_PI;

/// Most suns.
pub const COUNT: usize = 8;

/// Blocks along an edge of the finest grid.
pub const FINEST: u32 = 128;

/// A sun: the light that a block has above the others. Lamps of several colours may share a block, so each
/// channel has a place of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sun {
    /// Red, green and blue.
    pub channels: [SunChannel; 3],
}

/// One channel of a sun.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SunChannel {
    /// Mean direction, a unit vector in the map's space; zero without light.
    pub direction: Vec3A,
    /// Mean squared distance of its light from there, on the unit sphere.
    pub spread: f32,
    /// Radiance times solid angle.
    pub energy: f32,
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
            sun.channels =
                [0, 1, 2].map(|c| SunChannel::of(inner, above.clone().map(|(at, energy)| (at, energy[c]))));
        }
        Self { suns, clamp, greatest: chosen[0].0 }
    }
}

/// The share of a texel that stays in the map.
pub(crate) fn kept(brightness: f32, clamp: f32) -> f32 {
    if brightness > clamp { clamp / brightness } else { 1.0 }
}

impl Sun {
    /// Its light in a GGX lobe of `alpha` around the unit vector `direction`; `share` is 1 over the lobe's
    /// integral.
    pub(crate) fn glossy(&self, alpha: f32, share: f32, direction: Vec3A) -> Vec3A {
        Vec3A::from_array(self.channels.map(|channel| channel.glossy(alpha, direction))) * share
    }

    /// Its irradiance on a surface with the unit `normal`, over pi.
    pub(crate) fn diffuse(&self, normal: Vec3A) -> Vec3A {
        let facing = |channel: SunChannel| channel.energy * channel.direction.dot(normal).max(0.0);
        FRAC_1_PI * Vec3A::from_array(self.channels.map(facing))
    }
}

impl SunChannel {
    /// The sun of some texels' energies.
    fn of(inner: u32, texels: impl Iterator<Item = ([u32; 2], f64)> + Clone) -> Self {
        let texels = texels.map(|([x, y], energy)| {
            (direction_from_oct(texel_centre(inner, x, y)), texel_spread(inner, x, y), energy)
        });
        let energy: f64 = texels.clone().map(|(_, _, energy)| energy).sum();
        let mean: DVec3 = texels.clone().map(|(centre, _, energy)| energy * centre).sum();
        if energy == 0.0 {
            return Self::default();
        }
        let direction = mean.normalize();
        let apart: f64 = texels
            .map(|(centre, spread, energy)| energy * (centre.distance_squared(direction) + spread))
            .sum();
        Self { direction: direction.as_vec3a(), spread: (apart / energy) as f32, energy: energy as f32 }
    }

    /// A light of variance v around its mean is evaluated there by a lobe of alpha^2 + v / 2: near its centre
    /// GGX is 1 - d^2 / 2 alpha^2 of its peak at the distance d.
    fn glossy(&self, alpha: f32, direction: Vec3A) -> f32 {
        if self.energy == 0.0 {
            return 0.0;
        }
        let s = (self.direction.distance_squared(direction) / 4.0).min(0.5);
        let widened = (alpha * alpha + self.spread / 2.0).min(1.0);
        self.energy * lobe::ggx(f64::from(widened), f64::from(s)) as f32
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
