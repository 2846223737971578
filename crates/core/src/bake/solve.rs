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

use crate::common::vector::Arch;
use crate::light::chain::{ChainKind, Level, LevelSpec};
use crate::light::chain_lookup::LevelLookup;
use crate::light::environment::{Layout, Rgb};
use crate::lobe::ladder::Ladder;
use crate::lobe::{Lobe, full_width_at_half_maximum};
use crate::sphere::cube::{Face, cube_from_direction, cube_point};
use crate::sphere::quadrature::{THREE_NODES, TWO_NODES};
use rayon::prelude::*;
use std::collections::BinaryHeap;
use std::f64::consts::FRAC_PI_2;
use std::iter::zip;
use std::ops::Range;

/// A quadrature node: a lobe between two levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node {
    /// Its cube and roughness.
    pub(crate) spec: LevelSpec,
    /// Its quadrature weight over roughness.
    weight: f64,
    /// The sharper of the two levels.
    low: usize,
    /// Weight of the rougher level in a look-up.
    share: f64,
}

impl Node {
    /// Edge of its cube in texels.
    fn edge(&self) -> u32 {
        self.spec.layout.sides().1
    }
}

/// Minimum texels of a node's cube per full width at half maximum of its lobe.
const TEXELS_PER_WIDTH: f64 = 3.5;

/// Minimum edge of a node's cube.
const MIN_EDGE: u32 = 16;

/// Nodes and weights of Gauss quadratures over [0, 1], indexed by number of nodes minus 2.
const QUADRATURES: [&[(f64, f64)]; 2] = [&TWO_NODES, &THREE_NODES];

/// Whether cubic interpolation on a cube of `edge` texels resolves a lobe of `roughness`.
fn resolves(edge: u32, roughness: f64) -> bool {
    let width = full_width_at_half_maximum(Lobe::Ggx, roughness * roughness);
    edge >= MIN_EDGE && width * f64::from(edge) >= TEXELS_PER_WIDTH * FRAC_PI_2
}

/// Ratio of two levels' peaks above which three nodes are needed.
const STEEP: f64 = 8.0;

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

/// Lower bound of a solved value, relative to the sampled one.
const MIN_SHARE: f64 = 0.75;

/// The sharpest level of the equations along roughness, which its sampled value holds.
#[derive(Clone, Copy)]
struct Held {
    level: usize,
    /// The first level to be solved: this level or the next.
    first_solved: usize,
    /// Weight of its sampled value, as a range of roughness.
    weight: f64,
    /// Lower bound of its solved value, relative to the sampled one.
    least: f64,
}

impl Held {
    /// The held level of a chain from edge `size` whose levels have `roughness`.
    fn new(kind: ChainKind, size: u32, mut roughness: impl ExactSizeIterator<Item = f64> + Clone) -> Self {
        let first_solved = kind.first_solved(roughness.clone());
        if kind == ChainKind::Mixed {
            return Self { level: first_solved - 1, first_solved, weight: FIXED, least: MIN_SHARE };
        }
        let is_coarse = roughness.nth(first_solved).is_some_and(|own| !resolves(size >> first_solved, own));
        let (weight, least) = if is_coarse { (HELD_COARSE, MIN_COARSE) } else { (HELD_FINE, MIN_SHARE) };
        Self { level: first_solved, first_solved, weight, least }
    }
}

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

/// Number of levels on either side of the solved one.
const REACH: usize = 2;

/// Maximum levels of a window.
const MAX_LEVELS: usize = 2 * REACH + 1;

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
struct Window {
    /// Its first level.
    first: usize,
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
    fn new(index: usize, held: Held, last: usize, nodes: &[Node]) -> Self {
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
    fn targets<'a>(&'a self, edge: usize, sampled: &'a [Grid], between: &'a [Grid]) -> Targets<'a> {
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
struct Targets<'a> {
    window: &'a Window,
    /// Places along an edge.
    edge: usize,
    sampled: Vec<Read<'a>>,
    /// Per aim with a lobe of its own.
    lobes: Vec<Option<Read<'a>>>,
}

