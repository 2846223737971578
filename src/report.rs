//! `report.json`: what a bake did, for people and for programs.
//!
//! Two runs with the same input and options give the same report, but for the keys named `seconds`.

use crate::bake::{Bake, BakeSettings, Filter, LevelStats};
use crate::io::Repairs;
use crate::sh::order_text;
use crate::sun::Sun;
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
    /// The levels of the sheen; absent where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sheen: Vec<LevelReport>,
    /// Energy before and after reparameterisation.
    pub energy: EnergyReport,
    /// Spherical harmonics of the source.
    pub sh: ShReport,
    /// The sun that was taken out before the bake; `null` where none was, or none was to be.
    #[serde(default)]
    pub sun: Option<SunReport>,
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
    /// What tells whether the bake need not be done again; absent from the library's own reports.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fingerprint: Option<FingerprintReport>,
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
    /// Texels along an edge of a face, rows of a single image.
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

/// Spherical harmonics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShReport {
    /// Nine coefficients, or as many as were asked for, red, green and blue each.
    pub coefficients: Vec<[f64; 3]>,
    /// Which coefficient is which.
    pub order: String,
    /// What they are multiplied by.
    pub scale: String,
    /// What their bands are multiplied by besides: `none`, or the window's name and its width in bands.
    #[serde(default)]
    pub window: String,
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

/// A sun, see [`Sun`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SunReport {
    /// Unit vector towards it, in the world.
    pub direction: [f64; 3],
    /// Degrees from +X towards +Z.
    pub azimuth_degrees: f64,
    /// Degrees above the horizon.
    pub elevation_degrees: f64,
    /// Radiance of its brightest texel.
    pub peak: [f32; 3],
    /// Irradiance on a surface that faces it.
    pub irradiance: [f64; 3],
    /// Irradiance over its greatest channel, which is a directional light's intensity.
    pub color: [f64; 3],
    /// Steradians.
    pub solid_angle: f64,
    /// Texels.
    pub texels: usize,
    /// Its share of the environment's energy, by luminance.
    pub energy_share: f64,
}

impl SunReport {
    /// The report of `sun`, which has `energy_share` of all energy.
    #[must_use]
    pub fn new(sun: &Sun, energy_share: f64) -> Self {
        let intensity = sun.irradiance.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        Self {
            direction: sun.direction.to_array(),
            azimuth_degrees: sun.azimuth_degrees(),
            elevation_degrees: sun.elevation_degrees(),
            peak: sun.peak,
            irradiance: sun.irradiance,
            color: sun.irradiance.map(|channel| channel / intensity),
            solid_angle: sun.solid_angle,
            texels: sun.texels,
            energy_share,
        }
    }
}

impl From<Repairs> for RepairReport {
    fn from(repairs: Repairs) -> Self {
        let Repairs { negative, negative_energy_share, nan, infinite } = repairs;
        Self { negative, nan, infinite, negative_energy_share }
    }
}

/// The options of a bake.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OptionsReport {
    /// Edge of level 0.
    pub size: u32,
    /// `linear`, `filament`, `unity` or `babylon`.
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
    /// Whether the sun was to be taken out.
    #[serde(default)]
    pub extract_sun: bool,
    /// Edge of the irradiance cube.
    pub irradiance: Option<u32>,
    /// How the levels lie in images; absent where it is by faces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub out_layout: Option<String>,
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

/// What tells whether a bake need not be done again: BLAKE3 hashes in hexadecimal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FingerprintReport {
    /// Of the input's content, the options and the program's version.
    pub request: String,
    /// Of the content of the outputs, this file left out.
    pub outputs: String,
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
    /// Whether the sun was to be taken out.
    pub extract_sun: bool,
    /// The sun that was.
    pub sun: Option<SunReport>,
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
        let cubes = bake.chain.levels.iter().map(|level| (level.size, level.roughness));
        let images = bake.images.iter().map(|level| (level.layout.sides().1, level.roughness));
        let sheen = bake.sheen.iter().flat_map(|sheen| &sheen.levels);
        let sheen = sheen.map(|level| (level.size, level.roughness));
        Self {
            generator: concat!("octagloss ", env!("CARGO_PKG_VERSION")).to_owned(),
            input: told.input,
            engine: told.engine,
            adapter: told.adapter,
            oem: OemReport { size: bake.oem.inner, border: bake.oem.border },
            levels: level_reports(cubes.chain(images), &bake.stats, &told.level_pixels),
            sheen: level_reports(sheen, &bake.sheen_stats, &told.level_pixels),
            energy: EnergyReport {
                source: bake.source_energy,
                oem: bake.oem_energy,
                relative_difference: relative_difference(bake.source_energy, bake.oem_energy),
            },
            sh: ShReport {
                coefficients: bake.sh.clone(),
                order: order_text(bake.sh.len()),
                scale: "integrals of radiance times the real orthonormal basis without the Condon-Shortley phase: \
                        0.282095, 0.488603 {y, z, x}, 1.092548 {xy, yz}, 0.315392 (3zz-1), 1.092548 xz, \
                        0.546274 (xx-yy) and so on; no cosine, no division by pi"
                    .to_owned(),
                window: bake.sh_window.to_string(),
            },
            sun: told.sun,
            repaired: told.repaired,
            clamped: told.clamped,
            compressed: 0,
            warnings: told.warnings.into_iter().chain(bake.warnings.iter().cloned()).collect(),
            options: OptionsReport {
                size: settings.size,
                ladder: settings.ladder.name().to_owned(),
                lobe: settings.lobe.name().to_owned(),
                filter: filter_name(settings.filter),
                format: told.format,
                pixel: told.pixel,
                layout: told.layout,
                rotate_y: told.rotate_y,
                mirror: told.mirror,
                sanitize: told.sanitize,
                extract_sun: told.extract_sun,
                irradiance: settings.irradiance,
                out_layout: None,
            },
            conventions: ConventionsReport::default(),
            target: None,
            fingerprint: None,
            seconds: told.seconds,
        }
    }

    /// The greatest certified error bound of all levels.
    #[must_use]
    pub fn error_bound_max(&self) -> Option<f64> {
        self.levels.iter().filter_map(|level| level.error_bound_max).reduce(f64::max)
    }
}

/// Reports of levels by their sizes and roughnesses.
fn level_reports(
    levels: impl Iterator<Item = (u32, f64)>,
    stats: &[LevelStats],
    pixels: &[String],
) -> Vec<LevelReport> {
    let levels = (0..).zip(levels.zip(stats).zip(pixels));
    let report = levels.map(|(level, (((size, roughness), stats), pixel))| LevelReport {
        level,
        size,
        roughness,
        pixel: pixel.clone(),
        seconds: stats.seconds,
        leaves_per_texel: stats.leaves_per_texel,
        error_bound_max: stats.error_bound_max,
        error_bound_mean: stats.error_bound_mean,
    });
    report.collect()
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
