//! Shares of some rows of the source: the texels on the mirrors' positive sides, their numbers and images.

use super::BLOCK;
use super::carrier::{Block, Carrier, Numbers, quarterings};
use super::chart::{Chart as _, Domain, Piece};
use super::mirrors::{Mirrors, Side};
use crate::geometry::light::Light;
use crate::geometry::overlap::Share;
use crate::sphere::grid::Grid;
use crate::sphere::map::Texel;
use glam::{DVec2, DVec3};
use std::ops::Range;

/// Shares of the texels of some rows.
#[derive(Default)]
pub(super) struct Band {
    pub(super) shares: Vec<Share>,
    /// Images of each source texel, in the mirrors' order.
    pub(super) sources: Vec<u32>,
}

/// Makes the bands of a component of the source.
struct Bander<'a> {
    grid: &'a Grid,
    component: u32,
    mirrors: &'a Mirrors,
    carrier: Carrier<'a, Domain<'a>>,
}

impl Band {
    /// Carries the texels of `light` in `rows` of `component` that are on the positive sides of `mirrors` to
    /// `target`. `None` if a mirror cuts one of them.
    pub(super) fn of_rows(
        light: &Light<'_>,
        target: &Grid,
        component: u32,
        rows: Range<u32>,
        mirrors: &Mirrors,
    ) -> Option<Self> {
        let grid = &light.grid;
        let chart = Domain::new(grid, component, light.world_from_source);
        let depth = quarterings(grid.texel_count(), target.texel_count());
        let carrier = Carrier::new(chart, target, depth);
        let mut bander = Bander { grid, component, mirrors, carrier };
        let columns = grid.sides(component)[0];
        let mut band = Self::default();
        for top in rows.clone().step_by(BLOCK as usize) {
            for left in (0..columns).step_by(BLOCK as usize) {
                let (low, count) = ([left, top], [BLOCK.min(columns - left), BLOCK.min(rows.end - top)]);
                let numbers = bander.numbers(low, count, &mut band.sources)?;
                if numbers.iter().flatten().all(Option::is_none) {
                    continue;
                }
                let block = Block { low: DVec2::from(low.map(f64::from)), count };
                if !bander.carrier.at_once(block, &numbers, &mut band.shares) {
                    bander.carrier.singly(block, &numbers, &mut band.shares);
                }
            }
        }
        Some(band)
    }
}

impl Bander<'_> {
    /// Numbers of the `count` texels from `low` that are on the mirrors' positive sides; appends their
    /// images. `None` if a mirror cuts one of them.
    fn numbers(&self, low: [u32; 2], count: [u32; 2], images: &mut Vec<u32>) -> Option<Numbers> {
        let mut numbers = Numbers::default();
        let side = self.side_of_block(low, count);
        if side == Side::Behind {
            return Some(numbers);
        }
        for (y, row) in (low[1]..low[1] + count[1]).zip(&mut numbers) {
            for (x, number) in (low[0]..low[0] + count[0]).zip(row) {
                let texel = Texel { component: self.component, x, y };
                if side == Side::Unknown {
                    if self.mirrors.cut(self.grid, texel) {
                        return None;
                    }
                    if self.is_behind(texel) {
                        continue;
                    }
                }
                *number = Some((images.len() / self.mirrors.images()) as u32);
                self.mirrors.append(self.grid, texel, images)?;
            }
        }
        Some(numbers)
    }

    /// Whether `texel`, which no mirror cuts, is behind one: then it has a point that is.
    fn is_behind(&self, texel: Texel) -> bool {
        let piece = Piece::texel(DVec2::new(f64::from(texel.x), f64::from(texel.y)));
        let points = piece.corners().into_iter().chain([piece.middle()]);
        let mut directions = points.filter_map(|at| self.carrier.chart.direction(at));
        directions.any(|direction| self.mirrors.is_behind(direction))
    }

    /// On which side of the mirrors the block of `count` texels from `low` lies, by nine of its points:
    /// farther from the mirrors than neighbours are from each other, they speak for what is between them.
    fn side_of_block(&self, low: [u32; 2], count: [u32; 2]) -> Side {
        if self.mirrors.images() == 1 {
            return Side::Ahead;
        }
        let [low, extent] = [low, count].map(|at| DVec2::from(at.map(f64::from)));
        let node = |k: usize| {
            let share = DVec2::new((k % 3) as f64, (k / 3) as f64) / 2.0;
            self.carrier.chart.image.direction_anywhere(low + extent * share)
        };
        let nodes: [DVec3; 9] = std::array::from_fn(node);
        let along = (0..9).filter(|k| k % 3 < 2).map(|k| nodes[k].distance(nodes[k + 1]));
        let across = (0..6).map(|k| nodes[k].distance(nodes[k + 3]));
        let spacing = along.chain(across).fold(0.0, f64::max);
        self.mirrors.side(&nodes, spacing)
    }
}
