//! `report.json`: what a bake did, for people and for programs.
//!
//! Two runs with the same input and options give the same report, but for the keys named `seconds`.

use crate::bake::{Bake, BakeSettings, Filter, Ladder};
use serde::{Deserialize, Serialize};

/// A bake's report; its fields are the keys of `report.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The program and its version.
    pub generator: String,
    /// The input as it was named; of six files the first.
    pub input: String,
    /// What computed: `cpu`.
    pub engine: String,
    /// The graphics adapter; `null` on the CPU.
    pub adapter: Option<String>,
    /// Size of the octahedral map.
    pub oem: OemReport,
    /// The levels, the sharpest first.
    pub levels: Vec<LevelReport>,
    /// Energy before and after reparameterisation.
    pub energy: EnergyReport,
    /// Spherical harmonics of the source.
    pub sh: ShReport,
    /// What was set right in the input.
    pub repaired: RepairReport,
    /// Texels with a channel that the pixel format could not hold.
    pub clamped: u64,
    /// Texels scaled down for the pixel format; absent where there are none.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub compressed: u64,
    /// What the user should know, a line each.
    pub warnings: Vec<String>,
    /// What was asked for.
    pub options: OptionsReport,
    /// What the numbers and images mean.
    pub conventions: ConventionsReport,
    /// What was written for which engine; absent without `--target`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<TargetReport>,
    /// Wall time from reading to writing.
    pub seconds: f64,
}

/// Size of an octahedral environment map.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OemReport {
    /// Texels along an edge, without the border.
    pub size: u32,
    /// Texels added on every side.
    pub border: u32,
}

/// Figures of a level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelReport {
    /// Its number, from 0.
    pub level: u32,
    /// Texels along an edge of a face.
    pub size: u32,
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
    /// Format of its texels as stored.
    pub pixel: String,
    /// Wall time.
    pub seconds: f64,
    /// Leaves of the quadrature a texel, on average; `null` where the filter has none.
    pub leaves_per_texel: Option<f64>,
    /// Greatest certified error bound, absolute luminance; `null` where the filter has none.
    pub error_bound_max: Option<f64>,
    /// Mean certified error bound, absolute luminance; `null` where the filter has none.
    pub error_bound_mean: Option<f64>,
}

/// Total energy: radiance times solid angle, over the sphere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnergyReport {
    /// Red, green and blue of the source.
    pub source: [f64; 3],
    /// Red, green and blue of the octahedral map.
    pub oem: [f64; 3],
    /// The greatest relative difference of a channel.
    pub relative_difference: f64,
}

/// Spherical harmonics L0 to L2.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShReport {
    /// Nine coefficients, red, green and blue each.
    pub coefficients: [[f64; 3]; 9],
    /// Which coefficient is which.
    pub order: String,
    /// What they are multiplied by.
    pub scale: String,
}

/// What was set right in the input.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RepairReport {
    /// Negative values set to 0.
    pub negative: u64,
    /// NaN values set to 0.
    pub nan: u64,
    /// Infinite values set to a finite neighbour.
    pub infinite: u64,
    /// Energy of the negative values over that of the positive ones.
    pub negative_energy_share: f64,
}

/// The options of a bake.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OptionsReport {
    /// Edge of level 0.
    pub size: u32,
    /// `linear` or `filament`.
    pub ladder: String,
    /// Name of the lobe.
    pub lobe: String,
    /// Name of the filter, with its number.
    pub filter: String,
    /// `ktx2`, `exr` or `hdr`.
    pub format: String,
    /// `f16`, `f32`, `rgb9e5`, `rgbe`; `auto` for half with float where half is too small.
    pub pixel: String,
    /// Layout of the input as it was read.
    pub layout: String,
    /// Degrees turned about +Y.
    pub rotate_y: f64,
    /// Whether the input was flipped.
    pub mirror: bool,
    /// Whether NaN and Inf were to be repaired.
    pub sanitize: bool,
    /// Edge of the irradiance cube.
    pub irradiance: Option<u32>,
}

/// What was written for an engine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TargetReport {
    /// Name of the target.
    pub name: String,
    /// The axis that its engine negates before it looks into a cube: `none`, `x` or `z`.
    pub flip: String,
    /// `none`, `cube`, `sh` or `both`.
    pub diffuse: String,
    /// Whether a test has loaded such files into their engine.
    pub verified: bool,
    /// The files, beside this one.
    pub files: Vec<String>,
}

/// What the numbers and images mean.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConventionsReport {
    /// Handedness and up.
    pub space: String,
    /// Faces and their axes.
    pub cube: String,
    /// Which roughness.
    pub roughness: String,
    /// What the texels are.
    pub radiance: String,
}

