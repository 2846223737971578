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
//! Lobes between the levels are baked as separate levels, on the coarsest cubes that resolve them. A mixed
//! chain keeps its sharp levels as sampled; its rougher ones are solved with the last of them fixed.

use crate::chain::{ChainKind, Level, LevelSpec};
use crate::chain_lookup::{LevelLookup, Taps};
use crate::environment::{Layout, Rgb};
use crate::ladder::Ladder;
use crate::lobe::{Lobe, full_width_at_half_maximum};
use crate::sphere::cube::{Face, cube_from_direction, cube_point};
use crate::sphere::quadrature::{THREE_NODES, TWO_NODES};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;
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
    let of = |size: u32, texels: &[Rgb]| Smooth::new(size, &|texel| texels[texel].map(f64::from));
    let smooth = |level: &Level| of(level.size(), &level.texels);
    let sampled: Vec<Smooth> = levels[held.level..=last].iter().map(smooth).collect();
    let between: Vec<Smooth> =
        nodes.iter().zip(lobes).map(|(node, texels)| of(node.edge(), texels)).collect();
    for index in held.first_solved..=last {
        let window = Window::new(index, held, last, nodes);
        let target = |place| window.target(place, &sampled[window.first - held.level..], &between);
        let level = &mut levels[index];
        let fit = if resolves(level.size(), level.roughness) {
            // Cubic interpolation between texel centres.
            let n = level.size() as usize;
            let centre = |k: usize| (2 * k + 1) as f64 / n as f64 - 1.0;
            let place = |k: usize| (Face::ALL[k / (n * n)], centre(k % n), centre(k / n % n));
            let centres: Vec<[f64; 3]> =
                (0..6 * n * n).into_par_iter().with_min_len(256).map(|k| target(place(k))).collect();
            let smooth = Smooth::new(level.size(), &|texel| centres[texel]);
            Fit::new(level.size(), &|place| smooth.read(place))
        } else {
            Fit::new(level.size(), &target)
        };
        level.texels = fit.ordered(fit.texels(&level.texels), &level.texels);
    }
    held.first_solved..last + 1
}

/// Memory in bytes to solve a chain of cubes of `size` texels, excluding the levels.
pub(crate) fn solve_bytes(size: u32, nodes: &[Node]) -> u64 {
    let texels = |edge: u32| 6 * u64::from(edge) * u64::from(edge);
    let between: u64 = nodes.iter().map(|node| texels(node.edge() + 4)).sum();
    let first = nodes.iter().map(|node| node.low).min().unwrap_or(0);
    // Per texel of the first level: nine partners and six vectors of three. Cubics read three levels in
    // double precision.
    texels((size >> first) + 4) * (9 * 16 + 6 * 24 + 4 * 24) + between * 24
}

/// Number of levels on either side of the solved one.
const REACH: usize = 2;

/// Maximum levels of a window.
const MAX_LEVELS: usize = 2 * REACH + 1;

/// Maximum aims of a window: three between each two levels, and the first level.
const MAX_AIMS: usize = 3 * (MAX_LEVELS - 1) + 1;

/// Source of a value along a direction.
#[derive(Clone, Copy)]
enum Origin {
    /// The lobe of a node.
    Node(usize),
    /// A sampled level.
    Level(usize),
}

/// A target value of look-ups.
struct Aim {
    origin: Origin,
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
    /// Solution per level: weights of the aims.
    shares: Vec<Vec<f64>>,
}

