//! Scans of an OEM into an exact summed-area table. All give the same bits.

use crate::sat::{FixedPoint, Scan};
use rayon::prelude::*;

/// Fills `out` with the inclusive sums of `texels`, `width` to a row.
///
/// # Panics
/// Where `out` has not the size of `texels`, that is no whole number of rows, or a Hensley radix is below 2.
pub fn scan(scan: Scan, fixed: FixedPoint, texels: &[[f32; 4]], width: usize, out: &mut [[u64; 4]]) {
    assert!(
        width > 0 && texels.len().is_multiple_of(width) && out.len() == texels.len(),
        "whole rows, and as many out"
    );
    if texels.is_empty() {
        return;
    }
    match scan {
        Scan::Serial => serial(fixed, texels, width, out),
        Scan::Strips => strips(fixed, texels, width, out),
        Scan::Hensley { radix } => hensley(radix, fixed, texels, width, out),
    }
}

#[inline(always)]
fn add(a: [u64; 4], b: [u64; 4]) -> [u64; 4] {
    std::array::from_fn(|k| a[k].wrapping_add(b[k]))
}

fn serial(fixed: FixedPoint, texels: &[[f32; 4]], width: usize, out: &mut [[u64; 4]]) {
    for k in 0..texels.len() {
        let (x, y) = (k % width, k / width);
        let left = if x > 0 { out[k - 1] } else { [0; 4] };
        let above = if y > 0 { out[k - width] } else { [0; 4] };
        let corner = if x > 0 && y > 0 { out[k - width - 1] } else { [0; 4] };
        let value = fixed.quantise(texels[k]);
        out[k] = std::array::from_fn(|c| {
            value[c].wrapping_add(left[c]).wrapping_add(above[c]).wrapping_sub(corner[c])
        });
    }
}

/// Each strip of rows needs the sums of all rows above it: column sums first (input read once), then every strip on
/// its own, a running sum along the row added to the row above (input read again, output written once).
fn strips(fixed: FixedPoint, texels: &[[f32; 4]], width: usize, out: &mut [[u64; 4]]) {
    let threads = rayon::current_num_threads();
    let height = texels.len() / width;
    // One thread needs no column sums; more share the work evenly with a few strips each.
    let strip_count = if threads == 1 { 1 } else { (4 * threads).min(height) };
    let strip = height.div_ceil(strip_count) * width;
    let arch = pulp::Arch::new();

    let mut carries: Vec<Vec<[u64; 4]>> = texels
        .par_chunks(strip)
        .take((texels.len() - 1) / strip)
        .map(|texels| {
            let mut columns = vec![[0; 4]; width];
            arch.dispatch(ColumnSums { fixed, texels, columns: &mut columns });
            columns
        })
        .collect();
    let mut above = vec![[0; 4]; width];
    for columns in &mut carries {
        let mut run = [0; 4];
        for (above, column) in above.iter_mut().zip(columns.iter_mut()) {
            run = add(run, *column);
            *above = add(*above, run);
            *column = *above;
        }
    }

    texels.par_chunks(strip).zip(out.par_chunks_mut(strip)).enumerate().for_each(|(index, (texels, out))| {
        let zeros;
        let above: &[[u64; 4]] = if index > 0 {
            &carries[index - 1]
        } else {
            zeros = vec![[0; 4]; width];
            &zeros
        };
        arch.dispatch(StripSums { fixed, texels, above, out });
    });
}

/// Adds a strip's rows to `columns`.
struct ColumnSums<'a> {
    fixed: FixedPoint,
    texels: &'a [[f32; 4]],
    columns: &'a mut [[u64; 4]],
}

impl pulp::NullaryFnOnce for ColumnSums<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for row in self.texels.chunks_exact(self.columns.len()) {
            for (column, texel) in self.columns.iter_mut().zip(row) {
                *column = add(*column, self.fixed.quantise(*texel));
            }
        }
    }
}

/// The table of a strip under the row `above`.
struct StripSums<'a> {
    fixed: FixedPoint,
    texels: &'a [[f32; 4]],
    above: &'a [[u64; 4]],
    out: &'a mut [[u64; 4]],
}

impl pulp::NullaryFnOnce for StripSums<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let width = self.above.len();
        let mut above = self.above;
        for (row, out) in self.texels.chunks_exact(width).zip(self.out.chunks_exact_mut(width)) {
            let mut run = [0; 4];
            for ((out, texel), above) in out.iter_mut().zip(row).zip(above) {
                run = add(run, self.fixed.quantise(*texel));
                *out = add(run, *above);
            }
            above = out;
        }
    }
}

/// Passes of out[i] = sum over k < radix of in[i - k * radix^pass], along rows until they are summed, then along
/// columns, ping-pong.
fn hensley(radix: u32, fixed: FixedPoint, texels: &[[f32; 4]], width: usize, out: &mut [[u64; 4]]) {
    assert!(radix >= 2, "a radix of at least 2");
    let height = texels.len() / width;
    let mut front: Vec<[u64; 4]> = texels.par_iter().map(|texel| fixed.quantise(*texel)).collect();
    let mut back = vec![[0; 4]; texels.len()];
    for (length, step) in [(width, 1), (height, width)] {
        let mut stride = 1;
        while stride < length {
            back.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
                for (x, value) in row.iter_mut().enumerate() {
                    let (k, along) = (y * width + x, if step == 1 { x } else { y });
                    *value = (0..radix as usize)
                        .take_while(|sample| sample * stride <= along)
                        .fold([0; 4], |sum, sample| add(sum, front[k - sample * stride * step]));
                }
            });
            std::mem::swap(&mut front, &mut back);
            stride *= radix as usize;
        }
    }
    out.copy_from_slice(&front);
}
