//! Conversion of environments, and of pictures of any map, to the texels of another map.
//!
//! Between panoramas, cubes and octahedral squares by the exact overlaps of the bake, else by
//! [`resample()`]. Both correct the total of every channel; for the former, curved texels change it by up to
//! 1e-5, and one factor is enough.

use super::energy::energy;
use super::footprints::footprints_over;
use super::light::Light;
use super::overlap;
use super::resample::{self, resample};
use crate::common::error::Result;
use crate::light::environment::{Environment, Layout, Rgb};
use crate::sphere::grid::Grid;
use crate::sphere::registry::NamedMap;
use glam::DMat3;

/// Light to be converted.
#[derive(Clone, Debug)]
pub struct Source {
    grid: Grid,
    texels: Texels,
    world_from_source: DMat3,
}

#[derive(Clone, Debug)]
enum Texels {
    /// An environment, whose overlaps are exact.
    Environment(Environment),
    /// Texels of another map, in its order.
    Map(Vec<Rgb>),
}

impl Source {
    /// The source `environment`.
    ///
    /// # Errors
    /// As [`Light::new`].
    pub fn from_environment(environment: Environment) -> Result<Self> {
        let Light { grid, world_from_source, .. } = Light::new(&environment, DMat3::IDENTITY)?;
        Ok(Self { grid, texels: Texels::Environment(environment), world_from_source })
    }

    /// The source of `texels`, numbered as in `grid`.
    ///
    /// # Panics
    /// If there are not as many.
    #[must_use]
    pub fn from_texels(grid: Grid, texels: Vec<Rgb>, world_from_source: DMat3) -> Self {
        assert_eq!(texels.len(), grid.texel_count(), "the texels of a grid");
        Self { grid, texels: Texels::Map(texels), world_from_source }
    }

    /// The source's map and size.
    #[must_use]
    pub const fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The source's light.
    #[must_use]
    pub fn light(&self) -> Light<'_> {
        let texels = match &self.texels {
            Texels::Environment(environment) => environment.texels(),
            Texels::Map(texels) => texels,
        };
        Light { grid: self.grid, texels, world_from_source: self.world_from_source }
    }

    /// Mean radiance over every texel of `map` with `size` texels along the shorter side of a component.
    ///
    /// # Errors
    /// As [`Grid::new`] and [`footprints_over`].
    pub fn converted(&self, map: &NamedMap, size: u32) -> Result<Vec<Rgb>> {
        if let Some((environment, layout)) = self.exact(map, size) {
            let mut means = footprints_over(environment, layout)?;
            let sent = energy(environment.layout(), environment.texels());
            let held = energy(layout, &means);
            let scale: [f64; 3] =
                std::array::from_fn(|c| if held[c] > 0.0 { sent[c] / held[c] } else { 1.0 });
            for mean in &mut means {
                // A factor near 1 may round the greatest numbers to infinity.
                *mean = std::array::from_fn(|c| ((f64::from(mean[c]) * scale[c]) as f32).min(f32::MAX));
            }
            return Ok(means);
        }
        Ok(resample(&self.light(), &Grid::new(map.map, size)?))
    }

    /// The source and the layout that `map` of `size` is, if the overlaps of both are exact.
    fn exact(&self, map: &NamedMap, size: u32) -> Option<(&Environment, Layout)> {
        let Texels::Environment(environment) = &self.texels else { return None };
        let layout = match map.name {
            "octahedral" => Layout::Octahedral { size },
            "cube" => Layout::Cube { size },
            "equirect" => Layout::Panorama { width: 2 * size, height: size },
            _ => return None,
        };
        Some((environment, layout))
    }

    /// The most bytes that [`Source::converted`] takes, its result included.
    #[must_use]
    pub(crate) fn most_bytes(&self, map: &NamedMap, target: &Grid) -> u64 {
        match self.exact(map, target.size()) {
            Some((environment, layout)) => {
                overlap::most_bytes(environment.layout(), layout, self.world_from_source)
            }
            None => resample::most_bytes(&self.grid, target),
        }
    }
}
