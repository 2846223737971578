//! Spherical harmonics of an environment, up to L4.
//!
//! Real, orthonormal, without the Condon-Shortley phase, in the world's own axes (x, y up, z), in the order
//! L0; L1 by y, z, x; L2 by xy, yz, 3z^2 - 1, zx, x^2 - y^2; and so on, m = -l..l of the usual formulas,
//! whose pole is z: L_lm is at l^2 + l + m. Coefficients are of radiance: c_k is the integral of L * Y_k over
//! the sphere, and L(d) is about the sum of c_k Y_k(d).

use crate::common::error::{Result, wrong};
use crate::common::parallel;
use crate::geometry::exact::{ExactTexels, outer};
use crate::light::environment::{Environment, Layout, Rgb};
use crate::sphere::quadrature::gauss_legendre;
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// The highest supported band.
pub const MAX_ORDER: u32 = 4;

/// Number of functions up to [`MAX_ORDER`].
pub const MAX_COUNT: usize = count(MAX_ORDER);

/// The polynomials of the functions, without their factors.
const POLYNOMIALS: [&str; MAX_COUNT] = [
    "1",
    "y",
    "z",
    "x",
    "xy",
    "yz",
    "3zz-1",
    "xz",
    "xx-yy",
    "y(3xx-yy)",
    "xyz",
    "y(5zz-1)",
    "z(5zz-3)",
    "x(5zz-1)",
    "z(xx-yy)",
    "x(xx-3yy)",
    "xy(xx-yy)",
    "yz(3xx-yy)",
    "xy(7zz-1)",
    "yz(7zz-3)",
    "35zzzz-30zz+3",
    "xz(7zz-3)",
    "(xx-yy)(7zz-1)",
    "xz(xx-3yy)",
    "xxxx-6xxyy+yyyy",
];

/// Number of functions up to band `order`.
pub const fn count(order: u32) -> usize {
    ((order + 1) * (order + 1)) as usize
}

/// Band of the function at `index`.
pub const fn band(index: usize) -> usize {
    index.isqrt()
}

/// Name of the function at `index`: `L2-1`.
#[must_use]
pub fn name(index: usize) -> String {
    let l = band(index);
    format!("L{l}{}", index as i64 - (l * l + l) as i64)
}

/// Describes the order of the first `count` coefficients.
pub(crate) fn order_text(count: usize) -> String {
    let entry = |(index, polynomial): (usize, &&str)| match index {
        0 => name(0),
        _ => format!("{} ({polynomial})", name(index)),
    };
    POLYNOMIALS[..count].iter().enumerate().map(entry).collect::<Vec<_>>().join(", ")
}

/// The basis functions at `direction` (unit length).
pub fn basis(direction: DVec3) -> [f64; MAX_COUNT] {
    let d = direction;
    let mut all = [0.0; MAX_COUNT];
    all[..9].copy_from_slice(&from_moments(1.0, d, outer(d)));
    let DVec3 { x, y, z } = d;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let factor = |numerator: f64, denominator: f64| (numerator / (denominator * PI)).sqrt();
    let (tesseral, third) = (factor(35.0, 32.0), factor(21.0, 32.0));
    let (sectoral, fourth) = (factor(315.0, 32.0), factor(45.0, 32.0));
    all[9..].copy_from_slice(&[
        tesseral * y * (3.0 * xx - yy),
        factor(105.0, 4.0) * x * y * z,
        third * y * (5.0 * zz - 1.0),
        factor(7.0, 16.0) * z * (5.0 * zz - 3.0),
        third * x * (5.0 * zz - 1.0),
        factor(105.0, 16.0) * z * (xx - yy),
        tesseral * x * (xx - 3.0 * yy),
        factor(315.0, 16.0) * x * y * (xx - yy),
        sectoral * y * z * (3.0 * xx - yy),
        factor(45.0, 16.0) * x * y * (7.0 * zz - 1.0),
        fourth * y * z * (7.0 * zz - 3.0),
        factor(9.0, 256.0) * (35.0 * zz * zz - 30.0 * zz + 3.0),
        fourth * x * z * (7.0 * zz - 3.0),
        factor(45.0, 64.0) * (xx - yy) * (7.0 * zz - 1.0),
        sectoral * x * z * (xx - 3.0 * yy),
        factor(315.0, 256.0) * (xx * xx - 6.0 * xx * yy + yy * yy),
    ]);
    all
}

/// Coefficients of `environment`'s radiance up to band `order`, red, green and blue.
///
/// The basis functions are integrated over each texel to rounding; up to L2 the integrals follow from the
/// exact moments of the direction.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if `order` is above [`MAX_ORDER`].
pub fn spherical_harmonics(environment: &Environment, order: u32) -> Result<Vec<[f64; 3]>> {
    if order > MAX_ORDER {
        return wrong(format!("`order` is {order}; it must be 0 to {MAX_ORDER}"));
    }
    let texels = ExactTexels::new(environment.layout());
    let coefficients = match (environment.layout(), order) {
        (Layout::Panorama { width, .. }, 0..=2) => panorama::<5>(environment, &texels, width as usize, order),
        (Layout::Panorama { width, .. }, _) => panorama::<9>(environment, &texels, width as usize, order),
        _ => blocks(environment, &texels, order),
    };
    Ok(turned(&coefficients, environment.source_from_world()))
}

type Coefficients = Vec<[f64; 3]>;

