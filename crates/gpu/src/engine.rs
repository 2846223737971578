//! The GPU engine: prepares environments, queries and bakes them.

use super::device::readback;
use super::{Context, OemPlanes, SatPlanes, Stage};
use crate::stages::adaptive::{Answers, LobePart, Packet, Packets};
use crate::stages::box_filter::SatTextures;
use crate::stages::cells::CellTree;
use crate::stages::pyramid::{self, PyramidMaps};
use crate::stages::{adaptive, box_filter, build_pyramid, cells, reparameterise};
use glam::{DMat3, DVec3};
use octagloss_core::bake::job::Job;
use octagloss_core::bake::level::{Advance, BakedLevel, LeafCounts, LevelJob, Part};
use octagloss_core::bake::{self, Bake, BakeSettings, OnProgress, Processor};
use octagloss_core::common::direction::units;
use octagloss_core::common::error::{Error, Result, wrong};
use octagloss_core::common::parallel;
use octagloss_core::cpu::box_filter::single_box;
use octagloss_core::cpu::cells::{Cells, SourceLight};
use octagloss_core::cpu::leaves::LANES;
use octagloss_core::cpu::reflector::{ReflectorSettings, Workspace, check_answers};
use octagloss_core::geometry::footprints::footprints_over;
use octagloss_core::geometry::source_texels::{SourceTexels, cells_across};
use octagloss_core::geometry::tent::Reconstruction;
use octagloss_core::geometry::tiling::{Tile, Tiling};
use octagloss_core::light::environment::{Environment, Layout, Rgb};
use octagloss_core::light::light_scale::LightScale;
use octagloss_core::light::oem::{OemSize, bilinear_share};
use octagloss_core::light::sat::Scan;
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::{Answer, Filter};
use octagloss_core::lobe::kernel::Kernel;
use octagloss_core::pyramid::Levels;
use std::sync::OnceLock;

/// Least alpha that float32 directions resolve. The CPU evaluates sharper lobes and mirrors over the OEM read
/// back.
const SHARPEST_ALPHA: f64 = 1e-4;

/// Bakes and queries on one device.
#[derive(Clone, Debug)]
pub struct Engine {
    context: Context,
}

impl Engine {
    /// An engine on the device of `context`. Passes are compiled when they are first used.
    ///
    /// # Errors
    /// [`Error::Gpu`] if a shader fails to compile.
    pub fn new(context: Context) -> Result<Self> {
        let engine = Self { context };
        engine.context.check()?;
        Ok(engine)
    }

    /// The device.
    pub const fn context(&self) -> &Context {
        &self.context
    }

    /// Bakes `environment` several times from one octahedral map, as [`octagloss_core::bake::bake_all`] does.
    ///
    /// # Errors
    /// Those of the CPU engine, [`Error::Unsupported`] for filters that run on the CPU only, and
    /// [`Error::Gpu`].
    pub async fn bake_all(
        &self,
        environment: &Environment,
        settings: &[BakeSettings],
        progress: OnProgress<'_>,
    ) -> Result<Vec<Bake>> {
        let job = Job::new(environment, settings)?;
        let reflector_settings = job.reflector_settings();
        for level in job.levels() {
            self.check_fits(environment, &reflector_settings, level.filter)?;
        }
        let reflector = GpuReflector::new(self, environment, &reflector_settings)?;
        bake::bake_job(job, &reflector, progress).await
    }

    /// Checks, before any allocation, that the tables of `filter` fit the device. The error names the largest
    /// size that does.
    ///
    /// # Errors
    /// [`Error::Limit`] if they do not, [`Error::Unsupported`] for a filter or scan that runs on the CPU
    /// only.
    pub fn check_fits(
        &self,
        environment: &Environment,
        settings: &ReflectorSettings,
        filter: Filter,
    ) -> Result<()> {
        let (size, _) = settings.plan(environment.layout())?;
        if filter.reads_sat() && settings.scan == Scan::Serial {
            return Err(unsupported("the serial scan"));
        }
        match filter {
            Filter::Adaptive(_) => {
                CellTree::check_fits(&self.context, size.inner, |n| settings.block(n))?;
                let width = size.inner.div_ceil(settings.block(size.inner));
                CellTree::check_members_fit(&self.context, environment.layout(), width)
            }
            Filter::Box => SatPlanes::check_fits(&self.context, size),
            Filter::Pyramid => PyramidMaps::check_fits(&self.context, Levels::over(size.inner)?, 1),
            Filter::Reference => Err(unsupported("the reference filter")),
        }
    }

