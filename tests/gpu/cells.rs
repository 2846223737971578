//! Compares the quadtree of moments with the CPU's, within the error of float32 sums.

use crate::transfer::Upload as _;
use glam::DVec3;
use octagloss_core::cpu::cells::Cells;
use octagloss_core::geometry::tent::Reconstruction;
use octagloss_core::light::environment::LUMINANCE;
use octagloss_core::light::environment::Layout;
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_fixtures::adapters::{UNIT, exceeds, in_full, wait};
use octagloss_fixtures::common::{Look, Random, oem, texels};
use octagloss_gpu::device::readback;
use octagloss_gpu::stages::cells;
use octagloss_gpu::{Context, OemPlanes};

/// Fields of four siblings, as `shaders/common/quad.wgsl` orders them.
type Quad = [[f32; 4]; 34];

const RADIUS: usize = 9;
const LUMINANCE_FIELD: usize = 10;

/// Builds the quads of `oem` on the GPU.
fn built(context: &Context, oem: &Oem, block: u32, spread: Reconstruction) -> Vec<Quad> {
    let planes = OemPlanes::upload(context, oem).expect("small planes");
    let (stage, tree) = cells::stage(context, &planes, block, spread).expect("a small tree");
    context.submit(|encoder| stage.record(encoder));
    let least: Vec<[f32; 4]> = wait(context, readback::read(context, &tree.least));
    // One quotient per texel: within 2.5 ulp in the shader, rounded on the CPU.
    for (found, expected) in least[0].into_iter().zip(oem.least_radiance()) {
        let off = (f64::from(found) - f64::from(expected)).abs();
        assert!(off <= 6.0 * UNIT * f64::from(expected), "least radiance {found}, not {expected}");
    }
    wait(context, readback::read(context, &tree.quads))
}

/// Raw luminance of a cell's texels, and whether some texel's luminance above the least is lost in rounding.
#[derive(Clone, Copy, Default)]
struct Raw {
    luminance: f64,
    unclear: bool,
}

/// Greatest difference between the engines in a texel's luminance above the least, in units of the raw
/// luminance E: the least c takes 6 of c*w <= E, the product 2, the difference 2, and the luminance's
/// products and sums 4, on each side.
const TEXEL: f64 = 18.0;

struct Case<'a> {
    oem: &'a Oem,
    block: u32,
    spread: Reconstruction,
}

impl Case<'_> {
    fn raw(&self) -> (u32, Vec<Raw>) {
        let Self { oem, block, .. } = *self;
        let n = oem.size().inner;
        let least = oem.least_radiance();
        let luminance = |rgb: [f64; 3]| (0..3).map(|c| f64::from(LUMINANCE[c]) * rgb[c]).sum::<f64>();
        let width = n.div_ceil(block);
        let mut cells = vec![Raw::default(); (width * width) as usize];
        for (x, y) in (0..n * n).map(|k| (k % n, k / n)) {
            let cell = &mut cells[(y / block * width + x / block) as usize];
            let texel = oem.texel(x, y).map(f64::from);
            let raw = luminance([texel[0], texel[1], texel[2]]);
            let above =
                luminance(std::array::from_fn(|c| (texel[c] - f64::from(least[c]) * texel[3]).max(0.0)));
            cell.luminance += raw;
            cell.unclear |= raw > 0.0 && above <= 2.0 * TEXEL * UNIT * raw;
        }
        (width, cells)
    }

    /// Returns the first cell of `found` beyond its bound of the CPU's, or that does not reach as far as its
    /// members.
    fn difference(&self, found: &[Quad]) -> Option<String> {
        let Self { oem, block, spread } = *self;
        let expected = Cells::new(oem, block, spread).quad_fields();
        if expected.len() != found.len() {
            return Some(format!("{} quads for {}", found.len(), expected.len()));
        }
        let n = f64::from(oem.size().inner);
        let (mut width, mut raw) = self.raw();
        let (mut first, mut finer, mut level) = (0, None, 0);
        while first < expected.len() {
            let quads = width.div_ceil(2);
            // Greatest distance within a cell: directions move by less than 3 per unit of (u, v), and
            // spreading extends texels by up to half a texel per side.
            let side = (f64::from(block << level) + 1.0) * 2.0 / n;
            let bound = Bound::new(level, block, (3.0 * 2_f64.sqrt() * side).min(2.0));
            let mut parents = vec![Raw::default(); (quads * quads) as usize];
            for (i, j) in (0..width * width).map(|k| (k % width, k / width)) {
                let own = raw[(j * width + i) as usize];
                let quad = (j / 2 * quads + i / 2) as usize;
                parents[quad].luminance += own.luminance;
                parents[quad].unclear |= own.unclear;
                let sibling = (i % 2 + 2 * (j % 2)) as usize;
                let cell = |all: &[Quad]| all[first + quad].map(|field| f64::from(field[sibling]));
                let (expected, found_cell) = (cell(&expected), cell(found));
                let members =
                    finer.map(|(first, width): (usize, u32)| &found[first + (j * width + i) as usize]);
                let wrong = bound
                    .difference(own, &expected, &found_cell)
                    .or_else(|| members.and_then(|members| beyond_reach(&found_cell, members)));
                if let Some(what) = wrong {
                    return Some(format!(
                        "{what}: cell ({i}, {j}) of level {level} is {found_cell:?}, not {expected:?}"
                    ));
                }
            }
            finer = Some((first, quads));
            first += (quads * quads) as usize;
            (width, raw) = (quads, parents);
            level += 1;
        }
        None
    }
}