impl Targets<'_> {
    /// All rows.
    fn grid(&self) -> Grid {
        let mut grid = Grid::black(self.edge);
        let side = grid.side();
        let start = || (Scratch::default(), vec![[0.0; VALUES]; self.edge]);
        let rows = grid.places.par_chunks_mut(side).skip(MARGIN).take(self.edge);
        rows.enumerate().for_each_init(start, |(scratch, values), (y, row)| {
            self.row(y, scratch, values);
            zip(&mut row[MARGIN..], values)
                .for_each(|(place, value)| *place = value.map(|value| value as f32));
        });
        grid
    }

    /// Row `y`.
    fn row(&self, y: usize, scratch: &mut Scratch, out: &mut [Sums]) {
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

/// Relaxation sweeps; each reduces the error to a quarter.
const SWEEPS: usize = 12;

/// Values of a place: the channels of all six faces, face by face.
const VALUES: usize = 18;

/// Sums of values of a place.
type Sums = [f64; VALUES];

/// Adds `factor` times `values` to `sums`.
#[inline(always)]
fn add(sums: &mut Sums, factor: f64, values: &Sums) {
    for l in 0..VALUES {
        sums[l] += factor * values[l];
    }
}

/// Raises negative values to 0.
#[inline(always)]
fn at_least_black(row: &mut [Sums]) {
    for place in row {
        for value in place {
            *value = value.max(0.0);
        }
    }
}

/// The sums of each channel over the faces.
fn by_channel(sums: Sums) -> [f64; 3] {
    std::array::from_fn(|c| (0..6).map(|face| sums[3 * face + c]).sum())
}

/// The sums of rows, in their order.
fn total(rows: &[Sums]) -> [f64; 3] {
    let mut sums = [0.0; VALUES];
    rows.iter().for_each(|row| add(&mut sums, 1.0, row));
    by_channel(sums)
}

/// A power of two that brings values to at most 2, so that single precision holds what is computed of them.
#[derive(Clone, Copy)]
struct Scale(f64);

impl Scale {
    fn new<'a>(levels: impl Iterator<Item = &'a [Rgb]>) -> Self {
        let greatest = levels.flat_map(<[Rgb]>::as_flattened).fold(0.0_f32, |most, value| most.max(*value));
        Self(if greatest > 0.0 { 2.0_f64.powi(-(f64::from(greatest).log2().floor() as i32)) } else { 1.0 })
    }
}

/// Places around a face, for cubics.
const MARGIN: usize = 2;

/// The values of a cube, scaled, with all faces side by side.
#[derive(Clone)]
struct Grid {
    /// Texels along an edge.
    n: usize,
    /// Rows of a face with its margin.
    places: Vec<[f32; VALUES]>,
}

/// The first of adjacent places along an axis, margin included, and their weights.
type Taps<const W: usize> = (usize, [f64; W]);

/// Positions of `edge` centres in texels, from the middle of the place before `n` texels.
fn centres(n: usize, edge: usize) -> impl Iterator<Item = f64> {
    (0..edge).map(move |k| (k as f64 + 0.5) / edge as f64 * n as f64 + 0.5)
}

/// Cubic interpolation of `n` texels at `edge` centres.
fn cubic_taps(n: usize, edge: usize) -> Vec<Taps<4>> {
    centres(n, edge).map(|place| cubic_tap(place, (0, n))).collect()
}

/// Cubic interpolation at `place`; the second of the four places is in `within`.
fn cubic_tap(place: f64, (least, most): (usize, usize)) -> Taps<4> {
    let low = (place.max(0.0) as usize).clamp(least, most);
    (low, cubic(place - low as f64))
}

/// Linear interpolation of `n` texels at `edge` centres.
fn linear_taps(n: usize, edge: usize) -> Vec<Taps<2>> {
    let tap = |place: f64| {
        let low = (place as usize).min(n);
        (low + 1, [1.0 - (place - low as f64), place - low as f64])
    };
    centres(n, edge).map(tap).collect()
}

/// Weights at `x` of the cubic through the values at -1, 0, 1 and 2.
fn cubic(x: f64) -> [f64; 4] {
    let (a, b, c, d) = (x + 1.0, x, x - 1.0, x - 2.0);
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0]
}

/// Minimum edge of a level for cubic interpolation.
const MIN_CUBIC: usize = 4;

/// Edge to which smaller levels are upsampled.
const FINE: usize = 16;

