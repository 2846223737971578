//! Combines the levels of several settings, so that each is baked once.

use super::level::{BakedLevel, LevelJob};
use super::result::{Bake, LevelStats, Meter, OnProgress, sharpest};
use super::settings::BakeSettings;
use super::solve::solve;
use crate::common::error::{Error, Result, wrong};
use crate::cpu::box_filter;
use crate::cpu::reflector::{ReflectorSettings, source_oem_size};
use crate::light::chain::{Chain, Level, LevelSpec};
use crate::light::environment::{Environment, Layout, Map, Rgb};
use crate::light::oem::OemSize;
use crate::light::sat::Scan;
use crate::light::sh;
use crate::lobe::Lobe;
use crate::lobe::filter::Filter;
use std::sync::atomic::AtomicU64;

/// Several bakes of one environment over one OEM: the distinct levels, and which of them each bake uses.
pub struct Job<'a> {
    environment: &'a Environment,
    settings: &'a [BakeSettings],
    levels: Vec<LevelJob>,
    /// One entry per settings.
    bakes: Vec<BakeParts>,
}

/// The parts of one bake, as indices of [`Job::levels`].
struct BakeParts {
    levels: Vec<usize>,
    /// The levels of the Charlie lobe, if requested.
    sheen: Option<Vec<usize>>,
    irradiance: Option<usize>,
    skybox: Option<usize>,
    /// The lobes between its levels, for a solved chain.
    nodes: Vec<usize>,
}

impl<'a> Job<'a> {
    /// # Errors
    /// [`Error::Parameter`] for no settings, or settings out of their ranges.
    pub fn new(environment: &'a Environment, settings: &'a [BakeSettings]) -> Result<Self> {
        if settings.is_empty() {
            return wrong("there is nothing to bake");
        }
        shared_scan(settings)?;
        let mut levels: Vec<LevelJob> = Vec::new();
        let mut index_of = |level: LevelJob| {
            levels.iter().position(|other| *other == level).unwrap_or_else(|| {
                levels.push(level);
                levels.len() - 1
            })
        };
        let mut bakes = Vec::with_capacity(settings.len());
        for settings in settings {
            if settings.sh_order > sh::MAX_ORDER {
                let (asked, most) = (settings.sh_order, sh::MAX_ORDER);
                return wrong(format!("`sh_order` {asked} is above {most}"));
            }
            settings.sh_window.check()?;
            for (size, name) in [(settings.irradiance, "irradiance"), (settings.skybox, "skybox")] {
                if size == Some(0) {
                    return wrong(format!("`{name}` must be at least 1"));
                }
            }
            let (specs, other_filter) = (settings.level_specs()?, settings.filter.for_other_lobes());
            let mut chain = |lobe: Lobe, filter: Filter, sparse: bool| -> Vec<usize> {
                specs.iter().map(|spec| index_of(LevelJob { spec: *spec, lobe, filter, sparse })).collect()
            };
            // Those of other lobes are kept.
            let is_sparse = settings.lobe != Lobe::Charlie || !settings.bounds;
            let levels = chain(settings.lobe, settings.filter, is_sparse);
            let sheen = settings.sheen.then(|| chain(Lobe::Charlie, other_filter, true));
            let irradiance = settings.irradiance.map(|size| {
                let spec = LevelSpec { layout: Layout::Cube { size }, roughness: 1.0 };
                index_of(LevelJob { spec, lobe: Lobe::Cosine, filter: other_filter, sparse: false })
            });
            let skybox = settings.skybox.map(|size| {
                let layout = match settings.map {
                    Map::Panorama => Map::Panorama.layout(size.saturating_mul(2), 0),
                    Map::Cube | Map::Octahedral => Layout::Cube { size },
                };
                let spec = LevelSpec { layout, roughness: 0.0 };
                // As level 0 of that size.
                index_of(LevelJob { spec, lobe: Lobe::Ggx, filter: settings.filter, sparse: false })
            });
            let node = |spec| LevelJob { spec, lobe: settings.lobe, filter: settings.filter, sparse: false };
            let nodes = settings.nodes(specs.len()).iter().map(|found| index_of(node(found.spec))).collect();
            bakes.push(BakeParts { levels, sheen, irradiance, skybox, nodes });
        }
        Ok(Self { environment, settings, levels, bakes })
    }

