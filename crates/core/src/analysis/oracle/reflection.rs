//! The true reflection by exhaustive integration: GGX with Smith's height-correlated masking, any view.

use super::Oracle;
use super::integrate::Cut;
use super::kernel::{Kernel, Side};
use crate::common::frame::Frame;
use crate::geometry::exact::patch::{Accuracy, Patch, Sample, finest_rule};
use crate::geometry::exact::{cube_texel, for_each_octahedral_piece, panorama_texel};
use crate::light::environment::Layout;
use crate::lobe::Lobe;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::{PI, SQRT_2};

/// Relative accuracy over a piece.
const ACCURACY: f64 = 1e-6;

/// Levels of splitting where the horizon cannot be cut exactly, at most.
const EDGE_LEVELS: u32 = 6;

/// A reflection in a texel's own space.
struct Reflection {
    tangent: DVec3,
    bitangent: DVec3,
    normal: DVec3,
    view: DVec3,
    alpha: [f64; 2],
    /// The upper hemisphere.
    above: Kernel,
}

impl Reflection {
    fn masking(&self, w: DVec3) -> f64 {
        let (x, y) = (self.alpha[0] * w.dot(self.tangent), self.alpha[1] * w.dot(self.bitangent));
        (x * x + y * y + w.dot(self.normal).powi(2)).sqrt()
    }

    /// D V (n.l) without and with (1 - v.h)^5, towards the unit vector `light`.
    fn at(&self, light: DVec3) -> DVec2 {
        let half = (light + self.view).normalize();
        let [x, y] = [half.dot(self.tangent) / self.alpha[0], half.dot(self.bitangent) / self.alpha[1]];
        let bend = x * x + y * y + half.dot(self.normal).powi(2);
        let distribution = 1.0 / (PI * self.alpha[0] * self.alpha[1] * bend * bend);
        let (nl, nv) = (light.dot(self.normal).max(0.0), self.view.dot(self.normal));
        let visible = 0.5 / (nl * self.masking(self.view) + nv * self.masking(light)).max(f64::MIN_POSITIVE);
        distribution * visible * nl * DVec2::new(1.0, (1.0 - self.view.dot(half)).powi(5))
    }

    /// The length over which the reflection changes within a cap of chord `radius`.
    ///
    /// A light that moves by d moves the half vector by up to d / (2 v.h), and that one's slopes count in
    /// units of their alphas: across a ridge the reflection changes over the lesser one, as far out as the
    /// other says.
    fn reach(&self, centre: DVec3, radius: f64) -> f64 {
        let half = (centre + self.view).normalize_or(self.normal);
        let towards = (self.view.dot(half) - radius / 2.0).max(0.5 * self.view.dot(self.normal));
        let least = self.alpha[0].min(self.alpha[1]);
        let slopes = DVec2::new(half.dot(self.tangent), half.dot(self.bitangent));
        let slope = (slopes * least / DVec2::from_array(self.alpha)).length() - radius / (2.0 * towards);
        (2.0 * towards * slope.max(0.0).hypot(least)).min(1.0)
    }

    /// The integral over `patch`; pieces that the horizon crosses are split `edge_levels` times until it is
    /// cut.
    fn over<P: Cut>(&self, patch: &P, accuracy: &Accuracy, edge_levels: u32) -> DVec2 {
        let (centre, radius) = patch.cap();
        match self.above.side(centre, radius) {
            Side::Outside => DVec2::ZERO,
            Side::Inside => self.inside(patch, accuracy, 0),
            Side::Across => {
                let mut sum = DVec2::ZERO;
                if patch.cut(&self.above, &mut |piece| sum += self.inside(&piece, accuracy, 0)) {
                    sum
                } else if edge_levels == 0 {
                    self.inside(patch, accuracy, 0)
                } else {
                    patch.split().iter().map(|p| self.over(p, accuracy, edge_levels - 1)).sum()
                }
            }
        }
    }

    /// The integral over block `block` of `layout`, in whose space this is.
    fn over_block(&self, layout: Layout, block: usize, accuracy: &Accuracy) -> DVec2 {
        match layout {
            Layout::Panorama { width, height } => {
                self.over(&panorama_texel(width, height, block), accuracy, EDGE_LEVELS)
            }
            Layout::Cube { size } => self.over(&cube_texel(size, block), accuracy, EDGE_LEVELS),
            Layout::Octahedral { size } => {
                let mut sum = DVec2::ZERO;
                for_each_octahedral_piece(size, block, |p| sum += self.over(&p, accuracy, EDGE_LEVELS));
                sum
            }
        }
    }

    fn inside<P: Patch>(&self, patch: &P, accuracy: &Accuracy, level: u32) -> DVec2 {
        let (centre, radius) = patch.cap();
        let side = (SQRT_2 * radius / self.reach(centre, radius)).max(patch.bend());
        let Some(rule) = accuracy.rule(side).or_else(|| (level == 24).then(finest_rule)) else {
            return patch.split().iter().map(|p| self.inside(p, accuracy, level + 1)).sum();
        };
        let mut sum = DVec2::ZERO;
        patch.sample(rule, &mut |s: Sample| sum += self.at(s.point / s.length_squared.sqrt()) * s.weight);
        sum
    }
}

/// Radiance reflected to the viewer of `frame` (in the world), at `roughness` in (0, 1] and `anisotropy`
/// in [0, 1]: without Fresnel's term, and times (1 - v.h)^5. With f0 and f90 it is f0 times the first
/// plus (f90 - f0) times the second. A frame without a tangent reflects isotropically.
pub fn reflection(oracle: &Oracle<'_>, frame: &Frame, roughness: f64, anisotropy: f64) -> [[f64; 3]; 2] {
    let axes: DMat3 = oracle.environment.source_from_world() * frame.axes;
    let view = axes * frame.view;
    let alpha = roughness * roughness;
    let more = if frame.has_tangent { (1.0 - alpha) * anisotropy * anisotropy } else { 0.0 };
    let alpha = [alpha + more, alpha];
    let accuracy = Accuracy::new(ACCURACY);
    let layout = oracle.environment.layout();
    let cosine = Kernel::new(Lobe::Cosine, 1.0, axes.z_axis);
    let turned: Vec<Reflection> = oracle
        .texels
        .frames()
        .iter()
        .map(|turn| Reflection {
            tangent: *turn * axes.x_axis,
            bitangent: *turn * axes.y_axis,
            normal: *turn * axes.z_axis,
            view: *turn * view,
            alpha,
            above: cosine.around(*turn * axes.z_axis),
        })
        .collect();
    let mut sums = [DVec3::ZERO; 2];
    oracle.texels.for_each(|index, block, frame| {
        let radiance = oracle.environment.texels()[index];
        let (texel, reflection) = (&oracle.texels.blocks()[block], &turned[frame]);
        if radiance == [0.0; 3] || reflection.normal.dot(texel.centre) < -texel.radius {
            return;
        }
        let own = reflection.over_block(layout, block, &accuracy);
        let light = DVec3::from(radiance.map(f64::from));
        sums = [sums[0] + own.x * light, sums[1] + own.y * light];
    });
    sums.map(DVec3::into)
}