impl Grid {
    fn black(n: usize) -> Self {
        let side = n + 2 * MARGIN;
        Self { n, places: vec![[0.0; VALUES]; side * side] }
    }

    /// The `texels` of a cube; its margin is black.
    fn new(size: u32, texels: &[Rgb], scale: Scale) -> Self {
        let mut grid = Self::black(size as usize);
        let (n, side) = (grid.n, grid.side());
        grid.places.par_chunks_mut(side).skip(MARGIN).take(n).enumerate().for_each(|(y, row)| {
            for face in 0..6 {
                for (place, texel) in zip(&mut row[MARGIN..], &texels[(face * n + y) * n..][..n]) {
                    for c in 0..3 {
                        place[3 * face + c] = (f64::from(texel[c]) * scale.0) as f32;
                    }
                }
            }
        });
        grid
    }

    /// Writes the values to `texels`.
    fn write(&self, texels: &mut [Rgb], scale: Scale) {
        let n = self.n;
        texels.par_chunks_mut(n).enumerate().for_each(|(k, row)| {
            let (face, y) = (k / n, k % n);
            for (texel, place) in zip(row, &self.row(y + MARGIN)[MARGIN..]) {
                for c in 0..3 {
                    let value = f64::from(place[3 * face + c]) / scale.0;
                    texel[c] = value.clamp(0.0, f64::from(f32::MAX)) as f32;
                }
            }
        });
    }

    fn side(&self) -> usize {
        self.n + 2 * MARGIN
    }

    fn row(&self, j: usize) -> &[[f32; VALUES]] {
        &self.places[j * self.side()..][..self.side()]
    }

    /// Prepares cubic interpolation: fills the margin. Levels of too few texels are first interpolated
    /// linearly.
    fn smooth(mut self) -> Self {
        if self.n < MIN_CUBIC {
            Seams::new(self.n).fill(&mut self);
            let taps = linear_taps(self.n, FINE);
            let (mut fine, mut blended, mut values) =
                (Self::black(FINE), Vec::new(), vec![[0.0; VALUES]; FINE]);
            let side = fine.side();
            for (tap, row) in zip(&taps, fine.places.chunks_mut(side).skip(MARGIN)) {
                read_row(&self, *tap, &taps, &mut blended, &mut values);
                zip(&mut row[MARGIN..], &values)
                    .for_each(|(place, value)| *place = value.map(|value| value as f32));
            }
            return fine.smooth();
        }
        let (n, side) = (self.n, self.side());
        let inside = MARGIN..n + MARGIN;
        // Extend the face's plane beyond its edges.
        let extended = |k: usize| {
            let centre = |k: usize| (2.0 * k as f64 - 3.0) / n as f64 - 1.0;
            let mut place = [0.0; VALUES];
            for (own, values) in Face::ALL.into_iter().zip(place.as_chunks_mut::<3>().0) {
                let point = cube_point(own, centre(k % side), centre(k / side));
                let (face, s, t) = cube_from_direction(point);
                // The neighbour's margin is not filled yet.
                let tap = |x: f64| cubic_tap((x + 1.0) / 2.0 * n as f64 + 0.5, (2, n - 2));
                *values = self.interpolated(face, tap(s), tap(t));
            }
            (k, place)
        };
        let is_outside = |k: &usize| !(inside.contains(&(k % side)) && inside.contains(&(k / side)));
        let margin: Vec<usize> = (0..side * side).filter(is_outside).collect();
        let margin: Vec<(usize, [f32; VALUES])> =
            margin.into_par_iter().with_min_len(256).map(extended).collect();
        margin.into_iter().for_each(|(k, place)| self.places[k] = place);
        self
    }

    /// Value of `face` by the weights of four columns and rows.
    fn interpolated(&self, face: Face, (left, across): Taps<4>, (top, down): Taps<4>) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for (j, down) in (top..).zip(down) {
            for (place, across) in zip(&self.row(j)[left..], across) {
                for c in 0..3 {
                    sum[c] += down * across * f64::from(place[3 * face.index() + c]);
                }
            }
        }
        sum.map(|value| value as f32)
    }
}

/// Buffers of rows.
struct Scratch {
    arch: Arch,
    blended: Vec<Sums>,
    lobe: Vec<Sums>,
    /// Per level of a window.
    own: Vec<Vec<Sums>>,
    right: Vec<Vec<Sums>>,
}

