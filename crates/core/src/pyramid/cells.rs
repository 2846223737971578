//! Moments of the light in square cells, for what is smooth over the whole sphere: irradiance and harmonics.
//!
//! max(0, n.l) is linear on either side of the horizon: moments give irradiance exactly, up to cells that the
//! horizon crosses.

use super::levels::{self, Map};
use super::suns;
use crate::common::parallel;
use crate::common::vector::{Arch, Extremes as _, Fused as _};
use crate::light::oem::Oem;
use crate::light::sh::basis;
use crate::sphere::octahedral::{direction_from_oct, texel_centre};
use glam::{DVec3, Vec3A};
use std::f32::consts::FRAC_1_PI;

/// Functions of the basis of harmonics to order 4.
pub const BASIS: usize = 25;

/// Cells along an edge of the finest grid.
pub const FINEST: u32 = 64;

/// The light of a cell, by channel: the sums of energy times x, y and z of its direction, and of energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Cell {
    moments: [Vec3A; 3],
    energy: Vec3A,
}

/// The cells of a map.
#[derive(Debug)]
pub struct Cells {
    cells: Vec<Cell>,
}

impl Cells {
    /// Cells of `oem` clamped to `clamp`, with light times 2^-`exponent`.
    pub(crate) fn new(oem: &Oem, clamp: f32, exponent: i32) -> Self {
        let inner = oem.size().inner;
        let side = inner.min(FINEST);
        let block = inner / side;
        let scale = levels::scale(exponent);
        let cell = |k: usize| {
            let k = k as u32;
            let mut cell = Cell::default();
            for texel in 0..block * block {
                let (x, y) = (k % side * block + texel % block, k / side * block + texel / block);
                let direction = direction_from_oct(texel_centre(inner, x, y)).as_vec3a();
                let [r, g, b, w] = oem.texel(x, y);
                let kept = scale * suns::kept(r.max(g).max(b) / w, clamp);
                let energy = kept * Vec3A::new(r, g, b);
                for (moment, along) in cell.moments.iter_mut().zip(direction.to_array()) {
                    *moment += along * energy;
                }
                cell.energy += energy;
            }
            cell
        };
        Self { cells: parallel::values((side * side) as usize, cell) }
    }

    /// Irradiance over pi, in a map of `size` texels along an edge.
    pub(crate) fn cosine(&self, size: u32) -> Map {
        let (groups, _) = self.cells.as_chunks::<LANES>();
        let lanes: Vec<Lanes> = groups.iter().map(Lanes::new).collect();
        let arch = Arch::new();
        Map::new(size, |x, y| {
            let normal = direction_from_oct(texel_centre(size, x, y)).as_vec3().to_array();
            arch.dispatch(Facing { cells: &lanes, normal }) * FRAC_1_PI
        })
    }

    /// Harmonics to order 4, the light of a cell in its mean direction.
    pub(crate) fn harmonics(&self) -> [Vec3A; BASIS] {
        let mut sums = [Vec3A::ZERO; BASIS];
        for cell in &self.cells {
            let mean = DVec3::from_array(cell.moments.map(|moment| f64::from(moment.element_sum())));
            if mean != DVec3::ZERO {
                for (sum, basis) in sums.iter_mut().zip(basis(mean.normalize())) {
                    *sum += cell.energy * basis as f32;
                }
            }
        }
        sums
    }
}

/// Cells that are summed side by side; grids have a multiple of them.
const LANES: usize = 16;

/// The moments of cells, by channel and axis.
struct Lanes([[[f32; LANES]; 3]; 3]);

impl Lanes {
    fn new(cells: &[Cell; LANES]) -> Self {
        Self(std::array::from_fn(|channel| {
            std::array::from_fn(|axis| std::array::from_fn(|k| cells[k].moments[axis][channel]))
        }))
    }
}

/// The light that a surface with `normal` gets from `cells`.
struct Facing<'a> {
    cells: &'a [Lanes],
    normal: [f32; 3],
}

impl pulp::NullaryFnOnce for Facing<'_> {
    type Output = Vec3A;

    #[inline(always)]
    fn call(self) -> Vec3A {
        let [nx, ny, nz] = self.normal;
        let mut sums = [[0.0; LANES]; 3];
        for Lanes(channels) in self.cells {
            for (sums, [x, y, z]) in sums.iter_mut().zip(channels) {
                for k in 0..LANES {
                    let light = nx.times_plus(x[k], ny.times_plus(y[k], nz * z[k]));
                    sums[k] += light.at_least(0.0);
                }
            }
        }
        sums.map(|lanes| lanes.iter().sum()).into()
    }
}
