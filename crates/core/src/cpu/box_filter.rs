//! The paper's filter: one box per direction, sized by the lobe and the map's local density, or a stack of
//! boxes.

use crate::light::environment::Rgb;
use crate::light::sat::Sat;
use crate::lobe::{self, Lobe};
use crate::sphere::octahedral::{oct_from_direction, solid_angle_density};
use glam::{DVec2, DVec3};

/// One box of a stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StackedBox {
    /// Its solid angle, at least 0.
    pub solid_angle: f64,
    /// Weight of its energy and solid angle.
    pub weight: f64,
}

/// Weighted boxes around a direction over an exact table.
#[derive(Debug)]
pub struct BoxFilter<'a> {
    sat: &'a Sat,
    stack: Vec<StackedBox>,
}

impl<'a> BoxFilter<'a> {
    /// One box per direction, for `lobe` at `alpha` in [0, 1].
    pub fn new(sat: &'a Sat, lobe: Lobe, alpha: f64) -> Self {
        Self::stacked(sat, vec![single_box(lobe, alpha)])
    }

    /// The boxes of `stack` around every direction: their weighted energies over their weighted solid angles,
    /// so that a constant stays constant.
    ///
    /// # Panics
    /// If the stack is empty.
    pub fn stacked(sat: &'a Sat, stack: Vec<StackedBox>) -> Self {
        assert!(!stack.is_empty(), "at least one box");
        Self { sat, stack }
    }

    /// Radiance of the boxes around the unit vector `direction` in the OEM's space.
    ///
    /// A box's side in (u, v) is the square root of its solid angle over the local density, which is
    /// continuous across every fold; a one-texel box is added in quadrature, so that roughness 0 is bilinear
    /// interpolation.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        let n = f64::from(self.sat.size().inner);
        let uv = oct_from_direction(direction);
        let centre = (uv + 1.0) * (n / 2.0);
        let mut sum = [0.0; 4];
        for StackedBox { solid_angle, weight } in &self.stack {
            let texels = solid_angle / solid_angle_density(uv) * (n * n / 4.0);
            let half = DVec2::splat(half_side(texels, n));
            let energy = self.sat.fractional_box(centre - half, centre + half);
            for (sum, energy) in sum.iter_mut().zip(energy) {
                *sum += weight * energy;
            }
        }
        let [r, g, b, w] = sum;
        [(r / w) as f32, (g / w) as f32, (b / w) as f32]
    }
}

/// The single box that approximates `lobe` at `alpha`.
pub fn single_box(lobe: Lobe, alpha: f64) -> StackedBox {
    StackedBox { solid_angle: solid_angle(lobe, alpha), weight: 1.0 }
}

/// Half of a box's side in texels: a one-texel box added in quadrature, at most the whole period of the
/// plane.
fn half_side(texels: f64, n: f64) -> f64 {
    0.5 * (texels + 1.0).sqrt().min(2.0 * n)
}

/// The widest half-extent in texels of any box of `lobe` up to `alpha` on a square of `inner` texels: the
/// border that a four-corner read needs.
pub(crate) fn widest_half_extent(lobe: Lobe, alpha: f64, inner: u32) -> u32 {
    // Boxes are widest where the density is least: 1, at the vertices.
    let n = f64::from(inner);
    half_side(solid_angle(lobe, alpha) * n * n / 4.0, n).ceil() as u32
}

/// Solid angle of the cap that holds the lobe's weight at the lobe's peak value.
fn solid_angle(lobe: Lobe, alpha: f64) -> f64 {
    if alpha > 0.0 || lobe == Lobe::Cosine {
        lobe::kernel_integral(lobe, alpha) / lobe::kernel(lobe, alpha, 0.0)
    } else {
        0.0
    }
}
