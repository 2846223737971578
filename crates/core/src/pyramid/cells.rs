//! Moments of the light in square cells, for what is smooth over the whole sphere: irradiance and harmonics.
//!
//! max(0, n.l) is linear on either side of the horizon: moments give irradiance exactly, up to cells that the
//! horizon crosses. What a white world loses there is added in the mean over normals.

use super::levels::{self, Map};
use super::suns;
use crate::common::parallel;
use crate::common::vector::{Arch, Extremes as _, Fused as _};
use crate::light::oem::Oem;
use crate::light::sh::basis;
use crate::sphere::octahedral::{direction_from_oct, texel_centre};
use glam::{DVec2, DVec3, Vec3A};
use std::f32::consts::FRAC_1_PI;

/// Functions of the basis of harmonics to order 4.
pub const BASIS: usize = 25;

/// Cells along an edge of the finest grid.
pub const FINEST: u32 = 64;

/// What a white world's irradiance loses in cells that the horizon crosses: the mean over normals, over the
/// area of a cell less that of a texel, as shares of the map's square. It is 1.33 to 1.35 for grids of 16 to
/// 64 cells of 2 to 16 texels along an edge.
const HORIZON_LOSS: f32 = 1.345;

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
    /// Cells along an edge, and texels along an edge of each.
    side: u32,
    block: u32,
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
        Self { cells: parallel::values((side * side) as usize, cell), side, block }
    }

    /// Irradiance over pi, in a map of `size` texels along an edge.
    pub(crate) fn cosine(&self, size: u32) -> Map {
        let (groups, _) = self.cells.as_chunks::<LANES>();
        let lanes: Vec<Lanes> = groups.iter().map(Lanes::new).collect();
        let arch = Arch::new();
        let [cell, texel] = [self.side, self.side * self.block].map(|edge| (edge as f32).powi(-2));
        let share = FRAC_1_PI * (1.0 + HORIZON_LOSS * (cell - texel));
        Map::new(size, |x, y| {
            let normal = direction_from_oct(texel_centre(size, x, y)).as_vec3().to_array();
            arch.dispatch(Facing { cells: &lanes, normal }) * share
        })
    }

    /// Harmonics to order 4: those of the light of a cell in its mean direction, and what even light over the
    /// cell has beside that, so that a white world has none but the first.
    pub(crate) fn harmonics(&self) -> [Vec3A; BASIS] {
        let mut sums = [Vec3A::ZERO; BASIS];
        for (k, cell) in (0..).zip(&self.cells) {
            let mean = DVec3::from_array(cell.moments.map(|moment| f64::from(moment.element_sum())));
            if mean != DVec3::ZERO {
                let (own, spread) = (basis(mean.normalize()), self.spread(k));
                for (sum, basis) in sums.iter_mut().zip(own.into_iter().zip(spread)) {
                    *sum += cell.energy * (basis.0 + basis.1) as f32;
                }
            }
        }
        sums
    }

    /// The mean of the basis over cell `k` less what it is in the mean direction of its texels' centres.
    fn spread(&self, k: u32) -> [f64; BASIS] {
        let centre = texel_centre(self.side, k % self.side, k / self.side);
        // Gauss's points, and points that have the second moments of texels' centres.
        let gauss = 1.0 / (3.0_f64.sqrt() * f64::from(self.side));
        let centres = gauss * (1.0 - 1.0 / f64::from(self.block * self.block)).sqrt();
        let points = |offset: f64| {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
            corners.map(|(x, y)| sized_direction_from_oct(centre + offset * DVec2::new(x, y)))
        };
        let mean: DVec3 = points(centres).map(|(direction, size)| direction * size).into_iter().sum();
        let even = points(gauss);
        let all: f64 = even.iter().map(|(_, size)| size).sum();
        let mut spread = basis(mean.normalize()).map(|own| -own);
        for (direction, size) in even {
            spread.iter_mut().zip(basis(direction)).for_each(|(sum, own)| *sum += size / all * own);
        }
        spread
    }
}

/// The direction at a place of the square, and the solid angle there, over that of the square's middle.
fn sized_direction_from_oct(uv: DVec2) -> (DVec3, f64) {
    let direction = direction_from_oct(uv);
    // The octahedron's faces are flat, as far from the middle as directions are long there.
    (direction, direction.abs().element_sum().powi(3))
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

#[cfg(test)]
mod tests {
    use crate::light::environment::{Environment, Layout};
    use crate::pyramid::Pyramid;

    #[test]
    fn white_worlds_have_the_first_harmonic_only_and_even_irradiance() {
        let layout = Layout::Octahedral { size: 64 };
        let texels = vec![[1.0; 3]; layout.texel_count()];
        let white = Environment::new(layout, texels).expect("a world");
        for size in [32, 64, 128, 512] {
            let pyramid = Pyramid::build(&white, size).expect("a size");
            let [first, others @ ..] = pyramid.harmonics();
            let most = others.iter().map(|other| other.abs().max_element()).fold(0.0, f32::max);
            assert!(most < 2e-4 * first.x, "{size}: {most} beside {first}");
            // Every normal loses between nothing and twice the mean.
            let loss = super::HORIZON_LOSS / (size.min(super::FINEST) as f32).powi(2);
            let scale = pyramid.unscaled(glam::Vec3A::ONE).x;
            let cosine = pyramid.cosine().expect("a square map").with_border(0);
            let off: Vec<f32> = cosine.iter().map(|own| scale * own[0] - 1.0).collect();
            let most = off.iter().fold(0.0, |most: f32, off| most.max(off.abs()));
            assert!(most < 1.1 * loss, "{size}: {most}, where {loss} was added");
            let mean = off.iter().sum::<f32>() / off.len() as f32;
            assert!(mean.abs() < 0.1 * loss, "{size}: {mean}, where {loss} was added");
        }
    }
}
