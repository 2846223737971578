//! Sheen levels whose texels are much finer than their lobe: lobes at nodes several texels apart,
//! interpolated in between. Where the nodes' differences are too large for that, tiles of texels are
//! evaluated one by one.

use super::level::{Advance, BakedLevel, LeafCounts, LevelJob, Processor, answer_tile};
use crate::chain::LevelSpec;
use crate::environment::{Layout, Rgb};
use crate::error::Result;
use crate::filter::{Answer, Filter};
use crate::geometry::tiling::{TILE, Tile, Tiling, at};
use crate::lobe::{self, Lobe};
use crate::reflector::{Lobes, Reflector, Workspace};
use glam::DVec3;
use rayon::prelude::*;

/// Greatest distance of nodes, over the lobe's full width at half maximum.
const NODE_SHARE: f64 = 0.45;

/// Fewest cells between nodes along an edge of a face: lobes at directions farther apart share too little of
/// the light to be evaluated together.
const FEWEST_CELLS: u32 = 64;

/// Tolerance of these lobes over the requested one. A surface's sheen is this light times the lobe's
/// reflectance, at any roughness .19 (RMS over a sphere's disc): twice the error is seen as two fifths of it.
const SEEN: f64 = 2.0;

/// Greatest third difference of the nodes around a cell, over the mean radiance and the lobes' tolerance.
/// Measured on three photographs with nodes at every fourth texel: at a tolerance of 0.01 interpolation of
/// the rest is off by 0.0005 to 0.0014 of the mean (RMS), less than the lobes themselves; by a tenth near a
/// sun.
const ROUGHEST: f64 = 4.0;

/// The nodes of a cube: (cells + 1)^2 a face, its edges included, which neighbours share.
pub(super) struct Nodes {
    /// Texels from node to node.
    stride: u32,
    /// Cells along an edge of a face.
    cells: u32,
    /// Face by face, row-major.
    radiance: Vec<Rgb>,
}

/// Texels between nodes for a level, 1 for no nodes.
fn stride(spec: LevelSpec, lobe: Lobe) -> u32 {
    let Layout::Cube { size } = spec.layout else { return 1 };
    let width = lobe::full_width_at_half_maximum(lobe, spec.roughness * spec.roughness);
    // Texels are widest, 2 / size, at a face's centre.
    let fits = |stride: &u32| {
        size.is_multiple_of(*stride)
            && size / stride >= FEWEST_CELLS
            && 2.0 * f64::from(*stride) / f64::from(size) <= NODE_SHARE * width
    };
    std::iter::successors(Some(2), |stride| Some(2 * stride)).take_while(fits).last().unwrap_or(1)
}

/// Tolerance of a level that [`bake_sparsely`] bakes; `None` for others.
pub(super) fn tolerance(level: &LevelJob) -> Option<f64> {
    match level.filter {
        Filter::Adaptive(error) if level.sparse && stride(level.spec, level.lobe) > 1 => {
            // Tolerances are below 1.
            Some(if SEEN * error < 1.0 { SEEN * error } else { error })
        }
        _ => None,
    }
}

/// Bakes `level` to its [`tolerance`], without certified bounds.
pub(super) fn bake_sparsely(
    reflector: &Reflector<'_>,
    level: &LevelJob,
    tolerance: f64,
    advance: Advance<'_>,
) -> Result<BakedLevel> {
    let lobes = &reflector.lobes(level.lobe, level.spec.roughness, Filter::Adaptive(tolerance))?;
    let tiling = Tiling::new(reflector.size().inner, level.spec, level.lobe);
    let stride = stride(level.spec, level.lobe);
    let cells = tiling.sides.1 / stride;
    // Nodes take about half the time.
    let meter = Halves { total: level.spec.layout.texel_count() as u64, advance };
    let (nodes, mut work) = Nodes::new(lobes, stride, cells, &meter)?;
    let refined = nodes.rough_cells(tolerance);
    let rows = (0..tiling.rows())
        .into_par_iter()
        .map_init(
            || (Tile::default(), Vec::new()),
            |(tile, answers), row| {
                let (mut line, mut workspace) = (tiling.line(row), Workspace::default());
                let (face, top) =
                    (row / tiling.sides.1.div_ceil(TILE), row % tiling.sides.1.div_ceil(TILE) * TILE);
                nodes.interpolate(face, top, &mut line);
                tiling.for_each_tile(row, tile, |tile| {
                    let left = tile.texels[0].0 as u32 % tiling.sides.0;
                    if nodes.covers(&refined, face, [left, top]) {
                        answer_tile(lobes, tile, &mut workspace, answers, &mut line);
                    }
                });
                line.iter_mut().for_each(|answer| answer.bound = None);
                meter.advance(u64::from(row), u64::from(tiling.rows()))?;
                Ok((line, workspace))
            },
        )
        .collect::<Result<Vec<(Vec<Answer>, Workspace)>>>()?;
    rows.iter().for_each(|(_, workspace)| work.add(workspace));
    Ok(BakedLevel::new(Processor::Cpu, rows.into_iter().flat_map(|(line, _)| line), work))
}

