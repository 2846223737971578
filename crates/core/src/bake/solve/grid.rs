//! The values of a cube with all faces side by side, and how they are interpolated.

use crate::common::parallel;
use crate::common::vector::Arch;
use crate::light::environment::Rgb;
use std::iter::zip;

/// Values of a place: the channels of all six faces, face by face.
pub(super) const VALUES: usize = 18;

/// Sums of values of a place.
pub(super) type Sums = [f64; VALUES];

/// Adds `factor` times `values` to `sums`.
#[inline(always)]
pub(super) fn add(sums: &mut Sums, factor: f64, values: &Sums) {
    for l in 0..VALUES {
        sums[l] += factor * values[l];
    }
}

/// Raises negative values to 0.
#[inline(always)]
pub(super) fn at_least_black(row: &mut [Sums]) {
    for place in row {
        for value in place {
            *value = value.max(0.0);
        }
    }
}

/// A power of two that brings values to at most 2, so that single precision holds what is computed of them.
#[derive(Clone, Copy)]
pub(super) struct Scale(f64);

impl Scale {
    pub(super) fn new<'a>(levels: impl Iterator<Item = &'a [Rgb]>) -> Self {
        let greatest = levels.flat_map(<[Rgb]>::as_flattened).fold(0.0_f32, |most, value| most.max(*value));
        Self(if greatest > 0.0 { 2.0_f64.powi(-(f64::from(greatest).log2().floor() as i32)) } else { 1.0 })
    }
}

/// Places around a face, for cubics.
pub(super) const MARGIN: usize = 2;

/// The values of a cube, scaled, with all faces side by side.
#[derive(Clone)]
pub(super) struct Grid {
    /// Texels along an edge.
    pub(super) n: usize,
    /// Rows of a face with its margin.
    pub(super) places: Vec<[f32; VALUES]>,
}

/// The first of adjacent places along an axis, margin included, and their weights.
pub(super) type Taps<const W: usize> = (usize, [f64; W]);

/// Positions of `edge` centres in texels, from the middle of the place before `n` texels.
fn centres(n: usize, edge: usize) -> impl Iterator<Item = f64> {
    (0..edge).map(move |k| (k as f64 + 0.5) / edge as f64 * n as f64 + 0.5)
}

/// Cubic interpolation of `n` texels at `edge` centres.
pub(super) fn cubic_taps(n: usize, edge: usize) -> Vec<Taps<4>> {
    centres(n, edge).map(|place| cubic_tap(place, (0, n))).collect()
}

/// Cubic interpolation at `place`; the second of the four places is in `within`.
pub(super) fn cubic_tap(place: f64, (least, most): (usize, usize)) -> Taps<4> {
    let low = (place.max(0.0) as usize).clamp(least, most);
    (low, cubic(place - low as f64))
}

/// Linear interpolation of `n` texels at `edge` centres.
pub(super) fn linear_taps(n: usize, edge: usize) -> Vec<Taps<2>> {
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
pub(super) const MIN_CUBIC: usize = 4;

impl Grid {
    pub(super) fn black(n: usize) -> Self {
        let side = n + 2 * MARGIN;
        Self { n, places: vec![[0.0; VALUES]; side * side] }
    }

    /// The `texels` of a cube; its margin is black.
    pub(super) fn new(size: u32, texels: &[Rgb], scale: Scale) -> Self {
        let mut grid = Self::black(size as usize);
        let (n, side) = (grid.n, grid.side());
        let rows = grid.places.chunks_mut(side).skip(MARGIN).take(n);
        parallel::for_each(rows.enumerate(), |(y, row)| {
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
    pub(super) fn write(&self, texels: &mut [Rgb], scale: Scale) {
        let n = self.n;
        parallel::for_each(texels.chunks_mut(n).enumerate(), |(k, row)| {
            let (face, y) = (k / n, k % n);
            for (texel, place) in zip(row, &self.row(y + MARGIN)[MARGIN..]) {
                for c in 0..3 {
                    let value = f64::from(place[3 * face + c]) / scale.0;
                    texel[c] = value.clamp(0.0, f64::from(f32::MAX)) as f32;
                }
            }
        });
    }

    pub(super) fn side(&self) -> usize {
        self.n + 2 * MARGIN
    }

    pub(super) fn row(&self, j: usize) -> &[[f32; VALUES]] {
        &self.places[j * self.side()..][..self.side()]
    }
}

/// Buffers of rows.
pub(super) struct Scratch {
    pub(super) arch: Arch,
    pub(super) blended: Vec<Sums>,
    pub(super) lobe: Vec<Sums>,
    /// Per level of a window.
    pub(super) own: Vec<Vec<Sums>>,
    pub(super) right: Vec<Vec<Sums>>,
}

impl Default for Scratch {
    fn default() -> Self {
        let (blended, lobe, own, right) = Default::default();
        Self { arch: Arch::new(), blended, lobe, own, right }
    }
}

/// Reads a row of `grid` by the taps `down` and `across`.
#[inline(always)]
pub(super) fn read_row<const W: usize>(
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
pub(super) struct Reading<'a> {
    pub(super) grid: &'a Grid,
    pub(super) down: Taps<4>,
    pub(super) across: &'a [Taps<4>],
    pub(super) blended: &'a mut Vec<Sums>,
    pub(super) out: &'a mut [Sums],
}

impl pulp::NullaryFnOnce for Reading<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        read_row(self.grid, self.down, self.across, self.blended, self.out);
        at_least_black(self.out);
    }
}
