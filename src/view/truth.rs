//! The certified tier for the pixels of a picture: shown by the adaptive filter, and the reference for
//! others.

use crate::environment::Environment;
use crate::error::Result;
use crate::filter::Filter;
use crate::lobe::Lobe;
use crate::reflector::{Reflector, ReflectorSettings, Workspace};
use crate::table_bytes::{LIMIT, LobeRequest};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Query of a pixel: world direction and roughness.
pub(super) type PixelQuery = [f32; 4];

/// Edge of the pixel tiles that share traversals of the cells.
const TILE: usize = 4;

/// An environment prepared for the certified tier.
#[derive(Debug)]
pub struct Truth {
    reflector: Reflector<'static>,
}

impl Truth {
    /// Prepares lobes over `environment`, in its own space. Uses the default map size, or the largest size at
    /// which the cells of all lobes fit in memory together with the source.
    ///
    /// # Errors
    /// Those of [`Reflector::new`].
    pub fn new(environment: &Environment) -> Result<Self> {
        // Sharp lobes read bilinear cells, wide ones constant ones.
        let served = |roughness| LobeRequest { lobe: Lobe::Ggx, roughness, filter: Filter::Adaptive(1e-3) };
        let all = [served(1e-3), served(1.0)];
        let (layout, default) = (environment.layout(), ReflectorSettings::default());
        let (size, _) = default.plan(layout)?;
        let inner = default.largest_oem(layout, &all, LIMIT).map(|largest| largest.min(size.inner));
        let settings = ReflectorSettings { oem_size: inner, ..default };
        let reflector = Reflector::owning(environment.clone(), &settings)?;
        Ok(Self { reflector })
    }

    /// Radiance for each query of a picture in rows of `width`, to a relRMSE of `error`; `source_from_world`
    /// rotates the directions.
    ///
    /// # Errors
    /// Those of [`Reflector::lobes`].
    pub(super) fn answers(
        &self,
        asked: &[PixelQuery],
        width: usize,
        source_from_world: DMat3,
        error: f64,
    ) -> Result<Vec<[f32; 4]>> {
        // Group the queries by roughness, with neighbouring pixels adjacent.
        let mut alike: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (index, [.., roughness]) in asked.iter().enumerate() {
            alike.entry(roughness.to_bits()).or_default().push(index);
        }
        let mut answers = vec![[0.0, 0.0, 0.0, 1.0]; asked.len()];
        for (roughness, mut pixels) in alike {
            pixels.sort_by_key(|index| {
                let (x, y) = (index % width, index / width);
                (y / TILE, x / TILE, y % TILE, x % TILE)
            });
            let roughness = f64::from(f32::from_bits(roughness)).clamp(0.0, 1.0);
            let lobes = self.reflector.lobes(Lobe::Ggx, roughness, Filter::Adaptive(error))?;
            let found: Vec<_> = pixels
                .par_chunks(64 * TILE * TILE)
                .map(|chunk| {
                    let directions: Vec<DVec3> = chunk
                        .iter()
                        .map(|index| {
                            let [x, y, z, _] = asked[*index].map(f64::from);
                            (source_from_world * DVec3::new(x, y, z)).normalize_or(DVec3::Y)
                        })
                        .collect();
                    let mut found = Vec::with_capacity(directions.len());
                    lobes.evaluate(&directions, &mut Workspace::default(), &mut found).map(|()| found)
                })
                .collect::<Result<_>>()?;
            for (index, answer) in pixels.iter().zip(found.iter().flatten()) {
                answers[*index][..3].copy_from_slice(&answer.radiance);
            }
        }
        Ok(answers)
    }
}