/// Returns a member that reaches farther than its cell's radius.
fn beyond_reach(cell: &[f64; 34], members: &Quad) -> Option<String> {
    let centroid = |fields: &[f64; 34]| DVec3::new(fields[0], fields[1], fields[2]);
    (0..4).find_map(|k| {
        let member = members.map(|field| f64::from(field[k]));
        let reached = centroid(&member).distance(centroid(cell)) + member[RADIUS];
        (member[LUMINANCE_FIELD] > 0.0 && reached > cell[RADIUS]).then(|| format!("member {k} at {reached}"))
    })
}

/// Bounds the difference of a cell from the CPU's.
struct Bound {
    /// Number of merges below the cell.
    merges: f64,
    /// Luminance, in units of the raw luminance.
    luminance: f64,
    /// Greatest distance within the cell.
    extent: f64,
}

impl Bound {
    fn new(level: u32, block: u32, extent: f64) -> Self {
        // Four members take three additions on each side, a block as many as its texels.
        let block = if block > 1 { 2.0 * f64::from(block * block) } else { 0.0 };
        Self {
            merges: f64::from(level) + if block > 0.0 { 1.0 } else { 0.0 },
            luminance: TEXEL + block + 6.0 * f64::from(level),
            extent,
        }
    }

    fn difference(&self, raw: Raw, expected: &[f64; 34], found: &[f64; 34]) -> Option<String> {
        let Self { merges, extent, .. } = *self;
        let far = |fields: std::ops::Range<usize>, bound: f64| {
            fields.clone().any(|field| exceeds((expected[field] - found[field]).abs(), bound))
        };
        let noise = self.luminance * UNIT * raw.luminance;
        // A channel is at most 1/0.0722 of the luminance.
        for (fields, share, what) in [(10..11, 1.0, "luminance"), (11..14, 14.0, "energy")] {
            if far(fields, noise * share) {
                return Some(format!("{what} beyond {noise:e}"));
            }
        }
        if expected[LUMINANCE_FIELD] <= 2.0 * noise || found[LUMINANCE_FIELD] == 0.0 {
            // Only rounding remains above the least radiance, so its position means nothing.
            return None;
        }
        // Weights off by `relative` move a mean by that share of the extent: once for the cell's own members
        // and once for each merge below, in numerator and denominator of both engines, hence four.
        // Differences, products and quotients of directions take another 16 units.
        let relative = noise / (expected[LUMINANCE_FIELD] - noise);
        let centroid = (merges + 1.0) * (4.0 * relative * extent + 16.0 * UNIT);
        // Squared distances from it: twice the distance times its error, weights as before, and 16 units.
        let covariance =
            2.0 * extent * centroid + extent * extent * (merges + 1.0) * (4.0 * relative + 16.0 * UNIT);
        // Each merge moves a centroid, and rounds up by 2e-6 (the CPU by 1e-6).
        let radius = merges * (2.0 * centroid + 1.5e-6 * expected[RADIUS]);
        if far(0..3, centroid) {
            return Some(format!("centroid beyond {centroid:e}"));
        }
        // A tint's variation sums differences of texels' energies, each at most 14 times its luminance, and
        // of their shares of the luminance: off by as much as these, and by 2e-6 a merge (the CPU by 1e-6).
        // Its moments weight them by offsets from the centroid, which are off themselves, and their squares.
        let variation =
            14.0 * (4.0 * noise + raw.luminance * (merges + 1.0) * (relative + 16.0 * UNIT + 3e-6));
        let dipole = variation * extent + 28.0 * raw.luminance * centroid;
        let quadrupole = 2.0 * dipole * extent;
        for first in [14, 24] {
            let moments = [
                (first..first + 3, dipole, "dipole"),
                (first + 3..first + 9, quadrupole, "quadrupole"),
                (first + 9..first + 10, variation, "variation"),
            ];
            for (fields, bound, what) in moments {
                if far(fields, bound) {
                    return Some(format!("{what} beyond {bound:e}"));
                }
            }
        }
        if far(3..9, covariance) {
            return Some(format!("covariance beyond {covariance:e}"));
        }
        // A texel above the least in one engine only makes the radius arbitrary.
        if !raw.unclear && far(9..10, radius) {
            return Some(format!("radius beyond {radius:e}"));
        }
        None
    }
}

