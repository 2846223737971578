//! The oracle: exhaustive integration in plain double precision, slow and independent of the engines.
//!
//! [`Oracle::reflect`] is a lobe over the source environment, each texel constant over its exact solid angle,
//! divided by the same sum over the kernel alone. It audits a whole bake, the reparameterisation included.
//! The tests have another for the lobe over the OEM's own texels, which the engines serve to their bilinear
//! share.
//!
//! It shares with the engines the definitions of the maps (the directions of `sphere`) and nothing else:
//! kernels, their integrals, quadrature and wrapping are its own.

pub mod integrate;
pub mod kernel;
pub mod reflection;

use crate::common::error::{Result, wrong};
use crate::geometry::exact::ExactTexels;
use crate::geometry::exact::patch::Accuracy;
use crate::light::environment::{Environment, Layout, Rgb};
use crate::lobe::Lobe;
use crate::sphere::{cube, equirect, octahedral};
use glam::{DVec3, DVec4};
use integrate::over_texel;
use kernel::{Kernel, MIRROR, Side};

/// Relative accuracy of the kernel's integral over a texel near the core of the lobe.
const TEXEL_ACCURACY: f64 = 1e-7;

/// Where the second moments of a texel are enough: its radius in units of the kernel's reach. The first term
/// left out is of fourth order, below (radius/reach)^4 / 4, which is 3e-6 here for the nearest such texel.
const MOMENTS_REACH: f64 = 0.06;

/// Share of the answer that a texel at the edge of the lobe's support may be off by before it is cut finer.
const EDGE_SHARE: f64 = 1e-7;

/// Levels of splitting at the edge of the support, at most.
const EDGE_LEVELS: u32 = 10;

/// An environment made ready for exhaustive integration.
#[derive(Debug)]
pub struct Oracle<'a> {
    environment: &'a Environment,
    texels: ExactTexels,
}

/// A texel that the lobe's support ends in.
struct EdgeTexel {
    block: usize,
    frame: usize,
    radiance: Rgb,
    /// Its kernel integral, roughly.
    estimate: f64,
    /// How far off that may be.
    doubt: f64,
}

/// What the sums of L K, and of K in the last component, grow by for K = 1.
fn summand([r, g, b]: Rgb) -> DVec4 {
    DVec4::new(r.into(), g.into(), b.into(), 1.0)
}

impl<'a> Oracle<'a> {
    /// Works out the texels' solid angles and moments, once for all queries.
    #[must_use]
    pub fn new(environment: &'a Environment) -> Self {
        Self { environment, texels: ExactTexels::new(environment.layout()) }
    }

    /// Radiance of `lobe` at `roughness` in [0, 1] around `direction` (of the world, any length but zero).
    ///
    /// Each channel is sum(L_i K_i) / sum(K_i), K_i the kernel's integral over texel i to a relative 1e-5 or
    /// better. At roughness 0 (below 3e-5) it is the radiance of the texel looked at, but for lobes that have
    /// no mirror.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a roughness outside [0, 1], and a direction that is
    /// zero or not finite.
    pub fn reflect(&self, lobe: Lobe, roughness: f64, direction: DVec3) -> Result<[f64; 3]> {
        if !(0.0..=1.0).contains(&roughness) {
            return wrong(format!("roughness {roughness} is outside [0, 1]"));
        }
        // Scale first: squares of tiny and huge lengths exceed the range of floats.
        let longest = direction.abs().max_element();
        if !(direction.is_finite() && longest > 0.0) {
            return wrong(format!(
                "the direction is {direction}; finite numbers that are not all 0 are needed"
            ));
        }
        let direction = if (1e-100..1e100).contains(&longest) { direction } else { direction / longest };
        Ok(self.reflected(lobe, roughness, direction))
    }

