//! Sheen levels whose texels are much finer than their lobe: lobes at nodes several texels apart,
//! interpolated in between. Where the nodes' differences are too large for that, nodes half as far apart are
//! evaluated, and so on down to tiles of texels.

use super::Engine;
use super::level::{Advance, BakedLevel, LeafCounts, LevelJob, Part};
use crate::common::error::Result;
use crate::common::parallel;
use crate::cpu::leaves::LANES;
use crate::cpu::reflector::{Lobes, Workspace};
use crate::geometry::tiling::{TILE, Tile, Tiling, at, interleaved};
use crate::light::chain::LevelSpec;
use crate::light::environment::{Layout, Rgb};
use crate::lobe::filter::{Answer, Filter};
use crate::lobe::{self, Lobe};
use glam::DVec3;

/// Greatest distance of nodes, over the lobe's full width at half maximum.
const NODE_SHARE: f64 = 0.45;

/// Fewest cells between nodes along an edge of a face: lobes at directions farther apart share too little of
/// the light to be evaluated together.
pub(super) const FEWEST_CELLS: u32 = 64;

/// Tolerance of these lobes over the requested one. A surface's sheen is this light times the lobe's
/// reflectance, at any roughness .19 (RMS over a sphere's disc): twice the error is seen as two fifths of it.
const SEEN: f64 = 2.0;

/// Greatest third difference of the nodes around a cell, over the mean radiance and the lobes' tolerance.
/// Measured on five photographs at a tolerance of 0.01: levels are off by 0.0066 to 0.0130 of their RMS, as
/// with 4; with 32 one of them by a fourteenth more.
const ROUGHEST: f64 = 24.0;

/// Nodes along an edge of a block, whose lobes share packets.
const BLOCK: u32 = 8;

/// Texels whose tiles are gathered at once.
const GATHERED: u32 = 1 << 17;

/// Packets of up to [`LANES`] adjacent directions.
type Packets = Vec<Vec<DVec3>>;

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
        Filter::Adaptive(error)
            if level.sparse && level.lobe == Lobe::Charlie && stride(level.spec, level.lobe) > 1 =>
        {
            // Tolerances are below 1.
            Some(if SEEN * error < 1.0 { SEEN * error } else { error })
        }
        _ => None,
    }
}

/// What part `part` of `parts` is of `whole`; all parts add up to it.
pub(super) const fn share(whole: u64, part: u64, parts: u64) -> u64 {
    whole * (part + 1) / parts - whole * part / parts
}

/// Evaluates `lobes` on the CPU, for [`bake_sparsely`].
pub(super) fn evaluate(
    lobes: &Lobes<'_>,
    packets: &[Vec<DVec3>],
    done: Part<'_>,
) -> Result<(Vec<Answer>, LeafCounts)> {
    /// Packets of one task.
    const TASK: usize = 16;
    let tasks = packets.len().div_ceil(TASK) as u64;
    let task = |workspace: &mut Workspace, (task, packets): (usize, &[Vec<DVec3>])| {
        let mut answers = Vec::with_capacity(TASK * LANES);
        packets.iter().for_each(|packet| lobes.evaluate_units(packet, workspace, &mut answers));
        done(task as u64, tasks)?;
        Ok((answers, LeafCounts::take(workspace)))
    };
    let found = parallel::try_map_with(packets.chunks(TASK).enumerate(), Workspace::default, task)?;
    let (mut answers, mut work) = (Vec::new(), LeafCounts::default());
    for (found, counts) in found {
        answers.extend(found);
        work.add(&counts);
    }
    Ok((answers, work))
}

