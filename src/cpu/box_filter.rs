//! The paper's filter: one box, sized by the lobe and the map's local density.

use crate::environment::Rgb;
use crate::lobe::{self, Lobe};
use crate::sat::Sat;
use crate::sphere::octahedral::{oct_from_direction, solid_angle_density};
use glam::{DVec2, DVec3};

/// One box per direction over an exact table.
#[derive(Debug)]
pub struct BoxFilter<'a> {
    sat: &'a Sat,
    /// Solid angle of the box.
    solid_angle: f64,
}

impl<'a> BoxFilter<'a> {
    /// Boxes for `lobe` at `alpha` in [0, 1].
    #[must_use]
    pub fn new(sat: &'a Sat, lobe: Lobe, alpha: f64) -> Self {
        Self { sat, solid_angle: solid_angle(lobe, alpha) }
    }

    /// Radiance of the box around `direction` (unit, of the OEM's space).
    ///
    /// Its side in (u, v) is the square root of the box's solid angle over the local density, which is continuous
    /// across every fold; a one-texel box is added in quadrature, so that roughness 0 is bilinear interpolation.
    #[must_use]
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        let n = f64::from(self.sat.size().inner);
        let uv = oct_from_direction(direction);
        let texels = self.solid_angle / solid_angle_density(uv) * (n * n / 4.0);
        let half = half_side(texels, n);
        let centre = (uv + 1.0) * (n / 2.0);
        let [r, g, b, w] = self.sat.fractional_box(centre - DVec2::splat(half), centre + DVec2::splat(half));
        [(r / w) as f32, (g / w) as f32, (b / w) as f32]
    }
}

/// Half of a box's side in texels: a one-texel box added in quadrature, at most the whole plane's period.
fn half_side(texels: f64, n: f64) -> f64 {
    0.5 * (texels + 1.0).sqrt().min(2.0 * n)
}

/// The widest half-extent in texels of any box of `lobe` up to `alpha` on a square of `inner` texels: the border that
/// a plain four-corner read needs.
#[must_use]
pub fn widest_half_extent(lobe: Lobe, alpha: f64, inner: u32) -> u32 {
    // Boxes are widest where the density is least: 1, at the vertices.
    let n = f64::from(inner);
    half_side(solid_angle(lobe, alpha) * n * n / 4.0, n).ceil() as u32
}

/// Solid angle of the cap that holds the lobe's weight at the lobe's peak value.
pub(crate) fn solid_angle(lobe: Lobe, alpha: f64) -> f64 {
    if alpha > 0.0 || lobe == Lobe::Cosine {
        lobe::kernel_integral(lobe, alpha) / lobe::kernel(lobe, alpha, 0.0)
    } else {
        0.0
    }
}
