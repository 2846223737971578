//! The real-time tier's parameters: GGX lobes as a few soft boxes and a zonal harmonic term.
//!
//! ```text
//! direction ---> triangle ---> parameters ---> K soft boxes ---> energy and w of each, from a blurred table
//!                (16-fold)     of 3 nodes                            |
//! roughness ---> octave ------ x 2 knots ----> 5 weights ----> orders 0 to 4 of the harmonics
//!                                                                    |
//!                                                     sum of energies / sum of w  +  emitters
//! ```
//!
//! A few boxes do not have the shape of a lobe, and a sun's highlight shows that shape. Therefore the
//! brightest cells of the OEM become point emitters first ([`crate::realtime::emitters`]), for which the lobe
//! itself is evaluated. Everything below concerns the remaining light.
//!
//! A soft box is a box read from the SAT of an OEM blurred by a tent ([`crate::cpu::blur`]), with one SAT per
//! octave of alpha. It takes four entries at integer edges, like any box, but has no hard edges. Harmonics to
//! order 4 carry GGX's long tail. Boxes of masses m and half-widths h and harmonics of weights c have the
//! kernel
//!
//! ```text
//! K(l) = sum over boxes of m / (4 hu hv rho) * soft box(l) + sum over orders n of c_n (2n + 1)/4pi P_n(l.R)
//! ```
//!
//! with rho the solid angle of a unit of (u, v) at R. The kernel is applied to L and to 1; the answer is the
//! quotient, so a constant stays constant. Harmonics ring opposite bright light, so answers are clamped to at
//! least the least radiance.
//!
//! Around the cone points ±X and ±Z, from roughness 0.1 up, twelve boxes of another table replace four or
//! eight.
//!
//! Parameters are linear between nodes: 78 nodes in the triangle of directions to which the map's sixteen
//! symmetries reduce the sphere ([`triangle`]), times 4 knots in each of six octaves of alpha. Octaves
//! overlap by a quarter, in which one fades into the next. From roughness 0.65 to 0.75 boxes fade into
//! harmonics alone. A lobe sharper than the finest blur (octave 7, or the blur four OEM texels wide) mixes
//! the lobe of that blur with the mirror. The share of that lobe is t (2 - t), with t the square of alpha
//! over the blur's alpha. The answer is therefore continuous in direction and roughness, down to the mirror.
//!
//! `examples/fit_lobes` finds the parameters and writes the files.

pub mod triangle;

use glam::DVec2;
use std::sync::LazyLock;
use triangle::{Grid, GridPoint, node};

/// Supported numbers of boxes.
pub const COUNTS: [u32; 4] = [1, 2, 4, 8];

/// Parameters of a soft box: square root of its mass, offset of its centre from the lobe's in its own
/// half-widths, log2 of its half-widths in units of alpha.
pub const BOX_PARAMETERS: usize = 5;

/// Weights of the harmonics of order 0 to 4.
pub const HARMONICS: usize = 5;

/// Octaves of alpha with their own parameters: octave k, with blurs 2^-k wide, serves alpha from 1.2 times
/// 2^-k up.
pub const OCTAVES: std::ops::RangeInclusive<u32> = 2..=7;

/// Tabulated positions in an octave: log2 of alpha over the blur's half-width.
pub const KNOTS: [f64; 4] = [0.25, 2.0 / 3.0, 3.25 / 3.0, 1.5];

/// The fitted model for one number of boxes.
#[derive(Debug)]
pub struct Shape {
    /// The nodes of its parameters.
    pub grid: Grid,
    /// For each box, by how many octaves its blur is wider than that of its octave.
    pub wider: &'static [u32],
}

static ONE: Shape = Shape { grid: Grid::Triangle, wider: &[0] };
static TWO: Shape = Shape { grid: Grid::Triangle, wider: &[0, 0] };
static FOUR: Shape = Shape { grid: Grid::Triangle, wider: &[0, 0, 1, 1] };
static EIGHT: Shape = Shape { grid: Grid::Triangle, wider: &[0, 0, 0, 0, 1, 1, 1, 1] };
static CONE: Shape = Shape { grid: Grid::Cone, wider: &[0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1] };

impl Shape {
    /// Number of boxes.
    #[must_use]
    pub const fn boxes(&self) -> usize {
        self.wider.len()
    }

    /// Number of parameters: those of each box, then the harmonics' weights.
    #[must_use]
    pub const fn parameters(&self) -> usize {
        BOX_PARAMETERS * self.boxes() + HARMONICS
    }
}

/// Fitted parameters of one shape.
#[derive(Debug)]
pub struct Table {
    shape: &'static Shape,
    /// By octave, knot, node and parameter.
    values: Vec<f32>,
}

/// A soft box in the plane of the triangle.
#[derive(Clone, Copy, Debug)]
pub struct SoftBox {
    /// Its approximate share of the lobe: masses and the weight of order 0 sum to nearly 1.
    pub mass: f64,
    /// Its centre, relative to the lobe's.
    pub offset: DVec2,
    /// Its half-widths.
    pub half: DVec2,
    /// Octave of its blur: a tent of half-width 2^-octave.
    pub octave: u32,
}

/// Step of `parameter` of `shape` in files. The rounding changes the model's error over panoramas by at most
/// 4 %; harmonics count everywhere, and have finer steps.
#[must_use]
pub fn step(shape: &Shape, parameter: usize) -> f32 {
    match (parameter < BOX_PARAMETERS * shape.boxes(), parameter % BOX_PARAMETERS) {
        (true, 0) => 1.0 / 128.0,
        (true, _) => 1.0 / 64.0,
        (false, _) => 1.0 / 2048.0,
    }
}

