//! Spherical harmonics of an environment.
//!
//! Real, orthonormal, without the Condon-Shortley phase, in the world's own axes (x, y up, z), in the order
//! L0; L1 by y, z, x; L2 by xy, yz, 3z^2 - 1, zx, x^2 - y^2, which is m = -l..l of the usual formulas. Coefficients
//! are of radiance: c_k is the integral of L * Y_k over the sphere, and L(d) is about the sum of c_k Y_k(d).

use crate::environment::{Environment, Layout, Rgb};
use crate::oracle::SourceTexels;
use crate::sat::Sat;
use crate::sphere::octahedral::{direction_from_oct, texel_centre};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// The nine basis functions at `direction` (unit length).
#[must_use]
pub fn basis(direction: DVec3) -> [f64; 9] {
    let d = direction;
    let outer = DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    from_moments(1.0, d, outer)
}

/// The 25 basis functions up to L4 at `direction` (unit length); the first nine are [`basis`].
#[must_use]
pub fn basis_to_l4(direction: DVec3) -> [f64; 25] {
    let DVec3 { x, y, z } = direction;
    let mut values = [0.0; 25];
    // (x + iy)^m, whose parts are the sines and cosines of the longitude.
    let (mut re, mut im) = (1.0, 0.0);
    // (2m - 1)!!, the derivative of P_m that is a constant.
    let mut lowest = 1.0;
    for m in 0..5_usize {
        // The m-th derivatives of P_l, by the recurrence in l.
        let (mut before, mut derivative) = (0.0, lowest);
        for l in m..5 {
            let factorials = (l - m + 1..=l + m).map(|k| k as f64).product::<f64>();
            let scale = ((2 * l + 1) as f64 / (4.0 * PI * factorials)).sqrt();
            if m == 0 {
                values[l * (l + 1)] = scale * derivative;
            } else {
                let scale = scale * 2.0_f64.sqrt();
                values[l * (l + 1) + m] = scale * derivative * re;
                values[l * (l + 1) - m] = scale * derivative * im;
            }
            let next = ((2 * l + 1) as f64 * z * derivative - (l + m) as f64 * before) / (l + 1 - m) as f64;
            (before, derivative) = (derivative, next);
        }
        (re, im) = (re * x - im * y, re * y + im * x);
        lowest *= (2 * m + 1) as f64;
    }
    values
}

/// Coefficients up to L4 of an OEM's radiance and of 1 (red, green, blue and solid angle), in the OEM's own space, from its
/// table: texels of up to 1/128 in (u, v), each at its centre, which is 5e-5 off at most. Of the constant they say the
/// same as of radiance, so that their quotient is exact.
#[must_use]
pub fn table_harmonics(sat: &Sat) -> [[f64; 4]; 25] {
    let inner = sat.size().inner;
    let grid = sat.coarsened(inner / inner.min(256));
    let n = grid.size().inner;
    let rows: Vec<[[f64; 4]; 25]> = (0..n)
        .into_par_iter()
        .map(|y| {
            let mut sums = [[0.0; 4]; 25];
            for x in 0..n {
                let (left, top) = (i64::from(x), i64::from(y));
                let energy = grid.fixed_point().values(grid.bordered_box(left, top, left + 1, top + 1));
                let basis = basis_to_l4(direction_from_oct(texel_centre(n, x, y)));
                for (sums, basis) in sums.iter_mut().zip(basis) {
                    for (sum, energy) in sums.iter_mut().zip(energy) {
                        *sum += basis * energy;
                    }
                }
            }
            sums
        })
        .collect();
    let mut total = [[0.0; 4]; 25];
    for row in &rows {
        for (total, sums) in total.iter_mut().zip(row) {
            for (total, sum) in total.iter_mut().zip(sums) {
                *total += sum;
            }
        }
    }
    total
}

/// Coefficients of `environment`'s radiance up to L2, red, green and blue.
///
/// The basis functions are polynomials of the direction, so the exact integrals of 1, l and l l^T over each texel are
/// all that it takes.
#[must_use]
pub fn spherical_harmonics(environment: &Environment) -> [[f64; 3]; 9] {
    let moments = match environment.layout() {
        Layout::Panorama { width, .. } => panorama_moments(environment, width as usize),
        _ => block_moments(environment),
    };
    let world_from_source = environment.source_from_world().transpose();
    let mut coefficients = [[0.0; 3]; 9];
    for (channel, Moments { area, first, second }) in moments.into_iter().enumerate() {
        let second = world_from_source * second * world_from_source.transpose();
        for (coefficient, value) in
            coefficients.iter_mut().zip(from_moments(area, world_from_source * first, second))
        {
            coefficient[channel] = value;
        }
    }
    coefficients
}

/// The integrals of one channel's radiance times 1, l and l l^T, in the source's own space.
#[derive(Clone, Copy)]
struct Moments {
    area: f64,
    first: DVec3,
    second: DMat3,
}

impl Moments {
    const ZERO: Self = Self { area: 0.0, first: DVec3::ZERO, second: DMat3::ZERO };
}

