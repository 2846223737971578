//! Lobes to cube chains: the levels and roughnesses of a bake, and the bake itself.

pub mod dfg;
pub(crate) mod job;
pub(crate) mod level;
pub mod overflow;
pub mod report;
pub(crate) mod result;
pub(crate) mod settings;

use crate::environment::Environment;
use crate::error::Result;
use crate::memory;
use crate::reflector::Reflector;
use job::Job;
pub use result::{Bake, LevelStats, Progress};
pub use settings::BakeSettings;
use web_time::Instant;

/// Bakes `environment` on the CPU; calls `progress` now and then, from any thread.
///
/// # Errors
/// [`crate::Error::Parameter`] for settings that make no sense together, [`crate::Error::Limit`] where it
/// would take more than [`memory::LIMIT`].
pub fn bake(
    environment: &Environment,
    settings: &BakeSettings,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Bake> {
    let mut bakes = bake_all(environment, std::slice::from_ref(settings), progress)?;
    Ok(bakes.pop().expect("one bake for one settings"))
}

/// Bakes `environment` several times from one octahedral map, one bake for each of `settings`; levels that
/// several of them ask for are baked once. The map is fine enough for the sharpest lobe of all; where
/// settings name its size or border, the largest counts.
///
/// # Errors
/// As [`bake`]; [`crate::Error::Parameter`] for no settings.
pub fn bake_all(
    environment: &Environment,
    settings: &[BakeSettings],
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Vec<Bake>> {
    memory::check_bake(environment, settings, 0)?;
    let job = Job::new(environment, settings)?;
    let meter = job.meter(progress);
    let reflector = Reflector::new(environment, &job.reflector_settings())?;
    let mut levels = Vec::new();
    for (index, level) in job.levels().iter().enumerate() {
        let start = Instant::now();
        let advance = |texels| meter.advance(index, texels);
        let baked = level::bake_level(&reflector, level, &advance)?;
        levels.push((baked, start.elapsed().as_secs_f64()));
    }
    job.finish(levels, reflector.oem().size(), reflector.energy())
}