    /// The stages of a bake with [`Filter::Adaptive`], from the source's texture to every level's answers:
    /// OEM, its cells, levels. They can be recorded repeatedly. The cells of the source are built on the CPU,
    /// before.
    ///
    /// # Errors
    /// Those of the CPU engine, [`Error::Unsupported`] for filters that run on the CPU only, and
    /// [`Error::Gpu`].
    pub fn bake_stages(&self, environment: &Environment, settings: &BakeSettings) -> Result<Vec<Stage>> {
        let Filter::Adaptive(error) = settings.filter else {
            return wrong("`bake_stages` requires the adaptive filter");
        };
        let job = Job::new(environment, std::slice::from_ref(settings))?;
        let reflector = GpuReflector::new(self, environment, &job.reflector_settings())?;
        let context = &self.context;
        let mut levels = Vec::new();
        for level in job.levels() {
            let LevelJob { spec, lobe, .. } = *level;
            if level.is_mirror() {
                let texture = &reflector.texture;
                let Layout::Cube { size } = spec.layout else {
                    return wrong("`bake_stages` requires cube mirror levels");
                };
                levels.push(reparameterise::footprints(context, environment, texture, size)?.0);
                continue;
            }
            let groups = groups(&Tiling::new(reflector.planes.size().inner, spec, lobe));
            let packets = Packets::new(context, &packets(&groups, environment.source_from_world()))?;
            let parts = reflector.parts(lobe, spec.roughness * spec.roughness, error)?;
            levels.push(adaptive::stage(context, &parts, &packets));
        }
        let GpuReflector { stage, bilinear, .. } = &reflector;
        let cells = bilinear.get().map(|(stage, _)| stage);
        Ok(std::iter::once(stage).chain(cells).cloned().chain(levels).collect())
    }
}

/// An environment's OEM on the GPU, for queries. Tables are built on first use.
#[derive(Debug)]
pub struct GpuReflector<'a> {
    engine: &'a Engine,
    environment: &'a Environment,
    /// Scale of the light in texture, planes and tables.
    scale: LightScale,
    texture: wgpu::Texture,
    planes: OemPlanes,
    /// Stage that fills the planes.
    stage: Stage,
    settings: ReflectorSettings,
    source: OnceLock<CellTree>,
    bilinear: OnceLock<(Stage, CellTree)>,
    sat: OnceLock<SatTextures>,
    pyramid: OnceLock<PyramidMaps>,
}

impl<'a> GpuReflector<'a> {
    /// Uploads `environment` and builds its OEM.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an OEM of no texels and a rotation that is not finite, [`Error::Limit`] if
    /// the tables do not fit.
    pub fn new(
        engine: &'a Engine,
        environment: &'a Environment,
        settings: &ReflectorSettings,
    ) -> Result<Self> {
        let (size, _) = settings.plan(environment.layout())?;
        let context = &engine.context;
        let scale = LightScale::new(environment);
        let texture = reparameterise::upload(context, &scale.scaled(environment))?;
        let planes = OemPlanes::new(context, size)?;
        let stage = reparameterise::stage(context, environment.layout(), &texture, &planes)?;
        context.submit(|encoder| stage.record(encoder));
        context.check()?;
        Ok(Self {
            engine,
            environment,
            scale,
            texture,
            planes,
            stage,
            settings: *settings,
            source: OnceLock::new(),
            bilinear: OnceLock::new(),
            sat: OnceLock::new(),
            pyramid: OnceLock::new(),
        })
    }