/// Bakes `level` without certified bounds, by the answers of `engine` to `tolerance`.
pub(super) async fn bake_sparsely<E: Engine>(
    engine: &E,
    level: &LevelJob,
    tolerance: f64,
    advance: Advance<'_>,
) -> Result<BakedLevel> {
    let tiling = Tiling::new(engine.inner(), level.spec, level.lobe);
    let stride = stride(level.spec, level.lobe);
    // Nodes take about half the time.
    let total = level.spec.layout.texel_count() as u64;
    let half = total / 2;
    let unmeasured: Part<'_> = &|_, _| advance(0);

    let mut nodes = Nodes::new(stride, tiling.sides.1 / stride);
    let (places, packets) = nodes.gathered(|_, _, _| true);
    let first_half: Part<'_> = &|part, parts| advance(share(half, part, parts));
    let (answers, mut work) = engine.answers(level, tolerance, &packets, first_half).await?;
    nodes.take(&places, &answers);
    let mut refined = nodes.rough_cells(tolerance);
    while nodes.stride > 2 {
        let mut halved = nodes.halved();
        let (places, packets) = halved.gathered(|face, i, j| nodes.is_refined(&refined, face, [i, j]));
        let (answers, counts) = engine.answers(level, tolerance, &packets, unmeasured).await?;
        work.add(&counts);
        halved.take(&places, &answers);
        nodes = halved;
        refined = nodes.rough_cells(tolerance);
    }

    let mut texels = Vec::with_capacity(total as usize);
    let rows_of_face = tiling.sides.1.div_ceil(TILE);
    let rows_at_once = (GATHERED / (TILE * tiling.sides.0)).max(1);
    let batches = u64::from(tiling.rows().div_ceil(rows_at_once));
    for (batch, first) in (0..).zip((0..tiling.rows()).step_by(rows_at_once as usize)) {
        let rows = first..(first + rows_at_once).min(tiling.rows());
        let covers = |row: u32, left: u32| {
            nodes.covers(&refined, row / rows_of_face, [left, row % rows_of_face * TILE])
        };
        let gather = |row: u32| {
            let (mut line, mut packets) = (tiling.line(row), Packets::new());
            nodes.interpolate(row / rows_of_face, row % rows_of_face * TILE, &mut line);
            tiling.for_each_tile_at(
                row,
                &mut Tile::default(),
                |left| covers(row, left),
                |tile| {
                    packets.extend(tile.directions.chunks(LANES).map(<[DVec3]>::to_vec));
                },
            );
            (line, packets)
        };
        let (lines, packets): (Vec<_>, Vec<_>) = parallel::map(rows.clone(), gather).into_iter().unzip();
        let (answers, counts) = engine.answers(level, tolerance, &packets.concat(), unmeasured).await?;
        work.add(&counts);
        let mut rest = &answers[..];
        for (row, mut line) in rows.zip(lines) {
            tiling.for_each_tile_at(
                row,
                &mut Tile::default(),
                |left| covers(row, left),
                |tile| {
                    let (own, others) = rest.split_at(tile.directions.len());
                    tile.resolve(own, &mut line);
                    rest = others;
                },
            );
            texels.extend(line.into_iter().map(|answer| Answer { bound: None, ..answer }));
        }
        advance(share(total - half, batch, batches))?;
    }
    Ok(BakedLevel::new(E::PROCESSOR, texels.into_iter(), work))
}

impl Nodes {
    /// Nodes without light.
    pub(super) fn new(stride: u32, cells: u32) -> Self {
        Self { stride, cells, radiance: vec![[0.0; 3]; (6 * (cells + 1) * (cells + 1)) as usize] }
    }

    /// Nodes half as far apart, interpolated.
    fn halved(&self) -> Self {
        let (stride, cells) = (self.stride / 2, 2 * self.cells);
        let side = cells + 1;
        let weights: Vec<(u32, [f64; 4])> = (0..side).map(|n| self.weights(f64::from(n) / 2.0)).collect();
        let value = |k: usize| {
            let k = k as u32;
            let (face, i, j) = (k / (side * side), k % side, k / side % side);
            if i % 2 == 0 && j % 2 == 0 {
                self.at(face, i / 2, j / 2)
            } else {
                self.between(face, weights[i as usize], weights[j as usize])
            }
        };
        Self { stride, cells, radiance: parallel::values((6 * side * side) as usize, value) }
    }

    /// Whether node (`i`, `j`) of `face` among those half as far apart is none of these, and in or beside a
    /// cell in `marked`.
    fn is_refined(&self, marked: &[bool], face: u32, [i, j]: [u32; 2]) -> bool {
        let around = |n: u32| n.saturating_sub(1) / 2..=(n / 2).min(self.cells - 1);
        let is_marked = |i, j| marked[((face * self.cells + j) * self.cells + i) as usize];
        (i % 2 == 1 || j % 2 == 1) && around(j).any(|j| around(i).any(|i| is_marked(i, j)))
    }