impl Default for Scratch {
    fn default() -> Self {
        let (blended, lobe, own, right) = Default::default();
        Self { arch: Arch::new(), blended, lobe, own, right }
    }
}

/// Reads a row of `grid` by the taps `down` and `across`.
#[inline(always)]
fn read_row<const W: usize>(
    grid: &Grid,
    (top, down): Taps<W>,
    across: &[Taps<W>],
    blended: &mut Vec<Sums>,
    out: &mut [Sums],
) {
    let rows: [&[[f32; VALUES]]; W] = std::array::from_fn(|k| grid.row(top + k));
    blended.resize(grid.side(), [0.0; VALUES]);
    for (i, blended) in blended.iter_mut().enumerate() {
        let mut sums = [0.0; VALUES];
        for k in 0..W {
            add(&mut sums, down[k], &rows[k][i].map(f64::from));
        }
        *blended = sums;
    }
    for (out, (left, weights)) in zip(out, across) {
        let mut sums = [0.0; VALUES];
        for (weight, values) in zip(weights, &blended[*left..*left + W]) {
            add(&mut sums, *weight, values);
        }
        *out = sums;
    }
}

/// [`read_row`] by the widest vectors.
struct Reading<'a> {
    grid: &'a Grid,
    down: Taps<4>,
    across: &'a [Taps<4>],
    blended: &'a mut Vec<Sums>,
    out: &'a mut [Sums],
}

impl pulp::NullaryFnOnce for Reading<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        read_row(self.grid, self.down, self.across, self.blended, self.out);
        at_least_black(self.out);
    }
}

/// The places beyond the edges of faces, which hold neighbours' outermost texels, and those beyond corners,
/// which hold the mean of the three around.
struct Seams {
    n: usize,
    lookup: LevelLookup,
    /// Place, and for each face that of the texel there with its face.
    edges: Vec<(usize, [(usize, usize); 6])>,
    /// Place, and the three around.
    corners: [(usize, [usize; 3]); 4],
}

impl Seams {
    fn new(n: usize) -> Self {
        let lookup = LevelLookup::new(n as u32);
        let side = n + 2 * MARGIN;
        let at = |i: usize, j: usize| (j + 1) * side + i + 1;
        let source = |texel: u32| {
            let texel = texel as usize;
            (at(texel % n + 1, texel / n % n + 1), texel / (n * n))
        };
        let edge = |(i, j): (usize, usize)| {
            let texel = |face| source(lookup.texel(face, i, j).expect("no corner"));
            (at(i, j), Face::ALL.map(texel))
        };
        let edges = (1..=n).flat_map(|k| [(k, 0), (k, n + 1), (0, k), (n + 1, k)]).map(edge).collect();
        let ends = [(0, 1), (n + 1, n)];
        let corner = |k: usize| {
            let ((i, inner_i), (j, inner_j)) = (ends[k % 2], ends[k / 2]);
            (at(i, j), [at(inner_i, inner_j), at(i, inner_j), at(inner_i, j)])
        };
        Self { n, edges, corners: std::array::from_fn(corner), lookup }
    }

    /// Fills the places around the faces of `grid`.
    fn fill(&self, grid: &mut Grid) {
        for (place, sources) in &self.edges {
            for (face, (source, other)) in sources.iter().enumerate() {
                for c in 0..3 {
                    grid.places[*place][3 * face + c] = grid.places[*source][3 * other + c];
                }
            }
        }
        for (place, around) in &self.corners {
            grid.places[*place] =
                std::array::from_fn(|l| around.iter().map(|k| grid.places[*k][l]).sum::<f32>() / 3.0);
        }
    }

    /// Adds what the places around the faces of `grid` hold to where [`Self::fill`] takes it from.
    fn fold(&self, grid: &mut Grid) {
        for (place, around) in &self.corners {
            for (l, value) in grid.places[*place].into_iter().enumerate() {
                around.iter().for_each(|k| grid.places[*k][l] += value / 3.0);
            }
        }
        for (place, sources) in &self.edges {
            for (face, (source, other)) in sources.iter().enumerate() {
                for c in 0..3 {
                    grid.places[*source][3 * other + c] += grid.places[*place][3 * face + c];
                }
            }
        }
    }

