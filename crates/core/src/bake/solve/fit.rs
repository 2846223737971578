//! Least squares over direction for one level.

use super::grid::{Grid, MARGIN, MIN_CUBIC, Scratch, Sums, Taps, VALUES, add, linear_taps, read_row};
use super::nodes::MIN_EDGE;
use super::seams::Seams;
use crate::common::parallel;
use crate::common::vector::Arch;
use std::iter::zip;

/// Weight of a deviation from the sampled texels, relative to the error of a look-up.
const TETHER: f64 = 0.02;

/// The weight for levels smaller than [`MIN_CUBIC`]; in their wide bilinear squares a saddle could show as
/// a second maximum of more than 1 %.
const SMALL_TETHER: f64 = 0.2;

/// Conjugate gradient steps.
const STEPS: usize = 10;

/// Rows of a task.
const BAND: usize = 16;

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

/// Least squares over direction for one level: normal equations of its texels.
pub(super) struct Fit {
    n: usize,
    pub(super) seams: Seams,
    /// Look-ups at the points along an edge: four points per texel of a face, or more for small levels.
    pub(super) linear: Vec<Taps<2>>,
    /// Per place, the weights of itself, with the next place of its row, with that of its column, and of
    /// either diagonal between these.
    couplings: Vec<[f32; 4]>,
    /// Per place, the inverse of the diagonal.
    inverse: Vec<f32>,
}

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
    pub(super) fn new(size: u32) -> Self {
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
    pub(super) fn residual(&self, own: &Grid, targets: TargetRows<'_>) -> Grid {
        let mut residual = Grid::black(self.n);
        let side = residual.side();
        let bands = residual.places.chunks_mut(BAND * side).enumerate();
        parallel::map_with(bands, Scratch::default, |scratch, (band, places)| {
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
    pub(super) fn corrected(&self, own: &Grid, mut residual: Grid) -> Grid {
        let (n, side) = (self.n, residual.side());
        let mut texels = own.clone();
        let [mut step, mut image] = [(); 2].map(|()| Grid::black(n));
        let arch = Arch::new();
        let mut share = [0.0; 3];
        let mut squares = [0.0; 3];
        let mut first = [f64::INFINITY; 3];
        for round in 0..=STEPS {
            // The squares of the residual, and the next step.
            let rows = zip(residual.places.chunks(side), self.inverse.chunks(side));
            let sums = parallel::map(rows.skip(MARGIN).take(n), |(residual, inverse)| {
                let mut sums = [0.0; VALUES];
                for (residual, inverse) in zip(residual, inverse).skip(MARGIN).take(n) {
                    for l in 0..VALUES {
                        sums[l] += f64::from(residual[l]) * f64::from(residual[l]) * f64::from(*inverse);
                    }
                }
                sums
            });
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
            let rows = zip(step.places.chunks_mut(side), residual.places.chunks(side));
            let rows = zip(rows, self.inverse.chunks(side)).skip(MARGIN).take(n);
            parallel::for_each(rows, |((step, residual), inverse)| {
                for ((step, residual), inverse) in zip(zip(step, residual), inverse).skip(MARGIN).take(n) {
                    for l in 0..VALUES {
                        step[l] = residual[l] * inverse + shares[l] * step[l];
                    }
                }
            });
            self.seams.fill(&mut step);
            let rows = image.places.chunks_mut(side).enumerate().skip(1).take(n + 2);
            let sums =
                parallel::map(rows, |(j, row)| arch.dispatch(Coupling { fit: self, step: &step, j, row }));
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
            let rows = zip(texels.places.chunks_mut(side), residual.places.chunks_mut(side));
            let rows = zip(rows, zip(step.places.chunks(side), image.places.chunks(side)));
            parallel::for_each(rows.skip(MARGIN).take(n), |((texels, residual), (step, image))| {
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
