//! Least squares along roughness, for a window of levels around the solved one.

use super::grid::{Grid, MARGIN, Scratch, Sums, Taps, VALUES, add, at_least_black, cubic_taps, read_row};
use super::nodes::{Held, MIN_SHARE, Node};
use crate::common::parallel;
use std::iter::zip;

/// Number of levels on either side of the solved one.
const REACH: usize = 2;

/// Maximum levels of a window.
const MAX_LEVELS: usize = 2 * REACH + 1;

/// Relaxation sweeps; each reduces the error to a quarter.
const SWEEPS: usize = 12;

/// A target value of look-ups.
struct Aim {
    /// Index of its lobe; `None` for the first level as sampled.
    node: Option<usize>,
    weight: f64,
    /// The sharper level of the look-up, relative to the window's first.
    low: usize,
    /// Weight of the rougher level.
    share: f64,
}

/// Least squares along roughness: a window of levels and the target values between them.
pub(super) struct Window {
    /// Its first level.
    pub(super) first: usize,
    /// Index of the solved level in the window.
    own: usize,
    /// Lower bounds of the levels' values, relative to the sampled ones.
    least: [f64; MAX_LEVELS],
    aims: Vec<Aim>,
    /// Normal equations: the diagonal and the off-diagonal.
    diagonal: Vec<f64>,
    off_diagonal: Vec<f64>,
    /// Their inverse.
    inverse: Vec<Vec<f64>>,
}

impl Window {
    pub(super) fn new(index: usize, held: Held, last: usize, nodes: &[Node]) -> Self {
        let (first, end) = (index.saturating_sub(REACH).max(held.level), (index + REACH).min(last));
        let within = nodes.iter().enumerate().filter(|(_, node)| node.low >= first && node.low < end);
        let mut aims: Vec<Aim> = within
            .map(|(k, node)| Aim {
                node: Some(k),
                weight: node.weight,
                low: node.low - first,
                share: node.share,
            })
            .collect();
        if first == held.level {
            aims.push(Aim { node: None, weight: held.weight, low: 0, share: 0.0 });
        }
        let least = std::array::from_fn(|k| if first + k == held.level { held.least } else { MIN_SHARE });
        let count = end - first + 1;
        let (mut diagonal, mut off_diagonal) = (vec![0.0; count], vec![0.0; count]);
        for aim in &aims {
            let low = aim.low;
            diagonal[low] += aim.weight * (1.0 - aim.share).powi(2);
            if aim.share > 0.0 {
                diagonal[low + 1] += aim.weight * aim.share.powi(2);
                off_diagonal[low] += aim.weight * aim.share * (1.0 - aim.share);
            }
        }
        let own = index - first;
        let mut window = Self { first, own, least, aims, diagonal, off_diagonal, inverse: Vec::new() };
        window.inverse = (0..count).map(|level| window.exact(level)).collect();
        window
    }

    /// Response of each level to a unit on the right-hand side of `level`, by elimination.
    fn exact(&self, level: usize) -> Vec<f64> {
        let count = self.diagonal.len();
        let mut right = vec![0.0; count];
        right[level] = 1.0;
        let mut pivot = self.diagonal.clone();
        for k in 1..count {
            let factor = self.off_diagonal[k - 1] / pivot[k - 1];
            pivot[k] -= factor * self.off_diagonal[k - 1];
            right[k] -= factor * right[k - 1];
        }
        for k in (0..count).rev() {
            let above = if k + 1 < count { self.off_diagonal[k] * right[k + 1] } else { 0.0 };
            right[k] = (right[k] - above) / pivot[k];
        }
        right
    }

