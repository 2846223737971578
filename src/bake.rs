//! Lobes to cube chains: the levels and roughnesses of a bake, and the bake itself.

use crate::chain::{CubeChain, CubeLevel};
use crate::cpu::bake_level::{self, BakedLevel};
use crate::cpu::box_filter;
use crate::environment::Environment;
use crate::error::{Error, Result};
use crate::lobe::Lobe;
use crate::oem::OemSize;
use crate::reflector::{Reflector, ReflectorSettings, default_oem_size, source_oem_size};
use crate::sh;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// How a level's roughness follows from its index.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ladder {
    /// r = level/(levels - 1): glTF, Bevy, the Khronos sampler.
    #[default]
    Linear,
    /// r = 1 - sqrt(1 - level/(levels - 1)): Filament, three.js.
    Filament,
}

/// How a lobe is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Quadrature with a certified bound; the number is the relRMSE aimed at over the sphere, in (0, 1).
    Adaptive(f64),
    /// The paper's single box.
    Box,
    /// Exhaustive integration over the source texels in double precision: slow, for auditing.
    Reference,
}

/// What to bake. `Default` is what `octagloss bake INPUT` does.
#[derive(Clone, Debug)]
pub struct BakeSettings {
    /// Texels along an edge of level 0.
    pub size: u32,
    /// Number of levels; `None` for the ladder's own default.
    pub levels: Option<u32>,
    /// Roughness of each level.
    pub ladder: Ladder,
    /// The lobe.
    pub lobe: Lobe,
    /// The filter.
    pub filter: Filter,
    /// Texels along an edge of the OEM without its border; `None` for the source's own.
    pub oem_size: Option<u32>,
    /// Border of the OEM in texels; `None` for the filter's own.
    pub border: Option<u32>,
    /// Keep every texel's error bound in the levels.
    pub bounds: bool,
    /// Edge of an irradiance cube (cosine lobe, divided by pi) to bake as well.
    pub irradiance: Option<u32>,
}

impl Default for BakeSettings {
    fn default() -> Self {
        Self {
            size: 256,
            levels: None,
            ladder: Ladder::Linear,
            lobe: Lobe::Ggx,
            filter: Filter::Adaptive(0.005),
            oem_size: None,
            border: None,
            bounds: false,
            irradiance: None,
        }
    }
}

/// A level to be baked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rung {
    /// Texels along an edge.
    pub size: u32,
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
}

impl BakeSettings {
    /// Size and roughness of every level.
    ///
    /// # Errors
    /// [`Error::Parameter`] for no size, no levels, or more levels than reach a size of 1.
    pub fn rungs(&self) -> Result<Vec<Rung>> {
        if self.size == 0 {
            return Err(Error::Parameter("--size must be at least 1".to_owned()));
        }
        let most = self.size.ilog2() + 1;
        let own = match self.ladder {
            Ladder::Linear => most,
            // Down to 16: 256 has five.
            Ladder::Filament => most.saturating_sub(4).max(1),
        };
        let levels = match self.lobe {
            // Irradiance knows no roughness.
            Lobe::Cosine => self.levels.unwrap_or(1),
            _ => self.levels.unwrap_or(own),
        };
        if levels == 0 {
            return Err(Error::Parameter("--levels must be at least 1".to_owned()));
        }
        if levels > most {
            return Err(Error::Parameter(format!(
                "--levels {levels} is more than reach a size of 1 from --size {}; at most {most}",
                self.size
            )));
        }
        let roughness = |level: u32| {
            let step = if levels == 1 { 0.0 } else { f64::from(level) / f64::from(levels - 1) };
            match self.ladder {
                Ladder::Linear => step,
                Ladder::Filament => 1.0 - (1.0 - step).sqrt(),
            }
        };
        Ok((0..levels)
            .map(|level| Rung { size: (self.size >> level).max(1), roughness: roughness(level) })
            .collect())
    }
}

/// Figures of one baked level.
#[derive(Clone, Debug)]
pub struct LevelStats {
    /// Wall time.
    pub seconds: f64,
    /// Leaves of the quadrature a texel, on average; `None` where the filter has none.
    pub leaves_per_texel: Option<f64>,
    /// Greatest certified bound of the level, absolute luminance; `None` where the filter has none.
    pub error_bound_max: Option<f64>,
    /// Mean certified bound of the level, absolute luminance; `None` where the filter has none.
    pub error_bound_mean: Option<f64>,
}

/// What a bake made.
#[derive(Clone, Debug)]
pub struct Bake {
    /// The prefiltered levels.
    pub chain: CubeChain,
    /// Figures, one a level.
    pub stats: Vec<LevelStats>,
    /// The irradiance cube, where asked for; values are irradiance/pi.
    pub irradiance: Option<CubeLevel>,
    /// Spherical harmonics L0..L2 of the source, see [`crate::sh`].
    pub sh: [[f64; 3]; 9],
    /// The OEM's size.
    pub oem: OemSize,
    /// Total energy (radiance times solid angle) of the source, a channel each.
    pub source_energy: [f64; 3],
    /// Total energy of the OEM.
    pub oem_energy: [f64; 3],
    /// Things the user should know, in words.
    pub warnings: Vec<String>,
}

/// How far a bake is: `done` of `total` units of work (output texels), in level `level`.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Level being baked.
    pub level: u32,
    /// Output texels done in all levels.
    pub done: u64,
    /// Output texels of all levels.
    pub total: u64,
}