/// Counts texels done in two phases, half of them in each.
struct Halves<'a> {
    total: u64,
    advance: Advance<'a>,
}

impl Halves<'_> {
    /// Part `part` of `parts` of a phase is done. The first phase has the smaller half.
    fn advance(&self, part: u64, parts: u64) -> Result<()> {
        self.share(self.total.div_ceil(2), part, parts)
    }

    fn advance_first(&self, part: u64, parts: u64) -> Result<()> {
        self.share(self.total / 2, part, parts)
    }

    fn share(&self, phase: u64, part: u64, parts: u64) -> Result<()> {
        (self.advance)(phase * (part + 1) / parts - phase * part / parts)
    }
}

impl Nodes {
    fn new(lobes: &Lobes<'_>, stride: u32, cells: u32, meter: &Halves<'_>) -> Result<(Self, LeafCounts)> {
        let side = cells + 1;
        let layout = Layout::Cube { size: cells };
        let strips = side.div_ceil(TILE);
        let rows = (0..6 * strips)
            .into_par_iter()
            .map(|row| {
                let (face, top) = (row / strips, row % strips * TILE);
                let height = TILE.min(side - top);
                let mut workspace = Workspace::default();
                let mut found = vec![[0.0; 3]; (side * height) as usize];
                for left in (0..side).step_by(TILE as usize) {
                    let width = TILE.min(side - left);
                    let directions: Vec<DVec3> = (0..width * height)
                        .map(|k| at(layout, face, f64::from(left + k % width), f64::from(top + k / width)).0)
                        .collect();
                    let mut answers = Vec::with_capacity(directions.len());
                    lobes.evaluate_units(&directions, &mut workspace, &mut answers);
                    for (k, answer) in (0..).zip(answers) {
                        found[(k / width * side + left + k % width) as usize] = answer.radiance;
                    }
                }
                meter.advance_first(u64::from(row), u64::from(6 * strips))?;
                Ok((found, workspace))
            })
            .collect::<Result<Vec<(Vec<Rgb>, Workspace)>>>()?;
        let mut work = LeafCounts::default();
        rows.iter().for_each(|(_, workspace)| work.add(workspace));
        let radiance = rows.into_iter().flat_map(|(row, _)| row).collect();
        Ok((Self { stride, cells, radiance }, work))
    }

    /// Radiance of node (`i`, `j`) of `face`.
    fn at(&self, face: u32, i: u32, j: u32) -> Rgb {
        let side = self.cells + 1;
        self.radiance[((face * side + j) * side + i) as usize]
    }

    /// The first of the four nodes along an edge that are around `cell`, or beside it at an edge's end.
    fn first(&self, cell: u32) -> u32 {
        cell.saturating_sub(1).min(self.cells - 3)
    }

    /// For each cell, face by face, whether the nodes around it vary too much for interpolation to
    /// `tolerance`.
    fn rough_cells(&self, tolerance: f64) -> Vec<bool> {
        let mut mean = [0.0; 3];
        for radiance in &self.radiance {
            mean.iter_mut().zip(radiance).for_each(|(sum, value)| *sum += f64::from(*value));
        }
        let most = mean.map(|sum| ROUGHEST * tolerance * sum / self.radiance.len() as f64);
        let is_rough = |node: &dyn Fn(u32) -> Rgb, first: u32| {
            let nodes: [Rgb; 4] = std::array::from_fn(|n| node(first + n as u32));
            (0..3).any(|c| {
                let [a, b, d, e] = nodes.map(|node| f64::from(node[c]));
                (e - a + 3.0 * (b - d)).abs() > most[c]
            })
        };
        let count = self.cells;
        let is_rough_along = |node: &dyn Fn(u32) -> Rgb, cell: u32| {
            let first = self.first(cell);
            // The differences around a kink in the middle of a cell vanish, but not those beside it.
            let is_inside = first > 0 && first + 4 <= count;
            is_rough(node, first) || (is_inside && is_rough(node, first - 1) && is_rough(node, first + 1))
        };
        let rough = |k: u32| {
            let (face, i, j) = (k / (count * count), k % count, k / count % count);
            [0, 1].into_iter().any(|far| {
                is_rough_along(&|n| self.at(face, n, j + far), i)
                    || is_rough_along(&|n| self.at(face, i + far, n), j)
            })
        };
        (0..6 * count * count).map(rough).collect()
    }

