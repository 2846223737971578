//! Environment to OEM, by area: every source texel's energy arrives, and a constant stays one.

use super::overlap::{Overlaps, Target};
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
    let texels = environment.texels();
    let square = if environment.layout() == (Layout::Octahedral { size: n }) {
        let row = |y: u32| (0..n).map(move |x| (x, y));
        let weigh =
            |(x, y): (u32, u32)| energy(texels[y as usize * n as usize + x as usize], weights.at(x, y));
        (0..n).into_par_iter().flat_map_iter(|y| row(y).map(weigh)).collect()
    } else {
        let overlaps = Overlaps::new(environment, Target::Octahedral(n), false)?;
        let mut square = vec![[0.0; 4]; n as usize * n as usize];
        square.par_chunks_mut(n as usize).zip(0..n).for_each(|(line, y)| {
            for (texel, x) in line.iter_mut().zip(0..n) {
                let radiance = mean_radiance(&overlaps, y as usize * n as usize + x as usize, texels);
                *texel = energy(radiance, weights.at(x, y));
            }
        });
        square
    };
    Ok(Oem::from_square(size, square))
}

/// The cube of mean radiances over every texel's footprint, in the world: `size` x `size` x 6 texels.
///
/// # Errors
/// [`crate::Error::Limit`] where the overlaps would not fit.
pub fn footprints_from_environment(environment: &Environment, size: u32) -> Result<Vec<Rgb>> {
    let target = Target::Cube(size);
    let overlaps = Overlaps::new(environment, target, true)?;
    let mut cube = vec![[0.0; 3]; target.texel_count()];
    cube.par_chunks_mut(size as usize).enumerate().for_each(|(line, texels)| {
        for (i, texel) in texels.iter_mut().enumerate() {
            *texel = mean_radiance(&overlaps, line * size as usize + i, environment.texels());
        }
    });
    Ok(cube)
}

/// Overlap-weighted mean of the sources of one target texel.
fn mean_radiance(overlaps: &Overlaps, target: usize, texels: &[Rgb]) -> Rgb {
    // Radiance spans more decades than f32 sums keep; an f64 sum of a few products is exact enough to forget.
    let (mut sum, mut total) = ([0.0_f64; 3], 0.0_f64);
    overlaps.for_each_source(target, |source, solid_angle| {
        let weight = f64::from(solid_angle);
        total += weight;
        for (sum, value) in sum.iter_mut().zip(texels[source]) {
            *sum += weight * f64::from(value);
        }
    });
    sum.map(|sum| (sum / total) as f32)
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
        let quadrant = (0..half)
            .into_par_iter()
            .flat_map_iter(|y| (0..half).map(move |x| Self::solid_angle(n, n - half, x, y)))
            .collect();
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
