//! Takes the brightest lights out of the levels; look-ups add their lobes exactly.
//!
//! A few Gaussians are off by 1 to 2 % of a lobe's peak. Under a sun that is several percent of the mean. So
//! the map is clamped, and its excess becomes 8 suns. Their seeds are the brightest texels that are not near
//! each other on the sphere, whatever folds lie between; the ninth is what the rest is clamped to. Texels
//! above it belong to the nearest seed. Around a seed texels count little by little: the clamp does not jump
//! when the map turns, and a constant sky has no suns.
//!
//! A texel's light counts as its centre, where sums over texels put it. That widens a sun by a twelfth of a
//! texel's square (Sheppard's correction), which is subtracted.

use super::Levels;
use crate::common::parallel;
use crate::common::vector::{Extremes as _, Fused as _};
use crate::light::oem::Oem;
use crate::lobe;
use crate::sphere::octahedral::{direction_from_oct, steps_from_oct, texel_centre};
use glam::{DVec2, DVec3, Vec3A};
use std::f32::consts::FRAC_1_PI;

/// Most suns.
pub const COUNT: usize = 8;

/// Blocks along an edge of the finest grid, whose brightest texels are kept.
pub const FINEST: u32 = 128;

/// Texels closer to a seed than this, on the unit sphere, are no seeds; at twice the distance they count
/// fully.
pub const NEAR: f32 = 0.02;

/// The same in texels of the map, over its edge.
pub const NEAR_TEXELS: f32 = 7.0;

/// Bits of a brightness that do not count: it is rounded to the nearest without them. Engines round
/// otherwise, and would choose other seeds among texels of one brightness. Those of lamps often are short
/// numbers, which rounding keeps together where cutting off would part them.
pub const BELOW: u32 = 255;

/// Half of these.
const HALF: u32 = BELOW.div_ceil(2);

/// A sun: the light above the clamp that is nearest to one seed. Lamps of several colours may share a sun, so
/// each channel has a place of its own. Half of its light is a disc [`Self::half_axis`] away from there, half
/// one on the other side: few suns are round.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sun {
    /// Red, green and blue.
    pub channels: [SunChannel; 3],
    /// From the mean directions to the centre of one disc, touching the sphere.
    pub half_axis: Vec3A,
}

/// One channel of a sun.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SunChannel {
    /// Mean direction, a unit vector in the map's space; zero without light.
    pub direction: Vec3A,
    /// Mean squared distance of its light from its disc's centre, on the unit sphere.
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
    /// The greatest radiance of any channel, rounded without [`BELOW`].
    pub greatest: f32,
}

/// What a block is judged by.
fn brightness([r, g, b, w]: [f32; 4]) -> f32 {
    r.max(g).max(b) / w
}

/// The bits of it that count.
fn counted(brightness: f32) -> f32 {
    let bits = brightness.to_bits().min(f32::MAX.to_bits() - HALF);
    f32::from_bits((bits + HALF) & !BELOW)
}

/// A brightness above all those that [`counted`] takes for this one, but the greatest floats.
fn most(counted: f32) -> f32 {
    if counted > 0.0 { f32::from_bits(counted.to_bits() + HALF) } else { 0.0 }
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
        let own = |[x, y]: [u32; 2]| brightness(oem.texel(x, y));
        let direction = |[x, y]: [u32; 2]| direction_from_oct(texel_centre(inner, x, y)).as_vec3a();
        let near = NEAR.max(NEAR_TEXELS / inner as f32);
        // How much a texel counts beside `seeds`.
        let apart = |texel: [u32; 2], seeds: &[Vec3A]| {
            let at = direction(texel);
            let nearest = seeds.iter().map(|seed| at.distance_squared(*seed)).fold(f32::INFINITY, f32::min);
            ((nearest / (near * near) - 1.0) / 3.0).clamp(0.0, 1.0)
        };
        let first = |a: (f32, [u32; 2]), b: (f32, [u32; 2])| if b.0 > a.0 { b } else { a };
        let none = (-1.0, [0; 2]);
        let brightest = parallel::values((side * side) as usize, |k| {
            texels(k as u32).map(|texel| (counted(own(texel)), texel)).fold(none, first)
        });
        let greatest = brightest.iter().copied().fold(none, first).0;
        let mut left = brightest.clone();
        let mut seeds = Vec::new();
        for _ in 0..COUNT {
            let (_, texel) = left.iter().copied().fold(none, first);
            seeds.push(direction(texel));
            for (left, k) in left.iter_mut().zip(0..) {
                if apart(left.1, &seeds[seeds.len() - 1..]) < 1.0 {
                    let beside = |texel| (counted(own(texel) * apart(texel, &seeds)), texel);
                    *left = texels(k).map(beside).fold(none, first);
                }
            }
        }
        let clamp = most(left.iter().copied().fold(none, first).0);
        let mut lights = [(); COUNT].map(|()| Vec::new());
        let bright = (0..).zip(&brightest).filter(|(_, (brightest, _))| most(*brightest) > clamp);
        for [x, y] in bright.flat_map(|(k, _)| texels(k)) {
            let given = 1.0 - kept(own([x, y]), clamp);
            if given > 0.0 {
                let at = direction([x, y]);
                let squared = |k: &usize| at.distance_squared(seeds[*k]);
                let nearest = (0..COUNT).min_by(|a, b| squared(a).total_cmp(&squared(b)));
                let [r, g, b, _] = oem.texel(x, y).map(|energy| f64::from(given * energy));
                lights[nearest.expect("seeds")].push((texel_centre(inner, x, y), [r, g, b]));
            }
        }
        let suns = lights.map(|light| Sun::of(2.0 / f64::from(inner), &light));
        Self { suns, clamp, greatest }
    }
}