    /// The solved level's values on a grid of `edge` places, from the window's `sampled` levels.
    pub(super) fn targets<'a>(
        &'a self,
        edge: usize,
        sampled: &'a [Grid],
        between: &'a [Grid],
    ) -> Targets<'a> {
        let read = |grid: &'a Grid| (grid, cubic_taps(grid.n, edge));
        let lobe = |aim: &Aim| aim.node.map(|node| read(&between[node]));
        Targets {
            window: self,
            edge,
            sampled: sampled.iter().take(self.diagonal.len()).map(read).collect(),
            lobes: self.aims.iter().map(lobe).collect(),
        }
    }

    /// Solves for `levels` with the lower bounds `least`, by relaxation.
    #[inline(always)]
    fn bounded(
        &self,
        right: &[Sums; MAX_LEVELS],
        levels: &mut [Sums; MAX_LEVELS],
        least: &[Sums; MAX_LEVELS],
    ) {
        let count = self.diagonal.len();
        for _ in 0..SWEEPS {
            for k in 0..count {
                let mut rest = right[k];
                if k > 0 {
                    add(&mut rest, -self.off_diagonal[k - 1], &levels[k - 1]);
                }
                if k + 1 < count {
                    add(&mut rest, -self.off_diagonal[k], &levels[k + 1]);
                }
                for l in 0..VALUES {
                    levels[k][l] = (rest[l] / self.diagonal[k]).max(least[k][l]);
                }
            }
        }
    }
}

/// A grid, and how its rows and columns are read.
type Read<'a> = (&'a Grid, Vec<Taps<4>>);

/// Values of one solved level on a grid.
pub(super) struct Targets<'a> {
    window: &'a Window,
    /// Places along an edge.
    edge: usize,
    sampled: Vec<Read<'a>>,
    /// Per aim with a lobe of its own.
    lobes: Vec<Option<Read<'a>>>,
}

impl Targets<'_> {
    /// All rows.
    pub(super) fn grid(&self) -> Grid {
        let mut grid = Grid::black(self.edge);
        let side = grid.side();
        let start = || (Scratch::default(), vec![[0.0; VALUES]; self.edge]);
        let rows = grid.places.chunks_mut(side).skip(MARGIN).take(self.edge);
        parallel::map_with(rows.enumerate(), start, |(scratch, values), (y, row)| {
            self.row(y, scratch, values);
            zip(&mut row[MARGIN..], values)
                .for_each(|(place, value)| *place = value.map(|value| value as f32));
        });
        grid
    }

    /// Row `y`.
    pub(super) fn row(&self, y: usize, scratch: &mut Scratch, out: &mut [Sums]) {
        scratch.arch.dispatch(TargetRow { targets: self, y, scratch, out });
    }
}

/// One row of [`Targets`].
struct TargetRow<'a> {
    targets: &'a Targets<'a>,
    y: usize,
    scratch: &'a mut Scratch,
    out: &'a mut [Sums],
}

impl pulp::NullaryFnOnce for TargetRow<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Targets { window, edge, sampled, lobes } = self.targets;
        let Scratch { blended, lobe, own, right, .. } = self.scratch;
        let count = sampled.len();
        for rows in [&mut *own, &mut *right] {
            rows.resize(MAX_LEVELS, Vec::new());
            rows.iter_mut().for_each(|row| row.resize(*edge, [0.0; VALUES]));
        }
        lobe.resize(*edge, [0.0; VALUES]);
        right.iter_mut().for_each(|row| row.fill([0.0; VALUES]));
        for ((grid, taps), row) in zip(sampled, &mut *own) {
            read_row(grid, taps[self.y], taps, blended, row);
            at_least_black(row);
        }
        for (aim, read) in zip(&window.aims, lobes) {
            let values = match read {
                Some((grid, taps)) => {
                    read_row(grid, taps[self.y], taps, blended, lobe);
                    at_least_black(lobe);
                    &*lobe
                }
                None => &own[aim.low],
            };
            for (k, share) in [(aim.low, 1.0 - aim.share), (aim.low + 1, aim.share)] {
                if share > 0.0 {
                    for x in 0..*edge {
                        add(&mut right[k][x], aim.weight * share, &values[x]);
                    }
                }
            }
        }
        for x in 0..*edge {
            let at: [Sums; MAX_LEVELS] = std::array::from_fn(|k| right[k][x]);
            let (mut levels, mut least) = ([[0.0; VALUES]; MAX_LEVELS], [[0.0; VALUES]; MAX_LEVELS]);
            let mut below = [false; VALUES];
            for k in 0..count {
                for j in 0..count {
                    add(&mut levels[k], window.inverse[j][k], &at[j]);
                }
                for l in 0..VALUES {
                    least[k][l] = window.least[k] * own[k][x][l];
                    below[l] |= levels[k][l] < least[k][l];
                }
            }
            if below.contains(&true) {
                window.bounded(&at, &mut levels, &least);
            }
            self.out[x] = levels[window.own];
        }
    }
}
