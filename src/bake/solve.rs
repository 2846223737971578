//! Solved chains: texels that make trilinear look-ups, rather than texels, as near to lobes as they can be.
//!
//! A look-up joins samples of a curved function by straight lines, so it is off to the same side everywhere
//! between them. Here the levels are the least-squares fit of what look-ups give over direction and roughness,
//! in two steps, each linear but for its bounds:
//! 1. Along roughness, for each direction on its own: the values at the levels whose joining lines are nearest
//!    the lobes at the nodes of a quadrature between the levels. They are held to a share of the sampled lobe,
//!    or a sun, which one level shows many times brighter than the next, would leave a hole in the rougher one.
//! 2. Over direction, for each level on its own: the texels whose bilinear look-ups are nearest those values,
//!    by conjugate gradients.
//!
//! The lobes between the levels are baked as levels of their own, on the coarsest cubes that resolve them.

use crate::chain::{Level, LevelSpec};
use crate::chain_lookup::{LevelLookup, Taps};
use crate::environment::{Layout, Rgb};
use crate::ladder::Ladder;
use crate::lobe::{Lobe, full_width_at_half_maximum};
use crate::sphere::cube::{Face, cube_from_direction, cube_point};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

/// A lobe between two levels that the solver needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node {
    /// The cube that it is baked on, and its roughness.
    pub(crate) spec: LevelSpec,
    /// The share of the roughnesses that it stands for.
    weight: f64,
    /// The sharper of the two levels,
    low: usize,
    /// and the share of the rougher one in a look-up.
    share: f64,
}

impl Node {
    /// Texels along an edge of its cube.
    fn edge(&self) -> u32 {
        self.spec.layout.sides().1
    }
}

/// Texels of a node's cube in the full width of its lobe at half maximum.
const TEXELS_PER_WIDTH: f64 = 3.5;

/// The least edge of a node's cube.
const LEAST_EDGE: u32 = 16;

/// Nodes and weights of Gauss's quadratures over [0, 1], by number of nodes less 2.
const QUADRATURES: [&[(f64, f64)]; 2] = [
    &[(0.211_324_865_405_187_1, 0.5), (0.788_675_134_594_812_9, 0.5)],
    &[(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)],
];

/// Whether cubics between the texels of a cube of `edge` texels show a lobe of `roughness`.
fn resolves(edge: u32, roughness: f64) -> bool {
    let width = full_width_at_half_maximum(Lobe::Ggx, roughness * roughness);
    edge >= LEAST_EDGE && width * f64::from(edge) >= TEXELS_PER_WIDTH * FRAC_PI_2
}

/// The peaks of two levels this many times apart need three nodes.
const STEEP: f64 = 8.0;

