//! Environment to OEM, by area: every source texel's energy arrives, and a constant stays one.

use super::overlap::{Target, mean_radiances, panorama_mean_radiances};
use super::tent::mirrored_in_diagonal;
use crate::environment::{Environment, Layout, Rgb};
use crate::error::Result;
use crate::oem::{Oem, OemSize};
use crate::sphere::octahedral;
use rayon::prelude::*;

/// The OEM of `environment` in the source's own space (queries are turned, not the source).
///
/// # Errors
/// [`crate::Error::Limit`] where the overlaps would not fit.
pub fn oem_from_environment(environment: &Environment, size: OemSize) -> Result<Oem> {
    let n = size.inner;
    let weights = SolidAngles::new(n);
    let means;
    let texels = if environment.layout() == (Layout::Octahedral { size: n }) {
        environment.texels()
    } else {
        means = mean_radiances(environment, Target::Octahedral(n), false)?;
        &means
    };
    let weigh = |(k, radiance): (usize, &Rgb)| {
        let (x, y) = (k % n as usize, k / n as usize);
        energy(*radiance, weights.at(x as u32, y as u32))
    };
    let square = texels.par_iter().enumerate().map(weigh).collect();
    Ok(Oem::from_square(size, square))
}

/// The cube of mean radiances over every texel's footprint, in the world: `size` x `size` x 6 texels.
///
/// # Errors
/// [`crate::Error::Limit`] where the overlaps would not fit.
pub fn footprints_from_environment(environment: &Environment, size: u32) -> Result<Vec<Rgb>> {
    mean_radiances(environment, Target::Cube(size), true)
}

/// The mean radiances over the texels of `layout`, in the world.
///
/// # Errors
/// [`crate::Error::Limit`] where the overlaps would not fit.
pub fn footprints_over(environment: &Environment, layout: Layout) -> Result<Vec<Rgb>> {
    match layout {
        Layout::Cube { size } => footprints_from_environment(environment, size),
        Layout::Octahedral { size } => mean_radiances(environment, Target::Octahedral(size), true),
        Layout::Panorama { width, height } => panorama_mean_radiances(environment, width, height),
    }
}

fn energy([r, g, b]: Rgb, solid_angle: f32) -> [f32; 4] {
    [r * solid_angle, g * solid_angle, b * solid_angle, solid_angle]
}

/// Solid angles of an octahedral square's texels: one table for its eight mirror images.
pub(crate) struct SolidAngles {
    n: u32,
    quadrant: Vec<f32>,
}

impl SolidAngles {
    /// From this size on Gauss quadrature with three points (two from four times this) is exact to float32: it misses
    /// (2/n)^6/2016000 or (2/n)^4/4320 of the density's sixth or fourth derivative (below 1e6 and 1e4): 1e-9 of it.
    const GAUSS_FROM: u32 = 128;

    pub(crate) fn new(n: u32) -> Self {
        let half = n.div_ceil(2);
        let quadrant = mirrored_in_diagonal(
            half,
            |x, y| Self::solid_angle(n, n - half, x, y),
            |solid_angle| solid_angle,
        );
        Self { n, quadrant }
    }

    /// Texel (`x`, `y`) of the quadrant u, v >= 0, counted from the centre.
    fn solid_angle(n: u32, first: u32, x: u32, y: u32) -> f32 {
        let centre = octahedral::texel_centre(n, first + x, first + y).abs();
        // Across an axis or a fold diagonal the density has a kink that no quadrature likes.
        let reach = (1.0 - 1e-9) / f64::from(n);
        let kinked = centre.min_element() < reach || (centre.x + centre.y - 1.0).abs() < 2.0 * reach;
        if n < Self::GAUSS_FROM || kinked {
            return octahedral::texel_solid_angle(n, first + x, first + y) as f32;
        }
        let (nodes, weights): (&[f64], &[f64]) = if n < 4 * Self::GAUSS_FROM {
            (&[-0.774_596_669_241_483_4, 0.0, 0.774_596_669_241_483_4], &[5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0])
        } else {
            (&[-0.577_350_269_189_625_8, 0.577_350_269_189_625_8], &[0.5, 0.5])
        };
        let h = 1.0 / f64::from(n);
        let mut sum = 0.0;
        for (dv, weight_v) in nodes.iter().zip(weights) {
            for (du, weight_u) in nodes.iter().zip(weights) {
                let uv = centre + glam::DVec2::new(*du, *dv) * h;
                sum += weight_u * weight_v * octahedral::solid_angle_density(uv);
            }
        }
        (sum * 4.0 * h * h) as f32
    }

    pub(crate) fn at(&self, x: u32, y: u32) -> f32 {
        let half = self.n.div_ceil(2);
        let first = self.n - half;
        let fold = |k: u32| if k >= first { k - first } else { self.n - 1 - k - first };
        self.quadrant[fold(y) as usize * half as usize + fold(x) as usize]
    }
}