impl Default for ConventionsReport {
    fn default() -> Self {
        Self {
            space: "right-handed, y up".to_owned(),
            cube: "+X -X +Y -Y +Z -Z, axes as in OpenGL, Vulkan and Direct3D, rows downwards".to_owned(),
            roughness: "perceptual, alpha = roughness^2".to_owned(),
            radiance: "linear RGB, Rec. 709 primaries, the input's own unit".to_owned(),
        }
    }
}

/// What a report tells that the bake itself does not know.
#[derive(Clone, Debug)]
pub struct Circumstances {
    /// The input as it was named.
    pub input: String,
    /// Who baked: `cpu` or `gpu`.
    pub engine: String,
    /// The graphics adapter, where one did.
    pub adapter: Option<String>,
    /// What was set right in it.
    pub repaired: RepairReport,
    /// Its layout, in words.
    pub layout: String,
    /// Degrees turned about +Y.
    pub rotate_y: f64,
    /// Whether it was flipped.
    pub mirror: bool,
    /// Whether NaN and Inf were to be repaired.
    pub sanitize: bool,
    /// Format of the output.
    pub format: String,
    /// Pixel format asked for.
    pub pixel: String,
    /// Pixel format of each level as stored.
    pub level_pixels: Vec<String>,
    /// Texels clamped.
    pub clamped: u64,
    /// Warnings from reading and writing; the bake's own follow.
    pub warnings: Vec<String>,
    /// Wall time from reading to writing.
    pub seconds: f64,
}

impl Report {
    /// The report of `bake`.
    #[must_use]
    pub fn new(settings: &BakeSettings, bake: &Bake, told: Circumstances) -> Self {
        let levels = bake.chain.levels.iter().zip(&bake.stats).zip(told.level_pixels).enumerate();
        let levels = levels.map(|(index, ((level, stats), pixel))| LevelReport {
            level: u32::try_from(index).expect("a cube has at most 32 levels"),
            size: level.size,
            roughness: level.roughness,
            pixel,
            seconds: stats.seconds,
            leaves_per_texel: stats.leaves_per_texel,
            error_bound_max: stats.error_bound_max,
            error_bound_mean: stats.error_bound_mean,
        });
        Self {
            generator: concat!("octagloss ", env!("CARGO_PKG_VERSION")).to_owned(),
            input: told.input,
            engine: told.engine,
            adapter: told.adapter,
            oem: OemReport { size: bake.oem.inner, border: bake.oem.border },
            levels: levels.collect(),
            energy: EnergyReport {
                source: bake.source_energy,
                oem: bake.oem_energy,
                relative_difference: relative_difference(bake.source_energy, bake.oem_energy),
            },
            sh: ShReport {
                coefficients: bake.sh,
                order: "L00, L1-1 (y), L10 (z), L11 (x), L2-2 (xy), L2-1 (yz), L20 (3zz-1), L21 (xz), L22 (xx-yy)"
                    .to_owned(),
                scale: "integrals of radiance times the real orthonormal basis without the Condon-Shortley phase: \
                        0.282095, 0.488603 {y, z, x}, 1.092548 {xy, yz}, 0.315392 (3zz-1), 1.092548 xz, \
                        0.546274 (xx-yy); no cosine, no division by pi"
                    .to_owned(),
            },
            repaired: told.repaired,
            clamped: told.clamped,
            compressed: 0,
            warnings: told.warnings.into_iter().chain(bake.warnings.iter().cloned()).collect(),
            options: OptionsReport {
                size: settings.size,
                ladder: match settings.ladder {
                    Ladder::Linear => "linear",
                    Ladder::Filament => "filament",
                }
                .to_owned(),
                lobe: settings.lobe.name().to_owned(),
                filter: filter_name(settings.filter),
                format: told.format,
                pixel: told.pixel,
                layout: told.layout,
                rotate_y: told.rotate_y,
                mirror: told.mirror,
                sanitize: told.sanitize,
                irradiance: settings.irradiance,
            },
            conventions: ConventionsReport::default(),
            target: None,
            seconds: told.seconds,
        }
    }

    /// The greatest certified error bound of all levels.
    #[must_use]
    pub fn error_bound_max(&self) -> Option<f64> {
        self.levels.iter().filter_map(|level| level.error_bound_max).reduce(f64::max)
    }
}

/// The filter as the command line has it.
#[must_use]
pub fn filter_name(filter: Filter) -> String {
    match filter {
        Filter::Adaptive(error) => format!("adaptive:{error}"),
        Filter::Fitted(count) => format!("fitted:{count}"),
        Filter::Box => "box".to_owned(),
        Filter::Reference => "reference".to_owned(),
    }
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

fn relative_difference(source: [f64; 3], oem: [f64; 3]) -> f64 {
    // A black channel has nothing to lose.
    let channel = |c: usize| if source[c] > 0.0 { ((oem[c] - source[c]) / source[c]).abs() } else { 0.0 };
    (0..3).map(channel).fold(0.0, f64::max)
}
