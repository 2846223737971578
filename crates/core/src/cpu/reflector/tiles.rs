//! Lobes of the texels of a tile: means over each texel's directions.

use super::{Evaluation, Lobes, NO_LIGHT, Workspace, spread};
use crate::cpu::adaptive::{Adaptive, Shares};
use crate::cpu::footprints::Footprints;
use crate::cpu::leaves::{LANES, Packet};
use crate::geometry::tiling::Tile;
use crate::lobe::filter::Answer;
use glam::DVec3;

/// Fewest packets of directions for which their texels are evaluated together.
const WORTHWHILE: usize = 2;

/// Packets that share a cut: nearly the same leaves serve all. Those of texels many lobes wide are farther
/// apart.
const TOGETHER: usize = 8;

impl Lobes<'_> {
    /// Evaluates the texels of `tile` into their `line`, by way of `answers`.
    pub(crate) fn evaluate_tile(
        &self,
        tile: &Tile,
        workspace: &mut Workspace,
        answers: &mut Vec<Answer>,
        line: &mut [Answer],
    ) {
        answers.clear();
        let directions = &tile.directions[..];
        match &self.method {
            Evaluation::Adaptive { source, bilinear, widest }
                if directions.len() >= WORTHWHILE * LANES
                    && spread(directions) <= *widest
                    && tile.texels.len() <= LANES
                    && [source, bilinear].into_iter().flatten().all(Adaptive::takes_footprints) =>
            {
                let turned: Vec<DVec3> = directions.iter().map(|d| self.source_from_world * *d).collect();
                let footprints = Footprints::new(tile.footprints(&turned));
                let groups: Vec<Vec<Packet>> = turned
                    .chunks(TOGETHER * LANES)
                    .map(|group| Packet::sharing_a_cut(group).collect())
                    .collect();
                let mut far = [NO_LIGHT; LANES];
                answers.resize(directions.len(), NO_LIGHT);
                for part in [source, bilinear].into_iter().flatten() {
                    let shares = part.evaluate_far(&footprints, &mut workspace.scratch);
                    workspace.leaves += shares.leaves as u64;
                    add(&mut far, &shares);
                    let own = answers.chunks_mut(TOGETHER * LANES);
                    for (packets, answers) in groups.iter().zip(own) {
                        part.cut_rest(&packets[0], &mut workspace.scratch);
                        for (packet, answers) in packets.iter().zip(answers.chunks_mut(LANES)) {
                            let shares = part.sum_leaves(packet, &workspace.scratch);
                            workspace.leaves += shares.leaves as u64;
                            add(answers, &shares);
                        }
                    }
                }
                // Texels as lanes of a packet of their own.
                workspace.packets += 1 + directions.len().div_ceil(LANES) as u64;
                workspace.directions += (tile.texels.len() + directions.len()) as u64;
                tile.resolve(answers, line);
                for ((place, _), far) in tile.texels.iter().zip(far) {
                    let near = line[*place];
                    let bound = near.bound.zip(far.bound).map(|(near, far)| near + far);
                    let radiance = std::array::from_fn(|c| near.radiance[c] + far.radiance[c]);
                    line[*place] = self.scale.answer(Answer { radiance, bound });
                }
            }
            _ => {
                self.evaluate_units(directions, workspace, answers);
                tile.resolve(answers, line);
            }
        }
    }
}

/// Adds `shares` to `answers`, lane by lane.
pub(super) fn add(answers: &mut [Answer], shares: &Shares) {
    for (answer, (radiance, bound)) in answers.iter_mut().zip(shares.radiance.iter().zip(shares.bound)) {
        answer.radiance.iter_mut().zip(radiance).for_each(|(sum, value)| *sum += value);
        answer.bound = answer.bound.map(|sum| sum + bound);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::reflector::{Reflector, ReflectorSettings};
    use crate::geometry::tiling::Tiling;
    use crate::light::chain::LevelSpec;
    use crate::light::environment::{Layout, lamps};
    use crate::lobe::Lobe;
    use crate::lobe::filter::Filter;

    #[test]
    fn far_light_of_footprints_is_within_its_bounds() {
        let environment = lamps([0.997, 300.0]);
        let reflector = Reflector::new(&environment, &ReflectorSettings::default()).expect("a reflector");
        let (mut worst, mut far, mut together, mut apart) = (0.0_f64, 0, 0.0, 0.0);
        for roughness in [0.06, 0.1, 0.14] {
            let spec = LevelSpec { layout: Layout::Cube { size: 64 }, roughness };
            let tiling = Tiling::new(reflector.size().inner, spec, Lobe::Ggx);
            let lobes =
                |error| reflector.lobes(Lobe::Ggx, roughness, Filter::Adaptive(error)).expect("lobes");
            let (coarse, fine) = (lobes(0.02), lobes(1e-3));
            for row in [3, 40] {
                let [mut line, mut plain, mut truth] = [(); 3].map(|()| tiling.line(row));
                let (mut workspace, mut answers) = (Workspace::default(), Vec::new());
                tiling.for_each_tile(row, &mut Tile::default(), |tile| {
                    coarse.evaluate_tile(tile, &mut workspace, &mut answers, &mut line);
                    far += usize::from(tile.directions.len() >= WORTHWHILE * LANES);
                    for (lobes, line) in [(&coarse, &mut plain), (&fine, &mut truth)] {
                        answers.clear();
                        lobes.evaluate_units(&tile.directions, &mut workspace, &mut answers);
                        tile.resolve(&answers, line);
                    }
                });
                for ((found, plain), exact) in line.iter().zip(&plain).zip(&truth) {
                    let (bound, own) = found.bound.zip(exact.bound).expect("bounds");
                    for c in 0..3 {
                        let off = f64::from(found.radiance[c] - exact.radiance[c]);
                        let most = f64::from(bound.channels[c] + own.channels[c]);
                        worst = worst.max(off.abs() / most);
                        together += off * off;
                        apart += f64::from(plain.radiance[c] - exact.radiance[c]).powi(2);
                    }
                }
            }
        }
        assert!(far > 50, "only {far} tiles have footprints");
        assert!(worst < 0.9, "off by {worst} of the bound");
        // Errors of leaves add up as before.
        let ratio = (together / apart).sqrt();
        assert!(ratio < 1.2, "RMS errors are {ratio} times those of each direction alone");
    }
}