/// The share of a texel that stays in the map.
pub(crate) fn kept(brightness: f32, clamp: f32) -> f32 {
    if brightness > clamp { clamp / brightness } else { 1.0 }
}

impl Sun {
    /// The sun of `texels` of the width `texel`: their centres on the square, and energies.
    fn of(texel: f64, texels: &[(DVec2, [f64; 3])]) -> Self {
        let sum = |c: usize| texels.iter().map(|(_, energy)| energy[c]).sum::<f64>();
        let energies = [0, 1, 2].map(sum);
        let all: f64 = energies.iter().sum();
        if all == 0.0 {
            return Self::default();
        }
        let mean = |c: usize| {
            let own = texels.iter().map(|(at, energy)| energy[c] * direction_from_oct(*at));
            own.sum::<DVec3>().normalize_or_zero()
        };
        let directions = [0, 1, 2].map(mean);
        let middle: DVec3 = directions.iter().zip(energies).map(|(to, energy)| energy / all * *to).sum();
        // Channels that are opposite leave no direction.
        let (t, b) = middle.try_normalize().unwrap_or(DVec3::Z).any_orthonormal_pair();
        // Covariances of the channels in the plane that touches the sphere: along t, along both, along b.
        let mut covariances = [DVec3::ZERO; 3];
        for (at, energy) in texels {
            let (centre, steps) = (direction_from_oct(*at), steps_from_oct(*at));
            let area: DVec3 = steps.iter().map(|step| products(*step, t, b) * texel * texel / 12.0).sum();
            for c in (0..3).filter(|c| energies[*c] > 0.0) {
                covariances[c] += energy[c] / energies[c] * (products(centre - directions[c], t, b) - area);
            }
        }
        let [tt, tb, bb] = covariances
            .iter()
            .zip(energies)
            .map(|(covariance, energy)| energy / all * *covariance)
            .sum::<DVec3>()
            .to_array();
        // Half the sum of its eigenvalues, and half their difference: the half axis squared is the difference
        // of those above 0.
        let (mean, apart) = (0.5 * (tt + bb), (0.5 * (tt - bb)).hypot(tb));
        let square = (mean + apart).max(0.0) - (mean - apart).max(0.0);
        let angle = 0.5 * tb.atan2(0.5 * (tt - bb));
        let channel = |c: usize| SunChannel {
            direction: directions[c].as_vec3a(),
            spread: (covariances[c].x + covariances[c].z - square).max(0.0) as f32,
            energy: energies[c] as f32,
        };
        let half_axis = square.sqrt() * (angle.cos() * t + angle.sin() * b);
        Self { channels: [0, 1, 2].map(channel), half_axis: half_axis.as_vec3a() }
    }

    /// The centres of a channel's two discs.
    pub(super) fn discs(&self, channel: &SunChannel) -> [Vec3A; 2] {
        let middle = channel.direction * (1.0 - 0.5 * self.half_axis.length_squared());
        [middle + self.half_axis, middle - self.half_axis]
    }

    /// Its irradiance on a surface with the unit `normal`, over pi.
    pub(crate) fn diffuse(&self, normal: Vec3A) -> Vec3A {
        let facing = |channel: SunChannel| channel.energy * channel.direction.dot(normal).max(0.0);
        FRAC_1_PI * Vec3A::from_array(self.channels.map(facing))
    }
}