fn look_of(random: &mut Random, size: OemSize, look: Look) -> Oem {
    oem(size, &texels(random, look, Layout::Octahedral { size: size.inner }))
}

#[test]
fn cells_lie_within_their_bounds_of_the_cpu() {
    let cases = [(1, 1), (2, 1), (3, 1), (5, 1), (17, 1), (33, 2), (64, 1), (64, 4), (50, 8), (100, 1)];
    in_full("cells", |context| {
        let mut random = Random::new(51);
        for (inner, block) in cases {
            for (k, look) in Look::ALL.into_iter().enumerate() {
                let spread = [Reconstruction::Constant, Reconstruction::Bilinear][(k + inner as usize) % 2];
                let oem = look_of(&mut random, OemSize { inner, border: inner % 3 }, look);
                let found = built(context, &oem, block, spread);
                let difference = Case { oem: &oem, block, spread }.difference(&found);
                assert_eq!(difference, None, "{look:?} {inner} {block} {spread:?} on {}", context.describe());
            }
        }
    });
}

#[test]
fn faults_in_cells_are_detected() {
    in_full("faults in cells", |context| {
        let mut random = Random::new(52);
        for look in Look::ALL {
            let size = OemSize { inner: 16, border: 2 };
            let oem = look_of(&mut random, size, look);
            let spread = Reconstruction::Bilinear;
            let case = Case { oem: &oem, block: 1, spread };
            let seen = |wrong: &Oem| case.difference(&built(context, wrong, 1, spread)).is_some();
            assert!(!seen(&oem), "{look:?}: the correct tree passes");

            let square: Vec<[f32; 4]> = (0..256).map(|k| oem.texel(k % 16, k / 16)).collect();
            let brightest = (0..256).max_by(|a, b| square[*a][1].total_cmp(&square[*b][1])).expect("texels");
            let mut one = square.clone();
            one[brightest][1] *= 1.0001;
            assert!(seen(&Oem::from_square(size, one)), "{look:?}: one texel a ten-thousandth brighter");

            let mut swapped = square.clone();
            for (x, y) in (0..128).map(|k| (k % 16, k / 16)) {
                swapped.swap(y * 16 + x, (y + 8) * 16 + (x + 8) % 16);
            }
            assert!(seen(&Oem::from_square(size, swapped)), "{look:?}: quadrants swapped");

            // Read from one texel off the square's corner.
            let mut shifted = oem.texels().to_vec();
            shifted.rotate_left(1);
            assert!(seen(&Oem::from_bordered(size, shifted)), "{look:?}: a border off by one");

            let right = built(context, &oem, 1, spread);
            let faults = [
                (0, "centroid"),
                (4, "covariance"),
                (RADIUS, "radius"),
                (12, "energy"),
                (14, "dipole of red"),
                (18, "quadrupole of red"),
                (26, "dipole of blue"),
                (33, "variation of blue"),
            ];
            for (field, what) in faults {
                let mut wrong = right.clone();
                let root = wrong.len() - 1;
                let sibling = (0..4)
                    .max_by(|a, b| right[root][10][*a].total_cmp(&right[root][10][*b]))
                    .expect("siblings");
                // Tints are energies times distances.
                let lit = right[root][LUMINANCE_FIELD][sibling];
                let far = if field < 14 { 1e-3 } else { 0.1 * lit };
                wrong[root][field][sibling] = wrong[root][field][sibling] * 0.999 - far;
                assert!(case.difference(&wrong).is_some(), "{look:?}: a wrong {what}");
            }
        }
    });
}