    /// [`Self::reflect`] of a checked roughness and direction.
    pub fn reflected(&self, lobe: Lobe, roughness: f64, direction: DVec3) -> [f64; 3] {
        let direction = (self.environment.source_from_world() * direction).normalize();
        if roughness < MIRROR && lobe.has_mirror() {
            return self.texel_towards(direction).map(f64::from);
        }
        let kernel = Kernel::new(lobe, roughness, direction);
        let accuracy = Accuracy::new(TEXEL_ACCURACY);
        let integral = |block, kernel: &Kernel, edge_levels| {
            over_texel(self.environment.layout(), block, kernel, &accuracy, edge_levels)
        };
        let radiance = self.environment.texels();
        let frames: Vec<DVec3> = self.texels.frames().iter().map(|f| *f * direction).collect();
        let mut sum = DVec4::ZERO;
        let mut edge = Vec::new();
        self.texels.for_each(|index, block, frame| {
            let texel = &self.texels.blocks()[block];
            let towards = frames[frame];
            if towards.dot(texel.centre) < -texel.radius {
                return;
            }
            let cosine = towards.dot(texel.mean);
            let variance = towards.dot(texel.covariance * towards);
            let kernel = kernel.around(towards);
            let distance = (texel.centre - towards).length();
            let side = kernel.side(texel.centre, texel.radius);
            let smooth = texel.radius < MOMENTS_REACH * kernel.reach(distance - texel.radius);
            match side {
                Side::Outside => {}
                Side::Inside if smooth => {
                    let (value, curvature) = kernel.curve(cosine);
                    sum +=
                        (value + curvature * variance / 2.0) * texel.solid_angle * summand(radiance[index]);
                }
                Side::Inside => sum += integral(block, &kernel, 0) * summand(radiance[index]),
                Side::Across => {
                    let edges = kernel.mean_at_edge(cosine, (3.0 * variance).sqrt());
                    let (mut estimate, mut doubt) =
                        (edges.0 * texel.solid_angle, edges.1 * texel.solid_angle);
                    if !smooth {
                        estimate = integral(block, &kernel, 2);
                        doubt /= 8.0;
                    }
                    edge.push(EdgeTexel { block, frame, radiance: radiance[index], estimate, doubt });
                }
            }
        });
        let brightest = |rgb: Rgb| f64::from(rgb[0].max(rgb[1]).max(rgb[2]));
        let total = edge.iter().map(|e| e.estimate * brightest(e.radiance)).sum::<f64>()
            + sum.truncate().max_element().max(0.0);
        // A cone inside one texel may have no estimate of its own integral; without light there is nothing to
        // refine.
        if total == 0.0 && edge.iter().all(|texel| texel.radiance == [0.0; 3]) {
            return [0.0; 3];
        }
        // Without light, estimates do not bound the mean: refine all, as if it were the greatest.
        let mean = if total > 0.0 {
            total / (edge.iter().map(|e| e.estimate).sum::<f64>() + sum.w)
        } else {
            edge.iter().map(|e| brightest(e.radiance)).fold(0.0, f64::max)
        };
        for texel in edge {
            // A texel counts in the sum over the kernel too, with the mean radiance. Every halving makes the
            // doubt about a kink or a jump at least 2^1.5 times less.
            let excess = texel.doubt * brightest(texel.radiance).max(mean) / (EDGE_SHARE * total);
            let value = if excess > 1.0 {
                let levels = (2.0 + excess.log2() / 1.5).ceil().min(f64::from(EDGE_LEVELS)) as u32;
                let kernel = kernel.around(frames[texel.frame]);
                integral(texel.block, &kernel, levels)
            } else {
                texel.estimate
            };
            sum += value * summand(texel.radiance);
        }
        if sum.w == 0.0 {
            // A cone that falls between all samples lies inside the texel looked at.
            return self.texel_towards(direction).map(f64::from);
        }
        (sum.truncate() / sum.w).to_array()
    }

    /// Radiance of the texel that `direction` (of the source, unit length) falls in.
    fn texel_towards(&self, direction: DVec3) -> Rgb {
        let nearest = |t: f64, n: u32| ((t * f64::from(n)) as usize).min(n as usize - 1);
        let index = match self.environment.layout() {
            Layout::Panorama { width, height } => {
                let (u, v) = equirect::equirect_from_direction(direction);
                nearest(v, height) * width as usize + nearest(u, width)
            }
            Layout::Cube { size } => {
                let (face, s, t) = cube::cube_from_direction(direction);
                let row = face.index() * size as usize + nearest((t + 1.0) / 2.0, size);
                row * size as usize + nearest((s + 1.0) / 2.0, size)
            }
            Layout::Octahedral { size } => {
                let uv = (octahedral::oct_from_direction(direction) + 1.0) / 2.0;
                nearest(uv.y, size) * size as usize + nearest(uv.x, size)
            }
        };
        self.environment.texels()[index]
    }
}
