//! Fits the parameters of `realtime::tables` to the GGX lobe alone; no environment is involved.
//!
//! **Objective.** The difference between the kernel of the soft boxes and GGX, averaged over cells of several
//! sizes around the lobe's centre. A level has 24 x 24 cells. The cells of the finest level are a fifth of
//! alpha wide; each further level doubles the width, until the cells cover the sphere. The squared means are
//! weighted by solid angle, and each level counts twice as much as the one before, because natural light has
//! little fine detail: plain squares at one resolution give 1.6 to 1.9 times the error. One hundred times the
//! fourth power of the difference over the lobe's peak is added; it improves the highlights of suns. Soft
//! boxes are products of functions of u and of v, so their means over cells are exact and cheap.
//!
//! Far from its centre a lobe is small compared with its peak, but most pixels see a sun only through that
//! tail. Therefore the mean square of the error relative to the lobe (or to a constant lobe where that is
//! larger) has a weight of thirty. Without this term the harmonics of sharp lobes vary from node to node,
//! which appears as specks under a sun. A weight of three, as for one and two boxes, leaves ghosts of the sun
//! on dark ground.
//!
//! **Samples.** A node's parameters contribute to all lobes around it. A node is therefore fitted to at most
//! fifteen lobes: its own, those at the centres of the six cells and six edges around it, and those half-way
//! to the next knots of roughness; the other nodes keep their parameters. Interpolation then adds at most a
//! tenth to the error; nodes fitted separately interpolate to three times the error and more. Cone points
//! have only one cell and two edges, and their boxes differ from those of adjacent nodes, so the cell at a
//! cone point has more samples. They have a table of their own besides .
//! Nodes on the triangle's sides are tied: there mirrors exchange boxes or keep them, so that the kernel is
//! the same from both sides of a fold.
//!
//! **Result.** Relative RMS errors of luminance on eight panoramas that the fit never used, median / worst,
//! by number of boxes:
//!
//! | roughness | 1 | 2 | 4 | 8 |
//! |---|---|---|---|---|
//! | 0.2 | 0.107 / 0.47 | 0.059 / 0.23 | 0.030 / 0.11 | 0.022 / 0.07 |
//! | 0.3 | 0.106 / 0.27 | 0.048 / 0.14 | 0.016 / 0.08 | 0.008 / 0.04 |
//! | 0.5 | 0.042 / 0.06 | 0.021 / 0.03 | 0.011 / 0.02 | 0.007 / 0.01 |
//!
//! The kernel may be negative: few boxes leave a large share to the harmonics, which ring opposite bright
//! light that is too large for emitters. Without emitters, the errors at roughness 0.3 are 0.031 / 0.22 for
//! four boxes and 0.016 / 0.06 for eight.
//!
//! **Method.** Levenberg-Marquardt. One node of one layer is fitted from 24 starts, its layer from there ring
//! by ring, and every other layer from its neighbour. Then all nodes are refitted in `SWEEPS` sweeps, in
//! six colours such that no two nodes of one colour share a lobe. The order within a node is fixed, so the
//! bytes do not depend on the number of threads.
//!
//! ```console
//! for k in 1 2 4 8 cone; do cargo run --release --example fit_lobes $k; done
//! ```

pub(crate) mod grid;
mod model;
mod solve;

use glam::DVec2;
use grid::Nodes as _;
use model::Problem;
use octagloss::internals::realtime::tables::triangle::{Grid, node};
use octagloss::internals::realtime::tables::{
    BOX_PARAMETERS, HARMONICS, KNOTS, OCTAVES, Shape, Table, expected, step,
};
use rayon::prelude::*;
use solve::{Sample, Ties, minimise, total};

/// How often every node is fitted to the lobes around it.
pub(crate) const SWEEPS: u32 = 6;

