//! Mean radiance over texels that no domain covers: borders, and corners around discs.
//!
//! Such a texel's outline, by the map's continuation, is mapped to the plane of the light and rasterised
//! over the light's texels: the reverse of [`super::resample`], since a continuation may cover the sphere
//! more than once. Where the continuation ends in a single direction, as around the sphere map, texels have
//! the mean of a square of a texel's solid angle around it.

use super::BLOCK;
use super::carrier::{Block, Carrier, Numbers, quarterings};
use super::chart::{Around, Chart, Continued, Piece};
use super::sums::Totals;
use crate::common::parallel;
use crate::geometry::light::Light;
use crate::geometry::overlap::Share;
use crate::light::environment::Rgb;
use crate::sphere::grid::Grid;
use crate::sphere::map::Texel;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use std::ops::Range;

/// Footprints below this share of a texel's mean solid angle are single directions up to rounding.
const POINT: f64 = 1e-9;

/// The continuation of a map.
pub struct Continuation<'a> {
    light: &'a Light<'a>,
    target: &'a Grid,
    /// Mean solid angle of the target's texels.
    texel: f64,
    quarterings: Range<u32>,
}

impl<'a> Continuation<'a> {
    /// That of `target` under `light`.
    pub fn new(light: &'a Light<'a>, target: &'a Grid) -> Self {
        let count = target.texel_count();
        let texel = 4.0 * PI / count as f64;
        Self { light, target, texel, quarterings: quarterings(count, light.grid.texel_count()) }
    }

    /// Replaces the `means` over the target's texels that are NaN. Returns the totals of their parts inside
    /// the domain: rims may leave slivers that no outline reaches.
    pub(super) fn fill(&self, means: &mut [Rgb]) -> Totals {
        let mut totals = Totals::default();
        let mut rest = means;
        for component in 0..self.target.map().components() {
            let [width, height] = self.target.sides(component).map(|side| side as usize);
            let (own, others) = rest.split_at_mut(width * height);
            rest = others;
            let of_rows = |(k, means): (usize, &mut [Rgb])| {
                let mut totals = Totals::default();
                if means.iter().any(|mean| mean[0].is_nan()) {
                    let top = k as i64 * i64::from(BLOCK);
                    let rows = top..top + (means.len() / width) as i64;
                    let at = |x: i64, y: i64| (y - top) as usize * width + x as usize;
                    let is_needed = |x, y| means[at(x, y)][0].is_nan();
                    let found = self.means(component, 0..width as i64, rows, is_needed);
                    for (i, (mean, found)) in means.iter_mut().zip(found).enumerate() {
                        if mean[0].is_nan() {
                            let (x, y) = ((i % width) as u32, k as u32 * BLOCK + (i / width) as u32);
                            let solid_angle = self.inside(Texel { component, x, y });
                            totals = totals.plus(&Totals::new(found.map(f64::from), solid_angle));
                            *mean = found;
                        }
                    }
                }
                totals
            };
            let parts = parallel::map(own.chunks_mut(width * BLOCK as usize).enumerate(), of_rows);
            totals = parts.iter().fold(totals, |sum, part| sum.plus(part));
        }
        totals
    }

    /// Solid angle of the part of `texel` of the target in the domain; 0 if that has none of its corners.
    fn inside(&self, texel: Texel) -> f64 {
        let piece = Piece::texel(DVec2::new(f64::from(texel.x), f64::from(texel.y)));
        let map = self.target.map();
        let contains = |corner: DVec2| {
            map.contains(texel.component, self.target.uv(texel.component, corner.x, corner.y))
        };
        if piece.corners().into_iter().any(contains) { self.target.solid_angle(texel) } else { 0.0 }
    }