/// What files expect at node (`i`, `j`) after `steps` of the nodes before: the mean of the nodes before it in
/// its column and in its row.
#[must_use]
pub fn expected(steps: &[i32], (i, j): (usize, usize)) -> i32 {
    if i == 0 {
        return 0;
    }
    let beside = steps[node(i - 1, j.min(i - 1))];
    let below = if j == 0 || j == i { beside } else { steps[node(i, j - 1)] };
    (beside + below) >> 1
}

impl Table {
    /// The table of `count` boxes; `None` if `count` is not supported.
    #[must_use]
    pub fn of(count: u32) -> Option<&'static Self> {
        static TABLES: [LazyLock<Table>; 4] = [
            LazyLock::new(|| Table::read(&ONE, include_bytes!("one.bin"))),
            LazyLock::new(|| Table::read(&TWO, include_bytes!("two.bin"))),
            LazyLock::new(|| Table::read(&FOUR, include_bytes!("four.bin"))),
            LazyLock::new(|| Table::read(&EIGHT, include_bytes!("eight.bin"))),
        ];
        let place = COUNTS.iter().position(|other| *other == count)?;
        Some(&TABLES[place])
    }

    /// The table around cone points.
    #[must_use]
    pub fn around_cone_points() -> &'static Self {
        static TABLE: LazyLock<Table> = LazyLock::new(|| Table::read(&CONE, include_bytes!("cone.bin")));
        &TABLE
    }

    /// The table that replaces this one around cone points, if one does: one and two boxes are for those who
    /// have no time for more.
    #[must_use]
    pub fn beside_cone_points(&self) -> Option<&'static Self> {
        (self.shape.boxes() >= 4).then(Self::around_cone_points)
    }

    /// A table of `values` by octave, knot, node and parameter.
    ///
    /// # Panics
    /// If their number is not that of `shape`.
    #[must_use]
    pub fn new(shape: &'static Shape, values: Vec<f32>) -> Self {
        assert_eq!(
            values.len(),
            OCTAVES.count() * KNOTS.len() * shape.grid.node_count() * shape.parameters(),
            "parameters"
        );
        Self { shape, values }
    }

    /// The table in a file, which pages download compressed. By parameter, octave, knot and node: the value
    /// in steps less the mean of two nodes before, signs folded as 0, -1, 1, -2, ..., in 16 bits; the lower
    /// bytes of all before the upper ones.
    fn read(shape: &'static Shape, bytes: &[u8]) -> Self {
        let (low, high) = bytes.split_at(bytes.len() / 2);
        let mut folded = low.iter().zip(high).map(|(low, high)| i32::from(u16::from_le_bytes([*low, *high])));
        let parameters = shape.parameters();
        let mut values = vec![0.0; low.len()];
        for parameter in 0..parameters {
            for layer in values.chunks_exact_mut(shape.grid.node_count() * parameters) {
                let mut steps = Vec::with_capacity(shape.grid.node_count());
                for (node, value) in shape.grid.nodes().zip(layer.chunks_exact_mut(parameters)) {
                    let folded = folded.next().expect("a value of each node");
                    steps.push(expected(&steps, node) + ((folded >> 1) ^ -(folded & 1)));
                    value[parameter] = steps[steps.len() - 1] as f32 * step(shape, parameter);
                }
            }
        }
        Self::new(shape, values)
    }

    /// The model it was fitted for.
    #[must_use]
    pub const fn shape(&self) -> &'static Shape {
        self.shape
    }

    /// All parameters, by octave, knot, node and parameter.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Calls `visit` with the boxes of the kernel at `point` of the triangle for `alpha`, by the parameters
    /// of `octave`; returns the weights of the harmonics.
    ///
    /// # Panics
    /// If `octave` is not one of [`OCTAVES`].
    pub fn kernel(
        &self,
        octave: u32,
        alpha: f64,
        point: DVec2,
        mut visit: impl FnMut(SoftBox),
    ) -> [f64; HARMONICS] {
        assert!(OCTAVES.contains(&octave), "octave {octave} was fitted");
        let position = alpha.log2() + f64::from(octave);
        let parameters = self.parameters(octave, position, &self.shape.grid.place(point));
        let (boxes, harmonics) = parameters.split_at(BOX_PARAMETERS * self.shape.boxes());
        for (parameters, wider) in boxes.chunks_exact(BOX_PARAMETERS).zip(self.shape.wider) {
            let [root, cu, cv, lu, lv] = *parameters else { unreachable!("five to a box") };
            let half = DVec2::new(lu, lv).exp2() * alpha;
            let offset = DVec2::new(cu, cv) * half;
            visit(SoftBox { mass: root * root, offset, half, octave: octave - wider });
        }
        std::array::from_fn(|order| harmonics[order])
    }

    /// Parameters at `place` and `position` in `octave`; positions beyond the last knot have its parameters.
    fn parameters(&self, octave: u32, position: f64, place: &GridPoint) -> Vec<f64> {
        let count = self.shape.parameters();
        let along = ((position - KNOTS[0]) / (KNOTS[1] - KNOTS[0])).clamp(0.0, (KNOTS.len() - 1) as f64);
        let knot = (along as usize).min(KNOTS.len() - 2);
        let along = along - knot as f64;
        let first = (octave - OCTAVES.start()) as usize * KNOTS.len();
        let mut sums = vec![0.0; count];
        for (knot, share) in [(knot, 1.0 - along), (knot + 1, along)] {
            for (node, share_of_node) in place.nodes.iter().zip(place.shares) {
                let at = ((first + knot) * self.shape.grid.node_count() + node) * count;
                for (sum, value) in sums.iter_mut().zip(&self.values[at..at + count]) {
                    *sum += share * share_of_node * f64::from(*value);
                }
            }
        }
        sums
    }
}
