//! Adaptive quadrature of lobes over the cells of any map, with energies from its exact tables.
//!
//! A cell's energy is one box of four entries. Its light counts as even over its solid angle: s = |l - R|^2/4
//! then has the mean t = (|m - R|^2 + tr C)/4 and the variance V = R.C.R/4, and the kernel's mean is taken as
//! (k(t - sqrt V) + k(t + sqrt V))/2. Where the light really is in the cell, k lies between its values at the
//! nearest and the farthest point. Cells are split where that range times the energy exceeds the tolerance;
//! a texel at the end averages k over 4 x 4 of its points. The answer is c + sum of kmean (E - c w) / W with
//! c the least radiance and W the kernel's integral, so that a constant environment stays constant.

use super::boxes::LobeAnswer;
use super::cells::{Cell, Cells, points};
use super::tables::Tables;
use glam::DVec3;
use octagloss_core::light::environment::exact_luminance;
use octagloss_core::lobe::{self, Lobe};

/// A decreasing lobe over the cells of a map.
#[derive(Debug)]
pub struct Adaptive<'a> {
    tables: &'a Tables,
    cells: &'a Cells,
    lobe: Lobe,
    alpha: f64,
    integral: f64,
    /// Greatest range of the kernel times energy of a leaf.
    tolerance: f64,
}

/// Points along the edge of a texel that is averaged over.
const POINTS: u32 = 4;

/// A cell's tolerance over the relative error aimed at: measured, leaves' errors are far below their range
/// and have random signs.
const LEAF_SHARE: f64 = 0.6;

impl<'a> Adaptive<'a> {
    /// `lobe` at `alpha`, to an error of about `error` of the mean radiance.
    ///
    /// # Panics
    /// If `tables` have a border, or `cells` are of another map or size.
    pub fn new(tables: &'a Tables, cells: &'a Cells, lobe: Lobe, alpha: f64, error: f64) -> Self {
        assert_eq!(tables.border, 0, "a table of domains only");
        assert_eq!(tables.grid.texel_count(), cells.grid.texel_count(), "cells of the table's map");
        let integral = lobe::kernel_integral(lobe, alpha);
        let tolerance = LEAF_SHARE * error * integral * tables.mean_luminance();
        Self { tables, cells, lobe, alpha, integral, tolerance }
    }

    /// The lobe around `direction`, a unit vector, and a bound of its luminance's error against exhaustive
    /// integration over the map's own texels, but for float64 rounding.
    pub fn radiance(&self, direction: DVec3) -> (LobeAnswer, f64) {
        let least = self.tables.least;
        let (mut sum, mut bound, mut reads) = ([0.0; 3], 0.0, 0);
        let mut stack = self.cells.roots.clone();
        while let Some(index) = stack.pop() {
            let cell = &self.cells.cells[index as usize];
            let [low, high] = [cell.low, cell.high].map(|corner| corner.map(i64::from));
            let fixed = self.tables.fixed;
            let [energy @ .., solid_angle] = fixed.values(self.tables.sum(cell.component, low, high));
            reads += 4;
            let above: [f64; 3] = std::array::from_fn(|c| (energy[c] - least[c] * solid_angle).max(0.0));
            let luminance = exact_luminance(above);
            let (mut mean, [lower, upper]) = self.kernel(cell, direction);
            let is_wide = (upper - mean).max(mean - lower) * luminance > self.tolerance;
            if is_wide && !cell.is_texel() {
                let (first, count) = cell.children;
                stack.extend(first..first + count);
                continue;
            }
            if is_wide {
                let (mut weighted, mut total) = (0.0, 0.0);
                for (point, weight) in points(&self.cells.grid, cell.component, cell.low, POINTS) {
                    weighted += weight * self.at(point.distance_squared(direction) / 4.0);
                    total += weight;
                }
                if total > 0.0 {
                    mean = (weighted / total).clamp(lower, upper);
                }
            }
            bound += (upper - mean).max(mean - lower) * luminance;
            sum.iter_mut().zip(above).for_each(|(sum, above)| *sum += mean * above);
        }
        let radiance = std::array::from_fn(|c| least[c] + sum[c] / self.integral);
        (LobeAnswer { radiance, reads }, bound / self.integral)
    }

    fn at(&self, s: f64) -> f64 {
        lobe::kernel(self.lobe, self.alpha, s)
    }

    /// The kernel's mean over a cell of even light, and its range.
    fn kernel(&self, cell: &Cell, direction: DVec3) -> (f64, [f64; 2]) {
        let distance = cell.mean.distance(direction);
        let (near, far) = ((distance - cell.reach).max(0.0), (distance + cell.reach).min(2.0));
        let (upper, lower) = (self.at(near * near / 4.0), self.at(far * far / 4.0));
        let covariance = cell.covariance;
        let trace = covariance.x_axis.x + covariance.y_axis.y + covariance.z_axis.z;
        let t = (distance * distance + trace) / 4.0;
        let deviation = (direction.dot(covariance * direction).max(0.0) / 4.0).sqrt();
        let mean = 0.5 * (self.at((t - deviation).max(0.0)) + self.at((t + deviation).min(1.0)));
        (mean.clamp(lower, upper), [lower, upper])
    }
}