/// Iterations of a node's first fit: for the start, along the first layer, and from layer to layer.
const START_ITERATIONS: u32 = 100;
const RING_ITERATIONS: u32 = 40;
const LAYER_ITERATIONS: u32 = 15;
/// Iterations of a node's fit within a sweep.
const SWEEP_ITERATIONS: u32 = 2;

/// Number of starts.
const STARTS: u32 = 24;

/// Octave and knot of the first layer, from which all others are fitted.
const FIRST: (u32, usize) = (4, 1);

/// Parameters of one node: those of each box, then the harmonics' weights.
type Parameters = Vec<f64>;

/// Parameters of all nodes at one knot of one octave.
type Layer = Vec<Parameters>;

/// Layers by octave and knot.
type Layers = Vec<Vec<Layer>>;

/// Fits the parameters of `shape`; calls `progress` with messages, on this thread.
#[must_use]
pub(crate) fn fit(shape: &'static Shape, progress: &dyn Fn(&str)) -> Table {
    let mut layers: Layers = vec![vec![Vec::new(); KNOTS.len()]; OCTAVES.count()];
    layers[index(FIRST.0)][FIRST.1] = first_layer(shape);
    progress("first layer");
    for (octave, knot, from_octave, from_knot) in order() {
        let from = &layers[index(from_octave)][from_knot];
        let nodes: Vec<_> = shape.grid.nodes().zip(from).collect();
        let layer = nodes
            .par_iter()
            .map(|(place, start)| fit_node(shape, octave, knot, *place, start, LAYER_ITERATIONS).0)
            .collect();
        layers[index(octave)][knot] = layer;
    }
    progress("all layers");
    for number in 1..=SWEEPS {
        sweep(shape, &mut layers);
        progress(&format!("sweep {number} of {SWEEPS}"));
    }
    let values = layers.iter().flatten().flatten().flatten().map(|value| *value as f32).collect();
    Table::new(shape, values)
}

/// Refits one node of `table` while the others stay fixed; returns the distance of all its lobes before and
/// after.
///
/// # Panics
/// If there is no such node.
#[must_use]
pub(crate) fn refit(table: &Table, octave: u32, knot: usize, place: (usize, usize)) -> [f64; 2] {
    let layers = layers_from_table(table);
    let samples = samples_around(table.shape(), &layers, octave, knot, place);
    let here = &layers[index(octave)][knot][node(place.0, place.1)];
    let alpha = alpha(octave, KNOTS[knot]);
    let (_, after) = fit_samples(table.shape(), alpha, place, &samples, here, LAYER_ITERATIONS);
    [total(&samples, here, false).value, after]
}

fn layers_from_table(table: &Table) -> Layers {
    let values: Vec<f64> = table.values().iter().map(|value| f64::from(*value)).collect();
    let nodes: Vec<Parameters> =
        values.chunks_exact(table.shape().parameters()).map(<[f64]>::to_vec).collect();
    let layers: Vec<Layer> =
        nodes.chunks_exact(table.shape().grid.node_count()).map(<[Parameters]>::to_vec).collect();
    layers.chunks_exact(KNOTS.len()).map(<[Layer]>::to_vec).collect()
}

/// Index of an octave.
fn index(octave: u32) -> usize {
    (octave - OCTAVES.start()) as usize
}

/// Alpha at a position in an octave.
fn alpha(octave: u32, position: f64) -> f64 {
    (position - f64::from(octave)).exp2()
}

/// Octave and knot of every layer but the first, each with those of an earlier adjacent layer.
fn order() -> Vec<(u32, usize, u32, usize)> {
    let (middle, knot) = FIRST;
    let mut order = vec![(middle, 0, middle, knot), (middle, 2, middle, knot), (middle, 3, middle, 2)];
    for knot in 0..KNOTS.len() {
        order.extend((*OCTAVES.start()..middle).rev().map(|octave| (octave, knot, octave + 1, knot)));
        order.extend((middle + 1..=*OCTAVES.end()).map(|octave| (octave, knot, octave - 1, knot)));
    }
    order
}

