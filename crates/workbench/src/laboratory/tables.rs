//! Exact summed-area tables of a map's components.
//!
//! Fixed point, scan and differences are those of the octahedral table (`sat`): 64-bit integers modulo 2^64,
//! with one scale for all components of a map, so that sums over parts of a box add up exactly.

use super::charts::{Charts, Piece};
use super::light::Light;
use glam::DVec2;
use octagloss_core::cpu::sat_scan::scan;
use octagloss_core::geometry::resample::{Continuation, resample};
use octagloss_core::light::environment::{Rgb, exact_luminance};
use octagloss_core::light::sat::{FixedPoint, Scan, Spans, difference, fractional_sum};
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::map::Texel;
use rayon::prelude::*;

/// Rows filled together.
const BAND: i64 = 8;

/// Texels of a map's bordered components: [L_r w, L_g w, L_b w, w], w the texel's solid angle.
#[derive(Clone, Debug)]
pub struct Texels {
    /// The map's texels.
    pub grid: Grid,
    /// Texels around every component.
    pub border: u32,
    /// Row-major, border included, per component.
    pub components: Vec<Vec<[f32; 4]>>,
}

impl Texels {
    /// The texels of `grid` filled from `light`: means over the parts of texels inside their component's
    /// domain, and their solid angles. With a `border`, texels that are not wholly inside have the light and
    /// the solid angle of the map's continuation.
    pub fn new(charts: &dyn Charts, grid: Grid, border: u32, light: &Light<'_>) -> Self {
        let radiance = resample(light, &grid);
        let continuation = Continuation::new(light, &grid);
        let wide = i64::from(border);
        let components = (0..grid.map().components())
            .map(|component| {
                let [width, height] = grid.sides(component).map(i64::from);
                let (first, cell) = (grid.first_texel(component), grid.map().component(component));
                let step = grid.step(&cell);
                let own = |x: i64, y: i64| {
                    let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
                    let texel = Texel { component, x: x as u32, y: y as u32 };
                    // Outside the domain rounding may leave it below 0.
                    if is_inside { grid.solid_angle(texel).max(0.0) } else { 0.0 }
                };
                // The solid angle of the continuation if the texel is not wholly inside.
                let continued = |x: i64, y: i64| {
                    let low = cell.low + step * DVec2::new(x as f64, y as f64);
                    let whole = charts.continued_solid_angle(component, low, low + step);
                    (border > 0 && own(x, y) < whole * (1.0 - 1e-9)).then_some(whole)
                };
                let columns = -wide..width + wide;
                let band = |top: i64| {
                    let rows = top..(top + BAND).min(height + wide);
                    let is_needed = |x: i64, y: i64| continued(x, y).is_some();
                    let outside = continuation.means(component, columns.clone(), rows.clone(), is_needed);
                    let places = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
                    let texel = |((x, y), mean): ((i64, i64), Rgb)| {
                        let (light, solid_angle) = match continued(x, y) {
                            Some(whole) => (mean, whole),
                            None => (radiance[first + (y * width + x) as usize], own(x, y)),
                        };
                        let [r, g, b] = light.map(|channel| (f64::from(channel) * solid_angle) as f32);
                        [r, g, b, solid_angle as f32]
                    };
                    places.zip(outside).map(texel).collect::<Vec<_>>()
                };
                let tops: Vec<i64> = (-wide..height + wide).step_by(BAND as usize).collect();
                tops.into_par_iter().flat_map_iter(band).collect()
            })
            .collect();
        Self { grid, border, components }
    }
}

/// The tables of a map.
#[derive(Clone, Debug)]
pub struct Tables {
    /// The map's boxes.
    pub charts: &'static dyn Charts,
    /// The map's texels.
    pub grid: Grid,
    /// Texels around every component.
    pub border: u32,
    /// The scale of the sums.
    pub fixed: FixedPoint,
    /// Inclusive sums, row-major, border included, per component.
    components: Vec<Vec<[u64; 4]>>,
    /// The least radiance of each channel.
    pub least: [f64; 3],
}