    /// The exponent k, where the OEM holds the source's light times 2^k; see
    /// [`octagloss_core::cpu::reflector::Reflector::light_exponent`].
    pub const fn light_exponent(&self) -> i32 {
        self.scale.exponent()
    }

    /// Cells of the source's texels, from the CPU.
    fn source_cells(&self) -> Result<&CellTree> {
        made_once(&self.source, || {
            let inner = self.planes.size().inner;
            let layout = self.environment.layout();
            let light = SourceLight::new(self.environment, self.scale);
            let width = cells_across(layout, inner.div_ceil(self.settings.block(inner)));
            let cells = Cells::of_source(SourceTexels::new(layout), light, width);
            CellTree::of_source(&self.engine.context, &cells, &self.texture)
        })
    }

    /// Cells of the OEM, interpolated bilinearly.
    fn bilinear_cells(&self) -> Result<&CellTree> {
        let (_, tree) = made_once(&self.bilinear, || {
            let context = &self.engine.context;
            let block = self.settings.block(self.planes.size().inner);
            let (stage, tree) = cells::stage(context, &self.planes, block, Reconstruction::Bilinear)?;
            context.submit(|encoder| stage.record(encoder));
            Ok((stage, tree))
        })?;
        Ok(tree)
    }

    fn sat(&self) -> Result<&SatTextures> {
        made_once(&self.sat, || {
            let context = &self.engine.context;
            let (textures, stages) = box_filter::tables(context, self.settings.scan, &self.planes)?;
            context.submit(|encoder| stages.iter().for_each(|stage| stage.record(encoder)));
            Ok(textures)
        })
    }

    fn pyramid(&self) -> Result<&PyramidMaps> {
        made_once(&self.pyramid, || {
            let context = &self.engine.context;
            let maps = PyramidMaps::new(context, self.planes.size().inner)?;
            let stage = build_pyramid::stage(context, &self.planes, &maps);
            context.submit(|encoder| stage.record(encoder));
            Ok(maps)
        })
    }

    /// Answers to `directions` (in world space, any length but zero), evaluated one by one.
    ///
    /// # Errors
    /// [`Error::Parameter`] for invalid parameters and a direction that is zero or not finite,
    /// [`Error::Unsupported`] for filters that run on the CPU only, [`Error::Limit`] if a table does not fit,
    /// and [`Error::Gpu`].
    pub async fn query(
        &self,
        directions: &[DVec3],
        lobe: Lobe,
        roughness: f64,
        filter: Filter,
    ) -> Result<Vec<Answer>> {
        let directions = units(directions)?;
        let groups: Vec<&[DVec3]> = directions.chunks(1).collect();
        let answers = self.evaluate(&groups, lobe, roughness, filter).await?.lanes;
        check_answers(&directions, &answers)?;
        Ok(answers)
    }

    /// Answers to `groups` of up to [`LANES`] adjacent directions, in the source's units.
    async fn evaluate(
        &self,
        groups: &[impl AsRef<[DVec3]> + Sync],
        lobe: Lobe,
        roughness: f64,
        filter: Filter,
    ) -> Result<Answers> {
        let mut answers = self.evaluate_scaled(groups, lobe, roughness, filter).await?;
        for answer in &mut answers.lanes {
            *answer = self.scale.answer(*answer);
        }
        Ok(answers)
    }