/// Fits the first layer: many starts at a node in the middle of the triangle, then ring by ring around it.
fn first_layer(shape: &'static Shape) -> Layer {
    let (octave, knot) = FIRST;
    let root = (2 * shape.grid.intervals() / 3, shape.grid.intervals() / 3);
    let starts: Vec<Parameters> = (0..STARTS).map(|number| start(shape, number)).collect();
    let fits: Vec<(Parameters, f64)> =
        starts.par_iter().map(|start| fit_node(shape, octave, knot, root, start, START_ITERATIONS)).collect();
    let best = fits.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).expect("there are starts").0;
    let mut layer: Vec<Option<Parameters>> = vec![None; shape.grid.node_count()];
    layer[node(root.0, root.1)] = Some(best);
    while layer.iter().any(Option::is_none) {
        let ring: Vec<((usize, usize), Parameters)> = shape
            .grid
            .nodes()
            .filter(|(i, j)| layer[node(*i, *j)].is_none())
            .filter_map(|(i, j)| {
                let near: Vec<&Parameters> =
                    shape.grid.neighbours(i, j).filter_map(|(i, j)| layer[node(i, j)].as_ref()).collect();
                (!near.is_empty()).then(|| ((i, j), mean(&near)))
            })
            .collect();
        let fits: Vec<Parameters> = ring
            .par_iter()
            .map(|(place, start)| fit_node(shape, octave, knot, *place, start, RING_ITERATIONS).0)
            .collect();
        for (((i, j), _), fit) in ring.into_iter().zip(fits) {
            layer[node(i, j)] = Some(fit);
        }
    }
    layer.into_iter().flatten().collect()
}

fn mean(all: &[&Parameters]) -> Parameters {
    (0..all[0].len()).map(|k| all.iter().map(|x| x[k]).sum::<f64>() / all.len() as f64).collect()
}

/// A start: boxes from narrow to wide, placed randomly around the centre.
fn start(shape: &Shape, number: u32) -> Parameters {
    // Marsaglia's xorshift, for the same numbers on every platform.
    let mut state = number.wrapping_mul(2_654_435_761).wrapping_add(12345);
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        f64::from(state) / f64::from(u32::MAX) * 2.0 - 1.0
    };
    let boxes = shape.boxes();
    let mut x = Vec::new();
    for k in 0..boxes {
        let along = if boxes > 1 { k as f64 / (boxes - 1) as f64 } else { 0.3 };
        let width = -0.5 + 2.5 * along + 0.7 * random();
        let root = (0.8 / boxes as f64).sqrt();
        x.extend([root, random(), random(), width + 0.7 * random(), width + 0.7 * random()]);
    }
    x.extend([0.0; HARMONICS]);
    x
}

/// Fits every node to the lobes around it, colour by colour: nodes of one colour share no lobe.
fn sweep(shape: &'static Shape, layers: &mut Layers) {
    for colour in 0..6 {
        let nodes: Vec<(u32, usize, (usize, usize))> = OCTAVES
            .flat_map(|octave| (0..KNOTS.len()).map(move |knot| (octave, knot)))
            .flat_map(|(octave, knot)| shape.grid.nodes().map(move |place| (octave, knot, place)))
            .filter(|(_, knot, (i, j))| (i + j) % 3 + 3 * (knot % 2) == colour)
            .collect();
        let fits: Vec<Parameters> = nodes
            .par_iter()
            .map(|(octave, knot, place)| {
                let samples = samples_around(shape, layers, *octave, *knot, *place);
                let here = &layers[index(*octave)][*knot][node(place.0, place.1)];
                fit_samples(shape, alpha(*octave, KNOTS[*knot]), *place, &samples, here, SWEEP_ITERATIONS).0
            })
            .collect();
        for ((octave, knot, (i, j)), fit) in nodes.into_iter().zip(fits) {
            layers[index(octave)][knot][node(i, j)] = fit;
        }
    }
}