/// The nodes of a chain of cubes of `size` texels and `levels` levels on `ladder`.
pub(crate) fn nodes(size: u32, levels: u32, ladder: Ladder) -> Vec<Node> {
    let mut nodes = Vec::new();
    for low in 1..levels.saturating_sub(1) {
        let roughness = |level| ladder.roughness(level, levels, size);
        let (from, to) = (roughness(low), roughness(low + 1));
        let quadrature = QUADRATURES[usize::from((to / from).powi(4) > STEEP)];
        for (place, weight) in quadrature.iter().filter(|_| to > from) {
            let roughness = from + (to - from) * place;
            let edge = (0..32).map(|k| size >> k).take_while(|edge| resolves(*edge, roughness)).last();
            nodes.push(Node {
                spec: LevelSpec {
                    layout: Layout::Cube { size: edge.unwrap_or(size.max(LEAST_EDGE)) },
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

/// The least that a solved value is of the sampled one.
const LEAST_SHARE: f64 = 0.75;

/// Solves `levels`, a sampled chain of cubes, in place; `lobes` are the texels of each of `nodes`. Levels that no
/// look-up reads, and level 0, stay as they are. Returns the numbers of those that were solved.
pub(crate) fn solve(levels: &mut [Level], nodes: &[Node], lobes: &[&[Rgb]]) -> Range<usize> {
    let Some(last) = nodes.iter().map(|node| node.low + 1).max() else { return 0..0 };
    let of = |size: u32, texels: &[Rgb]| Smooth::new(size, &|texel| texels[texel].map(f64::from));
    let smooth = |level: &Level| of(level.size(), &level.texels);
    let sampled: Vec<Smooth> = levels[1..=last].iter().map(smooth).collect();
    let between: Vec<Smooth> =
        nodes.iter().zip(lobes).map(|(node, texels)| of(node.edge(), texels)).collect();
    for index in 1..=last {
        let window = Window::new(index, last, nodes);
        let wanted = |place| window.wanted(place, &sampled, &between);
        let level = &mut levels[index];
        let fit = if resolves(level.size(), level.roughness) {
            // Cubics between the texels' centres.
            let n = level.size() as usize;
            let centre = |k: usize| (2 * k + 1) as f64 / n as f64 - 1.0;
            let place = |k: usize| (Face::ALL[k / (n * n)], centre(k % n), centre(k / n % n));
            let centres: Vec<[f64; 3]> =
                (0..6 * n * n).into_par_iter().with_min_len(256).map(|k| wanted(place(k))).collect();
            let smooth = Smooth::new(level.size(), &|texel| centres[texel]);
            Fit::new(level.size(), &|place| smooth.read(place))
        } else {
            Fit::new(level.size(), &wanted)
        };
        level.texels = fit.ordered(fit.texels(&level.texels), &level.texels);
    }
    1..last + 1
}

/// Bytes that solving a chain of cubes of `size` texels takes besides the levels.
pub(crate) fn solve_bytes(size: u32, nodes: &[Node]) -> u64 {
    let texels = |edge: u32| 6 * u64::from(edge) * u64::from(edge);
    let between: u64 = nodes.iter().map(|node| texels(node.edge() + 4)).sum();
    // A texel of the first level is solved by nine partners, and six vectors of three; cubics read three levels
    // of numbers in double precision.
    texels(size / 2 + 4) * (9 * 16 + 6 * 24 + 4 * 24) + between * 24
}

/// How many levels on either side take part in solving one.
const REACH: usize = 2;

/// The most levels of a window,
const MOST_LEVELS: usize = 2 * REACH + 1;

/// and its most aims: three between each two levels, and the first level.
const MOST_AIMS: usize = 3 * (MOST_LEVELS - 1) + 1;

/// Where a value along a direction comes from.
#[derive(Clone, Copy)]
enum Origin {
    /// A node's lobe.
    Node(usize),
    /// A sampled level.
    Level(usize),
}

/// A value that look-ups should give.
struct Aim {
    origin: Origin,
    weight: f64,
    /// The sharper of the two levels of the look-up, from the first of the window,
    low: usize,
    /// and the share of the rougher one.
    share: f64,
}

/// The levels around one, and what look-ups between them should give: the least squares along roughness.
struct Window {
    /// The first of its levels.
    first: usize,
    /// The number of the level that is solved among them.
    own: usize,
    aims: Vec<Aim>,
    /// The normal equations: the diagonal, and what is beside it.
    diagonal: Vec<f64>,
    beside: Vec<f64>,
    /// The solution for each level: the shares of the aims.
    shares: Vec<Vec<f64>>,
}

impl Window {
    fn new(index: usize, last: usize, nodes: &[Node]) -> Self {
        let (first, end) = (index.saturating_sub(REACH).max(1), (index + REACH).min(last));
        let within = nodes.iter().enumerate().filter(|(_, node)| node.low >= first && node.low < end);
        let mut aims: Vec<Aim> = within
            .map(|(k, node)| Aim {
                origin: Origin::Node(k),
                weight: node.weight,
                low: node.low - first,
                share: node.share,
            })
            .collect();
        let step: f64 = nodes.iter().filter(|node| node.low == 1).map(|node| node.weight).sum();
        if first == 1 {
            aims.push(Aim { origin: Origin::Level(1), weight: HELD_FIRST * step, low: 0, share: 0.0 });
        }
        let count = end - first + 1;
        let (mut diagonal, mut beside) = (vec![0.0; count], vec![0.0; count]);
        for aim in &aims {
            let low = aim.low;
            diagonal[low] += aim.weight * (1.0 - aim.share).powi(2);
            if aim.share > 0.0 {
                diagonal[low + 1] += aim.weight * aim.share.powi(2);
                beside[low] += aim.weight * aim.share * (1.0 - aim.share);
            }
        }
        let mut window = Self { first, own: index - first, aims, diagonal, beside, shares: Vec::new() };
        let columns: Vec<Vec<f64>> = window.aims.iter().map(|aim| window.exact(aim)).collect();
        window.shares =
            (0..count).map(|level| columns.iter().map(|column| column[level]).collect()).collect();
        window
    }

    /// What a light of 1 at `aim` alone makes of each level, by elimination.
    fn exact(&self, aim: &Aim) -> Vec<f64> {
        let count = self.diagonal.len();
        let mut right = vec![0.0; count];
        right[aim.low] = aim.weight * (1.0 - aim.share);
        if aim.share > 0.0 {
            right[aim.low + 1] = aim.weight * aim.share;
        }
        let mut pivot = self.diagonal.clone();
        for k in 1..count {
            let factor = self.beside[k - 1] / pivot[k - 1];
            pivot[k] -= factor * self.beside[k - 1];
            right[k] -= factor * right[k - 1];
        }
        for k in (0..count).rev() {
            let above = if k + 1 < count { self.beside[k] * right[k + 1] } else { 0.0 };
            right[k] = (right[k] - above) / pivot[k];
        }
        right
    }

    /// The value of the level that is solved, at `place`.
    fn wanted(&self, place: Place, sampled: &[Smooth], between: &[Smooth]) -> [f64; 3] {
        let count = self.diagonal.len();
        let mut own = [[0.0; 3]; MOST_LEVELS];
        for (k, own) in own.iter_mut().enumerate().take(count) {
            *own = sampled[self.first - 1 + k].read(place);
        }
        let mut lobes = [[0.0; 3]; MOST_AIMS];
        for (lobe, aim) in lobes.iter_mut().zip(&self.aims) {
            *lobe = match aim.origin {
                Origin::Node(node) => between[node].read(place),
                Origin::Level(level) => own[level - self.first],
            };
        }
        let mut levels = [[0.0; 3]; MOST_LEVELS];
        for (level, shares) in levels.iter_mut().zip(&self.shares) {
            for (share, lobe) in shares.iter().zip(&lobes) {
                for (sum, value) in level.iter_mut().zip(lobe) {
                    *sum += share * value;
                }
            }
        }
        let least = own.map(|value| value.map(|value| LEAST_SHARE * value));
        for c in 0..3 {
            if (0..count).any(|k| levels[k][c] < least[k][c]) {
                self.bounded(c, &lobes, &mut levels, &least);
            }
        }
        levels[self.own]
    }

    /// Channel `c` of `levels` where they must be at least `least`, by relaxation.
    fn bounded(&self, c: usize, lobes: &[[f64; 3]], levels: &mut [[f64; 3]], least: &[[f64; 3]]) {
        let count = self.diagonal.len();
        let mut right = [0.0; MOST_LEVELS + 1];
        for (aim, lobe) in self.aims.iter().zip(lobes) {
            right[aim.low] += aim.weight * (1.0 - aim.share) * lobe[c];
            right[aim.low + 1] += aim.weight * aim.share * lobe[c];
        }
        for _ in 0..SWEEPS {
            for k in 0..count {
                let mut rest = right[k];
                if k > 0 {
                    rest -= self.beside[k - 1] * levels[k - 1][c];
                }
                if k + 1 < count {
                    rest -= self.beside[k] * levels[k + 1][c];
                }
                levels[k][c] = (rest / self.diagonal[k]).max(least[k][c]);
            }
        }
    }
}

/// How much the first level, below which there is only the mirror, is held to the sampled one, to the step from
/// it to the next.
const HELD_FIRST: f64 = 0.08;

/// Sweeps of the relaxation: each leaves a quarter of the error.
const SWEEPS: usize = 12;

/// A face, and s and t on it.
type Place = (Face, f64, f64);

/// A level's texels, interpolated by cubics, across the edges of faces as well.
struct Smooth {
    size: usize,
    /// For each face a square with two more places on every side.
    places: Vec<[f64; 3]>,
}

/// Weights of the four values at -1, 0, 1 and 2 for the cubic through them at `x`.
fn cubic(x: f64) -> [f64; 4] {
    let (a, b, c, d) = (x + 1.0, x, x - 1.0, x - 2.0);
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0]
}

/// The least edge of a level that cubics fit into,
const LEAST_CUBIC: u32 = 4;

/// and the edge that smaller ones are brought to.
const FINE: usize = 16;

impl Smooth {
    /// The cubics between the texels of a cube of `size` texels, whose values `texel` gives.
    fn new(size: u32, texel: &dyn Fn(usize) -> [f64; 3]) -> Self {
        if size < LEAST_CUBIC {
            // Fewer texels than a cubic takes: straight lines.
            let lookup = LevelLookup::new(size);
            let centre = |k: usize| (2 * k + 1) as f64 / FINE as f64 - 1.0;
            return Self::new(FINE as u32, &|k| {
                let face = Face::ALL[k / (FINE * FINE)];
                let taps = lookup.taps_at((face, centre(k % FINE), centre(k / FINE % FINE)));
                let mut sum = [0.0; 3];
                for (place, weight) in taps.texels.into_iter().zip(taps.weights).take(taps.count) {
                    for (sum, value) in sum.iter_mut().zip(texel(place as usize)) {
                        *sum += weight * value;
                    }
                }
                sum
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
        // Outside of a face its plane goes on over its neighbours.
        for place in 0..smooth.places.len() {
            let (face, row, column, inside) = own(place);
            if !inside {
                let centre = |k: usize| (2.0 * k as f64 - 3.0) / n as f64 - 1.0;
                let point = cube_point(Face::ALL[face], centre(column), centre(row));
                let (face, s, t) = cube_from_direction(point);
                // Cubics within the neighbour, whose own border is not known yet.
                let within = (3, n - 1);
                smooth.places[place] = smooth.interpolated(face, s, t, within);
            }
        }
        smooth
    }

    /// The value at a place of the cube.
    fn read(&self, (face, s, t): Place) -> [f64; 3] {
        self.interpolated(face, s, t, (1, self.size + 1)).map(|value| value.max(0.0))
    }

    /// The cubic through the four lines and columns around (`s`, `t`), the second of which is in `within`.
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

/// The least squares over direction for one level: the normal equations of its texels.
struct Fit {
    /// For each texel those that share look-ups with it, itself included, with the weight that they have.
    partners: Vec<[(u32, f64); MOST_PARTNERS]>,
    /// What the texels' look-ups should sum to.
    right: Vec<[f64; 3]>,
    /// What a deviation from the sampled texels costs.
    tether: f64,
}

/// Texels around one, and itself; at edges of the cube there are no more.
const MOST_PARTNERS: usize = 9;

/// What a deviation from the sampled texels costs, to the error of a look-up.
const TETHER: f64 = 0.02;

/// The same for levels of fewer texels than [`LEAST_CUBIC`]: their bilinear squares are wide enough for a saddle to
/// show as a second maximum of more than 1 %.
const SMALL_TETHER: f64 = 0.2;

/// Steps of the conjugate gradients.
const STEPS: usize = 12;

/// Points that are read at once.
const BLOCK: u32 = 1 << 14;

impl Fit {
    /// The equations of a level of `size` texels whose look-ups should give `wanted`, at four points a texel;
    /// at more for small levels.
    fn new(size: u32, wanted: &(dyn Fn(Place) -> [f64; 3] + Sync)) -> Self {
        let edge = size * LEAST_EDGE.div_ceil(size).max(2);
        let lookup = LevelLookup::new(size);
        let (texel, scale) = (f64::from(size) / f64::from(edge), 2.0 / f64::from(edge));
        let point = |k: u32| {
            let centre = |k: u32| (f64::from(k) + 0.5) * scale - 1.0;
            let place = (Face::ALL[(k / (edge * edge)) as usize], centre(k % edge), centre(k / edge % edge));
            let squared = 1.0 + place.1 * place.1 + place.2 * place.2;
            // The solid angle of a point, to that of a texel at a face's centre.
            let weight = texel * texel / (squared * squared.sqrt());
            (lookup.taps_at(place), wanted(place), weight)
        };
        let texels = 6 * size as usize * size as usize;
        let mut fit = Self {
            partners: vec![[(u32::MAX, 0.0); MOST_PARTNERS]; texels],
            right: vec![[0.0; 3]; texels],
            tether: if size < LEAST_CUBIC { SMALL_TETHER } else { TETHER },
        };
        let count = 6 * edge * edge;
        for first in (0..count).step_by(BLOCK as usize) {
            let points: Vec<_> =
                (first..count.min(first + BLOCK)).into_par_iter().with_min_len(256).map(point).collect();
            for (taps, wanted, weight) in &points {
                fit.add(taps, wanted, *weight);
            }
        }
        fit
    }

    fn add(&mut self, taps: &Taps, wanted: &[f64; 3], weight: f64) {
        let used = || taps.texels.into_iter().zip(taps.weights).take(taps.count);
        for (texel, share) in used() {
            let share = weight * share;
            for (sum, value) in self.right[texel as usize].iter_mut().zip(wanted) {
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

    /// The texels whose look-ups are nearest what they should give, from those `sampled`.
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

    /// `texels` in the order of those `sampled`: of two neighbours the brighter one stays no darker than the
    /// other. So there is no second maximum where there was none.
    fn ordered(&self, mut texels: Vec<Rgb>, sampled: &[Rgb]) -> Vec<Rgb> {
        let mut order: Vec<u32> = (0..sampled.len() as u32).collect();
        for c in 0..3 {
            let of = |texel: u32| sampled[texel as usize][c];
            order.sort_unstable_by(|a, b| of(*a).total_cmp(&of(*b)).then(a.cmp(b)));
            let mut raised: Vec<f32> = texels.iter().map(|texel| texel[c]).collect();
            let mut lowered = raised.clone();
            for texel in &order {
                for other in self.partners_of(*texel).filter(|other| of(*other) < of(*texel)) {
                    raised[*texel as usize] = raised[*texel as usize].max(raised[other as usize]);
                }
            }
            for texel in order.iter().rev() {
                for other in self.partners_of(*texel).filter(|other| of(*other) > of(*texel)) {
                    lowered[*texel as usize] = lowered[*texel as usize].min(lowered[other as usize]);
                }
            }
            for ((texel, raised), lowered) in texels.iter_mut().zip(raised).zip(lowered) {
                texel[c] = ((f64::from(lowered) + f64::from(raised)) / 2.0) as f32;
            }
        }
        texels
    }

    /// The texels that share look-ups with `texel`, itself included.
    fn partners_of(&self, texel: u32) -> impl Iterator<Item = u32> {
        self.partners[texel as usize].iter().map(|(other, _)| *other).take_while(|other| *other != u32::MAX)
    }

    /// The normal equations of `texels`: the weighted look-ups, gathered.
    fn applied(&self, texels: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let row = |partners: &[(u32, f64); MOST_PARTNERS]| {
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
