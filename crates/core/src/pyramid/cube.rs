//! Pyramids as cube maps, for engines that sample cubes and have no bordered squares.
//!
//! One cube holds them all: MIP level 0 has the mirror, then come the Gaussians from fine to coarse, each
//! twice as wide as the one before. A texel is 1 / 1.4 of its Gaussian's standard deviation in the middle of
//! a face, and less than half of that at a corner. Harmonics to order 4 stand for the cosine level.

use super::Pyramid;
use super::levels::{Between, Map, Place, Taps, scale};
use super::sharp::Texels;
use crate::common::parallel;
use crate::light::chain_lookup::LevelLookup;
use crate::light::environment::Rgb;
use crate::sphere::cube::{Face, direction_from_texel};
use glam::Vec3A;

/// A level's standard deviation over that of the square that it is made of, at least.
const FINER: f64 = 1.4;

impl Map {
    /// The cube whose faces of `inner` x `inner` have `texels`, which continue across edges as in every
    /// graphics API: at a corner, where three texels meet, the fourth is their mean.
    pub(crate) fn of_cube(inner: u32, texels: &[Vec3A]) -> Self {
        let (last, side) = (inner as usize, inner as usize + 2);
        let lookup = LevelLookup::new(inner);
        let bordered = |k: usize| {
            let (face, x, y) = (Face::ALL[k / (side * side)], k % side, k / side % side);
            let of = |x: usize, y: usize| lookup.texel(face, x, y).map(|k| texels[k as usize]);
            let (inside_x, inside_y) = (x.clamp(1, last), y.clamp(1, last));
            let own = of(x, y).unwrap_or_else(|| {
                let three = [of(inside_x, inside_y), of(x, inside_y), of(inside_x, y)];
                three.into_iter().flatten().sum::<Vec3A>() / 3.0
            });
            own.extend(0.0).to_array()
        };
        let texels = parallel::values(6 * side * side, bordered);
        Self { inner, is_cube: true, texels }
    }

    /// The texels of a cube, face by face, without borders.
    pub(crate) fn faces(&self) -> Vec<Rgb> {
        let (inner, side) = (self.inner as usize, self.inner as usize + 2);
        let faces = self.texels.chunks_exact(side * side);
        let rows = faces.flat_map(|face| face.chunks_exact(side).skip(1).take(inner));
        rows.flat_map(|row| row[1..=inner].iter().map(|[r, g, b, _]| [*r, *g, *b])).collect()
    }
}

impl Pyramid {
    /// The same pyramid on cubes, as files of `--map cube` hold it; one of such a file stays as it is.
    #[must_use]
    pub fn on_cubes(&self) -> Self {
        if self.cosine.is_none() {
            return self.clone();
        }
        let (squares, levels) = (self.levels, self.levels.on_cubes());
        let cube = |map: u32| {
            let (size, width) = (levels.inner() >> map, levels.width(map));
            let each = |texel: &(dyn Fn(Face, u32, u32) -> Vec3A + Sync)| -> Vec<Vec3A> {
                let area = size * size;
                parallel::values(6 * area as usize, |k| {
                    let k = k as u32;
                    texel(Face::ALL[(k / area) as usize], k % size, k / size % size)
                })
            };
            let texels = match map {
                0 => each(&|face, x, y| self.maps[0].around(direction_from_texel(face, size, x, y))),
                1 => {
                    let texels = Texels::new(&self.maps[0], self.suns.clamp * scale(self.exponent));
                    each(&|face, x, y| texels.under(Place::on_cube(size, face, x, y, width * width), width))
                }
                _ => {
                    let is_finer = |own: &u32| squares.width(*own) < width / FINER;
                    let finer = (1..squares.count()).rev().find(is_finer).unwrap_or(1);
                    let Between { variance, bend } = Between::new(width, squares.width(finer));
                    let taps = Taps::new(bend);
                    let finer = &self.maps[finer as usize];
                    each(&|face, x, y| {
                        let [own, ..] = taps.mirrored(finer, &Place::on_cube(size, face, x, y, variance));
                        own
                    })
                }
            };
            Map::of_cube(size, &texels)
        };
        let maps = (0..levels.count()).map(cube).collect();
        Self { levels, maps, cosine: None, ..*self }
    }
}