    /// Indices of the nodes that are `wanted` by face, column and row, and packets of their directions.
    pub(super) fn gathered(&self, wanted: impl Fn(u32, u32, u32) -> bool + Sync) -> (Vec<usize>, Packets) {
        let side = self.cells + 1;
        let blocks = side.div_ceil(BLOCK);
        let block = |k: u32| {
            let (face, left, top) = (k / (blocks * blocks), k % blocks * BLOCK, k / blocks % blocks * BLOCK);
            let places: Vec<(u32, u32)> = (0..BLOCK * BLOCK)
                .map(|k| (left + interleaved(k), top + interleaved(k >> 1)))
                .filter(|&(i, j)| i < side && j < side && wanted(face, i, j))
                .collect();
            let direction =
                |&(i, j): &(u32, u32)| at(Layout::Cube { size: self.cells }, face, i.into(), j.into()).0;
            let packets: Packets =
                places.chunks(LANES).map(|places| places.iter().map(direction).collect()).collect();
            let index = |(i, j)| ((face * side + j) * side + i) as usize;
            (places.into_iter().map(index).collect::<Vec<usize>>(), packets)
        };
        let (places, packets): (Vec<_>, Vec<_>) =
            parallel::map(0..6 * blocks * blocks, block).into_iter().unzip();
        (places.concat(), packets.concat())
    }

    /// Sets the nodes of indices `places`.
    fn take(&mut self, places: &[usize], answers: &[Answer]) {
        places.iter().zip(answers).for_each(|(k, answer)| self.radiance[*k] = answer.radiance);
    }

    /// Cells along an edge of a face.
    pub(super) const fn cells(&self) -> u32 {
        self.cells
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

    /// Fills `line`, rows of texels from `top` on.
    fn interpolate(&self, face: u32, top: u32, line: &mut [Answer]) {
        let columns = self.cells * self.stride;
        let place = |texel: u32| (f64::from(texel) + 0.5) / f64::from(self.stride);
        let weights: Vec<(u32, [f64; 4])> = (0..columns).map(|texel| self.weights(place(texel))).collect();
        for (k, answer) in (0..).zip(line) {
            let (x, y) = (k % columns, top + k / columns);
            answer.radiance = self.between(face, weights[x as usize], weights[y as usize]);
        }
    }

    /// Radiance by cubic interpolation in the plane of `face`, by the first nodes and weights of
    /// [`Self::weights`] across and down.
    fn between(&self, face: u32, (left, across): (u32, [f64; 4]), (above, down): (u32, [f64; 4])) -> Rgb {
        let mut sum = [0.0; 3];
        for (j, row) in (above..).zip(down) {
            for (i, weight) in (left..).zip(across) {
                let node = self.at(face, i, j);
                sum.iter_mut().zip(node).for_each(|(sum, value)| *sum += row * weight * f64::from(value));
            }
        }
        sum.map(|value| value.clamp(0.0, f64::from(f32::MAX)) as f32)
    }

    /// First node and weights of the cubic through four nodes, at `place` in distances of nodes.
    pub(super) fn weights(&self, place: f64) -> (u32, [f64; 4]) {
        let first = self.first((place as u32).min(self.cells - 1));
        let t = place - f64::from(first);
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
    fn halved_nodes_are_those_of_a_cubic_and_are_refined_around_marked_cells() {
        let cubic = |face: u32, x: f64, y: f64| 1000.0 + f64::from(face) + x * x * (y - 2.0) + y * y * y;
        let coarse = nodes(4, 8, cubic);
        let halved = coarse.halved();
        assert_eq!((halved.stride, halved.cells), (2, 16));
        for k in 0..6 * 17 * 17 {
            let (face, i, j) = (k / 289, k % 17, k / 17 % 17);
            let exact = cubic(face, f64::from(i) / 2.0, f64::from(j) / 2.0);
            // As below.
            let off = (f64::from(halved.at(face, i, j)[0]) - exact).abs();
            assert!(off < 3.0 * 2000.0 / f64::from(1 << 24), "{face} {i} {j}: off by {off}");
        }
        // Cell (7, 0) of face 2 has the new nodes 14 to 16 across and 0 to 2 down, but for its own four.
        let marked: Vec<bool> = (0..6 * 64).map(|k| k == 2 * 64 + 7).collect();
        let (places, packets) = halved.gathered(|face, i, j| coarse.is_refined(&marked, face, [i, j]));
        let mut places: Vec<usize> = places.iter().map(|k| k - 2 * 289).collect();
        places.sort_unstable();
        assert_eq!(places, [15, 17 + 14, 17 + 15, 17 + 16, 2 * 17 + 15]);
        assert_eq!(packets.concat().len(), 5);
        // All nodes are gathered once, in packets of adjacent ones.
        let (mut all, packets) = coarse.gathered(|_, _, _| true);
        all.sort_unstable();
        assert!(all.into_iter().eq(0..6 * 81));
        assert!(packets.iter().all(|packet| packet.len() <= LANES));
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
