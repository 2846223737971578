//! The certified tier for the pixels of a picture: shown by the adaptive filter, and the reference for
//! others.

use glam::{DMat3, DVec3};
use octagloss_core::common::error::Result;
use octagloss_core::common::frame::Frame;
use octagloss_core::common::parallel;
use octagloss_core::cpu::reflection::{LEAST_ROUGHNESS, ReflectedLight};
use octagloss_core::cpu::reflector::{Reflector, ReflectorSettings, Workspace};
use octagloss_core::cpu::table_bytes::{LIMIT, LobeRequest};
use octagloss_core::light::environment::{Environment, Rgb};
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter;
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Query of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelQuery {
    /// World direction and roughness.
    pub(super) lobe: [f32; 4],
    /// The surface there in world space, if what it reflects is asked for: normal and anisotropy, tangent,
    /// reflectance at normal incidence.
    pub(super) surface: Option<[[f32; 4]; 3]>,
}

impl PixelQuery {
    fn roughness(&self) -> f32 {
        self.lobe[3]
    }

    /// In the source's space.
    fn direction(&self, source_from_world: DMat3) -> DVec3 {
        (source_from_world * three(self.lobe)).normalize_or(DVec3::Y)
    }

    /// The surface's frame in the source's space, anisotropy and reflectance.
    fn frame(&self, source_from_world: DMat3) -> Option<(Frame, f64, [f64; 3])> {
        let [normal, tangent, f0] = self.surface?;
        let turned = |texel| source_from_world * three(texel);
        let (direction, up) = (turned(self.lobe), turned(normal).normalize());
        // The lobe's direction is the view's, mirrored.
        let view = up * (2.0 * up.dot(direction)) - direction;
        let frame = Frame::new(up, view, turned(tangent))?;
        Some((frame, f64::from(normal[3]), three(f0).to_array()))
    }
}

fn three([x, y, z, _]: [f32; 4]) -> DVec3 {
    DVec3::new(f64::from(x), f64::from(y), f64::from(z))
}

/// Edge of the pixel tiles that share traversals of the cells.
const TILE: usize = 4;

/// An environment prepared for the certified tier.
#[derive(Debug)]
pub struct Truth {
    reflector: Reflector<'static>,
    /// The same light for true reflections, on first use.
    reflected: OnceLock<ReflectedLight<'static>>,
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
        Ok(Self { reflector, reflected: OnceLock::new() })
    }

    /// Radiance for each query of a picture in rows of `width`, to a relRMSE of `error`; `source_from_world`
    /// rotates the directions.
    ///
    /// # Errors
    /// Those of [`Reflector::lobes`].
    pub fn answers(
        &self,
        asked: &[PixelQuery],
        width: usize,
        source_from_world: DMat3,
        error: f64,
    ) -> Result<Vec<[f32; 4]>> {
        // Group the queries by roughness, with neighbouring pixels adjacent. Mirrors are lobes.
        let is_frame =
            |query: &PixelQuery| query.surface.is_some() && f64::from(query.roughness()) >= LEAST_ROUGHNESS;
        let mut alike: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (index, query) in asked.iter().enumerate().filter(|(_, query)| !is_frame(query)) {
            alike.entry(query.roughness().to_bits()).or_default().push(index);
        }
        let mut answers = vec![[0.0, 0.0, 0.0, 1.0]; asked.len()];
        for (roughness, mut pixels) in alike {
            pixels.sort_by_key(|index| {
                let (x, y) = (index % width, index / width);
                (y / TILE, x / TILE, y % TILE, x % TILE)
            });
            let roughness = f64::from(f32::from_bits(roughness)).clamp(0.0, 1.0);
            let lobes = self.reflector.lobes(Lobe::Ggx, roughness, Filter::Adaptive(error))?;
            let chunks = pixels.chunks(64 * TILE * TILE);
            let found = parallel::try_map_with(chunks, Workspace::default, |workspace, chunk| {
                let directions: Vec<DVec3> =
                    chunk.iter().map(|index| asked[*index].direction(source_from_world)).collect();
                let mut found = Vec::with_capacity(directions.len());
                lobes.evaluate(&directions, workspace, &mut found).map(|()| found)
            })?;
            for (index, answer) in pixels.iter().zip(found.iter().flatten()) {
                let fresnel = asked[*index].frame(source_from_world).map_or([1.0; 3], |(frame, _, f0)| {
                    f0.map(|f0| f0 + (1.0 - f0) * (1.0 - frame.view.z).powi(5))
                });
                for (c, fresnel) in fresnel.into_iter().enumerate() {
                    answers[*index][c] = answer.radiance[c] * fresnel as f32;
                }
            }
        }
        if asked.iter().any(is_frame) {
            let frames = asked.iter().enumerate().filter(|(_, query)| is_frame(query));
            let reflect = |(index, query): (usize, &PixelQuery)| {
                Some((index, self.reflected(query, source_from_world, error)?))
            };
            for (index, radiance) in parallel::map(frames, reflect).into_iter().flatten() {
                answers[index][..3].copy_from_slice(&radiance);
            }
        }
        Ok(answers)
    }

    /// What the surface of `query` reflects.
    fn reflected(&self, query: &PixelQuery, source_from_world: DMat3, error: f64) -> Option<Rgb> {
        let (frame, anisotropy, f0) = query.frame(source_from_world)?;
        let light =
            self.reflected.get_or_init(|| ReflectedLight::owning(self.reflector.environment().clone()));
        let roughness = f64::from(query.roughness()).min(1.0);
        Some(light.reflect(&frame, roughness, anisotropy, f0, error).radiance)
    }
}
