//! Bakes prefiltered cube chains.

pub mod dfg;
mod interpolated;
pub mod job;
pub mod level;
pub mod memory;
pub mod query;
pub(crate) mod result;
pub(crate) mod settings;
pub(crate) mod solve;
mod sparse;

use self::interpolated::Interpolation;
use crate::analysis::typical::{median, probes};
use crate::common::error::{Error, Result};
use crate::cpu::reflector::{Reflector, check_answers};
use crate::light::chain::Chain;
use crate::light::chain_lookup::ChainLookup;
use crate::light::environment::{Environment, Layout};
use crate::light::oem::OemSize;
use crate::lobe::Lobe;
use crate::lobe::filter::{Answer, Filter};
use crate::pyramid::BakedPyramid;
use glam::DVec3;
use job::Job;
pub use level::Processor;
use level::{Advance, BakedLevel, LeafCounts, LevelJob, Part};
pub use result::{Bake, LevelStats, OnProgress, Progress};
pub use settings::{BakeSettings, Skybox};
use std::ops::ControlFlow;
use std::pin::pin;
use std::task::{Context, Poll, Waker};
use web_time::Instant;

/// Bakes `environment` on the CPU.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for inconsistent settings,
/// [`crate::common::error::Error::Limit`] if it needs more than
/// `memory::LIMIT`.
pub fn bake(environment: &Environment, settings: &BakeSettings) -> Result<Bake> {
    let mut bakes = bake_all(environment, std::slice::from_ref(settings), &unwatched)?;
    Ok(bakes.pop().expect("one bake for one settings"))
}

/// Bakes `environment` once for each of `settings` from one octahedral map; shared levels are baked once. The
/// map's resolution suits the sharpest lobe. If settings give its size or border, the largest applies.
///
/// # Errors
/// As [`bake`]; [`crate::common::error::Error::Parameter`] for no settings,
/// [`crate::common::error::Error::Cancelled`] if `progress` returns [`ControlFlow::Break`].
pub fn bake_all(
    environment: &Environment,
    settings: &[BakeSettings],
    progress: OnProgress<'_>,
) -> Result<Vec<Bake>> {
    memory::check_bake(environment, settings, 0)?;
    let job = Job::new(environment, settings)?;
    let reflector = Reflector::new(environment, &job.reflector_settings())?;
    ready(bake_job(job, &reflector, progress))
}