impl Tables {
    /// Sums `texels` of the map of `charts`.
    ///
    /// # Panics
    /// If the number of texels is not that of their grid.
    pub fn new(charts: &'static dyn Charts, texels: &Texels) -> Self {
        let Texels { grid, border, .. } = *texels;
        let all = || texels.components.iter().flatten();
        let fixed = FixedPoint::of_texels(all().count() as u64, all);
        let mut least = [f64::INFINITY; 3];
        for [energy @ .., solid_angle] in all().filter(|texel| texel[3] > 0.0) {
            for (least, energy) in least.iter_mut().zip(energy) {
                *least = least.min(f64::from(*energy) / f64::from(*solid_angle));
            }
        }
        let components = (0..)
            .zip(&texels.components)
            .map(|(component, texels)| {
                let [columns, rows] = grid.sides(component).map(|side| (side + 2 * border) as usize);
                assert_eq!(texels.len(), columns * rows, "texels of component {component}");
                let mut entries = vec![[0; 4]; texels.len()];
                scan(Scan::Blocks, fixed, texels, columns, &mut entries);
                entries
            })
            .collect();
        Self { charts, grid, border, fixed, components, least }
    }

    /// Bytes of the tables.
    pub fn bytes(&self) -> usize {
        self.components.iter().map(|entries| size_of_val(&entries[..])).sum()
    }

    /// Luminance of the mean over all texels.
    pub fn mean_luminance(&self) -> f64 {
        let mut sum = [0.0; 4];
        for component in 0..self.grid.map().components() {
            let [columns, rows] = self.grid.sides(component).map(i64::from);
            let all = self.fixed.values(self.sum(component, [0, 0], [columns, rows]));
            sum.iter_mut().zip(all).for_each(|(sum, value)| *sum += value);
        }
        let [energy @ .., solid_angle] = sum;
        exact_luminance(energy) / solid_angle
    }

    /// Sum of the texels below (`x`, `y`) of `component`, from the corner of its border.
    #[inline]
    fn prefix(&self, component: u32, x: i64, y: i64) -> [u64; 4] {
        let (x, y) = (x + i64::from(self.border), y + i64::from(self.border));
        if x == 0 || y == 0 {
            return [0; 4];
        }
        let columns = (self.grid.sides(component)[0] + 2 * self.border) as usize;
        self.components[component as usize][(y as usize - 1) * columns + x as usize - 1]
    }

    /// Sum of the texels from `low` up to but not including `high` of `component`; the image's first texel is
    /// (0, 0).
    ///
    /// # Panics
    /// If the box leaves the border.
    pub fn sum(&self, component: u32, low: [i64; 2], high: [i64; 2]) -> [u64; 4] {
        let border = i64::from(self.border);
        let far = self.grid.sides(component).map(|side| i64::from(side) + border);
        assert!(
            (0..2).all(|k| -border <= low[k] && low[k] <= high[k] && high[k] <= far[k]),
            "box {low:?} .. {high:?} within {far:?} and a border of {border}"
        );
        let at = |x: usize, y: usize| self.prefix(component, [low[0], high[0]][x], [low[1], high[1]][y]);
        difference(at(0, 0), at(1, 0), at(0, 1), at(1, 1))
    }

    /// Energy and solid angle of `piece`, which may leave its component, and the number of table entries
    /// read: sixteen a part.
    pub fn fractional(&self, piece: Piece) -> ([f64; 4], usize) {
        let (mut sum, mut reads) = ([0.0; 4], 0);
        self.charts.split(&self.grid, piece, &mut |Piece { component, low, high }| {
            // Rounding may place an edge outside by a few units in the last place.
            let border = f64::from(self.border);
            let far = DVec2::from(self.grid.sides(component).map(f64::from)) + border;
            let (low, high) = (low.clamp(DVec2::splat(-border), far), high.clamp(DVec2::splat(-border), far));
            if low.x >= high.x || low.y >= high.y {
                return;
            }
            let (columns, rows) = (Spans::new(low.x, high.x), Spans::new(low.y, high.y));
            let part = fractional_sum(self.fixed, &columns, &rows, |x, y| self.prefix(component, x, y));
            sum.iter_mut().zip(part).for_each(|(sum, value)| *sum += value);
            reads += 16;
        });
        (sum, reads)
    }
}
