//! Lobes by adaptive quadrature over the cells, with a certified bound of the error.
//!
//! A lobe's kernel is a convex, decreasing function k(s) of s = |l - R|^2/4 (GGX, cosine, and Phong from n = 2). Over
//! a cell with energy E, centroid m, spread q and reach rho the mean of s is exactly t = (|m - R|^2 + q)/4, so by
//! Jensen's inequality the cell's share lies in
//!
//! ```text
//! E k(t)  <=  share  <=  E min(k(s0), k(t) + V k''(s0)/2 + kink),      s0 = max(0, |m - R| - rho)^2/4
//! ```
//!
//! where V bounds the variance of s over the cell: with theta the angle between m and R, the tangential part of
//! (l - m).R is at most sqrt(q) sin(theta) and the radial one sqrt(q) rho/2 (Bhatia and Davis 2000 on [1 - rho^2/2,
//! 1]), so V <= q/4 (sin(theta) + rho/2)^2; a cell across the horizon s = 1/2, where k' jumps by J, may gain J
//! sqrt(V)/2 more. Cells are split while the width of that interval, times their energy, exceeds the tolerance;
//! the estimate adds the second-order term of an isotropic cell, E q s(1 - s) k''/4, to the lower end.
//!
//! Other lobes (cones, wide Phong) fall back on the first-order interval E k(s1) <= share <= E k(s0), s1 the farthest.

use super::cells::Cells;
use super::kernel::Kernel;
use super::subtexel;
use crate::environment::{LUMINANCE, Rgb};
use glam::DVec3;

/// Directions evaluated together.
pub const LANES: usize = 16;

/// A tolerance of E allows every leaf this share of E times the mean radiance. Measured: see the README's table of
/// errors; the leaves' errors have random signs and mostly lie far inside their intervals.
const LEAF_SHARE: f64 = 0.05;

/// Up to [`LANES`] directions near one another, in the space of the cells.
#[derive(Clone, Copy, Debug)]
pub struct Packet {
    axis: DVec3,
    radius: f32,
    /// Directions less the axis: differences keep the precision that sharp lobes need.
    x: [f32; LANES],
    y: [f32; LANES],
    z: [f32; LANES],
}

impl Packet {
    /// A packet of unit `directions`, at least one and at most [`LANES`]; spare lanes repeat the first.
    ///
    /// # Panics
    /// Where there are none or too many.
    #[must_use]
    pub fn new(directions: &[DVec3]) -> Self {
        assert!(!directions.is_empty() && directions.len() <= LANES, "1 to {LANES} directions");
        let axis = if directions.len() == 1 {
            directions[0]
        } else {
            directions.iter().sum::<DVec3>().try_normalize().unwrap_or(directions[0])
        };
        let radius = directions.iter().map(|d| d.distance(axis)).fold(0.0, f64::max);
        let offset = |k: usize| directions[if k < directions.len() { k } else { 0 }] - axis;
        Self {
            axis,
            radius: (radius * (1.0 + 1e-6)) as f32,
            x: std::array::from_fn(|k| offset(k).x as f32),
            y: std::array::from_fn(|k| offset(k).y as f32),
            z: std::array::from_fn(|k| offset(k).z as f32),
        }
    }
}

/// The answers to a packet.
#[derive(Clone, Copy, Debug)]
pub struct Shares {
    /// Radiance, lane by lane.
    pub radiance: [Rgb; LANES],
    /// Certified bound of each lane's luminance.
    pub bound: [f32; LANES],
    /// Leaves that the packet's lanes shared.
    pub leaves: usize,
}

/// The leaves of one packet's cut, relative to its axis; kept between packets.
#[derive(Debug, Default)]
pub(super) struct Leaves {
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
    pub(super) spread: Vec<f32>,
    pub(super) energy: Vec<Rgb>,
    /// Sum of the widths of the leaves' intervals.
    pub(super) gap: f64,
}

impl Leaves {
    fn clear(&mut self) {
        for field in [&mut self.x, &mut self.y, &mut self.z, &mut self.spread] {
            field.clear();
        }
        self.energy.clear();
        self.gap = 0.0;
    }

    pub(super) fn push(&mut self, offset: [f32; 3], spread: f32, energy: Rgb) {
        self.x.push(offset[0]);
        self.y.push(offset[1]);
        self.z.push(offset[2]);
        self.spread.push(spread);
        self.energy.push(energy);
    }
}

/// Buffers of an evaluation, kept between packets.
#[derive(Debug, Default)]
pub struct Scratch {
    leaves: Leaves,
    stack: Vec<(u8, u32, u32)>,
}

/// Evaluates lobes of one kernel over one environment's cells to one tolerance.
#[derive(Debug)]
pub struct Adaptive<'a> {
    cells: &'a Cells,
    kernel: Kernel,
    /// Greatest width of a leaf's interval, in units of the kernel times energy.
    tolerance: f64,
    arch: pulp::Arch,
}

impl<'a> Adaptive<'a> {
    /// Lobes of `kernel` to a relRMSE of `error` over the sphere.
    #[must_use]
    pub fn new(cells: &'a Cells, kernel: Kernel, error: f64) -> Self {
        let tolerance = LEAF_SHARE * error * cells.mean_luminance * kernel.integral;
        Self { cells, kernel, tolerance, arch: pulp::Arch::new() }
    }

