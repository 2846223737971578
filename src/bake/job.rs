//! What is baked for several settings: every level once.

use super::part::Part;
use crate::bake::level::BakedLevel;
use crate::bake::result::{Bake, LevelStats, Meter, Progress, sharpest};
use crate::bake::settings::BakeSettings;
use crate::chain::{CubeChain, CubeLevel, ImageLevel, Rung};
use crate::cpu::box_filter;
use crate::environment::{Environment, Layout, Map};
use crate::error::{Error, Result};
use crate::filter::Filter;
use crate::lobe::Lobe;
use crate::oem::OemSize;
use crate::reflector::{ReflectorSettings, default_oem_size, source_oem_size};
use crate::sh;
use std::sync::atomic::AtomicU64;

/// Bakes as they are ordered of an engine: which levels, over which OEM.
pub(crate) struct Order<'a> {
    pub(crate) environment: &'a Environment,
    pub(crate) settings: &'a [BakeSettings],
    pub(crate) parts: Vec<Part>,
    /// Which parts each bake takes: its ladder, then that of its sheen and its irradiance where they are
    /// asked for.
    wanted: Vec<Vec<usize>>,
    /// The rungs of all ladders.
    pub(crate) rungs: Vec<Rung>,
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

    /// The bakes, from the levels and the seconds that each took, and the OEM's size and its energy in the
    /// source's units.
    ///
    /// # Errors
    /// [`Error::NonFiniteResult`] for a level, a bound or a coefficient that is not a number to be written.
    /// Every bake of either engine comes through here.
    pub(crate) fn finish(
        self,
        mut levels: Vec<(BakedLevel, f64)>,
        oem: OemSize,
        oem_energy: [f64; 3],
    ) -> Result<Vec<Bake>> {
        let Self { environment, settings, parts, wanted, rungs } = self;
        for (part, (level, _)) in parts.iter().zip(&levels) {
            level.check(part)?;
        }
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
        let sums = sh.as_flattened().iter().chain(&oem_energy);
        if let Some(value) = sums.into_iter().find(|value| !value.is_finite()) {
            let place = "the source's harmonics or the OEM's energy".to_owned();
            return Err(Error::NonFiniteResult { place, value: *value });
        }
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
                oem_energy,
                warnings: warnings.clone(),
            }
        };
        Ok(settings.iter().zip(wanted).map(assemble).collect())
    }
}
