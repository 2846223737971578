//! Measurements of `octagloss compare` and `bake --verify`.

use super::args::CompareArgs;
use super::values::Texels;
use crate::Lobe;
use octagloss_core::analysis::compare::Sampling;
use std::path::PathBuf;

/// Texels of a level to integrate by default,
const TEXELS: usize = 400;
/// and of cones, whose edge takes an integration as long as ten of another lobe.
const CONE_TEXELS: usize = 40;

/// Requested measurements.
#[derive(Clone, Default)]
pub(super) struct Measures {
    pub(super) texels: Option<Texels>,
    /// Roughnesses of look-ups; without any, those between the levels.
    pub(super) delivered: Option<Vec<f64>>,
    /// Whether the errors of texels are drawn.
    pub(super) is_drawn: bool,
    /// Whether the errors of look-ups are.
    pub(super) is_charted: bool,
    pub(super) overlays: Vec<PathBuf>,
    /// Roughness from which a verdict is needed.
    pub(super) from: Option<f64>,
}

impl Measures {
    pub(super) fn new(args: &CompareArgs, from: Option<f64>) -> Self {
        Self {
            texels: args.texels,
            delivered: args.delivered.clone(),
            is_drawn: args.picture.is_some(),
            is_charted: args.chart.is_some(),
            overlays: args.overlay.clone(),
            from,
        }
    }

    /// The texels to compare: those requested, else few enough for a quick run.
    pub(super) fn sampling(&self, lobe: Lobe) -> Sampling {
        let count = match self.texels {
            Some(Texels::All) => return Sampling::All,
            Some(Texels::Some(count)) => count,
            None if lobe == Lobe::Cone => CONE_TEXELS,
            None => TEXELS,
        };
        if self.is_drawn { Sampling::Grid(count) } else { Sampling::Random(count) }
    }
}

/// Whether a gate from the roughness `from` on judges `roughness`; files store roughness as float32.
pub(super) fn is_from(from: f64, roughness: f64) -> bool {
    roughness >= from - 1e-6
}