    /// Whether a cell in `marked` reaches into the tile whose first texel is (`left`, `top`).
    fn covers(&self, marked: &[bool], face: u32, [left, top]: [u32; 2]) -> bool {
        let within = |from: u32| {
            from / self.stride..=(from + TILE - 1).min(self.cells * self.stride - 1) / self.stride
        };
        within(top).any(|j| within(left).any(|i| marked[((face * self.cells + j) * self.cells + i) as usize]))
    }

    /// Fills `line`, rows of texels from `top` on, by cubic interpolation in the face's plane.
    fn interpolate(&self, face: u32, top: u32, line: &mut [Answer]) {
        let columns = self.cells * self.stride;
        let weights: Vec<(u32, [f64; 4])> = (0..columns).map(|texel| self.weights(texel)).collect();
        for (k, answer) in (0..).zip(line) {
            let (x, y) = (k % columns, top + k / columns);
            let ((left, across), (above, down)) = (weights[x as usize], weights[y as usize]);
            let mut sum = [0.0; 3];
            for (j, row) in (above..).zip(down) {
                for (i, weight) in (left..).zip(across) {
                    let node = self.at(face, i, j);
                    sum.iter_mut().zip(node).for_each(|(sum, value)| *sum += row * weight * f64::from(value));
                }
            }
            answer.radiance = sum.map(|value| value.clamp(0.0, f64::from(f32::MAX)) as f32);
        }
    }

    /// First node and weights of the cubic through four nodes, at the centre of `texel`.
    fn weights(&self, texel: u32) -> (u32, [f64; 4]) {
        let first = self.first(texel / self.stride);
        let t = (f64::from(texel) + 0.5) / f64::from(self.stride) - f64::from(first);
        let [a, b, c, d] = [t, t - 1.0, t - 2.0, t - 3.0];
        (first, [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes of `function` of face, column and row.
    fn nodes(stride: u32, cells: u32, function: impl Fn(u32, f64, f64) -> f64) -> Nodes {
        let side = cells + 1;
        let value = |k: u32| {
            let (face, i, j) = (k / (side * side), k % side, k / side % side);
            [function(face, f64::from(i), f64::from(j)) as f32; 3]
        };
        Nodes { stride, cells, radiance: (0..6 * side * side).map(value).collect() }
    }

    #[test]
    fn cubics_are_interpolated_exactly_up_to_the_edges() {
        let cubic = |face: u32, x: f64, y: f64| 1000.0 + f64::from(face) + x * x * (y - 2.0) + y * y * y;
        let nodes = nodes(4, 8, cubic);
        let mut line = vec![Answer { radiance: [0.0; 3], bound: None }; 32 * 4];
        for (face, top) in [(0, 0), (2, 12), (5, 28)] {
            nodes.interpolate(face, top, &mut line);
            for (k, answer) in (0..).zip(&line) {
                let place = |texel: u32| (f64::from(texel) + 0.5) / 4.0;
                let exact = cubic(face, place(k % 32), place(top + k / 32));
                // Nodes and texels are rounded to single precision; weights add up to less than 2 in size.
                let off = (f64::from(answer.radiance[0]) - exact).abs();
                assert!(off < 3.0 * 2000.0 / f64::from(1 << 24), "{face} {k}: off by {off}");
            }
        }
    }

    #[test]
    fn kinks_are_found_with_the_tiles_that_they_cross() {
        // Along x = 3.5, in the cells of column 3: nodes 1 to 6 are around those of columns 2 to 4.
        let kinked = nodes(4, 8, |face, x, _| 1.0 + if face == 1 { (x - 3.5).abs() } else { 0.0 });
        let rough = kinked.rough_cells(0.001);
        let columns: Vec<u32> =
            (0..8).filter(|i| (0..8).any(|j| rough[((8 + j) * 8 + i) as usize])).collect();
        assert_eq!(columns, [2, 3, 4]);
        assert!(rough[..64].iter().chain(&rough[128..]).all(|rough| !rough), "only face 1 has a kink");
        assert!(kinked.covers(&rough, 1, [12, 0]) && !kinked.covers(&rough, 1, [20, 0]));
        assert!(!kinked.covers(&rough, 0, [12, 0]));
        let wide = nodes(2, 8, |_, x, _| (x - 3.5).abs());
        let rough = wide.rough_cells(0.001);
        assert!(wide.covers(&rough, 0, [8, 0]) && wide.covers(&rough, 0, [4, 0]), "cells 4 and 2");
        assert!(!wide.covers(&rough, 0, [12, 0]), "cells 6 and 7");
    }

    #[test]
    fn nodes_are_as_far_apart_as_the_lobe_allows() {
        let stride =
            |size, roughness| stride(LevelSpec { layout: Layout::Cube { size }, roughness }, Lobe::Charlie);
        assert_eq!([stride(256, 0.0), stride(128, 0.143), stride(64, 0.286), stride(100, 0.9)], [4, 2, 1, 1]);
        assert_eq!(stride(2048, 0.9), 32);
    }
}