/// Bakes `environment` on the CPU; calls `progress` now and then, from any thread.
///
/// # Errors
/// [`Error::Parameter`] for settings that make no sense together, [`Error::Limit`] where a table would not fit.
pub fn bake(
    environment: &Environment,
    settings: &BakeSettings,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Bake> {
    let order = Order::new(environment, settings)?;
    let meter = order.meter(progress);
    let reflector = Reflector::new(environment, &order.reflector_settings())?;
    let mut levels = Vec::new();
    for (index, (rung, lobe)) in order.levels().enumerate() {
        let start = Instant::now();
        let advance = |texels| meter.advance(index, texels);
        let level = bake_level::bake_level(&reflector, rung, lobe, settings.filter, &advance)?;
        levels.push((level, start.elapsed().as_secs_f64()));
    }
    Ok(order.finish(levels, reflector.oem().size(), reflector.oem().totals()))
}

/// A bake as it is ordered of an engine: which levels, over which OEM.
pub(crate) struct Order<'a> {
    environment: &'a Environment,
    settings: &'a BakeSettings,
    rungs: Vec<Rung>,
}

/// Counts output texels for whoever watches.
pub(crate) struct Meter<'a> {
    done: AtomicU64,
    total: u64,
    progress: &'a (dyn Fn(Progress) + Sync),
}

impl Meter<'_> {
    /// Tells that `texels` more of level `level` are done.
    pub(crate) fn advance(&self, level: usize, texels: u64) {
        let done = self.done.fetch_add(texels, Ordering::Relaxed) + texels;
        (self.progress)(Progress { level: level as u32, done, total: self.total });
    }
}

impl<'a> Order<'a> {
    pub(crate) fn new(environment: &'a Environment, settings: &'a BakeSettings) -> Result<Self> {
        let rungs = settings.rungs()?;
        if settings.irradiance == Some(0) {
            return Err(Error::Parameter("--irradiance must be at least 1".to_owned()));
        }
        Ok(Self { environment, settings, rungs })
    }

    pub(crate) fn meter<'p>(&self, progress: &'p (dyn Fn(Progress) + Sync)) -> Meter<'p> {
        let total = self.levels().map(|(rung, _)| 6 * u64::from(rung.size) * u64::from(rung.size)).sum();
        Meter { done: AtomicU64::new(0), total, progress }
    }

    /// What to bake: the ladder, then the irradiance cube where it is asked for.
    pub(crate) fn levels(&self) -> impl Iterator<Item = (Rung, Lobe)> {
        let irradiance = self.settings.irradiance.map(|size| (Rung { size, roughness: 1.0 }, Lobe::Cosine));
        self.rungs.iter().map(|rung| (*rung, self.settings.lobe)).chain(irradiance)
    }

    /// What the reflector must serve.
    pub(crate) fn reflector_settings(&self) -> ReflectorSettings {
        reflector_settings(self.environment, self.settings, &self.rungs)
    }

    /// The bake, from its levels and the seconds that each took, and the OEM's size and totals.
    pub(crate) fn finish(self, levels: Vec<(BakedLevel, f64)>, oem: OemSize, totals: [f64; 4]) -> Bake {
        let Self { environment, settings, rungs } = self;
        let mut warnings = Vec::new();
        let asked = default_oem_size(environment.layout(), 0, sharpest(&rungs))
            .min(source_oem_size(environment.layout()));
        if oem.inner < asked {
            warnings.push(format!(
                "the OEM of {} texels is coarser than source and lobes ask for, {asked}",
                oem.inner
            ));
        }
        let mut levels = levels.into_iter();
        let mut chain = CubeChain { levels: Vec::with_capacity(rungs.len()) };
        let mut stats = Vec::with_capacity(rungs.len());
        for (rung, (baked, seconds)) in rungs.iter().zip(levels.by_ref()) {
            let bounds = baked.bounds.as_deref();
            stats.push(LevelStats {
                seconds,
                leaves_per_texel: baked.leaves_per_texel,
                error_bound_max: bounds
                    .map(|b| b.iter().fold(0.0, |most, bound| f64::from(*bound).max(most))),
                error_bound_mean: bounds
                    .map(|b| b.iter().map(|v| f64::from(*v)).sum::<f64>() / b.len() as f64),
            });
            chain.levels.push(CubeLevel {
                size: rung.size,
                roughness: rung.roughness,
                texels: baked.texels,
                bounds: baked.bounds.filter(|_| settings.bounds),
            });
        }
        let irradiance = settings.irradiance.zip(levels.next()).map(|(size, (baked, _))| CubeLevel {
            size,
            roughness: 1.0,
            texels: baked.texels,
            bounds: None,
        });
        let sh = sh::spherical_harmonics(environment);
        // L0 is the integral of the radiance times the constant 1/sqrt(4 pi).
        let source_energy = sh[0].map(|coefficient| coefficient * (4.0 * std::f64::consts::PI).sqrt());
        Bake {
            chain,
            stats,
            irradiance,
            sh,
            oem,
            source_energy,
            oem_energy: [totals[0], totals[1], totals[2]],
            warnings,
        }
    }
}

/// The least roughness above 0.
fn sharpest(rungs: &[Rung]) -> f64 {
    rungs.iter().map(|rung| rung.roughness).filter(|r| *r > 0.0).fold(1.0, f64::min)
}

/// What the reflector of a bake must serve.
fn reflector_settings(
    environment: &Environment,
    settings: &BakeSettings,
    rungs: &[Rung],
) -> ReflectorSettings {
    let sharpest = sharpest(rungs);
    let border = settings.border.or_else(|| {
        // The safety border: plain four-corner reads for the widest box of the ladder.
        let roughest = rungs.iter().map(|rung| rung.roughness).fold(0.0, f64::max);
        let inner = settings.oem_size.unwrap_or_else(|| default_oem_size(environment.layout(), 0, sharpest));
        (settings.filter == Filter::Box)
            .then(|| box_filter::widest_half_extent(settings.lobe, roughest * roughest, inner))
    });
    ReflectorSettings { oem_size: settings.oem_size, border, sharpest }
}