/// Coefficients of a panorama. The texels of a row are one block rotated by their longitudes, so a few sums
/// along the row suffice. Rotations about y are simple with y as the pole: exchange y and z before and after.
fn panorama<const WAVES: usize>(
    environment: &Environment,
    texels: &ExactTexels,
    width: usize,
    order: u32,
) -> Coefficients {
    let pole_from_up = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y);
    let waves: Vec<[f64; WAVES]> = (0..width)
        .map(|i| {
            let longitude = ((i as f64 + 0.5) / width as f64 - 0.5) * TAU;
            // 1, cos, sin, cos 2, sin 2, ...
            std::array::from_fn(|k| {
                let (sin, cos) = (k.div_ceil(2) as f64 * longitude).sin_cos();
                if k > 0 && k % 2 == 0 { sin } else { cos }
            })
        })
        .collect();
    let arch = crate::common::vector::Arch::new();
    let rows = environment.texels().chunks_exact(width);
    let rows = parallel::map(rows, |row| arch.dispatch(RowSums { row, waves: &waves }));
    let mut coefficients = vec![[0.0; 3]; count(order)];
    for (block, sums) in rows.iter().enumerate() {
        let integrals = block_integrals(texels, block, pole_from_up, order);
        for (index, coefficient) in coefficients.iter_mut().enumerate() {
            let l = band(index);
            let m = index as i64 - (l * l + l) as i64;
            // The block is symmetric about longitude 0: only its cosines contribute.
            let own = integrals[l * l + l + m.unsigned_abs() as usize];
            let wave = if m < 0 { 2 * m.unsigned_abs() as usize } else { (2 * m as usize).saturating_sub(1) };
            for (value, sum) in coefficient.iter_mut().zip(sums[wave]) {
                *value += own * sum;
            }
        }
    }
    turned(&coefficients, pole_from_up)
}

/// Sums of a row's radiance times each of `waves`; the fourth channel fills the vector.
struct RowSums<'a, const WAVES: usize> {
    row: &'a [Rgb],
    waves: &'a [[f64; WAVES]],
}

impl<const WAVES: usize> pulp::NullaryFnOnce for RowSums<'_, WAVES> {
    type Output = [[f64; 4]; WAVES];

    #[inline(always)]
    fn call(self) -> [[f64; 4]; WAVES] {
        let mut sums = [[0.0; 4]; WAVES];
        for ([r, g, b], waves) in self.row.iter().zip(self.waves) {
            let radiance = [*r, *g, *b, 0.0].map(f64::from);
            sums = std::array::from_fn(|k| std::array::from_fn(|c| sums[k][c] + waves[k] * radiance[c]));
        }
        sums
    }
}

/// Coefficients of cubes and octahedral squares, accumulated in each frame's space from the integrals over
/// every block.
fn blocks(environment: &Environment, texels: &ExactTexels, order: u32) -> Coefficients {
    let indices = 0..texels.blocks().len();
    let integrals = parallel::map(indices, |block| block_integrals(texels, block, DMat3::IDENTITY, order));
    let mut gathered = vec![vec![[0.0; 3]; count(order)]; texels.frames().len()];
    texels.for_each(|index, block, frame| {
        let radiance = environment.texels()[index].map(f64::from);
        for (sum, integral) in gathered[frame].iter_mut().zip(&integrals[block]) {
            (0..3).for_each(|c| sum[c] += radiance[c] * integral);
        }
    });
    let mut coefficients = vec![[0.0; 3]; count(order)];
    for (gathered, block_from_source) in gathered.iter().zip(texels.frames()) {
        for (sum, part) in coefficients.iter_mut().zip(turned(gathered, *block_from_source)) {
            (0..3).for_each(|c| sum[c] += part[c]);
        }
    }
    coefficients
}

/// Integrals of the basis functions over a block, with its directions transformed by `map`.
fn block_integrals(texels: &ExactTexels, block: usize, map: DMat3, order: u32) -> [f64; MAX_COUNT] {
    let texel = &texels.blocks()[block];
    let mut integrals = [0.0; MAX_COUNT];
    if order <= 2 {
        let second = map * texel.second_moment() * map.transpose();
        integrals[..9].copy_from_slice(&from_moments(1.0, map * texel.mean, second));
        return integrals.map(|mean| mean * texel.solid_angle);
    }
    let mut area = 0.0;
    texels.for_each_sample(block, &mut |direction, weight| {
        area += weight;
        for (sum, value) in integrals.iter_mut().zip(basis(map * direction)) {
            *sum += weight * value;
        }
    });
    integrals.map(|sum| sum / area * texel.solid_angle)
}

/// Coefficients of d -> f(`map` d) for f with `coefficients`; `map` is a rotation, a reflection or both.
fn turned(coefficients: &[[f64; 3]], map: DMat3) -> Coefficients {
    if map == DMat3::IDENTITY {
        return coefficients.to_vec();
    }
    let mut result = vec![[0.0; 3]; coefficients.len()];
    // Products of two of the functions have degree 8: exact by five nodes in z and nine around it.
    let around = 9;
    for (node, weight) in gauss_legendre(5) {
        let z = 2.0 * node - 1.0;
        let weight = 2.0 * weight * TAU / f64::from(around);
        for k in 0..around {
            let (sin, cos) = (f64::from(k) / f64::from(around) * TAU).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            let direction = DVec3::new(radius * cos, radius * sin, z);
            let (here, there) = (basis(direction), basis(map * direction));
            // A rotation does not mix bands.
            for l in 0..=band(coefficients.len() - 1) {
                let own = l * l..(l + 1) * (l + 1);
                for c in 0..3 {
                    let value: f64 = own.clone().map(|j| coefficients[j][c] * there[j]).sum();
                    own.clone().for_each(|k| result[k][c] += weight * value * here[k]);
                }
            }
        }
    }
    result
}

/// The integrals of the functions up to L2, from those of 1, l and l l^T.
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