    /// The lobes around a packet's directions.
    pub fn evaluate(&self, packet: &Packet, scratch: &mut Scratch) -> Shares {
        scratch.leaves.clear();
        self.arch.dispatch(|| {
            self.cut(packet, scratch);
            self.sum(packet, &scratch.leaves)
        })
    }

    /// Collects the coarsest cells whose intervals are narrow enough for every direction of the packet.
    #[inline(always)]
    fn cut(&self, packet: &Packet, scratch: &mut Scratch) {
        let Scratch { leaves, stack } = scratch;
        let cells = self.cells;
        let axis = packet.axis.as_vec3();
        let tolerance = self.tolerance as f32;
        stack.clear();
        stack.push((u8::try_from(cells.levels.len() - 1).expect("few levels"), 0, 0));
        while let Some((level, i, j)) = stack.pop() {
            let place = cells.levels[usize::from(level)];
            let quad = &cells.quads[(place.first + j * place.width + i) as usize];
            let mut gap = [0.0_f32; 4];
            for k in 0..4 {
                let (x, y, z) = (quad.x[k] - axis.x, quad.y[k] - axis.y, quad.z[k] - axis.z);
                let distance = (x * x + y * y + z * z).sqrt();
                gap[k] = quad.luminance[k]
                    * self.kernel.gap(distance, quad.radius[k], packet.radius, quad.spread[k]);
            }
            for k in 0..4 {
                // A black cell's gap is 0, or NaN where its kernel overflows: neither splits nor counts.
                if quad.luminance[k] == 0.0 {
                    continue;
                }
                let (i, j) = (2 * i + (k as u32 & 1), 2 * j + (k as u32 >> 1));
                if gap[k] > tolerance {
                    if level > 0 {
                        stack.push((level - 1, i, j));
                        continue;
                    }
                    if cells.block == 1 {
                        subtexel::refine(
                            cells,
                            (i, j),
                            &self.kernel,
                            packet.axis,
                            packet.radius,
                            self.tolerance,
                            leaves,
                        );
                        continue;
                    }
                }
                leaves.gap += f64::from(gap[k]);
                let offset = [
                    (f64::from(quad.x[k]) - packet.axis.x) as f32,
                    (f64::from(quad.y[k]) - packet.axis.y) as f32,
                    (f64::from(quad.z[k]) - packet.axis.z) as f32,
                ];
                leaves.push(offset, quad.spread[k], [quad.red[k], quad.green[k], quad.blue[k]]);
            }
        }
    }

    /// Sums the leaves for every lane.
    #[inline(always)]
    fn sum(&self, packet: &Packet, leaves: &Leaves) -> Shares {
        let mut sums = [[0.0_f32; LANES]; 3];
        let mut second_order = [0.0_f32; LANES];
        let count = leaves.x.len();
        let (xs, ys, zs) = (&leaves.x[..count], &leaves.y[..count], &leaves.z[..count]);
        let (spreads, energies) = (&leaves.spread[..count], &leaves.energy[..count]);
        for leaf in 0..count {
            let (lx, ly, lz, spread) = (xs[leaf], ys[leaf], zs[leaf], spreads[leaf]);
            let energy = energies[leaf];
            let luminance = LUMINANCE[0] * energy[0] + LUMINANCE[1] * energy[1] + LUMINANCE[2] * energy[2];
            let mut low = [0.0_f32; LANES];
            let mut curved = [0.0_f32; LANES];
            for k in 0..LANES {
                let (x, y, z) = (lx - packet.x[k], ly - packet.y[k], lz - packet.z[k]);
                let s = (x * x + y * y + z * z + spread) * 0.25;
                (low[k], curved[k]) = self.kernel.share(s, spread);
            }
            for k in 0..LANES {
                let value = low[k] + curved[k];
                sums[0][k] += value * energy[0];
                sums[1][k] += value * energy[1];
                sums[2][k] += value * energy[2];
                second_order[k] += curved[k] * luminance;
            }
        }
        let least = self.cells.least;
        let per_integral = 1.0 / self.kernel.integral;
        let mut shares = Shares { radiance: [[0.0; 3]; LANES], bound: [0.0; LANES], leaves: count };
        for k in 0..LANES {
            let above: [f64; 3] = std::array::from_fn(|c| f64::from(sums[c][k]) * per_integral);
            shares.radiance[k] = std::array::from_fn(|c| (f64::from(least[c]) + above[c]) as f32);
            // The truth lies between the sum less its second-order terms and that sum plus all the gaps.
            let raised = f64::from(second_order[k]);
            let interval = raised.max(leaves.gap - raised) * per_integral;
            let luminance = |rgb: [f64; 3]| (0..3).map(|c| f64::from(LUMINANCE[c]) * rgb[c]).sum::<f64>();
            let base = luminance(least.map(f64::from));
            shares.bound[k] =
                (interval + self.kernel.rounding(count) * luminance(above) + base * 2e-7) as f32;
        }
        shares
    }
}