    /// Calls `visit` with the places of the eight texels around place `k` on `face`, seven at corners, and
    /// their faces.
    fn for_each_neighbour(&self, k: usize, face: usize, mut visit: impl FnMut(usize, usize)) {
        let side = self.n + 2 * MARGIN;
        let (i, j) = (k % side - 1, k / side - 1);
        let inside = 2..self.n;
        if inside.contains(&i) && inside.contains(&j) {
            for row in [k - side, k, k + side] {
                (row - 1..=row + 1).filter(|other| *other != k).for_each(|other| visit(other, face));
            }
            return;
        }
        for (i, j) in (0..9).filter(|m| *m != 4).map(|m| (i + m % 3 - 1, j + m / 3 - 1)) {
            if let Some(texel) = self.lookup.texel(Face::ALL[face], i, j) {
                let texel = texel as usize;
                visit(self.place(texel), texel / (self.n * self.n));
            }
        }
    }

    /// The place of a texel.
    fn place(&self, texel: usize) -> usize {
        (texel / self.n % self.n + MARGIN) * (self.n + 2 * MARGIN) + texel % self.n + MARGIN
    }

    /// Restores the order of `sampled` in `solved`: the brighter of two neighbours stays no darker than the
    /// other. This adds no second maximum. Neighbours nearer than [`TIE`] are ordered in part, the less the
    /// nearer they are: otherwise rounding, which differs between engines, would decide about whole steps.
    fn ordered(&self, sampled: &Grid, mut solved: Grid) -> Grid {
        self.fill(&mut solved);
        let disordered = self.disordered(sampled, &solved);
        let [raised, lowered] = [Change::Raise, Change::Lower].map(|change| {
            let mut changed = solved.clone();
            // Texels by their sampled values, the darkest first to be raised, the brightest to be lowered.
            let key = |value: f32, texel: u32| {
                let bits = if change == Change::Raise { !value.to_bits() } else { value.to_bits() };
                (u64::from(bits) << 32) | u64::from(texel)
            };
            let mut queued = vec![false; solved.places.len() * VALUES];
            let mut queue = BinaryHeap::new();
            for texel in disordered[change as usize].iter() {
                queued[*texel as usize] = true;
                queue.push(key(sampled.places.as_flattened()[*texel as usize], *texel));
            }
            while let Some(next) = queue.pop() {
                let texel = next as u32 as usize;
                let (k, face, c) = (texel / VALUES, texel % VALUES / 3, texel % 3);
                let own = sampled.places[k][texel % VALUES];
                let mut value = changed.places[k][texel % VALUES];
                self.for_each_neighbour(k, face, |other, face| {
                    let theirs = sampled.places[other][3 * face + c];
                    let (brighter, darker, sign) = match change {
                        Change::Raise => (own, theirs, 1.0),
                        Change::Lower => (theirs, own, -1.0),
                    };
                    if darker < brighter {
                        let share =
                            (f64::from(brighter - darker) / (TIE * f64::from(brighter))).min(1.0) as f32;
                        let step = (sign * (changed.places[other][3 * face + c] - value)).max(0.0);
                        value += sign * share * step;
                    }
                });
                changed.places[k][texel % VALUES] = value;
                self.for_each_neighbour(k, face, |other, face| {
                    let (at, theirs) = (other * VALUES + 3 * face + c, sampled.places[other][3 * face + c]);
                    let (follows, is_beyond) = match change {
                        Change::Raise => (theirs > own, value > changed.places[other][3 * face + c]),
                        Change::Lower => (theirs < own, value < changed.places[other][3 * face + c]),
                    };
                    if follows && is_beyond && !queued[at] {
                        queued[at] = true;
                        queue.push(key(theirs, at as u32));
                    }
                });
            }
            changed
        });
        for (k, place) in solved.places.iter_mut().enumerate() {
            for l in 0..VALUES {
                place[l] = ((f64::from(lowered.places[k][l]) + f64::from(raised.places[k][l])) / 2.0) as f32;
            }
        }
        solved
    }

