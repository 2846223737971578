//! Quadrature of a kernel over pieces of the sphere, which are cut in four until the kernel is smooth on
//! them.

use super::kernel::{Kernel, Side};
use crate::geometry::exact::patch::{Accuracy, Band, Flat, Patch, Sample, finest_rule};
use crate::geometry::exact::{cube_texel, for_each_octahedral_piece, panorama_texel};
use crate::light::environment::Layout;
use glam::DVec2;
use std::f64::consts::SQRT_2;

/// A piece that kernels may end in.
pub trait Cut: Patch {
    /// Cuts along the boundary of the kernel's support and calls `keep` with the pieces inside; false where
    /// that cannot be done, or not yet.
    fn cut(&self, kernel: &Kernel, keep: &mut impl FnMut(Self)) -> bool;
}

/// Calls `visit` with quadrature points of `patch` and the kernel there; weights sum to the solid angle. At a
/// boundary of the support that is not cut exactly, pieces are split `edge_levels` times.
pub fn integrate<P: Cut, V: FnMut(Sample, f64)>(
    patch: &P,
    kernel: &Kernel,
    accuracy: &Accuracy,
    edge_levels: u32,
    visit: &mut V,
) {
    let (centre, radius) = patch.cap();
    match kernel.side(centre, radius) {
        Side::Outside => {}
        Side::Inside => integrate_inside(patch, kernel, accuracy, 0, visit),
        Side::Across => {
            if patch.cut(kernel, &mut |piece| integrate_inside(&piece, kernel, accuracy, 0, visit)) {
                return;
            }
            if edge_levels == 0 {
                let rule = accuracy.rule(0.0).expect("a rule for points");
                patch.sample(rule, &mut |s| visit(s, kernel.at(s.point, s.length_squared)));
                return;
            }
            for quarter in patch.split() {
                integrate(&quarter, kernel, accuracy, edge_levels - 1, visit);
            }
        }
    }
}

/// The same for a piece on which the kernel is smooth.
fn integrate_inside<P: Cut, V: FnMut(Sample, f64)>(
    patch: &P,
    kernel: &Kernel,
    accuracy: &Accuracy,
    level: u32,
    visit: &mut V,
) {
    let (centre, radius) = patch.cap();
    let nearest = (centre.distance(kernel.direction) - radius).max(0.0);
    if nearest >= kernel.vanishes {
        return;
    }
    let side = (SQRT_2 * radius / kernel.panel(nearest)).max(patch.bend());
    // A sixtieth halving is below the rounding of a direction.
    match accuracy.rule(side).or_else(|| (level == 60).then(finest_rule)) {
        Some(rule) => patch.sample(rule, &mut |s| visit(s, kernel.at(s.point, s.length_squared))),
        None => {
            for quarter in patch.split() {
                integrate_inside(&quarter, kernel, accuracy, level + 1, visit);
            }
        }
    }
}

/// The integral of `kernel`, given in the block's own space, over block `block` of `layout`.
pub fn over_texel(
    layout: Layout,
    block: usize,
    kernel: &Kernel,
    accuracy: &Accuracy,
    edge_levels: u32,
) -> f64 {
    let mut sum = 0.0;
    let mut add = |s: Sample, value: f64| sum += s.weight * value;
    match layout {
        Layout::Panorama { width, height } => {
            let texel = panorama_texel(width, height, block);
            integrate(&texel, kernel, accuracy, edge_levels, &mut add);
        }
        Layout::Cube { size } => {
            integrate(&cube_texel(size, block), kernel, accuracy, edge_levels, &mut add);
        }
        Layout::Octahedral { size } => for_each_octahedral_piece(size, block, |piece| {
            integrate(&piece, kernel, accuracy, edge_levels, &mut add);
        }),
    }
    sum
}

impl Cut for Flat {
    fn cut(&self, kernel: &Kernel, keep: &mut impl FnMut(Self)) -> bool {
        if !kernel.is_hemisphere() {
            // A circle is cut along chords: with pieces this small the area between is below 1e-6 of its own.
            let (_, radius) = self.cap();
            if radius > 1e-3 * kernel.support {
                return false;
            }
        }
        let depth = self.corners.map(|c| kernel.depth(self.plane.point(c)));
        if depth.iter().all(|d| *d >= 0.0) {
            keep(*self);
            return true;
        }
        // Walk round the outline, keep what is inside, and cut the edges that cross.
        let mut outline = [DVec2::ZERO; 8];
        let mut count = 0;
        for k in 0..4 {
            let next = (k + 1) % 4;
            if depth[k] >= 0.0 {
                outline[count] = self.corners[k];
                count += 1;
            }
            if (depth[k] > 0.0 && depth[next] < 0.0) || (depth[k] < 0.0 && depth[next] > 0.0) {
                outline[count] =
                    self.corners[k].lerp(self.corners[next], depth[k] / (depth[k] - depth[next]));
                count += 1;
            }
        }
        for k in 2..count {
            keep(Self::triangle(self.plane, outline[0], outline[k - 1], outline[k]));
        }
        true
    }
}

impl Cut for Band {
    fn cut(&self, kernel: &Kernel, keep: &mut impl FnMut(Self)) -> bool {
        kernel.is_hemisphere() && self.cut_at_hemisphere(kernel.direction, keep)
    }
}
