//! Blurred SATs for soft boxes: an OEM blurred by a tent, computed from its own SAT.

use super::sat_scan::sum_up;
use crate::sat::Sat;
use rayon::prelude::*;

/// Texels of a blurred table in half of its tent's width. Interpolation between them has an error of at most
/// 1/128 of the height of a soft edge.
const TEXELS: u32 = 4;

/// Texels of the blurred grid in half of the tent's width.
const FINE_TEXELS: u32 = 16;

/// Texels along an edge, over `inner` texels, of the grid to blur for `octave` and of the blurred table.
pub(crate) fn grids(inner: u32, octave: u32) -> [u32; 2] {
    // Half of the square's width is 1.
    [FINE_TEXELS, TEXELS].map(|texels| inner.min((2 * texels) << octave))
}

/// The table of `sat`'s texels blurred by a tent of half-width 2^-`octave` in u and in v. Its texels are
/// about a quarter of that wide, but not finer than `sat`'s.
///
/// The tent is a box applied twice, on the unfolded plane, in integers. Radiance and solid angle lose less
/// than one fixed-point unit for each texel; wrapping and scale stay the same.
///
/// `sat`'s square must be a power of two wide, and at least 4 * 2^`octave`.
///
/// # Panics
/// If it is not.
#[must_use]
pub fn blurred(sat: &Sat, octave: u32) -> Sat {
    let inner = sat.size().inner;
    assert!(inner.is_power_of_two() && inner >= 4 << octave, "a power of two, four texels to the tent");
    let [n, coarse] = grids(inner, octave);
    let grid = sat.coarsened(inner / n);
    // The box, and the shift that divides by its number of texels.
    let side = i64::from(n >> (octave + 1));
    let shift = 2 * side.ilog2();
    // Boxes around the corners of texels, as far as boxes around texels need them: even widths are centred on
    // a corner, and a half-turn of the plane maps corners to corners.
    let (first, corners) = (1 - side / 2, i64::from(n) + side - 1);
    let at = |k: i64| (k % corners + first, k / corners + first);
    let mut once: Vec<[u64; 4]> = (0..corners * corners)
        .into_par_iter()
        .map(|k| {
            let (x, y) = at(k);
            let sum = grid.plane_box(x - side / 2, y - side / 2, x + side / 2, y + side / 2);
            sum.map(|channel| channel >> shift)
        })
        .collect();
    sum_up(&mut once, corners as usize);
    let prefix = |x: i64, y: i64| match (x, y) {
        (0, _) | (_, 0) => [0; 4],
        _ => once[((y - 1) * corners + x - 1) as usize],
    };
    let texels = i64::from(n);
    let twice = (0..texels * texels)
        .into_par_iter()
        .map(|k| {
            let (x, y) = (k % texels, k / texels);
            let [a, b, c, d] =
                [prefix(x, y), prefix(x + side, y), prefix(x, y + side), prefix(x + side, y + side)];
            std::array::from_fn(|channel| {
                let sum = d[channel].wrapping_sub(b[channel]).wrapping_sub(c[channel]);
                sum.wrapping_add(a[channel]) >> shift
            })
        })
        .collect();
    Sat::from_values(grid.fixed_point(), twice).coarsened(n / coarse)
}
