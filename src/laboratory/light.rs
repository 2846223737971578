//! The light that tables are filled from.

use crate::analysis::delivered::even_directions;
use crate::environment::{Environment, Layout, Rgb};
use crate::error::{Error, Result};
use crate::sphere::cube::{Face, direction_from_cube};
use crate::sphere::grid::Grid;
use crate::sphere::registry::named;
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Texels of a source and its orientation.
#[derive(Clone, Copy, Debug)]
pub struct Light<'a> {
    /// The source's texels.
    pub grid: Grid,
    /// Their radiance.
    pub texels: &'a [Rgb],
    /// Turns the source into the space of the tables.
    pub world_from_source: DMat3,
}

impl<'a> Light<'a> {
    /// The light of `environment`, turned by `turn`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a panorama that is not 2:1.
    pub fn new(environment: &'a Environment, turn: DMat3) -> Result<Self> {
        let (name, size) = match environment.layout() {
            Layout::Panorama { width, height } if width == 2 * height => ("equirect", height),
            Layout::Panorama { width, height } => {
                return Err(Error::Parameter(format!(
                    "a panorama of {width}x{height}; tables are filled from panoramas of 2:1"
                )));
            }
            Layout::Cube { size } => ("cube", size),
            Layout::Octahedral { size } => ("octahedral", size),
        };
        let grid = Grid::new(named(name).expect("a map of the registry").map, size)?;
        let world_from_source = turn * environment.source_from_world().transpose();
        Ok(Self { grid, texels: environment.texels(), world_from_source })
    }

    /// The same, turned by `turn` as well.
    #[must_use]
    pub fn turned(&self, turn: DMat3) -> Self {
        Self { world_from_source: turn * self.world_from_source, ..*self }
    }

    /// Radiance along `direction`.
    #[must_use]
    pub fn look(&self, direction: DVec3) -> Rgb {
        let local = self.world_from_source.transpose() * direction;
        self.texels[self.grid.index(self.grid.texel_from_direction(local))]
    }
}

/// Number of lamps of [`lamps`].
const LAMPS: usize = 400;

/// Cosine of a lamp's radius, 1.6 degrees.
const LAMP_COSINE: f64 = 0.9996;

/// A cube of `size` x `size` texels a face: 400 round lamps, evenly spread over the sphere, of 1 to 100 times
/// the radiance of each other, over a dim ground. Every region of the sphere has the same light on average,
/// so that differences between regions are those of the map.
///
/// # Errors
/// [`Error::Parameter`] for no texels.
pub fn lamps(size: u32) -> Result<Environment> {
    let lamps: Vec<(DVec3, f64)> = (0..)
        .zip(even_directions(LAMPS))
        .map(|(k, direction)| {
            // The fractional parts of multiples of sqrt(2) are even and independent of the place.
            (direction, 100_f64.powf((f64::from(k) * std::f64::consts::SQRT_2).fract()))
        })
        .collect();
    let radiance = |direction: DVec3| {
        let lit = lamps.iter().filter(|(lamp, _)| lamp.dot(direction) > LAMP_COSINE);
        lit.fold(0.1, |sum, (_, strength)| sum + strength)
    };
    let texel = |index: u32| {
        let (face, j, i) = (index / (size * size), index / size % size, index % size);
        let at = |k: u32, share: u32| {
            2.0 * (f64::from(k) + (f64::from(share) + 0.5) / 4.0) / f64::from(size) - 1.0
        };
        let sum: f64 = (0..16)
            .map(|k| radiance(direction_from_cube(Face::ALL[face as usize], at(i, k % 4), at(j, k / 4))))
            .sum();
        [(sum / 16.0) as f32; 3]
    };
    let texels = (0..6 * size * size).into_par_iter().map(texel).collect();
    Environment::new(Layout::Cube { size }, texels)
}