    /// The values of `solved` below those of neighbours that are darker in `sampled`, and those above
    /// neighbours that are brighter; both grids are filled.
    fn disordered(&self, sampled: &Grid, solved: &Grid) -> [Vec<u32>; 2] {
        let side = sampled.side();
        let row = |j: usize| {
            let mut found = [Vec::new(), Vec::new()];
            for k in j * side + MARGIN..(j + 1) * side - MARGIN {
                let (own, value) = (&sampled.places[k], &solved.places[k]);
                let (mut low, mut high) = ([false; VALUES], [false; VALUES]);
                for row in [k - side, k, k + side] {
                    for other in row - 1..=row + 1 {
                        if self.corners.iter().any(|(corner, _)| *corner == other) {
                            continue;
                        }
                        let (others, values) = (&sampled.places[other], &solved.places[other]);
                        for l in 0..VALUES {
                            low[l] |= (others[l] < own[l]) & (values[l] > value[l]);
                            high[l] |= (others[l] > own[l]) & (values[l] < value[l]);
                        }
                    }
                }
                for (lanes, found) in zip([low, high], &mut found) {
                    found.extend((0..VALUES).filter(|l| lanes[*l]).map(|l| (k * VALUES + l) as u32));
                }
            }
            found
        };
        let rows: Vec<[Vec<u32>; 2]> = (MARGIN..side - MARGIN).into_par_iter().map(row).collect();
        [0, 1].map(|change| rows.iter().flat_map(|row| &row[change]).copied().collect())
    }
}

/// How texels are ordered.
#[derive(Clone, Copy, PartialEq)]
enum Change {
    Raise,
    Lower,
}

/// Least squares over direction for one level: normal equations of its texels.
struct Fit {
    n: usize,
    seams: Seams,
    /// Look-ups at the points along an edge: four points per texel of a face, or more for small levels.
    linear: Vec<Taps<2>>,
    /// Per place, the weights of itself, with the next place of its row, with that of its column, and of
    /// either diagonal between these.
    couplings: Vec<[f32; 4]>,
    /// Per place, the inverse of the diagonal.
    inverse: Vec<f32>,
}

/// Weight of a deviation from the sampled texels, relative to the error of a look-up.
const TETHER: f64 = 0.02;

/// The weight for levels smaller than [`MIN_CUBIC`]; in their wide bilinear squares a saddle could show as
/// a second maximum of more than 1 %.
const SMALL_TETHER: f64 = 0.2;

/// Difference of two neighbours, relative to the brighter, from which their order is kept entirely.
const TIE: f64 = 0.01;

/// Conjugate gradient steps.
const STEPS: usize = 10;

/// Rows of a task.
const BAND: usize = 16;

/// Solid angle of point (`a`, `b`) of `edge` x `edge` points of a face of `n` texels, relative to a texel at
/// its centre.
#[inline(always)]
fn solid_angle(n: usize, edge: usize, a: usize, b: usize) -> f64 {
    let (texel, scale) = (n as f64 / edge as f64, 2.0 / edge as f64);
    let (s, t) = ((a as f64 + 0.5) * scale - 1.0, (b as f64 + 0.5) * scale - 1.0);
    let squared = 1.0 + s * s + t * t;
    texel * texel / (squared * squared.sqrt())
}

/// Computes one row of targets, by its number.
type TargetRows<'a> = &'a (dyn Fn(usize, &mut Scratch, &mut [Sums]) + Sync);

impl Fit {
    fn new(size: u32) -> Self {
        let n = size as usize;
        let edge = n * (MIN_EDGE as usize).div_ceil(n).max(2);
        let (linear, side) = (linear_taps(n, edge), n + 2 * MARGIN);
        let mut sums = vec![[0.0; 4]; side * side];
        for (b, (top, down)) in linear.iter().enumerate() {
            for (a, (left, across)) in linear.iter().enumerate() {
                let weight = solid_angle(n, edge, a, b);
                for (j, down_j) in down.iter().enumerate() {
                    for (i, across_i) in across.iter().enumerate() {
                        sums[(top + j) * side + left + i][0] += weight * (down_j * across_i).powi(2);
                    }
                    sums[(top + j) * side + left][1] += weight * down_j * down_j * across[0] * across[1];
                }
                for (i, across_i) in across.iter().enumerate() {
                    sums[top * side + left + i][2] += weight * across_i * across_i * down[0] * down[1];
                }
                sums[top * side + left][3] += weight * down[0] * down[1] * across[0] * across[1];
            }
        }
        let tether = if n < MIN_CUBIC { SMALL_TETHER } else { TETHER };
        for row in sums.chunks_mut(side).skip(MARGIN).take(n) {
            row[MARGIN..][..n].iter_mut().for_each(|sums| sums[0] += tether);
        }
        let couplings: Vec<[f32; 4]> = sums.into_iter().map(|sums| sums.map(|sum| sum as f32)).collect();
        let seams = Seams::new(n);
        let mut diagonal = Grid::black(n);
        zip(&mut diagonal.places, &couplings).for_each(|(place, own)| *place = [own[0]; VALUES]);
        seams.fold(&mut diagonal);
        // The same on all faces.
        let inverse = diagonal.places.iter().map(|place| if place[0] > 0.0 { 1.0 / place[0] } else { 0.0 });
        Self { n, linear, couplings, inverse: inverse.collect(), seams }
    }