/// The node at +X. Kernels change fastest there, so its cell has more samples.
const fn cone_point(grid: Grid) -> (usize, usize) {
    match grid {
        Grid::Triangle => (grid.intervals(), grid.intervals()),
        Grid::Cone => (0, 0),
    }
}

/// The lobes that depend on a node's parameters: its own, those at the centres of the cells and edges around
/// it, and those half-way to the adjacent knots.
fn samples_around(
    shape: &'static Shape,
    layers: &Layers,
    octave: u32,
    knot: usize,
    (i, j): (usize, usize),
) -> Vec<Sample> {
    let layer = &layers[index(octave)][knot];
    let (here, own) = (KNOTS[knot], DVec2::new(i as f64, j as f64));
    // The contributions of the other nodes; this node has the remaining share.
    let sample = |position: f64, place: DVec2, others: &[(f64, &Parameters)]| Sample {
        problem: Problem::new(shape, octave, alpha(octave, position), shape.grid.point(place.to_array())),
        share: 1.0 - others.iter().map(|(share, _)| share).sum::<f64>(),
        rest: (0..shape.parameters())
            .map(|k| others.iter().map(|(share, other)| share * other[k]).sum())
            .collect(),
    };
    let among = |others: &[(f64, (usize, usize))]| {
        let place = others
            .iter()
            .fold(own, |place, (share, (a, b))| place + *share * (DVec2::new(*a as f64, *b as f64) - own));
        let parameters: Vec<_> =
            others.iter().map(|(share, (a, b))| (*share, &layer[node(*a, *b)])).collect();
        sample(here, place, &parameters)
    };
    let mut samples = vec![among(&[])];
    for (a, b) in shape.grid.cells_around(i, j) {
        samples.push(among(&[(1.0 / 3.0, a), (1.0 / 3.0, b)]));
        if [(i, j), a, b].contains(&cone_point(shape.grid)) {
            let close =
                [(0.25, 0.0), (0.0, 0.25), (0.75, 0.0), (0.0, 0.75), (0.5, 0.25), (0.25, 0.5), (0.25, 0.25)];
            samples.extend(close.map(|(to_a, to_b)| among(&[(to_a, a), (to_b, b)])));
        }
    }
    samples.extend(shape.grid.neighbours(i, j).map(|neighbour| among(&[(0.5, neighbour)])));
    for neighbour in [knot.wrapping_sub(1), knot + 1].into_iter().filter(|neighbour| *neighbour < KNOTS.len())
    {
        let other = &layers[index(octave)][neighbour][node(i, j)];
        samples.push(sample((here + KNOTS[neighbour]) / 2.0, own, &[(0.5, other)]));
    }
    samples
}

/// Fits a node to its own lobe alone; returns its parameters and the distance from the lobe.
fn fit_node(
    shape: &'static Shape,
    octave: u32,
    knot: usize,
    place: (usize, usize),
    start: &[f64],
    iterations: u32,
) -> (Parameters, f64) {
    let alpha = alpha(octave, KNOTS[knot]);
    let point = shape.grid.point([place.0 as f64, place.1 as f64]);
    let problem = Problem::new(shape, octave, alpha, point);
    let sample = Sample { problem, share: 1.0, rest: vec![0.0; shape.parameters()] };
    fit_samples(shape, alpha, place, &[sample], start, iterations)
}

fn fit_samples(
    shape: &'static Shape,
    alpha: f64,
    (i, j): (usize, usize),
    samples: &[Sample],
    start: &[f64],
    iterations: u32,
) -> (Parameters, f64) {
    let on_sides = shape.grid.on_sides(i, j).into_iter().zip(mirrors(shape));
    let mirrors: Vec<_> = on_sides.filter(|(on, _)| *on).map(|(_, mirror)| mirror).collect();
    let ties = Ties::new(shape.parameters(), &mirrors);
    minimise(samples, &ties, &|x| clamp(shape, alpha, x), start, iterations)
}

