//! Lobes to cube chains: the levels and roughnesses of a bake, and the bake itself.

use crate::chain::{CubeChain, CubeLevel, ImageLevel};
use crate::cpu::bake_level::{self, BakedLevel};
use crate::cpu::box_filter;
use crate::environment::{Environment, Layout, Map};
use crate::error::{Error, Result};
use crate::fitted::COUNTS;
use crate::lobe::Lobe;
use crate::oem::OemSize;
use crate::reflector::{Reflector, ReflectorSettings, default_oem_size, source_oem_size};
use crate::sh;
use crate::sh_window::ShWindow;
use std::sync::atomic::{AtomicU64, Ordering};
use web_time::Instant;

/// How a level's roughness follows from its index.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ladder {
    /// r = level/(levels - 1): glTF, Bevy, the Khronos sampler.
    #[default]
    Linear,
    /// r = 1 - sqrt(1 - level/(levels - 1)): Filament, three.js.
    Filament,
    /// r (1.7 - 0.7 r) = level/(levels - 1): Unity.
    Unity,
    /// alpha = 2^(level/0.8)/size, at most 1: Babylon.js.
    Babylon,
}

impl Ladder {
    /// Name on the command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Filament => "filament",
            Self::Unity => "unity",
            Self::Babylon => "babylon",
        }
    }

    /// Perceptual roughness of level `level` of `levels` below a level 0 of `size` texels.
    #[must_use]
    pub fn roughness(self, level: u32, levels: u32, size: u32) -> f64 {
        let step = if levels <= 1 { 0.0 } else { f64::from(level) / f64::from(levels - 1) };
        match self {
            _ if step == 0.0 => 0.0,
            Self::Linear => step,
            Self::Filament => 1.0 - (1.0 - step).sqrt(),
            // Exact at the end, where the root is rounded.
            Self::Unity if step == 1.0 => 1.0,
            Self::Unity => (1.7 - (2.89 - 2.8 * step).sqrt()) / 1.4,
            Self::Babylon => ((f64::from(level) / 0.8).exp2() / f64::from(size)).min(1.0).sqrt(),
        }
    }
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
    /// The filter of the lobes that come beside a chain's own, sheen and irradiance: fitted lobes are GGX alone.
    #[must_use]
    pub const fn beside(self) -> Self {
        match self {
            Self::Fitted(_) => Self::Adaptive(0.005),
            other => other,
        }
    }

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
            Self::Box if lobe == Lobe::Charlie => wrong(
                "one box around a direction is no Charlie lobe, which is dark there; use --filter adaptive:E"
                    .to_owned(),
            ),
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
    /// What the levels' texels cover.
    pub map: Map,
    /// Texels along an edge of level 0; of a panorama its height.
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
    /// The highest band of the spherical harmonics, at most [`sh::MAX_ORDER`].
    pub sh_order: u32,
    /// What their bands are multiplied by.
    pub sh_window: ShWindow,
    /// Bake the sizes and roughnesses of the chain with the Charlie lobe (sheen) as well.
    pub sheen: bool,
}

impl Default for BakeSettings {
    fn default() -> Self {
        Self {
            map: Map::Cube,
            size: 256,
            levels: None,
            ladder: Ladder::Linear,
            lobe: Lobe::Ggx,
            filter: Filter::Adaptive(0.005),
            oem_size: None,
            border: None,
            bounds: false,
            irradiance: None,
            sh_order: 2,
            sh_window: ShWindow::None,
            sheen: false,
        }
    }
}

/// A level to be baked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rung {
    /// Its texels.
    pub layout: Layout,
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
}

