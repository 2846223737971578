//! Lobes to cube chains: the levels and roughnesses of a bake, and the bake itself.

use crate::chain::{CubeChain, CubeLevel};
use crate::cpu::bake_level::{self, BakedLevel};
use crate::cpu::box_filter;
use crate::environment::Environment;
use crate::error::{Error, Result};
use crate::fitted::COUNTS;
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
    /// The real-time tier: this many soft boxes (1, 2, 4 or 8) and a harmonic term, fitted to GGX; see [`crate::fitted`].
    /// Irradiance is by [`Filter::Adaptive`] of 0.005.
    Fitted(u32),
    /// The paper's single box.
    Box,
    /// Exhaustive integration over the source texels in double precision: slow, for auditing.
    Reference,
}

impl Filter {
    /// Whether it serves `lobe`, over an OEM of `inner` texels where that is settled.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an adaptive error outside (0, 1); for fitted lobes other than GGX, of a count of boxes that
    /// there is not, or over an OEM that is no power of two from 16 on.
    pub fn check(self, lobe: Lobe, inner: Option<u32>) -> Result<()> {
        let wrong = |message: String| Err(Error::Parameter(message));
        match self {
            Self::Adaptive(error) if !(error > 0.0 && error < 1.0) => {
                wrong(format!("adaptive:{error} is outside (0, 1)"))
            }
            Self::Fitted(count) if !COUNTS.contains(&count) => {
                wrong(format!("fitted:{count}: there are 1, 2, 4 and 8 boxes"))
            }
            Self::Fitted(count) if lobe != Lobe::Ggx => {
                wrong(format!("fitted:{count} is fitted to ggx; for {} take adaptive:E", lobe.name()))
            }
            Self::Fitted(count) => match inner {
                Some(inner) if !inner.is_power_of_two() || inner < 16 => wrong(format!(
                    "an OEM of {inner} texels: fitted:{count} needs --oem-size to be a power of two from 16 on"
                )),
                _ => Ok(()),
            },
            _ => Ok(()),
        }
    }
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
    let mut bakes = bake_all(environment, std::slice::from_ref(settings), progress)?;
    Ok(bakes.pop().expect("one bake for one settings"))
}

/// Bakes `environment` several times from one octahedral map, one bake for each of `settings`; levels that several of
/// them ask for are baked once. The map is fine enough for the sharpest lobe of all; where settings name its size or
/// border, the largest counts.
///
/// # Errors
/// As [`bake`]; [`Error::Parameter`] for no settings.
pub fn bake_all(
    environment: &Environment,
    settings: &[BakeSettings],
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Vec<Bake>> {
    let order = Order::new(environment, settings)?;
    let meter = order.meter(progress);
    let reflector = Reflector::new(environment, &order.reflector_settings())?;
    let mut levels = Vec::new();
    for (index, part) in order.parts().iter().enumerate() {
        let start = Instant::now();
        let advance = |texels| meter.advance(index, texels);
        let level = bake_level::bake_level(&reflector, part.rung, part.lobe, part.filter, &advance)?;
        levels.push((level, start.elapsed().as_secs_f64()));
    }
    Ok(order.finish(levels, reflector.oem().size(), reflector.oem().totals()))
}

/// What makes one level differ from another of the same environment.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Part {
    pub(crate) rung: Rung,
    pub(crate) lobe: Lobe,
    pub(crate) filter: Filter,
}

