//! Quadrature nodes between the levels of a solved chain, and the level that holds it.

use crate::light::chain::{ChainKind, LevelSpec};
use crate::light::environment::Layout;
use crate::lobe::ladder::Ladder;
use crate::lobe::{Lobe, full_width_at_half_maximum};
use crate::sphere::quadrature::{THREE_NODES, TWO_NODES};
use std::f64::consts::FRAC_PI_2;

/// A quadrature node: a lobe between two levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node {
    /// Its cube and roughness.
    pub(crate) spec: LevelSpec,
    /// Its quadrature weight over roughness.
    pub(super) weight: f64,
    /// The sharper of the two levels.
    pub(super) low: usize,
    /// Weight of the rougher level in a look-up.
    pub(super) share: f64,
}

impl Node {
    /// Edge of its cube in texels.
    pub(super) fn edge(&self) -> u32 {
        self.spec.layout.sides().1
    }
}

/// Minimum texels of a node's cube per full width at half maximum of its lobe.
const TEXELS_PER_WIDTH: f64 = 3.5;

/// Minimum edge of a node's cube.
pub(super) const MIN_EDGE: u32 = 16;

/// Nodes and weights of Gauss quadratures over [0, 1], indexed by number of nodes minus 2.
const QUADRATURES: [&[(f64, f64)]; 2] = [&TWO_NODES, &THREE_NODES];

/// Whether cubic interpolation on a cube of `edge` texels resolves a lobe of `roughness`.
pub(super) fn resolves(edge: u32, roughness: f64) -> bool {
    let width = full_width_at_half_maximum(Lobe::Ggx, roughness * roughness);
    edge >= MIN_EDGE && width * f64::from(edge) >= TEXELS_PER_WIDTH * FRAC_PI_2
}

/// Ratio of two levels' peaks above which three nodes are needed.
const STEEP: f64 = 8.0;

/// Lower bound of a solved value, relative to the sampled one.
pub(super) const MIN_SHARE: f64 = 0.75;

/// Weight that pulls the first level, below which is only the mirror, to its sampled value, where the level
/// resolves its lobe. Less weight lowers the error between the levels and raises the one below them, which
/// then exceeds 1.2 times that of sampled chains.
const HELD_FINE: f64 = 0.055;

/// The weight for a level of fewer texels.
const HELD_COARSE: f64 = 0.018;

/// Lower bound of such a level's values, relative to the sampled ones. Its sampled peaks are already too low
/// between texels: below 0.9, the error of a sun at that level's roughness would be the greatest of all.
const MIN_COARSE: f64 = 0.9;

/// Weight that fixes a level.
const FIXED: f64 = 1e6;

/// Nodes of a chain with `levels` levels from edge `size` on `ladder`; none if no level is solved.
pub(crate) fn nodes(kind: ChainKind, size: u32, levels: u32, ladder: Ladder) -> Vec<Node> {
    let mut nodes = Vec::new();
    let roughness = |level| ladder.roughness(level, levels, size);
    let Held { level: held, .. } =
        Held::new(kind, size, (0..levels as usize).map(|level| roughness(level as u32)));
    for low in held as u32..levels.saturating_sub(1) {
        let (from, to) = (roughness(low), roughness(low + 1));
        let quadrature = QUADRATURES[usize::from((to / from).powi(4) > STEEP)];
        for (place, weight) in quadrature.iter().filter(|_| to > from) {
            let roughness = from + (to - from) * place;
            let edge = (0..32).map(|k| size >> k).take_while(|edge| resolves(*edge, roughness)).last();
            nodes.push(Node {
                spec: LevelSpec {
                    layout: Layout::Cube { size: edge.unwrap_or(size.max(MIN_EDGE)) },
                    roughness,
                },
                weight: weight * (to - from),
                low: low as usize,
                share: ladder.lod(roughness, levels, size) - f64::from(low),
            });
        }
    }
    nodes
}

/// The sharpest level of the equations along roughness, which its sampled value holds.
#[derive(Clone, Copy)]
pub(super) struct Held {
    pub(super) level: usize,
    /// The first level to be solved: this level or the next.
    pub(super) first_solved: usize,
    /// Weight of its sampled value, as a range of roughness.
    pub(super) weight: f64,
    /// Lower bound of its solved value, relative to the sampled one.
    pub(super) least: f64,
}

impl Held {
    /// The held level of a chain from edge `size` whose levels have `roughness`.
    pub(super) fn new(
        kind: ChainKind,
        size: u32,
        mut roughness: impl ExactSizeIterator<Item = f64> + Clone,
    ) -> Self {
        let first_solved = kind.first_solved(roughness.clone());
        if kind == ChainKind::Mixed {
            return Self { level: first_solved - 1, first_solved, weight: FIXED, least: MIN_SHARE };
        }
        let is_coarse = roughness.nth(first_solved).is_some_and(|own| !resolves(size >> first_solved, own));
        let (weight, least) = if is_coarse { (HELD_COARSE, MIN_COARSE) } else { (HELD_FINE, MIN_SHARE) };
        Self { level: first_solved, first_solved, weight, least }
    }
}