    /// What look-ups of `own`, a filled grid, lack of `targets`, on the right-hand side of the equations.
    fn residual(&self, own: &Grid, targets: TargetRows<'_>) -> Grid {
        let mut residual = Grid::black(self.n);
        let side = residual.side();
        let bands = residual.places.par_chunks_mut(BAND * side).enumerate();
        bands.for_each_init(Scratch::default, |scratch, (band, places)| {
            let mut rows = vec![[0.0; VALUES]; places.len()];
            let [mut target, mut found] = [(); 2].map(|()| vec![[0.0; VALUES]; self.linear.len()]);
            let first = band * BAND;
            for (b, (top, _)) in self.linear.iter().enumerate() {
                if (first..first + places.len() / side + 1).contains(&(top + 1)) {
                    targets(b, scratch, &mut target);
                    let Scratch { arch, blended, .. } = scratch;
                    arch.dispatch(Restriction {
                        fit: self,
                        own,
                        b,
                        target: &target,
                        found: &mut found,
                        blended,
                        first,
                        rows: &mut rows,
                    });
                }
            }
            zip(places, rows).for_each(|(place, sums)| *place = sums.map(|sum| sum as f32));
        });
        self.seams.fold(&mut residual);
        residual
    }

    /// `own` with the correction that leaves no `residual`, by conjugate gradients.
    fn corrected(&self, own: &Grid, mut residual: Grid) -> Grid {
        let (n, side) = (self.n, residual.side());
        let mut texels = own.clone();
        let [mut step, mut image] = [(); 2].map(|()| Grid::black(n));
        let arch = Arch::new();
        let mut share = [0.0; 3];
        let mut squares = [0.0; 3];
        let mut first = [f64::INFINITY; 3];
        for round in 0..=STEPS {
            // The squares of the residual, and the next step.
            let rows = residual.places.par_chunks(side).zip(self.inverse.par_chunks(side));
            let rows = rows.skip(MARGIN).take(n);
            let sums: Vec<Sums> = rows
                .map(|(residual, inverse)| {
                    let mut sums = [0.0; VALUES];
                    for (residual, inverse) in zip(residual, inverse).skip(MARGIN).take(n) {
                        for l in 0..VALUES {
                            sums[l] += f64::from(residual[l]) * f64::from(residual[l]) * f64::from(*inverse);
                        }
                    }
                    sums
                })
                .collect();
            let next = total(&sums);
            if round == 0 {
                first = next;
            } else {
                share = std::array::from_fn(|c| if squares[c] > 0.0 { next[c] / squares[c] } else { 0.0 });
            }
            squares = next;
            if round == STEPS || (0..3).all(|c| squares[c] <= 1e-12 * first[c]) {
                break;
            }
            let shares: [f32; VALUES] = std::array::from_fn(|l| share[l % 3] as f32);
            let rows = step.places.par_chunks_mut(side).zip(residual.places.par_chunks(side));
            rows.zip(self.inverse.par_chunks(side)).skip(MARGIN).take(n).for_each(
                |((step, residual), inverse)| {
                    for ((step, residual), inverse) in zip(zip(step, residual), inverse).skip(MARGIN).take(n)
                    {
                        for l in 0..VALUES {
                            step[l] = residual[l] * inverse + shares[l] * step[l];
                        }
                    }
                },
            );
            self.seams.fill(&mut step);
            let rows = image.places.par_chunks_mut(side).enumerate().skip(1).take(n + 2);
            let sums: Vec<Sums> =
                rows.map(|(j, row)| arch.dispatch(Coupling { fit: self, step: &step, j, row })).collect();
            self.seams.fold(&mut image);
            let curvature = total(&sums);
            let length = |c: usize| {
                if squares[c] > 1e-12 * first[c] && curvature[c] > 0.0 {
                    squares[c] / curvature[c]
                } else {
                    0.0
                }
            };
            let lengths: [f32; VALUES] = std::array::from_fn(|l| length(l % 3) as f32);
            let rows = texels.places.par_chunks_mut(side).zip(residual.places.par_chunks_mut(side));
            let rows = rows.zip(step.places.par_chunks(side).zip(image.places.par_chunks(side)));
            rows.skip(MARGIN).take(n).for_each(|((texels, residual), (step, image))| {
                let places = zip(zip(texels, residual), zip(step, image));
                for ((texel, residual), (step, image)) in places.skip(MARGIN).take(n) {
                    for l in 0..VALUES {
                        texel[l] += lengths[l] * step[l];
                        residual[l] -= lengths[l] * image[l];
                    }
                }
            });
        }
        texels.places.iter_mut().for_each(|place| *place = place.map(|value| value.max(0.0)));
        texels
    }
}