/// A panorama's moments: the texels of a row are one block turned by their longitudes, so five sums along the row do.
fn panorama_moments(environment: &Environment, width: usize) -> [Moments; 3] {
    let texels = SourceTexels::new(environment.layout());
    let waves: Vec<[f64; 5]> = (0..width)
        .map(|i| {
            let (sin, cos) = (((i as f64 + 0.5) / width as f64 - 0.5) * TAU).sin_cos();
            [1.0, cos, sin, cos * cos - sin * sin, 2.0 * cos * sin]
        })
        .collect();
    let arch = pulp::Arch::new();
    let rows: Vec<[[f64; 4]; 5]> = environment
        .texels()
        .par_chunks_exact(width)
        .map(|row| arch.dispatch(RowSums { row, waves: &waves }))
        .collect();
    let mut moments = [Moments::ZERO; 3];
    for (sums, block) in rows.iter().zip(texels.blocks()) {
        let (mean, spread) = (block.mean, block.second_moment());
        let (even, odd) =
            ((spread.x_axis.x + spread.z_axis.z) / 2.0, (spread.x_axis.x - spread.z_axis.z) / 2.0);
        for (channel, moments) in moments.iter_mut().enumerate() {
            let [one, cos, sin, cos2, sin2] = sums.map(|sum| sum[channel] * block.solid_angle);
            let (xy, yz, zx) = (spread.x_axis.y * cos, spread.x_axis.y * sin, odd * sin2);
            moments.area += one;
            moments.first += DVec3::new(mean.x * cos, mean.y * one, mean.x * sin);
            moments.second += DMat3::from_cols(
                DVec3::new(even * one + odd * cos2, xy, zx),
                DVec3::new(xy, spread.y_axis.y * one, yz),
                DVec3::new(zx, yz, even * one - odd * cos2),
            );
        }
    }
    moments
}

/// Sums of a row's radiance times each of `waves`; the fourth channel fills the vector.
struct RowSums<'a> {
    row: &'a [Rgb],
    waves: &'a [[f64; 5]],
}

impl pulp::NullaryFnOnce for RowSums<'_> {
    type Output = [[f64; 4]; 5];

    #[inline(always)]
    fn call(self) -> [[f64; 4]; 5] {
        let mut sums = [[0.0; 4]; 5];
        for ([r, g, b], waves) in self.row.iter().zip(self.waves) {
            let radiance = [*r, *g, *b, 0.0].map(f64::from);
            sums = std::array::from_fn(|k| std::array::from_fn(|c| sums[k][c] + waves[k] * radiance[c]));
        }
        sums
    }
}

/// The moments of cubes and octahedral squares, from those of every block.
fn block_moments(environment: &Environment) -> [Moments; 3] {
    let texels = SourceTexels::new(environment.layout());
    // The integrals of 1, l and l l^T over each block, in its own space.
    let blocks: Vec<[f64; 10]> = texels
        .blocks()
        .iter()
        .map(|texel| {
            let (mean, second) = (texel.mean, texel.second_moment());
            let (x, y, z) = (second.x_axis, second.y_axis, second.z_axis);
            [1.0, mean.x, mean.y, mean.z, x.x, y.y, z.z, x.y, y.z, z.x]
                .map(|moment| moment * texel.solid_angle)
        })
        .collect();
    // Moments of the radiance, gathered in each frame's own space.
    let mut gathered = vec![[[0.0; 10]; 3]; texels.frames().len()];
    texels.for_each(|index, block, frame| {
        for (sums, radiance) in gathered[frame].iter_mut().zip(environment.texels()[index]) {
            for (sum, moment) in sums.iter_mut().zip(&blocks[block]) {
                *sum += f64::from(radiance) * moment;
            }
        }
    });
    let mut moments = [Moments::ZERO; 3];
    for (frame, gathered) in texels.frames().iter().zip(&gathered) {
        for (moments, sums) in moments.iter_mut().zip(gathered) {
            let [one, x, y, z, xx, yy, zz, xy, yz, zx] = *sums;
            let source_from_block = frame.transpose();
            let own =
                DMat3::from_cols(DVec3::new(xx, xy, zx), DVec3::new(xy, yy, yz), DVec3::new(zx, yz, zz));
            moments.area += one;
            moments.first += source_from_block * DVec3::new(x, y, z);
            moments.second += source_from_block * own * source_from_block.transpose();
        }
    }
    moments
}

/// The integrals of the nine basis functions, from those of 1, l and l l^T.
fn from_moments(area: f64, first: DVec3, second: DMat3) -> [f64; 9] {
    let linear = (3.0 / (4.0 * PI)).sqrt();
    let quadratic = (15.0 / (4.0 * PI)).sqrt();
    [
        area / (4.0 * PI).sqrt(),
        linear * first.y,
        linear * first.z,
        linear * first.x,
        quadratic * second.y_axis.x,
        quadratic * second.z_axis.y,
        (5.0 / (16.0 * PI)).sqrt() * (3.0 * second.z_axis.z - area),
        quadratic * second.x_axis.z,
        quadratic / 2.0 * (second.x_axis.x - second.y_axis.y),
    ]
}
