//! Lobes to cube chains: the levels and roughnesses of a bake, and the bake itself.

use crate::chain::{CubeChain, CubeLevel};
use crate::environment::Environment;
use crate::error::Result;
use crate::lobe::Lobe;
use crate::oem::OemSize;

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

/// Bakes `environment`; calls `progress` now and then, from any thread.
///
/// # Errors
/// [`crate::Error::Parameter`] for settings that make no sense together.
pub fn bake(
    _environment: &Environment,
    _settings: &BakeSettings,
    _progress: &(dyn Fn(Progress) + Sync),
) -> Result<Bake> {
    Err(crate::Error::Parameter("the bake is under construction".to_owned()))
}