/// Adds what the look-ups of row `b` lack to `rows`, from row `first` on.
struct Restriction<'a> {
    fit: &'a Fit,
    own: &'a Grid,
    b: usize,
    target: &'a [Sums],
    found: &'a mut [Sums],
    blended: &'a mut Vec<Sums>,
    first: usize,
    rows: &'a mut [Sums],
}

impl pulp::NullaryFnOnce for Restriction<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { fit, own, b, target, found, blended, first, rows } = self;
        let (side, edge) = (own.side(), fit.linear.len());
        let (top, down) = fit.linear[b];
        read_row(own, (top, down), &fit.linear, blended, found);
        blended.fill([0.0; VALUES]);
        for a in 0..edge {
            let weight = solid_angle(fit.n, edge, a, b);
            let mut lack = target[a];
            add(&mut lack, -1.0, &found[a]);
            let (left, across) = fit.linear[a];
            add(&mut blended[left], weight * across[0], &lack);
            add(&mut blended[left + 1], weight * across[1], &lack);
        }
        for (j, weight) in (top..).zip(down) {
            if let Some(row) = j.checked_sub(first).and_then(|j| rows.get_mut(j * side..(j + 1) * side)) {
                zip(row, &*blended).for_each(|(sums, values)| add(sums, weight, values));
            }
        }
    }
}

/// Row `j` of the normal equations times `step`; returns its products with `step`.
struct Coupling<'a> {
    fit: &'a Fit,
    step: &'a Grid,
    j: usize,
    row: &'a mut [[f32; VALUES]],
}

impl pulp::NullaryFnOnce for Coupling<'_> {
    type Output = Sums;

    #[inline(always)]
    fn call(self) -> Sums {
        let (j, side) = (self.j, self.row.len());
        let [above, own] = [j - 1, j].map(|j| &self.fit.couplings[j * side..(j + 1) * side]);
        let [before, here, after] = [j - 1, j, j + 1].map(|j| &self.step.row(j)[..side]);
        let mut products = [0.0; VALUES];
        for i in 1..side - 1 {
            let terms = [
                (own[i][0], &here[i]),
                (own[i - 1][1], &here[i - 1]),
                (own[i][1], &here[i + 1]),
                (above[i][2], &before[i]),
                (own[i][2], &after[i]),
                (above[i - 1][3], &before[i - 1]),
                (above[i][3], &before[i + 1]),
                (own[i - 1][3], &after[i - 1]),
                (own[i][3], &after[i + 1]),
            ];
            let mut sums = [0.0_f32; VALUES];
            for (weight, values) in terms {
                for l in 0..VALUES {
                    sums[l] += weight * values[l];
                }
            }
            for l in 0..VALUES {
                products[l] += f64::from(here[i][l]) * f64::from(sums[l]);
            }
            self.row[i] = sums;
        }
        products
    }
}