/// Bakes as they are ordered of an engine: which levels, over which OEM.
pub(crate) struct Order<'a> {
    environment: &'a Environment,
    settings: &'a [BakeSettings],
    parts: Vec<Part>,
    /// Which parts each bake takes: its ladder, then its irradiance where it is asked for.
    wanted: Vec<Vec<usize>>,
    /// The rungs of all ladders.
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
    pub(crate) fn new(environment: &'a Environment, settings: &'a [BakeSettings]) -> Result<Self> {
        if settings.is_empty() {
            return Err(Error::Parameter("there is nothing to bake".to_owned()));
        }
        let mut parts: Vec<Part> = Vec::new();
        let mut wanted = Vec::with_capacity(settings.len());
        let mut all_rungs = Vec::new();
        for settings in settings {
            if settings.irradiance == Some(0) {
                return Err(Error::Parameter("--irradiance must be at least 1".to_owned()));
            }
            let filter = settings.filter;
            let rungs = settings.rungs()?;
            all_rungs.extend(rungs.iter().copied());
            let levels = rungs.into_iter().map(|rung| Part { rung, lobe: settings.lobe, filter });
            let irradiance = settings.irradiance.map(|size| {
                let rung = Rung { size, roughness: 1.0 };
                let filter = if let Filter::Fitted(_) = filter { Filter::Adaptive(0.005) } else { filter };
                Part { rung, lobe: Lobe::Cosine, filter }
            });
            let places: Vec<usize> = levels
                .chain(irradiance)
                .map(|part| {
                    parts.iter().position(|other| *other == part).unwrap_or_else(|| {
                        parts.push(part);
                        parts.len() - 1
                    })
                })
                .collect();
            wanted.push(places);
        }
        Ok(Self { environment, settings, parts, wanted, rungs: all_rungs })
    }

    pub(crate) fn meter<'p>(&self, progress: &'p (dyn Fn(Progress) + Sync)) -> Meter<'p> {
        let texels = |part: &Part| 6 * u64::from(part.rung.size) * u64::from(part.rung.size);
        Meter { done: AtomicU64::new(0), total: self.parts.iter().map(texels).sum(), progress }
    }

    /// The levels to bake, each once.
    pub(crate) fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// What the reflector must serve.
    pub(crate) fn reflector_settings(&self) -> ReflectorSettings {
        let Self { environment, settings, rungs, .. } = self;
        let sharpest = sharpest(rungs);
        let oem_size = settings.iter().filter_map(|settings| settings.oem_size).max();
        // The safety border: plain four-corner reads for the widest box of the ladders.
        let inner = oem_size.unwrap_or_else(|| default_oem_size(environment.layout(), 0, sharpest));
        let roughest = rungs.iter().map(|rung| rung.roughness).fold(0.0, f64::max);
        let own = |settings: &BakeSettings| {
            settings.border.or_else(|| {
                (settings.filter == Filter::Box)
                    .then(|| box_filter::widest_half_extent(settings.lobe, roughest * roughest, inner))
            })
        };
        let border = settings.iter().filter_map(own).max();
        let fitted = settings.iter().any(|settings| matches!(settings.filter, Filter::Fitted(_)));
        ReflectorSettings { oem_size, border, sharpest, fitted }
    }

    /// The bakes, from the levels and the seconds that each took, and the OEM's size and totals.
    pub(crate) fn finish(
        self,
        mut levels: Vec<(BakedLevel, f64)>,
        oem: OemSize,
        totals: [f64; 4],
    ) -> Vec<Bake> {
        let Self { environment, settings, parts, wanted, rungs } = self;
        let mut warnings = Vec::new();
        let asked = default_oem_size(environment.layout(), 0, sharpest(&rungs))
            .min(source_oem_size(environment.layout()));
        if oem.inner < asked {
            warnings.push(format!(
                "the OEM of {} texels is coarser than source and lobes ask for, {asked}",
                oem.inner
            ));
        }
        let sh = sh::spherical_harmonics(environment);
        // L0 is the integral of the radiance times the constant 1/sqrt(4 pi).
        let source_energy = sh[0].map(|coefficient| coefficient * (4.0 * std::f64::consts::PI).sqrt());
        let stats: Vec<LevelStats> =
            levels.iter().map(|(level, seconds)| LevelStats::new(level, *seconds)).collect();
        // The last bake to want a level gets the level itself.
        let mut uses = vec![0_u32; parts.len()];
        wanted.iter().flatten().for_each(|place| uses[*place] += 1);
        let mut cube_level = |place: usize, bounds: bool| {
            let Rung { size, roughness } = parts[place].rung;
            let level = &mut levels[place].0;
            uses[place] -= 1;
            let (texels, all_bounds) = if uses[place] == 0 {
                (std::mem::take(&mut level.texels), level.bounds.take())
            } else {
                (level.texels.clone(), level.bounds.clone())
            };
            CubeLevel { size, roughness, texels, bounds: all_bounds.filter(|_| bounds) }
        };
        let assemble = |(settings, mut places): (&BakeSettings, Vec<usize>)| {
            let irradiance = settings.irradiance.and_then(|_| places.pop());
            Bake {
                chain: CubeChain {
                    levels: places.iter().map(|place| cube_level(*place, settings.bounds)).collect(),
                },
                stats: places.iter().map(|place| stats[*place].clone()).collect(),
                irradiance: irradiance.map(|place| cube_level(place, false)),
                sh,
                oem,
                source_energy,
                oem_energy: [totals[0], totals[1], totals[2]],
                warnings: warnings.clone(),
            }
        };
        settings.iter().zip(wanted).map(assemble).collect()
    }
}

impl LevelStats {
    fn new(level: &BakedLevel, seconds: f64) -> Self {
        let bounds = level.bounds.as_deref();
        Self {
            seconds,
            leaves_per_texel: level.leaves_per_texel,
            error_bound_max: bounds.map(|b| b.iter().fold(0.0, |most, bound| f64::from(*bound).max(most))),
            error_bound_mean: bounds.map(|b| b.iter().map(|v| f64::from(*v)).sum::<f64>() / b.len() as f64),
        }
    }
}

/// The least roughness above 0.
fn sharpest(rungs: &[Rung]) -> f64 {
    rungs.iter().map(|rung| rung.roughness).filter(|r| *r > 0.0).fold(1.0, f64::min)
}