impl BakeSettings {
    /// Size and roughness of every level.
    ///
    /// # Errors
    /// [`Error::Parameter`] for no size, no levels, more levels than reach a size of 1, or a filter that the lobe does
    /// not have.
    pub fn rungs(&self) -> Result<Vec<Rung>> {
        if self.size == 0 {
            return Err(Error::Parameter("--size must be at least 1".to_owned()));
        }
        self.filter.check(self.lobe, self.oem_size)?;
        if self.sheen {
            self.filter.beside().check(Lobe::Charlie, None)?;
        }
        let most = self.map.most_levels(self.size);
        let own = match self.ladder {
            Ladder::Linear | Ladder::Babylon => most,
            // Six steps (UNITY_SPECCUBE_LOD_STEPS).
            Ladder::Unity => most.min(7),
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
        let roughness = |level| self.ladder.roughness(level, levels, self.size);
        Ok((0..levels)
            .map(|level| Rung { layout: self.map.layout(self.size, level), roughness: roughness(level) })
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
    /// The prefiltered levels; none where [`BakeSettings::map`] is not the cube.
    pub chain: CubeChain,
    /// The prefiltered levels where it is another.
    pub images: Vec<ImageLevel>,
    /// Figures, one a level.
    pub stats: Vec<LevelStats>,
    /// The irradiance cube, where asked for; values are irradiance/pi.
    pub irradiance: Option<CubeLevel>,
    /// The levels of the Charlie lobe, where asked for.
    pub sheen: Option<CubeChain>,
    /// Their figures.
    pub sheen_stats: Vec<LevelStats>,
    /// Spherical harmonics of the source, see [`crate::sh`], windowed.
    pub sh: Vec<[f64; 3]>,
    /// Their window, its width found where it was to be.
    pub sh_window: ShWindow,
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
    /// Which parts each bake takes: its ladder, then that of its sheen and its irradiance where they are asked for.
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
            if settings.sh_order > sh::MAX_ORDER {
                let (asked, most) = (settings.sh_order, sh::MAX_ORDER);
                return Err(Error::Parameter(format!("--sh-order {asked} is above {most}")));
            }
            if settings.irradiance == Some(0) {
                return Err(Error::Parameter("--irradiance must be at least 1".to_owned()));
            }
            let filter = settings.filter;
            let rungs = settings.rungs()?;
            let sheen = settings.sheen.then_some((Lobe::Charlie, filter.beside()));
            let lobes = std::iter::once((settings.lobe, filter)).chain(sheen);
            let levels: Vec<Part> = lobes
                .flat_map(|(lobe, filter)| rungs.iter().map(move |rung| Part { rung: *rung, lobe, filter }))
                .collect();
            all_rungs.extend(levels.iter().map(|Part { rung, lobe, .. }| Rung {
                roughness: lobe.served_roughness(rung.roughness),
                ..*rung
            }));
            let irradiance = settings.irradiance.map(|size| {
                let rung = Rung { layout: Layout::Cube { size }, roughness: 1.0 };
                Part { rung, lobe: Lobe::Cosine, filter: filter.beside() }
            });
            let places: Vec<usize> = levels
                .into_iter()
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
        let texels = |part: &Part| part.rung.layout.texel_count() as u64;
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
        let highest = settings.iter().map(|settings| settings.sh_order).max().unwrap_or(0);
        let sh = sh::spherical_harmonics(environment, highest);
        // L0 is the integral of the radiance times the constant 1/sqrt(4 pi).
        let source_energy = sh[0].map(|coefficient| coefficient * (4.0 * std::f64::consts::PI).sqrt());
        let stats: Vec<LevelStats> =
            levels.iter().map(|(level, seconds)| LevelStats::new(level, *seconds)).collect();
        // The last bake to want a level gets the level itself.
        let mut uses = vec![0_u32; parts.len()];
        wanted.iter().flatten().for_each(|place| uses[*place] += 1);
        let mut taken = |place: usize| {
            let level = &mut levels[place].0;
            uses[place] -= 1;
            if uses[place] == 0 {
                (std::mem::take(&mut level.texels), level.bounds.take())
            } else {
                (level.texels.clone(), level.bounds.clone())
            }
        };
        let assemble = |(settings, mut places): (&BakeSettings, Vec<usize>)| {
            let irradiance = settings.irradiance.and_then(|_| places.pop());
            let sheen = if settings.sheen { places.split_off(places.len() / 2) } else { Vec::new() };
            let sh = &sh[..sh::count(settings.sh_order)];
            let sh_window = settings.sh_window.settled(sh);
            let mut cube_level = |place: usize, keep_bounds: bool| {
                let Rung { layout, roughness } = parts[place].rung;
                let (texels, bounds) = taken(place);
                CubeLevel {
                    size: layout.sides().0,
                    roughness,
                    texels,
                    bounds: bounds.filter(|_| keep_bounds),
                }
            };
            let irradiance = irradiance.map(|place| cube_level(place, false));
            let sheen_stats = sheen.iter().map(|place| stats[*place].clone()).collect();
            let sheen = settings
                .sheen
                .then(|| CubeChain { levels: sheen.iter().map(|place| cube_level(*place, false)).collect() });
            let mut chain = CubeChain { levels: Vec::new() };
            let mut images = Vec::new();
            if settings.map == Map::Cube {
                chain.levels.extend(places.iter().map(|place| cube_level(*place, settings.bounds)));
            } else {
                images.extend(places.iter().map(|place| {
                    let Rung { layout, roughness } = parts[*place].rung;
                    ImageLevel { layout, roughness, texels: taken(*place).0 }
                }));
            }
            Bake {
                chain,
                images,
                stats: places.iter().map(|place| stats[*place].clone()).collect(),
                irradiance,
                sheen,
                sheen_stats,
                sh: sh_window.apply(sh),
                sh_window,
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