    /// Mean radiances over the texels of `columns` and `rows`, which may lie outside the image of
    /// `component`, row by row; black for texels that are not `is_needed`.
    pub fn means(
        &self,
        component: u32,
        columns: Range<i64>,
        rows: Range<i64>,
        is_needed: impl Fn(i64, i64) -> bool,
    ) -> Vec<Rgb> {
        let width = (columns.end - columns.start).max(0) as usize;
        let mut means = vec![[0.0; 3]; width * (rows.end - rows.start).max(0) as usize];
        let chart = Continued::new(self.target, component, self.light.world_from_source.transpose());
        let carrier = Carrier::new(chart, &self.light.grid, self.quarterings.clone());
        let mut footprints = Footprints { continuation: self, carrier, shares: Vec::new(), point: None };
        let step = i64::from(BLOCK);
        for top in rows.clone().step_by(BLOCK as usize) {
            for left in columns.clone().step_by(BLOCK as usize) {
                let (right, bottom) = (columns.end.min(left + step), rows.end.min(top + step));
                let (mut numbers, mut places) = (Numbers::default(), Vec::new());
                for (y, row) in (top..bottom).zip(&mut numbers) {
                    for (x, number) in (left..right).zip(row).filter(|(x, _)| is_needed(*x, y)) {
                        *number = Some(places.len() as u32);
                        places.push((y - rows.start) as usize * width + (x - columns.start) as usize);
                    }
                }
                let low = DVec2::new(left as f64, top as f64);
                let block = Block { low, count: [(right - left) as u32, (bottom - top) as u32] };
                for (place, mean) in places.iter().zip(footprints.means(block, numbers, places.len())) {
                    means[*place] = mean;
                }
            }
        }
        means
    }
}

/// Footprints of one component's texels over the light.
struct Footprints<'a> {
    continuation: &'a Continuation<'a>,
    carrier: Carrier<'a, Continued<'a>>,
    shares: Vec<Share>,
    /// The last direction that was the whole footprint of a texel, and the mean around it.
    point: Option<(DVec3, Rgb)>,
}

impl Footprints<'_> {
    /// Means over the `count` texels of `block` with `numbers`, in their order.
    fn means(&mut self, block: Block, mut numbers: Numbers, count: usize) -> Vec<Rgb> {
        if count == 0 {
            return Vec::new();
        }
        let mut directions = vec![DVec3::ZERO; count];
        let [columns, rows] = block.count;
        for (y, x) in (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x))) {
            if let Some(number) = numbers[y as usize][x as usize] {
                let middle = Piece::texel(block.corner(x, y)).middle();
                directions[number as usize] = self.carrier.chart.direction_anywhere(middle);
            }
        }
        let least = POINT * self.continuation.texel;
        self.shares.clear();
        let is_point = self.carrier.chart.size_of(block.piece()) <= least;
        if !is_point && !self.carrier.at_once(block, &numbers, &mut self.shares) {
            for (y, x) in (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x))) {
                if self.carrier.chart.size_of(Piece::texel(block.corner(x, y))) <= least {
                    numbers[y as usize][x as usize] = None;
                }
            }
            self.carrier.singly(block, &numbers, &mut self.shares);
        }
        let means = means_of(&self.shares, count, self.continuation.light.texels);
        means.into_iter().zip(directions).map(|(mean, at)| mean.unwrap_or_else(|| self.around(at))).collect()
    }

    /// The mean over a square of a texel's solid angle around `direction`, in the light's space.
    fn around(&mut self, direction: DVec3) -> Rgb {
        if let Some((known, mean)) = self.point
            && known.distance_squared(direction) < POINT * POINT
        {
            return mean;
        }
        let Continuation { light, texel, quarterings, .. } = self.continuation;
        let mut carrier = Carrier::new(Around::new(direction, *texel), &light.grid, quarterings.clone());
        let mut numbers = Numbers::default();
        numbers[0][0] = Some(0);
        self.shares.clear();
        carrier.singly(Block { low: DVec2::ZERO, count: [1, 1] }, &numbers, &mut self.shares);
        let mean = means_of(&self.shares, 1, light.texels)[0].expect("a square has an area");
        self.point = Some((direction, mean));
        mean
    }
}

/// Means over the `shares` of `count` texels; `None` for those without.
fn means_of(shares: &[Share], count: usize, texels: &[Rgb]) -> Vec<Option<Rgb>> {
    let mut sums = vec![[0.0_f64; 4]; count];
    for Share { target, source, solid_angle } in shares {
        let weight = f64::from(*solid_angle);
        let [sums @ .., total] = &mut sums[*source as usize];
        for (sum, value) in sums.iter_mut().zip(texels[*target as usize]) {
            *sum += weight * f64::from(value);
        }
        *total += weight;
    }
    let mean = |[r, g, b, total]: [f64; 4]| {
        (total > 0.0).then(|| [r, g, b].map(|sum| ((sum / total) as f32).clamp(f32::MIN, f32::MAX)))
    };
    sums.into_iter().map(mean).collect()
}