/// Discs of all suns.
const DISCS: usize = 2 * COUNT;

/// The suns' light in GGX lobes of one roughness, by discs.
#[derive(Clone, Debug)]
pub(super) struct GlossySuns {
    channels: [Discs; 3],
    alpha2: f32,
}

/// One channel's discs.
#[derive(Clone, Debug)]
struct Discs {
    x: [f32; DISCS],
    y: [f32; DISCS],
    z: [f32; DISCS],
    radius2: [f32; DISCS],
    /// Of a disc, over pi and the lobe's integral.
    energy: [f32; DISCS],
}

impl GlossySuns {
    /// Lobes of `alpha`; `share` is 1 over their integral.
    pub(super) fn new(suns: &[Sun; COUNT], alpha: f32, share: f32) -> Self {
        let channel = |c: usize| {
            let of = |part: &dyn Fn(&Sun, usize) -> f32| std::array::from_fn(|k| part(&suns[k / 2], k % 2));
            let centre = |sun: &Sun, side: usize| sun.discs(&sun.channels[c])[side];
            Discs {
                x: of(&|sun, side| centre(sun, side).x),
                y: of(&|sun, side| centre(sun, side).y),
                z: of(&|sun, side| centre(sun, side).z),
                radius2: of(&|sun, _| sun.channels[c].spread / 2.0),
                energy: of(&|sun, _| 0.5 * share * FRAC_1_PI * sun.channels[c].energy),
            }
        };
        // Sharper lobes read the mirror; a sun of one texel is a point there.
        let alpha2 = (alpha * alpha).at_least(1e-12);
        Self { channels: [0, 1, 2].map(channel), alpha2 }
    }

    /// Those around the unit vector `direction`.
    ///
    /// GGX under uniform discs, in closed form: a2 / (a2 + s)^2 is the kernel of a parallel disc's form
    /// factor.
    #[inline(always)]
    pub(super) fn around(&self, direction: Vec3A) -> Vec3A {
        let (a2, [dx, dy, dz]) = (self.alpha2, direction.to_array());
        let mut sums = [0.0; 3];
        for (sum, discs) in sums.iter_mut().zip(&self.channels) {
            let mut shares = [0.0; DISCS];
            for k in 0..DISCS {
                let (x, y, z, radius2) =
                    (dx - discs.x[k], dy - discs.y[k], dz - discs.z[k], discs.radius2[k]);
                let s = (0.25 * x.times_plus(x, y.times_plus(y, z * z))).at_most(0.5);
                let nearness = s + a2 * (1.0 - s) - radius2;
                let root =
                    nearness.times_plus(nearness, 4.0 * radius2 * a2).sqrt().at_least(f32::MIN_POSITIVE);
                let (above, below) = if nearness > 0.0 {
                    (2.0 * a2, root + nearness)
                } else {
                    (root - nearness, 2.0 * radius2)
                };
                let light = discs.energy[k] * (above / (below * root)) * (1.0 - 2.0 * s);
                shares[k] = if discs.energy[k] > 0.0 { light } else { 0.0 };
            }
            *sum = shares.iter().sum();
        }
        Vec3A::from_array(sums)
    }
}

/// The products of `v`'s parts along `t` and `b`: of the first, of both, of the second.
fn products(v: DVec3, t: DVec3, b: DVec3) -> DVec3 {
    let (along, across) = (v.dot(t), v.dot(b));
    DVec3::new(along * along, along * across, across * across)
}

/// 1 over the integral of GGX at `roughness`.
pub(crate) fn lobe_share(levels: Levels, roughness: f64) -> f64 {
    let alpha = (roughness * roughness).max(0.5 * levels.width(0));
    1.0 / lobe::ggx_integral(alpha)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Short numbers, which lamps in files have, count as one brightness when engines are a few units off.
    #[test]
    fn a_brightness_counts_as_its_neighbours_do() {
        for short in [0.5_f32, 1.0, 3.0, 100.0, 60_000.0] {
            for off in 0..=3 {
                let [above, below] = [short.to_bits() + off, short.to_bits() - off].map(f32::from_bits);
                assert_eq!(counted(above), counted(below), "{short}");
                assert!(most(counted(above)) > above, "{short}");
            }
        }
        assert_ne!(counted(100.0), counted(f32::from_bits(100.0_f32.to_bits() + BELOW)));
        assert!(counted(f32::MAX).is_finite() && most(counted(f32::MAX)).is_finite());
        assert_eq!([counted(0.0), most(0.0)], [0.0; 2]);
    }
}
