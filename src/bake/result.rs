//! What a bake gives, and how far it is.

use crate::bake::level::BakedLevel;

use crate::chain::{Chain, Level};
use crate::error::{Error, Result};
use crate::oem::OemSize;
use crate::sh::window::ShWindow;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

/// What computed a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Processor {
    /// The CPU; also in a bake of the GPU engine, for levels that it does not serve.
    Cpu,
    /// The GPU.
    Gpu,
}

impl Processor {
    /// Name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
        }
    }
}

/// Figures of one baked level.
#[derive(Clone, Debug)]
pub struct LevelStats {
    /// What computed it.
    pub processor: Processor,
    /// Wall time.
    pub seconds: f64,
    /// Leaves of the quadrature a texel, on average; `None` where the filter has none.
    pub leaves_per_texel: Option<f64>,
    /// Greatest certified bound of the level, absolute luminance; `None` where the filter or a solved chain
    /// has none.
    pub error_bound_max: Option<f64>,
    /// Mean certified bound of the level, absolute luminance; `None` where the filter has none.
    pub error_bound_mean: Option<f64>,
    /// The bound that 99 % of the level's texels keep, absolute luminance; `None` where the filter has none.
    pub error_bound_p99: Option<f64>,
}

/// What a bake made.
#[derive(Clone, Debug)]
pub struct Bake {
    /// The prefiltered levels.
    pub chain: Chain,
    /// Figures, one a level.
    pub stats: Vec<LevelStats>,
    /// The irradiance cube, where asked for; values are irradiance/pi.
    pub irradiance: Option<Level>,
    /// The levels of the Charlie lobe, where asked for.
    pub sheen: Option<Chain>,
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

impl Bake {
    /// All levels: those of the chain, then the irradiance and the sheen where they are.
    pub fn levels(&self) -> impl Iterator<Item = &Level> {
        let sheen = self.sheen.iter().flat_map(|sheen| &sheen.levels);
        self.chain.levels.iter().chain(&self.irradiance).chain(sheen)
    }

    /// [`Bake::levels`], to be changed.
    pub fn levels_mut(&mut self) -> impl Iterator<Item = &mut Level> {
        let sheen = self.sheen.iter_mut().flat_map(|sheen| &mut sheen.levels);
        self.chain.levels.iter_mut().chain(self.irradiance.as_mut()).chain(sheen)
    }
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

/// Called during a bake, from any thread; [`ControlFlow::Break`] cancels it.
pub type OnProgress<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

/// Counts output texels.
pub(crate) struct Meter<'a> {
    pub(super) done: AtomicU64,
    pub(super) total: u64,
    pub(super) progress: OnProgress<'a>,
}

impl Meter<'_> {
    /// Reports that `texels` more of level `level` are done.
    ///
    /// # Errors
    /// [`Error::Cancelled`] where the caller cancels.
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
        }
    }
}

/// The least of `roughnesses` above 0.
pub(super) fn sharpest(roughnesses: impl Iterator<Item = f64>) -> f64 {
    roughnesses.filter(|r| *r > 0.0).fold(1.0, f64::min)
}

/// The least of `bounds` that 99 % of them do not exceed; `None` where there are none.
pub(super) fn percentile_99(bounds: &[f32]) -> Option<f32> {
    let place = (99 * bounds.len()).div_ceil(100).checked_sub(1)?;
    Some(*bounds.to_vec().select_nth_unstable_by(place, f32::total_cmp).1)
}
