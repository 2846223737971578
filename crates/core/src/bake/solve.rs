//! Solved chains: texels whose trilinear look-ups, rather than the texels themselves, best fit the lobes.
//!
//! A look-up interpolates a curved function linearly, so its error between samples has one sign. Solved
//! levels are the least-squares fit of look-ups over direction and roughness, in two steps, each linear
//! except for its bounds:
//! 1. Along roughness, per direction: the level values whose linear interpolation best fits the lobes at
//!    quadrature nodes between the levels. Values are at least a share of the sampled lobe; otherwise a sun,
//!    many times brighter in one level than in the next, would leave a hole in the rougher one.
//! 2. Over direction, per level: the texels whose bilinear look-ups best fit those values, by conjugate
//!    gradients.
//!
//! All faces have the same look-ups, so that a place of all six is computed at once.
//!
//! Lobes between the levels are baked as separate levels, on the coarsest cubes that resolve them. A mixed
//! chain keeps its sharp levels as sampled; its rougher ones are solved with the last of them fixed.

mod fit;
mod grid;
mod nodes;
mod seams;
mod window;

pub(crate) use nodes::{Node, nodes};

use crate::light::chain::{ChainKind, Level};
use crate::light::environment::Rgb;
use fit::Fit;
use grid::{Grid, Reading, Scale, cubic_taps};
use nodes::{Held, resolves};
use std::iter::zip;
use std::ops::Range;
use window::Window;

/// Solves `levels`, a sampled chain of cubes, in place; `lobes` are the texels of `nodes`. Keeps level 0, the
/// sharp levels of a mixed chain and levels that no look-up reads. Returns the indices of the solved levels.
pub(crate) fn solve(kind: ChainKind, levels: &mut [Level], nodes: &[Node], lobes: &[&[Rgb]]) -> Range<usize> {
    let Some(last) = nodes.iter().map(|node| node.low + 1).max() else { return 0..0 };
    let held = Held::new(kind, levels[0].size(), levels.iter().map(|level| level.roughness));
    let scale = Scale::new(
        levels[held.level..=last].iter().map(|level| &level.texels[..]).chain(lobes.iter().copied()),
    );
    let smooth = |size: u32, texels: &[Rgb]| Grid::new(size, texels, scale).smooth();
    let sampled: Vec<Grid> =
        levels[held.level..=last].iter().map(|level| smooth(level.size(), &level.texels)).collect();
    let between: Vec<Grid> = zip(nodes, lobes).map(|(node, texels)| smooth(node.edge(), texels)).collect();
    for index in held.first_solved..=last {
        let window = Window::new(index, held, last, nodes);
        let level = &mut levels[index];
        let targets = |edge| window.targets(edge, &sampled[window.first - held.level..], &between);
        let fit = Fit::new(level.size());
        let mut own = Grid::new(level.size(), &level.texels, scale);
        fit.seams.fill(&mut own);
        let residual = if resolves(level.size(), level.roughness) {
            // Cubic interpolation between texel centres.
            let centres = targets(own.n).grid().smooth();
            let across = cubic_taps(own.n, fit.linear.len());
            fit.residual(&own, &|y, scratch, out| {
                scratch.arch.dispatch(Reading {
                    grid: &centres,
                    down: across[y],
                    across: &across,
                    blended: &mut scratch.blended,
                    out,
                })
            })
        } else {
            let targets = targets(fit.linear.len());
            fit.residual(&own, &|y, scratch, out| targets.row(y, scratch, out))
        };
        let solved = fit.corrected(&own, residual);
        fit.seams.ordered(&own, solved).write(&mut level.texels, scale);
    }
    held.first_solved..last + 1
}

/// Memory in bytes to solve a chain of cubes of `size` texels, excluding the levels.
pub(crate) fn solve_bytes(size: u32, nodes: &[Node]) -> u64 {
    let texels = |edge: u32| 6 * u64::from(edge) * u64::from(edge);
    let between: u64 = nodes.iter().map(|node| texels(node.edge() + 4)).sum();
    let first = nodes.iter().map(|node| node.low).min().unwrap_or(0);
    // Grids of three floats: the levels, and seven of the first; five floats per place of one face.
    texels((size >> first) + 4) * (16 + 7 * 12 + 4) + between * 12
}