    /// The environment and the settings, one a bake.
    pub(crate) const fn inputs(&self) -> (&'a Environment, &'a [BakeSettings]) {
        (self.environment, self.settings)
    }

    pub(crate) fn meter<'p>(&self, progress: OnProgress<'p>) -> Meter<'p> {
        let texels = |level: &LevelJob| level.spec.layout.texel_count() as u64;
        Meter { done: AtomicU64::new(0), total: self.levels.iter().map(texels).sum(), progress }
    }

    /// The levels to bake.
    pub fn levels(&self) -> &[LevelJob] {
        &self.levels
    }

    /// The roughnesses of all chains and lobes.
    fn roughnesses(&self) -> impl Iterator<Item = f64> {
        let chains = self.bakes.iter().flat_map(|bake| bake.levels.iter().chain(bake.sheen.iter().flatten()));
        chains.map(|index| {
            let LevelJob { spec, lobe, .. } = self.levels[*index];
            lobe.served_roughness(spec.roughness)
        })
    }

    /// Settings of a reflector that supports all levels.
    pub fn reflector_settings(&self) -> ReflectorSettings {
        let Self { environment, settings, .. } = self;
        let sharpest = sharpest(self.roughnesses());
        let oem_size = settings.iter().filter_map(|settings| settings.oem_size).max();
        // Border that allows plain four-corner reads for the widest box of the ladders.
        let pyramid = settings.iter().any(|settings| settings.filter == Filter::Pyramid);
        let scan = shared_scan(settings).expect("checked");
        let table = ReflectorSettings { oem_size, border: None, scan, sharpest, pyramid };
        let inner = oem_size.unwrap_or_else(|| table.default_oem_size(environment.layout()));
        let roughest = self.roughnesses().fold(0.0, f64::max);
        let own = |settings: &BakeSettings| {
            settings.border.or_else(|| {
                (settings.filter == Filter::Box)
                    .then(|| box_filter::widest_half_extent(settings.lobe, roughest * roughest, inner))
            })
        };
        let border = settings.iter().filter_map(own).max();
        ReflectorSettings { border, ..table }
    }

    /// Assembles the bakes from the levels with their durations in seconds, and the OEM's size and energy in
    /// the source's units.
    ///
    /// # Errors
    /// [`Error::NonFiniteResult`] for a NaN, infinite or negative level or bound, or an invalid coefficient.
    /// All bakes of both engines pass through this check.
    pub(crate) fn finish(
        self,
        mut baked: Vec<(BakedLevel, f64)>,
        oem: OemSize,
        oem_energy: [f64; 3],
    ) -> Result<Vec<Bake>> {
        for (level, (baked, _)) in self.levels.iter().zip(&baked) {
            baked.check(level)?;
        }
        let mut warnings = Vec::new();
        let source = self.environment.layout();
        let table = ReflectorSettings { border: None, ..self.reflector_settings() };
        let asked = table.default_oem_size(source).min(source_oem_size(source));
        if oem.inner < asked {
            warnings.push(format!(
                "the octahedral map of {0} x {0} texels is coarser than the source; lobes sharper than its \
                 texels are blurred. `oem_size` {asked} resolves them",
                oem.inner
            ));
        }
        let highest = self.settings.iter().map(|settings| settings.sh_order).max().unwrap_or(0);
        let sh = sh::spherical_harmonics(self.environment, highest)?;
        // L0 is the integral of the radiance times the constant 1/sqrt(4 pi).
        let source_energy = sh[0].map(|coefficient| coefficient * (4.0 * std::f64::consts::PI).sqrt());
        let sums = sh.as_flattened().iter().chain(&oem_energy);
        if let Some(value) = sums.into_iter().find(|value| !value.is_finite()) {
            let place = "the source's harmonics or the OEM's energy".to_owned();
            return Err(Error::NonFiniteResult { place, value: *value });
        }
        let stats: Vec<LevelStats> =
            baked.iter().map(|(level, seconds)| LevelStats::new(level, *seconds)).collect();
        // Move a level into the last bake that uses it; clone it for the others.
        let mut uses = vec![0_u32; baked.len()];
        for BakeParts { levels, sheen, irradiance, skybox, nodes } in &self.bakes {
            let all =
                levels.iter().chain(sheen.iter().flatten()).chain(irradiance).chain(skybox).chain(nodes);
            all.for_each(|index| uses[*index] += 1);
        }
        let Self { settings, levels: jobs, bakes, .. } = self;
        let mut taken = |index: usize, bounds: BoundsUse| {
            let level = &mut baked[index].0;
            uses[index] -= 1;
            let (texels, found) = if uses[index] == 0 {
                (std::mem::take(&mut level.texels), level.bounds.take())
            } else {
                (level.texels.clone(), level.bounds.clone())
            };
            let LevelSpec { layout, roughness } = jobs[index].spec;
            Level { layout, roughness, texels, bounds: found.filter(|_| bounds == BoundsUse::Keep) }
        };
        let assemble = |(settings, parts): (&BakeSettings, BakeParts)| {
            let sh = &sh[..sh::count(settings.sh_order)];
            let sh_window = settings.sh_window.settled(sh);
            let bounds = if settings.bounds { BoundsUse::Keep } else { BoundsUse::Drop };
            let stats_of = |indices: &[usize]| -> Vec<LevelStats> {
                indices.iter().map(|index| stats[*index].clone()).collect()
            };
            let sheen_stats = stats_of(parts.sheen.as_deref().unwrap_or_default());
            let mut chain = |indices: &[usize], bounds: BoundsUse| Chain {
                levels: indices.iter().map(|index| taken(*index, bounds)).collect(),
            };
            let (mut own, mut stats) = (chain(&parts.levels, bounds), stats_of(&parts.levels));
            let nodes = settings.nodes(own.levels.len());
            let lobes = chain(&parts.nodes, BoundsUse::Drop);
            let lobes: Vec<&[Rgb]> = lobes.levels.iter().map(|lobe| &lobe.texels[..]).collect();
            for index in solve(settings.chain(), &mut own.levels, &nodes, &lobes) {
                stats[index].drop_bounds();
            }
            Bake {
                chain: own,
                stats,
                sheen: parts.sheen.map(|sheen| chain(&sheen, BoundsUse::Drop)),
                sheen_stats,
                pyramid: None,
                irradiance: parts.irradiance.map(|index| taken(index, BoundsUse::Drop)),
                skybox: parts.skybox.map(|index| taken(index, BoundsUse::Drop)),
                sh: sh_window.applied(sh),
                sh_window,
                oem,
                source_energy,
                oem_energy,
                typical_error: None,
                warnings: warnings.clone(),
            }
        };
        Ok(settings.iter().zip(bakes).map(assemble).collect())
    }
}

/// The scan of the table that all of `settings` share.
///
/// # Errors
/// [`Error::Parameter`] for different scans among the settings whose filter reads the table.
fn shared_scan(settings: &[BakeSettings]) -> Result<Scan> {
    let mut scans = settings.iter().filter(|own| own.filter.reads_sat()).map(|own| own.scan);
    let first = scans.next().unwrap_or_default();
    match scans.find(|scan| *scan != first) {
        None => Ok(first),
        Some(other) => wrong(format!(
            "`scan` {first} and {other} for one table; bakes of one environment share it, choose one of them"
        )),
    }
}

/// Handling of a level's bounds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum BoundsUse {
    Keep,
    Drop,
}