impl Window {
    fn new(index: usize, held: Held, last: usize, nodes: &[Node]) -> Self {
        let (first, end) = (index.saturating_sub(REACH).max(held.level), (index + REACH).min(last));
        let within = nodes.iter().enumerate().filter(|(_, node)| node.low >= first && node.low < end);
        let mut aims: Vec<Aim> = within
            .map(|(k, node)| Aim {
                origin: Origin::Node(k),
                weight: node.weight,
                low: node.low - first,
                share: node.share,
            })
            .collect();
        if first == held.level {
            aims.push(Aim { origin: Origin::Level(first), weight: held.weight, low: 0, share: 0.0 });
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
        let mut window = Self { first, own, least, aims, diagonal, off_diagonal, shares: Vec::new() };
        let columns: Vec<Vec<f64>> = window.aims.iter().map(|aim| window.exact(aim)).collect();
        window.shares =
            (0..count).map(|level| columns.iter().map(|column| column[level]).collect()).collect();
        window
    }

    /// Response of each level to a unit value at `aim`, by elimination.
    fn exact(&self, aim: &Aim) -> Vec<f64> {
        let count = self.diagonal.len();
        let mut right = vec![0.0; count];
        right[aim.low] = aim.weight * (1.0 - aim.share);
        if aim.share > 0.0 {
            right[aim.low + 1] = aim.weight * aim.share;
        }
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

    /// Value of the solved level at `place`, from the window's `sampled` levels.
    fn target(&self, place: FacePoint, sampled: &[Smooth], between: &[Smooth]) -> [f64; 3] {
        let count = self.diagonal.len();
        let mut own = [[0.0; 3]; MAX_LEVELS];
        for (k, own) in own.iter_mut().enumerate().take(count) {
            *own = sampled[k].read(place);
        }
        let mut lobes = [[0.0; 3]; MAX_AIMS];
        for (lobe, aim) in lobes.iter_mut().zip(&self.aims) {
            *lobe = match aim.origin {
                Origin::Node(node) => between[node].read(place),
                Origin::Level(level) => own[level - self.first],
            };
        }
        let mut levels = [[0.0; 3]; MAX_LEVELS];
        for (level, shares) in levels.iter_mut().zip(&self.shares) {
            for (share, lobe) in shares.iter().zip(&lobes) {
                for (sum, value) in level.iter_mut().zip(lobe) {
                    *sum += share * value;
                }
            }
        }
        let least: [[f64; 3]; MAX_LEVELS] =
            std::array::from_fn(|k| own[k].map(|value| self.least[k] * value));
        for c in 0..3 {
            if (0..count).any(|k| levels[k][c] < least[k][c]) {
                self.bounded(c, &lobes, &mut levels, &least);
            }
        }
        levels[self.own]
    }

    /// Solves channel `c` of `levels` with the lower bounds `least`, by relaxation.
    fn bounded(&self, c: usize, lobes: &[[f64; 3]], levels: &mut [[f64; 3]], least: &[[f64; 3]]) {
        let count = self.diagonal.len();
        let mut right = [0.0; MAX_LEVELS + 1];
        for (aim, lobe) in self.aims.iter().zip(lobes) {
            right[aim.low] += aim.weight * (1.0 - aim.share) * lobe[c];
            right[aim.low + 1] += aim.weight * aim.share * lobe[c];
        }
        for _ in 0..SWEEPS {
            for k in 0..count {
                let mut rest = right[k];
                if k > 0 {
                    rest -= self.off_diagonal[k - 1] * levels[k - 1][c];
                }
                if k + 1 < count {
                    rest -= self.off_diagonal[k] * levels[k + 1][c];
                }
                levels[k][c] = (rest / self.diagonal[k]).max(least[k][c]);
            }
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

/// A face with s and t.
type FacePoint = (Face, f64, f64);

/// Cubic interpolation of a level's texels, continued across face edges.
struct Smooth {
    size: usize,
    /// Per face, a square with a border of two.
    places: Vec<[f64; 3]>,
}

/// Weights at `x` of the cubic through the values at -1, 0, 1 and 2.
fn cubic(x: f64) -> [f64; 4] {
    let (a, b, c, d) = (x + 1.0, x, x - 1.0, x - 2.0);
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0]
}

/// Minimum edge of a level for cubic interpolation.
const MIN_CUBIC: u32 = 4;

/// Edge to which smaller levels are upsampled.
const FINE: usize = 16;

impl Smooth {
    /// Prepares cubic interpolation of a cube of `size` texels with the values `texel`.
    fn new(size: u32, texel: &dyn Fn(usize) -> [f64; 3]) -> Self {
        if size < MIN_CUBIC {
            // Too few texels for a cubic: interpolate linearly.
            let lookup = LevelLookup::new(size);
            let centre = |k: usize| (2 * k + 1) as f64 / FINE as f64 - 1.0;
            return Self::new(FINE as u32, &|k| {
                let face = Face::ALL[k / (FINE * FINE)];
                lookup.taps_at((face, centre(k % FINE), centre(k / FINE % FINE))).mean(texel)
            });
        }
        let (n, side) = (size as usize, size as usize + 4);
        let mut smooth = Self { size: n, places: vec![[0.0; 3]; 6 * side * side] };
        let own = |place: usize| {
            let (face, row, column) = (place / (side * side), place / side % side, place % side);
            let inside = (2..n + 2).contains(&row) && (2..n + 2).contains(&column);
            (face, row, column, inside)
        };
        for place in 0..smooth.places.len() {
            let (face, row, column, inside) = own(place);
            if inside {
                smooth.places[place] = texel((face * n + row - 2) * n + column - 2);
            }
        }
        // Extend the face's plane beyond its edges.
        for place in 0..smooth.places.len() {
            let (face, row, column, inside) = own(place);
            if !inside {
                let centre = |k: usize| (2.0 * k as f64 - 3.0) / n as f64 - 1.0;
                let point = cube_point(Face::ALL[face], centre(column), centre(row));
                let (face, s, t) = cube_from_direction(point);
                // Interpolate within the neighbour; its border is not filled yet.
                let within = (3, n - 1);
                smooth.places[place] = smooth.interpolated(face, s, t, within);
            }
        }
        smooth
    }

    /// Value at a position on the cube.
    fn read(&self, (face, s, t): FacePoint) -> [f64; 3] {
        self.interpolated(face, s, t, (1, self.size + 1)).map(|value| value.max(0.0))
    }

    /// Bicubic value from the four rows and columns around (`s`, `t`); the second of them is in `within`.
    fn interpolated(&self, face: Face, s: f64, t: f64, (least, most): (usize, usize)) -> [f64; 3] {
        let side = self.size + 4;
        let split = |x: f64| {
            let place = (x + 1.0) / 2.0 * self.size as f64 + 1.5;
            let low = (place as usize).clamp(least, most);
            (low - 1, cubic(place - low as f64))
        };
        let ((i, across), (j, down)) = (split(s), split(t));
        let mut sum = [0.0; 3];
        for (row, down) in down.iter().enumerate() {
            let start = (face.index() * side + j + row) * side + i;
            for (value, across) in self.places[start..start + 4].iter().zip(across) {
                for (sum, value) in sum.iter_mut().zip(value) {
                    *sum += down * across * value;
                }
            }
        }
        sum
    }
}

/// Least squares over direction for one level: normal equations of its texels.
struct Fit {
    /// Per texel, the texels that share look-ups with it, including itself, and their weights.
    partners: Vec<[(u32, f64); MAX_PARTNERS]>,
    /// Right-hand side.
    right: Vec<[f64; 3]>,
    /// Weight of a deviation from the sampled texels.
    tether: f64,
}

/// Maximum neighbours of a texel, including itself; also valid at cube edges.
const MAX_PARTNERS: usize = 9;

/// Weight of a deviation from the sampled texels, relative to the error of a look-up.
const TETHER: f64 = 0.02;

/// The weight for levels smaller than [`MIN_CUBIC`]; in their wide bilinear squares a saddle could show as
/// a second maximum of more than 1 %.
const SMALL_TETHER: f64 = 0.2;

/// Difference of two neighbours, relative to the brighter, from which their order is kept entirely.
const TIE: f64 = 0.01;

/// Conjugate gradient steps.
const STEPS: usize = 12;

/// Points per batch.
const BLOCK: u32 = 1 << 14;

impl Fit {
    /// Equations of a level of `size` texels for the look-up values `target`, at four points per texel, or
    /// more for small levels.
    fn new(size: u32, target: &(dyn Fn(FacePoint) -> [f64; 3] + Sync)) -> Self {
        let edge = size * MIN_EDGE.div_ceil(size).max(2);
        let lookup = LevelLookup::new(size);
        let (texel, scale) = (f64::from(size) / f64::from(edge), 2.0 / f64::from(edge));
        let point = |k: u32| {
            let centre = |k: u32| (f64::from(k) + 0.5) * scale - 1.0;
            let place = (Face::ALL[(k / (edge * edge)) as usize], centre(k % edge), centre(k / edge % edge));
            let squared = 1.0 + place.1 * place.1 + place.2 * place.2;
            // Solid angle of a point, relative to a texel at a face's centre.
            let weight = texel * texel / (squared * squared.sqrt());
            (lookup.taps_at(place), target(place), weight)
        };
        let texels = 6 * size as usize * size as usize;
        let mut fit = Self {
            partners: vec![[(u32::MAX, 0.0); MAX_PARTNERS]; texels],
            right: vec![[0.0; 3]; texels],
            tether: if size < MIN_CUBIC { SMALL_TETHER } else { TETHER },
        };
        let count = 6 * edge * edge;
        for first in (0..count).step_by(BLOCK as usize) {
            let points: Vec<_> =
                (first..count.min(first + BLOCK)).into_par_iter().with_min_len(256).map(point).collect();
            for (taps, target, weight) in &points {
                fit.add(taps, target, *weight);
            }
        }
        fit
    }

    fn add(&mut self, taps: &Taps, target: &[f64; 3], weight: f64) {
        let used = || taps.texels.into_iter().zip(taps.weights).take(taps.count);
        for (texel, share) in used() {
            let share = weight * share;
            for (sum, value) in self.right[texel as usize].iter_mut().zip(target) {
                *sum += share * value;
            }
            let own = &mut self.partners[texel as usize];
            for (other, other_share) in used() {
                let place = own.iter_mut().find(|(known, _)| *known == other || *known == u32::MAX);
                let place = place.expect("at most nine texels share look-ups");
                *place = (other, place.1 + share * other_share);
            }
        }
    }

    /// Solves for the texels, starting from `sampled`.
    fn texels(&self, sampled: &[Rgb]) -> Vec<Rgb> {
        let mut texels: Vec<[f64; 3]> = sampled.iter().map(|texel| texel.map(f64::from)).collect();
        let mut residual = self.right.clone();
        for (residual, image) in residual.iter_mut().zip(self.applied(&texels)) {
            *residual = std::array::from_fn(|c| residual[c] - image[c]);
        }
        let mut step = residual.clone();
        let mut squares = dot(&residual, &residual);
        let first = squares;
        for _ in 0..STEPS {
            let mut image = self.applied(&step);
            for (image, step) in image.iter_mut().zip(&step) {
                *image = std::array::from_fn(|c| image[c] + self.tether * step[c]);
            }
            let curvature = dot(&step, &image);
            let length: [f64; 3] = std::array::from_fn(|c| {
                if squares[c] > 1e-12 * first[c] && curvature[c] > 0.0 {
                    squares[c] / curvature[c]
                } else {
                    0.0
                }
            });
            for (k, texel) in texels.iter_mut().enumerate() {
                for c in 0..3 {
                    texel[c] += length[c] * step[k][c];
                    residual[k][c] -= length[c] * image[k][c];
                }
            }
            let next = dot(&residual, &residual);
            let share: [f64; 3] =
                std::array::from_fn(|c| if squares[c] > 0.0 { next[c] / squares[c] } else { 0.0 });
            squares = next;
            for (step, residual) in step.iter_mut().zip(&residual) {
                *step = std::array::from_fn(|c| residual[c] + share[c] * step[c]);
            }
        }
        texels
            .into_iter()
            .map(|texel| texel.map(|value| value.clamp(0.0, f64::from(f32::MAX)) as f32))
            .collect()
    }

    /// Restores the order of `sampled` in `texels`: the brighter of two neighbours stays no darker than the
    /// other. This adds no second maximum. Neighbours nearer than [`TIE`] are ordered in part, the less the
    /// nearer they are: otherwise rounding, which differs between engines, would decide about whole steps.
    fn ordered(&self, mut texels: Vec<Rgb>, sampled: &[Rgb]) -> Vec<Rgb> {
        let mut order: Vec<u32> = (0..sampled.len() as u32).collect();
        for c in 0..3 {
            let of = |texel: u32| sampled[texel as usize][c];
            let share = |brighter: u32, darker: u32| {
                (f64::from(of(brighter) - of(darker)) / (TIE * f64::from(of(brighter)))).min(1.0) as f32
            };
            order.sort_unstable_by(|a, b| of(*a).total_cmp(&of(*b)).then(a.cmp(b)));
            let mut raised: Vec<f32> = texels.iter().map(|texel| texel[c]).collect();
            let mut lowered = raised.clone();
            for texel in &order {
                for other in self.partners_of(*texel).filter(|other| of(*other) < of(*texel)) {
                    let step = (raised[other as usize] - raised[*texel as usize]).max(0.0);
                    raised[*texel as usize] += share(*texel, other) * step;
                }
            }
            for texel in order.iter().rev() {
                for other in self.partners_of(*texel).filter(|other| of(*other) > of(*texel)) {
                    let step = (lowered[*texel as usize] - lowered[other as usize]).max(0.0);
                    lowered[*texel as usize] -= share(other, *texel) * step;
                }
            }
            for ((texel, raised), lowered) in texels.iter_mut().zip(raised).zip(lowered) {
                texel[c] = ((f64::from(lowered) + f64::from(raised)) / 2.0) as f32;
            }
        }
        texels
    }

    /// Texels that share look-ups with `texel`, including itself.
    fn partners_of(&self, texel: u32) -> impl Iterator<Item = u32> {
        self.partners[texel as usize].iter().map(|(other, _)| *other).take_while(|other| *other != u32::MAX)
    }

    /// Multiplies `texels` by the normal equations.
    fn applied(&self, texels: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let row = |partners: &[(u32, f64); MAX_PARTNERS]| {
            let mut sum = [0.0; 3];
            for (texel, weight) in partners.iter().take_while(|(texel, _)| *texel != u32::MAX) {
                for (sum, value) in sum.iter_mut().zip(texels[*texel as usize]) {
                    *sum += weight * value;
                }
            }
            sum
        };
        self.partners.par_iter().with_min_len(1024).map(row).collect()
    }
}

fn dot(a: &[[f64; 3]], b: &[[f64; 3]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (a, b) in a.iter().zip(b) {
        for c in 0..3 {
            sum[c] += a[c] * b[c];
        }
    }
    sum
}