    /// [`GpuReflector::evaluate`] in the OEM's units.
    async fn evaluate_scaled(
        &self,
        groups: &[impl AsRef<[DVec3]> + Sync],
        lobe: Lobe,
        roughness: f64,
        filter: Filter,
    ) -> Result<Answers> {
        if !(0.0..=1.0).contains(&roughness) {
            return wrong(format!("roughness {roughness} is outside [0, 1]"));
        }
        filter.check(lobe, Some(self.planes.size().inner))?;
        let context = &self.engine.context;
        let source_from_world = self.environment.source_from_world();
        let alpha = roughness * roughness;
        let directions = || -> Vec<DVec3> {
            groups.iter().flat_map(AsRef::as_ref).map(|direction| source_from_world * *direction).collect()
        };
        let unbounded = |radiance: Vec<Rgb>| {
            let lanes = radiance.into_iter().map(|radiance| Answer { radiance, bound: None }).collect();
            Ok(Answers { lanes, leaves: 0 })
        };
        let error = match filter {
            Filter::Reference => return Err(unsupported("the reference filter")),
            Filter::Pyramid => {
                let queries: Vec<_> = directions().into_iter().map(|d| (d, roughness)).collect();
                return unbounded(pyramid::radiance(context, self.pyramid()?, &queries).await?);
            }
            Filter::Box => {
                let stack = [single_box(lobe, alpha)];
                return unbounded(box_filter::radiance(context, self.sat()?, &directions(), &stack).await?);
            }
            Filter::Adaptive(error) => error,
        };
        if is_near_mirror(lobe, alpha) {
            let oem = self.planes.read(context).await?;
            let reflector =
                octagloss_core::cpu::reflector::Reflector::over(self.environment, oem, self.settings);
            let lobes = reflector.lobes(lobe, roughness, filter)?;
            let (mut workspace, mut lanes) = (Workspace::default(), Vec::new());
            for group in groups {
                lobes.evaluate(group.as_ref(), &mut workspace, &mut lanes)?;
            }
            return Ok(Answers { lanes, leaves: workspace.leaves });
        }
        let packets = packets(groups, source_from_world);
        let parts = self.parts(lobe, alpha, error)?;
        let mut answers = adaptive::evaluate(context, &parts, &packets).await?;
        // Drop padding lanes.
        let mut index = 0;
        answers.lanes.retain(|_| {
            index += 1;
            (index - 1) % LANES < groups[(index - 1) / LANES].as_ref().len()
        });
        Ok(answers)
    }

    /// The parts of `lobe`, with their cells built.
    fn parts(&self, lobe: Lobe, alpha: f64, error: f64) -> Result<Vec<LobePart<'_>>> {
        let kernel = Kernel::new(lobe, alpha);
        let bilinear = bilinear_share(lobe, alpha, self.planes.size().inner);
        let mut parts = Vec::new();
        if bilinear < 1.0 {
            parts.push(LobePart { cells: self.source_cells()?, kernel, error, share: 1.0 - bilinear });
        }
        if bilinear > 0.0 {
            parts.push(LobePart { cells: self.bilinear_cells()?, kernel, error, share: bilinear });
        }
        Ok(parts)
    }
}

