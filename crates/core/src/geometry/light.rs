//! Radiance over the texels of a map, turned into the world.

use crate::common::error::{Result, wrong};
use crate::light::environment::{Environment, Layout, Rgb};
use crate::sphere::grid::Grid;
use crate::sphere::registry::named;
use glam::DMat3;

/// Texels of a map and its orientation.
#[derive(Clone, Copy, Debug)]
pub struct Light<'a> {
    /// The map.
    pub grid: Grid,
    /// Radiance of its texels.
    pub texels: &'a [Rgb],
    /// Turns the map into the world.
    pub world_from_source: DMat3,
}

impl<'a> Light<'a> {
    /// The light of `environment`, turned by `turn`.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a panorama that is not 2:1.
    pub fn new(environment: &'a Environment, turn: DMat3) -> Result<Self> {
        let (name, size) = match environment.layout() {
            Layout::Panorama { width, height } if width == 2 * height => ("equirect", height),
            Layout::Panorama { width, height } => {
                return wrong(format!(
                    "a panorama of {width}x{height}; its texels fit other maps only at 2:1"
                ));
            }
            Layout::Cube { size } => ("cube", size),
            Layout::Octahedral { size } => ("octahedral", size),
        };
        let grid = Grid::new(named(name).expect("a map of the registry").map, size)?;
        let world_from_source = turn * environment.source_from_world().transpose();
        Ok(Self { grid, texels: environment.texels(), world_from_source })
    }

    /// This light, also rotated by `turn`.
    pub fn turned(&self, turn: DMat3) -> Self {
        Self { world_from_source: turn * self.world_from_source, ..*self }
    }
}