/// Progress callback that ignores progress and continues.
pub fn unwatched(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[expect(async_fn_in_trait, reason = "no caller needs its futures to be Send")]
/// Interface of both engines, over a prepared OEM. Futures of the CPU engine are always ready.
pub trait Engine {
    /// What bakes, unless a level says otherwise.
    const PROCESSOR: Processor;

    /// Texels along an edge of the OEM, without its border.
    fn inner(&self) -> u32;

    /// Bakes `level` texel by texel; calls `advance` with the number of texels done and stops at its error.
    async fn bake_texels(&self, level: &LevelJob, advance: Advance<'_>) -> Result<BakedLevel>;

    /// Answers of lobes of `level`, by [`Filter::Adaptive`] to `tolerance`, to the directions of `packets`;
    /// calls `done` after each part.
    async fn answers(
        &self,
        level: &LevelJob,
        tolerance: f64,
        packets: &[Vec<DVec3>],
        done: Part<'_>,
    ) -> Result<(Vec<Answer>, LeafCounts)>;

    /// The OEM's size, and the energy of the light that lobes read in the source's units.
    async fn oem(&self) -> Result<(OemSize, [f64; 3])>;

    /// Answers to `directions` (unit vectors in world space; [`Query`](query::Query) checks them), each
    /// evaluated on its own: an answer depends on no other direction.
    async fn query_each(
        &self,
        directions: &[DVec3],
        lobe: Lobe,
        roughness: f64,
        filter: Filter,
    ) -> Result<Vec<Answer>>;
}

impl Engine for Reflector<'_> {
    const PROCESSOR: Processor = Processor::Cpu;

    fn inner(&self) -> u32 {
        self.size().inner
    }

    async fn bake_texels(&self, level: &LevelJob, advance: Advance<'_>) -> Result<BakedLevel> {
        level::bake_texels(self, level, advance)
    }

    async fn answers(
        &self,
        level: &LevelJob,
        tolerance: f64,
        packets: &[Vec<DVec3>],
        done: Part<'_>,
    ) -> Result<(Vec<Answer>, LeafCounts)> {
        let lobes = self.lobes(level.lobe, level.spec.roughness, Filter::Adaptive(tolerance))?;
        sparse::evaluate(&lobes, packets, done)
    }

    async fn oem(&self) -> Result<(OemSize, [f64; 3])> {
        Ok((self.size(), self.energy()))
    }

    async fn query_each(
        &self,
        directions: &[DVec3],
        lobe: Lobe,
        roughness: f64,
        filter: Filter,
    ) -> Result<Vec<Answer>> {
        let lobes = self.lobes(lobe, roughness, filter)?;
        let answers = query::each(directions.iter().map(|direction| (&lobes, *direction)), &|| Ok(()))?;
        check_answers(directions, &answers)?;
        Ok(answers)
    }
}

/// Bakes every level of `job` by `engine`.
pub async fn bake_job(job: Job<'_>, engine: &impl Engine, progress: OnProgress<'_>) -> Result<Vec<Bake>> {
    let (environment, settings) = job.inputs();
    let meter = job.meter(progress);
    let mut levels = Vec::new();
    for (index, level) in job.levels().iter().enumerate() {
        let start = Instant::now();
        let baked = bake_level(engine, environment, level, &|texels| meter.advance(index, texels)).await?;
        levels.push((baked, start.elapsed().as_secs_f64()));
    }
    let (oem, energy) = engine.oem().await?;
    let mut bakes = job.finish(levels, oem, energy)?;
    for (bake, settings) in bakes.iter_mut().zip(settings).filter(|(_, settings)| settings.pyramid) {
        bake.pyramid = Some(BakedPyramid::new(environment, settings.size)?);
    }
    for (bake, settings) in bakes.iter_mut().zip(settings).filter(|(_, settings)| settings.measure) {
        bake.typical_error = typical_error(engine, &bake.chain, settings, environment.layout()).await?;
    }
    Ok(bakes)
}

/// Bakes `level` of lobes over `environment`: by interpolation where that is as good, else texel by texel.
async fn bake_level(
    engine: &impl Engine,
    environment: &Environment,
    level: &LevelJob,
    advance: Advance<'_>,
) -> Result<BakedLevel> {
    if let Some(interpolation) = Interpolation::of(level) {
        return interpolation.bake(engine, environment, level, advance).await;
    }
    match sparse::tolerance(level) {
        Some(tolerance) => sparse::bake_sparsely(engine, level, tolerance, advance).await,
        None => engine.bake_texels(level, advance).await,
    }
}

/// Typical error of the look-ups of `chain`, against finer lobes of `engine`: the median over roughness.
/// `None` if the source resolves none of the lobes, or if they do not fit into memory.
async fn typical_error(
    engine: &impl Engine,
    chain: &Chain,
    settings: &BakeSettings,
    source: Layout,
) -> Result<Option<f64>> {
    let filter = match settings.filter {
        Filter::Reference => Filter::Reference,
        Filter::Adaptive(error) => Filter::Adaptive((FINER * error).max(FINEST)),
        Filter::Box => Filter::Adaptive(0.005),
        // Its own error is small beside that of look-ups.
        Filter::Pyramid => Filter::Pyramid,
    };
    let lookup = ChainLookup::new(&chain.levels);
    let mut errors = Vec::new();
    for probe in probes(chain, settings.ladder, settings.lobe, source) {
        match engine.query_each(&probe.directions, settings.lobe, probe.roughness, filter).await {
            Ok(answers) => errors.push(probe.error(&lookup, answers.iter().map(|answer| answer.radiance))),
            // These lobes may need tables that the bake's do not.
            Err(Error::Limit { .. } | Error::Unsupported { .. }) => return Ok(None),
            Err(other) => return Err(other),
        }
    }
    Ok(median(errors))
}

/// Tolerance of the lobes that look-ups are compared with, over that of the bake,
const FINER: f64 = 0.4;
/// and the least tolerance there is.
const FINEST: f64 = 1e-6;

/// Output of a future of the CPU engine.
pub(crate) fn ready<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(output) => output,
        Poll::Pending => unreachable!("the CPU waits for nothing"),
    }
}