impl bake::Engine for GpuReflector<'_> {
    const PROCESSOR: Processor = Processor::Gpu;

    fn inner(&self) -> u32 {
        self.planes.size().inner
    }

    async fn bake_texels(&self, level: &LevelJob, advance: Advance<'_>) -> Result<BakedLevel> {
        let LevelJob { spec, lobe, filter, .. } = *level;
        let context = &self.engine.context;
        if level.is_mirror() {
            // Use the CPU for overlaps with other maps: each matrix is used once.
            let Layout::Cube { size } = spec.layout else {
                let texels = footprints_over(self.environment, spec.layout)?;
                advance(texels.len() as u64)?;
                return Ok(BakedLevel::unbounded(texels));
            };
            let (stage, footprints) =
                reparameterise::footprints(context, self.environment, &self.texture, size)?;
            context.submit(|encoder| stage.record(encoder));
            let texels: Vec<[f32; 4]> = readback::read(context, &footprints).await?;
            let texels = texels.iter().map(|[r, g, b, _]| self.scale.radiance([*r, *g, *b])).collect();
            advance(level.spec.layout.texel_count() as u64)?;
            return Ok(BakedLevel { processor: Processor::Gpu, ..BakedLevel::unbounded(texels) });
        }
        let is_sharp = is_near_mirror(lobe, spec.roughness * spec.roughness);
        let on_cpu = is_sharp && matches!(filter, Filter::Adaptive(_));
        let processor = if on_cpu { Processor::Cpu } else { Processor::Gpu };
        let tiling = Tiling::new(self.planes.size().inner, spec, lobe);
        let groups = groups(&tiling);
        let packets = if matches!(filter, Filter::Adaptive(_)) { groups.len() as u64 } else { 0 };
        let answers = self.evaluate(&groups, lobe, spec.roughness, filter).await?;

        let mut rest = &answers.lanes[..];
        let mut texels = Vec::new();
        let mut tile = Tile::default();
        for row in 0..tiling.rows() {
            let mut line = tiling.line(row);
            tiling.for_each_tile(row, &mut tile, |tile| {
                let (own, others) = rest.split_at(tile.directions.len());
                tile.resolve(own, &mut line);
                rest = others;
            });
            texels.extend(line);
        }
        advance(texels.len() as u64)?;
        let work = LeafCounts { leaves: answers.leaves, packets, directions: answers.lanes.len() as u64 };
        Ok(BakedLevel::new(processor, texels.into_iter(), work))
    }

    async fn answers(
        &self,
        level: &LevelJob,
        tolerance: f64,
        packets: &[Vec<DVec3>],
        done: Part<'_>,
    ) -> Result<(Vec<Answer>, LeafCounts)> {
        if packets.is_empty() {
            return Ok((Vec::new(), LeafCounts::default()));
        }
        let LevelJob { spec, lobe, .. } = *level;
        let Answers { lanes, leaves } =
            self.evaluate(packets, lobe, spec.roughness, Filter::Adaptive(tolerance)).await?;
        done(0, 1)?;
        let work = LeafCounts { leaves, packets: packets.len() as u64, directions: lanes.len() as u64 };
        Ok((lanes, work))
    }

    async fn oem(&self) -> Result<(OemSize, [f64; 3])> {
        let oem = self.planes.read(&self.engine.context).await?;
        let [red, green, blue, _] = oem.totals();
        Ok((oem.size(), self.scale.energies([red, green, blue])))
    }

    async fn query_each(
        &self,
        directions: &[DVec3],
        lobe: Lobe,
        roughness: f64,
        filter: Filter,
    ) -> Result<Vec<Answer>> {
        self.query(directions, lobe, roughness, filter).await
    }
}

/// The value of `cell`, which `make` makes at the first use.
fn made_once<T>(cell: &OnceLock<T>, make: impl FnOnce() -> Result<T>) -> Result<&T> {
    if let Some(value) = cell.get() {
        return Ok(value);
    }
    let value = make()?;
    Ok(cell.get_or_init(|| value))
}

/// Whether `lobe` is too sharp for float32 directions; the CPU then evaluates it.
fn is_near_mirror(lobe: Lobe, alpha: f64) -> bool {
    lobe.has_mirror() && alpha < SHARPEST_ALPHA
}

fn unsupported(what: &str) -> Error {
    Error::Unsupported { what: what.to_owned() }
}

/// The directions of all tiles of a level, in the same packets as on the CPU.
fn groups(tiling: &Tiling) -> Vec<Vec<DVec3>> {
    let of_row = |row| {
        let mut groups = Vec::new();
        tiling.for_each_tile(row, &mut Tile::default(), |tile| {
            groups.extend(tile.directions.chunks(LANES).map(<[DVec3]>::to_vec));
        });
        groups
    };
    parallel::map(0..tiling.rows(), of_row).concat()
}

/// Packets of `groups` of world directions.
fn packets(groups: &[impl AsRef<[DVec3]> + Sync], source_from_world: DMat3) -> Vec<Packet> {
    parallel::map(groups, |group| {
        let mut turned = [DVec3::ZERO; LANES];
        for (turned, direction) in turned.iter_mut().zip(group.as_ref()) {
            *turned = source_from_world * *direction;
        }
        Packet::new(&turned[..group.as_ref().len()])
    })
}
