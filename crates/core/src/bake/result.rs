//! Results and progress of a bake.

use super::level::{BakedLevel, Processor};
use crate::common::error::{Error, Result, wrong};
use crate::light::chain::{Chain, Level};
use crate::light::environment::first_wrong;
use crate::light::oem::OemSize;
use crate::light::sh::window::ShWindow;
use crate::pyramid::BakedPyramid;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

/// Statistics of a baked level.
#[derive(Clone, Debug)]
pub struct LevelStats {
    /// Engine that computed the level.
    pub processor: Processor,
    /// Wall time.
    pub seconds: f64,
    /// Average quadrature leaves per texel; `None` if the filter has none.
    pub leaves_per_texel: Option<f64>,
    /// Maximum certified bound, absolute luminance; `None` if the filter or a solved chain has none.
    pub error_bound_max: Option<f64>,
    /// Mean certified bound, absolute luminance; `None` if the filter has none.
    pub error_bound_mean: Option<f64>,
    /// 99th percentile of the bounds, absolute luminance; `None` if the filter has none.
    pub error_bound_p99: Option<f64>,
    /// Maximum certified bound of red, green and blue, absolute; `None` if the filter or a solved chain has
    /// none.
    pub error_bound_max_channels: Option<[f64; 3]>,
}

/// Result of a bake.
#[derive(Clone, Debug)]
pub struct Bake {
    /// The prefiltered levels.
    pub chain: Chain,
    /// Statistics of each level.
    pub stats: Vec<LevelStats>,
    /// The irradiance cube, if requested; values are irradiance/pi.
    pub irradiance: Option<Level>,
    /// The unfiltered environment, if requested; see [`crate::bake::BakeSettings::skybox`].
    pub skybox: Option<Level>,
    /// The levels of the Charlie lobe, if requested.
    pub sheen: Option<Chain>,
    /// Statistics of each sheen level.
    pub sheen_stats: Vec<LevelStats>,
    /// The pyramid, if requested.
    pub pyramid: Option<BakedPyramid>,
    /// Spherical harmonics of the source, see `sh`, windowed.
    pub sh: Vec<[f64; 3]>,
    /// Their window, with its width resolved.
    pub sh_window: ShWindow,
    /// The OEM's size.
    pub oem: OemSize,
    /// Total energy (radiance times solid angle) of the source, per channel.
    pub source_energy: [f64; 3],
    /// Total energy of the OEM.
    pub oem_energy: [f64; 3],
    /// Typical error of the chain's trilinear look-ups, measured along a few dozen directions at each of
    /// several roughnesses: the median over roughness of the root mean square error of the worst channel,
    /// relative to its mean. `None` unless requested ([`crate::bake::BakeSettings::measure`]), and where the
    /// source resolves none of the lobes.
    pub typical_error: Option<f64>,
    /// Warnings.
    pub warnings: Vec<String>,
}

impl Bake {
    /// All levels: the chain, then the irradiance, the skybox and the sheen, if present.
    pub fn levels(&self) -> impl Iterator<Item = &Level> {
        let sheen = self.sheen.iter().flat_map(|sheen| &sheen.levels);
        self.chain.levels.iter().chain(&self.irradiance).chain(&self.skybox).chain(sheen)
    }

    /// Checks that the levels, whose fields the caller may have changed, are those of a chain.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a chain of no levels or of sides that do not halve, for another number of
    /// texels or bounds than a level's layout has, and for values that are negative or not finite.
    pub(crate) fn check(&self) -> Result<()> {
        for chain in std::iter::once(&self.chain).chain(&self.sheen) {
            let Some(first) = chain.levels.first() else {
                return wrong("a chain of no levels; bake it again");
            };
            for (level, number) in chain.levels.iter().zip(0..) {
                let layout = first.layout.map().layout(first.size(), number);
                if level.layout != layout {
                    return wrong(format!(
                        "level {number} is {:?}, but its place needs {layout:?}",
                        level.layout
                    ));
                }
            }
        }
        for level in self.levels() {
            let (layout, needed) = (level.layout, level.layout.texel_count());
            let counts = [Some(level.texels.len()), level.bounds.as_ref().map(Vec::len)];
            if let Some(count) = counts.into_iter().flatten().find(|count| *count != needed) {
                return wrong(format!("a level of {layout:?} has {count} texels or bounds, not {needed}"));
            }
            let values = [level.texels.as_flattened(), level.bounds.as_deref().unwrap_or_default()];
            if let Some(value) = values.iter().find_map(|values| Some(values[first_wrong(values)?])) {
                return wrong(format!(
                    "a level of {layout:?} holds {value}; it must be finite, not negative"
                ));
            }
        }
        Ok(())
    }

    /// Mutable [`Bake::levels`].
    pub fn levels_mut(&mut self) -> impl Iterator<Item = &mut Level> {
        let sheen = self.sheen.iter_mut().flat_map(|sheen| &mut sheen.levels);
        let cubes = self.irradiance.iter_mut().chain(self.skybox.as_mut());
        self.chain.levels.iter_mut().chain(cubes).chain(sheen)
    }
}

/// Progress of a bake: `done` of `total` output texels.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Level being baked.
    pub level: u32,
    /// Output texels done in all levels.
    pub done: u64,
    /// Output texels of all levels.
    pub total: u64,
}

/// Called during a bake, from any thread; [`ControlFlow::Break`] cancels it.
pub type OnProgress<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

/// Counts output texels and reports progress.
pub(crate) struct Meter<'a> {
    pub(super) done: AtomicU64,
    pub(super) total: u64,
    pub(super) progress: OnProgress<'a>,
}

impl Meter<'_> {
    /// Reports `texels` more finished texels of level `level`.
    ///
    /// # Errors
    /// [`Error::Cancelled`] if the caller cancels.
    pub(crate) fn advance(&self, level: usize, texels: u64) -> Result<()> {
        let done = self.done.fetch_add(texels, Ordering::Relaxed) + texels;
        match (self.progress)(Progress { level: level as u32, done, total: self.total }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Cancelled),
        }
    }
}

impl LevelStats {
    /// Forgets the bounds, which are not those of solved texels.
    pub(super) const fn drop_bounds(&mut self) {
        (self.error_bound_max, self.error_bound_mean, self.error_bound_p99) = (None, None, None);
        self.error_bound_max_channels = None;
    }

    pub(super) fn new(level: &BakedLevel, seconds: f64) -> Self {
        let bounds = level.bounds.as_deref();
        Self {
            processor: level.processor,
            seconds,
            leaves_per_texel: level.leaves_per_texel,
            error_bound_max: bounds.map(|b| b.iter().fold(0.0, |most, bound| f64::from(*bound).max(most))),
            error_bound_mean: bounds.map(|b| b.iter().map(|v| f64::from(*v)).sum::<f64>() / b.len() as f64),
            error_bound_p99: bounds.and_then(percentile_99).map(f64::from),
            error_bound_max_channels: level.channel_bounds.map(|bounds| bounds.map(f64::from)),
        }
    }
}

/// Smallest of `roughnesses` above 0.
pub(super) fn sharpest(roughnesses: impl Iterator<Item = f64>) -> f64 {
    roughnesses.filter(|r| *r > 0.0).fold(1.0, f64::min)
}

/// 99th percentile of `bounds`; `None` if there are none.
pub(super) fn percentile_99(bounds: &[f32]) -> Option<f32> {
    let place = (99 * bounds.len()).div_ceil(100).checked_sub(1)?;
    Some(*bounds.to_vec().select_nth_unstable_by(place, f32::total_cmp).1)
}