/// Greatest half-width of a box in alphas. The harmonics cover what lies beyond; a box as wide as the sphere
/// would compete with them.
const WIDEST: f64 = 16.0;

/// Keeps boxes within a few of their own widths of the lobe, and within the square's own size.
fn clamp(shape: &Shape, alpha: f64, x: &mut [f64]) {
    let widest = (1.0 / alpha).min(WIDEST).log2();
    for parameters in x[..shape.boxes() * BOX_PARAMETERS].chunks_exact_mut(BOX_PARAMETERS) {
        let [root, cu, cv, lu, lv] = parameters else { unreachable!("five to a box") };
        *root = root.clamp(0.0, 1.2);
        *cu = cu.clamp(-4.0, 4.0);
        *cv = cv.clamp(-4.0, 4.0);
        *lu = lu.clamp(-3.0, widest);
        *lv = lv.clamp(-3.0, widest);
    }
}

/// The image of each box in the mirrors v = 0, u = v and u + v = 1. Lobes are longest across u = v, so there
/// boxes form pairs; in the other two mirrors each box is its own image. This is the best of all pairings
/// tried.
///
/// Around cone points three groups of four are images of each other in both mirrors, one towards the
/// diagonals and one along the axes with narrow blurs, and one towards the diagonals with wide ones. There a
/// small step asks for a quadrupole, which such groups yield linearly, by masses and half-widths.
fn images(shape: &Shape) -> [Vec<usize>; 3] {
    let own: Vec<usize> = (0..shape.boxes()).collect();
    match (shape.grid, shape.boxes()) {
        (Grid::Triangle, 1) => [own.clone(), own.clone(), own],
        (Grid::Triangle, _) => [own.clone(), own.iter().map(|k| k ^ 1).collect(), own],
        (Grid::Cone, _) => {
            [vec![2, 3, 0, 1, 4, 5, 7, 6, 10, 11, 8, 9], own, vec![1, 0, 2, 3, 7, 6, 5, 4, 9, 8, 10, 11]]
        }
    }
}

/// The mirrors v = 0, u = v and u + v = 1: the parameter that each maps every parameter to, and the sign.
fn mirrors(shape: &Shape) -> [Vec<(usize, f64)>; 3] {
    let images = images(shape);
    std::array::from_fn(|side| {
        let of_boxes = images[side].iter().flat_map(|to| {
            let at = to * BOX_PARAMETERS;
            match side {
                0 => [(at, 1.0), (at + 1, 1.0), (at + 2, -1.0), (at + 3, 1.0), (at + 4, 1.0)],
                1 => [(at, 1.0), (at + 2, 1.0), (at + 1, 1.0), (at + 4, 1.0), (at + 3, 1.0)],
                _ => [(at, 1.0), (at + 2, -1.0), (at + 1, -1.0), (at + 4, 1.0), (at + 3, 1.0)],
            }
        });
        let harmonics = shape.boxes() * BOX_PARAMETERS..shape.parameters();
        of_boxes.chain(harmonics.map(|k| (k, 1.0))).collect()
    })
}

/// The bytes of the file of `table`.
pub(crate) fn bytes(table: &Table) -> Vec<u8> {
    let (parameters, grid) = (table.shape().parameters(), table.shape().grid);
    let mut folded: Vec<[u8; 2]> = Vec::with_capacity(table.values().len());
    for parameter in 0..parameters {
        let step = step(table.shape(), parameter);
        for layer in table.values().chunks_exact(grid.node_count() * parameters) {
            let values = layer.iter().skip(parameter).step_by(parameters);
            let steps: Vec<i32> = values.map(|value| (value / step).round() as i32).collect();
            for (node, value) in grid.nodes().zip(&steps) {
                let change = value - expected(&steps, node);
                folded.push((((change << 1) ^ (change >> 31)) as u16).to_le_bytes());
            }
        }
    }
    [0, 1].into_iter().flat_map(|byte| folded.iter().map(move |half| half[byte])).collect()
}
