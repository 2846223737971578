//! `report.json`: the record of a bake, for people and programs.
//!
//! Two runs with the same input and options give the same report, except the keys named `seconds`.
//!
//! `docs/report.md` lists every key with its type; a test checks real reports against it.

use crate::analysis::extraction::Suns;
use crate::analysis::sun::Sun;
use crate::bake::overflow::Overflow;
use crate::bake::result::{Bake, LevelStats};
use crate::bake::settings::BakeSettings;
use crate::chain::Level;
use crate::environment::{LUMINANCE, Map};
use crate::filter::Filter;
use crate::finite::finite;
use crate::io::{Pad, Repairs};
use crate::sh::order_text;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the schema in `docs/report.md`. It increases when a key is removed or changes its meaning, not
/// when one is added.
pub const SCHEMA_VERSION: u32 = 1;

/// A bake's report; its fields are the keys of `report.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`SCHEMA_VERSION`]; 0 for reports of version 0.1, which have no such key.
    #[serde(default)]
    pub schema_version: u32,
    /// The program and its version.
    pub generator: String,
    /// The input path as given; for six files the first.
    pub input: String,
    /// The input's files with their sizes and hashes.
    #[serde(default)]
    pub input_files: Vec<InputFileReport>,
    /// Engine: `cpu` or `gpu`.
    pub engine: String,
    /// The graphics adapter; `null` on the CPU.
    pub adapter: Option<String>,
    /// Size of the octahedral map.
    pub oem: OemReport,
    /// What the levels' texels are: `sampled` or `solved`. Reports of version 0.2 lack it.
    #[serde(default)]
    pub chain: String,
    /// The levels, the sharpest first.
    pub levels: Vec<LevelReport>,
    /// The sheen levels; absent if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sheen: Vec<LevelReport>,
    /// [`Bake::typical_error`].
    #[serde(default, serialize_with = "finite")]
    pub typical_error: Option<f64>,
    /// Energy before and after reparameterisation.
    pub energy: EnergyReport,
    /// Spherical harmonics of the source.
    pub sh: ShReport,
    /// The first sun removed before the bake; `null` if none was found or requested.
    #[serde(default)]
    pub sun: Option<SunReport>,
    /// All suns removed before the bake.
    #[serde(default)]
    pub suns: Vec<SunReport>,
    /// Repairs of the input.
    pub repaired: RepairReport,
    /// Texels with a channel above the pixel format's maximum.
    pub clamped: u64,
    /// Share of luminance energy removed by clamping, of the level that lost most.
    #[serde(default)]
    pub clamped_energy_share: f64,
    /// Texels scaled down for the pixel format; absent if there are none.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub compressed: u64,
    /// Warnings, one line each.
    pub warnings: Vec<String>,
    /// The options.
    pub options: OptionsReport,
    /// Conventions of the numbers and images.
    pub conventions: ConventionsReport,
    /// The target; absent without `--target`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<TargetReport>,
    /// The files written, except the report.
    #[serde(default)]
    pub outputs: Vec<OutputFileReport>,
    /// Hashes for `--skip-unchanged`; absent from the library's own reports.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fingerprint: Option<FingerprintReport>,
    /// Wall time from reading to writing.
    pub seconds: f64,
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFileReport {
    /// Path as given.
    pub path: String,
    /// Its size; for a folder, that of its level 0.
    pub bytes: u64,
    /// BLAKE3 hash of its content in hexadecimal; for a folder, of the names and hashes of its level 0.
    pub blake3: String,
}

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutputFileReport {
    /// Path relative to the output's folder; a `--preview` picture as given.
    pub path: String,
    /// Its size.
    pub bytes: u64,
}

/// Size of an octahedral environment map.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OemReport {
    /// Texels along an edge, without the border.
    pub size: u32,
    /// Border on every side, in texels.
    pub border: u32,
}

/// Figures of a level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelReport {
    /// Its number, from 0.
    pub level: u32,
    /// Texels along an edge of a face; rows of a single image.
    pub size: u32,
    /// Perceptual roughness in [0, 1].
    #[serde(serialize_with = "finite")]
    pub roughness: f64,
    /// Format of its texels as stored.
    pub pixel: String,
    /// Engine of the level: `cpu` or `gpu`. The GPU engine computes mirror levels of maps other than the
    /// cube, and lobes too narrow for float32, on the CPU. Absent from reports of version 0.2.
    #[serde(default)]
    pub engine: String,
    /// Wall time.
    pub seconds: f64,
    /// Average quadrature leaves per texel; `null` if the filter has none.
    #[serde(serialize_with = "finite")]
    pub leaves_per_texel: Option<f64>,
    /// Maximum certified error bound, absolute luminance; `null` if the filter has none.
    #[serde(serialize_with = "finite")]
    pub error_bound_max: Option<f64>,
    /// Mean certified error bound, absolute luminance; `null` if the filter has none.
    #[serde(serialize_with = "finite")]
    pub error_bound_mean: Option<f64>,
    /// 99th percentile of the certified error bounds, absolute luminance; `null` if the filter has none.
    #[serde(default)]
    pub error_bound_p99: Option<f64>,
    /// `error_bound_max` over the environment's mean luminance.
    #[serde(default)]
    pub error_bound_max_relative: Option<f64>,
    /// `error_bound_mean` over the environment's mean luminance.
    #[serde(default)]
    pub error_bound_mean_relative: Option<f64>,
    /// `error_bound_p99` over the environment's mean luminance.
    #[serde(default)]
    pub error_bound_p99_relative: Option<f64>,
    /// Maximum certified error bounds of red, green and blue, absolute; `null` if the filter has none. Absent
    /// from reports of version 0.2.
    #[serde(default)]
    pub error_bound_max_channels: Option<[f64; 3]>,
}

/// Total energy: radiance times solid angle, over the sphere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnergyReport {
    /// Red, green and blue of the source.
    #[serde(serialize_with = "finite")]
    pub source: [f64; 3],
    /// Red, green and blue of the octahedral map.
    #[serde(serialize_with = "finite")]
    pub oem: [f64; 3],
    /// Maximum relative difference of a channel.
    #[serde(serialize_with = "finite")]
    pub relative_difference: f64,
    /// Mean luminance of the source over the sphere, the same for every level: the reference of relative
    /// bounds.
    #[serde(default)]
    pub mean_luminance: f64,
}

/// Spherical harmonics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShReport {
    /// Nine coefficients, or as many as requested; red, green and blue each.
    #[serde(serialize_with = "finite")]
    pub coefficients: Vec<[f64; 3]>,
    /// Order of the coefficients.
    pub order: String,
    /// Scaling of the coefficients.
    pub scale: String,
    /// Window applied to the bands: `none`, or its name and width in bands.
    #[serde(default)]
    pub window: String,
}

/// Repairs of the input.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RepairReport {
    /// Negative values set to 0.
    pub negative: u64,
    /// NaN values set to 0.
    pub nan: u64,
    /// Infinite values set to a finite neighbour.
    pub infinite: u64,
    /// Energy of the negative values over that of the positive ones.
    #[serde(serialize_with = "finite")]
    pub negative_energy_share: f64,
}

/// A sun, see [`Sun`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SunReport {
    /// Unit vector towards it, in the world.
    #[serde(serialize_with = "finite")]
    pub direction: [f64; 3],
    /// Degrees from +X towards +Z.
    #[serde(serialize_with = "finite")]
    pub azimuth_degrees: f64,
    /// Degrees above the horizon.
    #[serde(serialize_with = "finite")]
    pub elevation_degrees: f64,
    /// Radiance of its brightest texel.
    #[serde(serialize_with = "finite")]
    pub peak: [f32; 3],
    /// Irradiance on a surface that faces it.
    #[serde(serialize_with = "finite")]
    pub irradiance: [f64; 3],
    /// Irradiance over its maximum channel, which is a directional light's intensity.
    #[serde(serialize_with = "finite")]
    pub color: [f64; 3],
    /// Steradians.
    #[serde(serialize_with = "finite")]
    pub solid_angle: f64,
    /// Number of texels.
    pub texels: usize,
    /// Its share of the environment's energy, by luminance.
    #[serde(serialize_with = "finite")]
    pub energy_share: f64,
    /// Median luminance around it.
    #[serde(default)]
    pub surroundings: f64,
}

impl SunReport {
    /// Creates the report of `sun` with its share of the total energy.
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
            surroundings: sun.surroundings,
        }
    }
}

impl From<Repairs> for RepairReport {
    fn from(repairs: Repairs) -> Self {
        let Repairs { negative, negative_energy_share, nan, infinite } = repairs;
        Self { negative, nan, infinite, negative_energy_share }
    }
}

/// The options of a bake with defaults filled in, except those of paths, verbosity and speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OptionsReport {
    /// Edge of level 0.
    pub size: u32,
    /// Number of levels.
    #[serde(default)]
    pub levels: u32,
    /// `linear`, `filament`, `unity` or `babylon`.
    pub ladder: String,
    /// Name of the lobe.
    pub lobe: String,
    /// Name of the filter, with its number.
    pub filter: String,
    /// Edge of the octahedral map, without its border.
    #[serde(default)]
    pub oem_size: u32,
    /// Its border.
    #[serde(default)]
    pub border: u32,
    /// Scan of the summed-area table: `blocks` or `hensley:2`, `4`, `8` or `16`; `null` if the filter reads
    /// no such table. Absent in reports of version 0.2.
    #[serde(default)]
    pub scan: Option<String>,
    /// `ktx2`, `ktx`, `dds`, `exr`, `hdr`, or the extension of a target's own format.
    pub format: String,
    /// `f16`, `f32`, `rgb9e5`, `r11g11b10f`, `bc6h`, `rgbd`, `rgbe`; `auto` for half, or float if half is
    /// insufficient.
    pub pixel: String,
    /// `clamp`, `compress` or `error`.
    #[serde(default)]
    pub overflow: String,
    /// Layout of the input.
    pub layout: String,
    /// Rotation about +Y in degrees.
    pub rotate_y: f64,
    /// Whether the input was flipped.
    pub mirror: bool,
    /// Factor applied to the radiance; absent in reports of version 0.2.
    #[serde(default = "unscaled")]
    pub scale: f64,
    /// Whether to remove black bars.
    #[serde(default)]
    pub crop: bool,
    /// Fill for a panorama that is not 2:1: `black` or `edge`; `null` for none.
    #[serde(default)]
    pub pad: Option<String>,
    /// Whether to repair NaN and Inf.
    pub sanitize: bool,
    /// Whether repairs are errors.
    #[serde(default)]
    pub strict: bool,
    /// Whether to remove the sun.
    #[serde(default)]
    pub extract_sun: bool,
    /// The suns to remove: `brightest`, a number, or directions; `null` for none.
    #[serde(default)]
    pub suns: Option<String>,
    /// Whether to write the environment without its sun.
    #[serde(default)]
    pub sunless: bool,
    /// Edge of the irradiance cube; `null` for none.
    pub irradiance: Option<u32>,
    /// Requested edge of the cube of the unfiltered environment; `null` for none.
    #[serde(default)]
    pub skybox: Option<u32>,
    /// Whether the levels of the Charlie lobe were also baked.
    #[serde(default)]
    pub sheen: bool,
    /// The highest band of the spherical harmonics.
    #[serde(default)]
    pub sh_order: u32,
    /// Their window as requested; [`ShReport::window`] has the resolved width.
    #[serde(default)]
    pub sh_window: String,
    /// Whether to write the bound of every texel.
    #[serde(default)]
    pub bounds: bool,
    /// Whether to write a preview.
    #[serde(default)]
    pub preview: bool,
    /// Image layout of the levels, as named by `--out-layout`. Version 0.1 omits it for faces.
    #[serde(default)]
    pub out_layout: Option<String>,
}

/// The target of a bake.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TargetReport {
    /// Name of the target.
    pub name: String,
    /// Name of the environment in the file names.
    #[serde(default)]
    pub environment: String,
    /// Axis that the engine negates at cube look-ups: `none`, `x` or `z`.
    pub flip: String,
    /// `none`, `cube`, `sh` or `both`.
    pub diffuse: String,
    /// Whether a test loads such files into the engine.
    pub verified: bool,
    /// The files, relative to the report.
    pub files: Vec<String>,
}

/// BLAKE3 hashes in hexadecimal that identify an unchanged bake.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FingerprintReport {
    /// Hash of the input's content, the options and the program's version.
    pub request: String,
    /// Hash of the outputs' content, except the report.
    pub outputs: String,
    /// Hash of the report's own text, with zeros in place of this hash; `None` if the report was printed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub report: Option<String>,
    /// Hash of each file in the report's folder, by name. Readers ignore the report for a file with another
    /// hash.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, String>,
}

/// Conventions of the numbers and images.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConventionsReport {
    /// Handedness and up.
    pub space: String,
    /// Faces and their axes.
    pub cube: String,
    /// Definition of roughness.
    pub roughness: String,
    /// Definition of the texel values.
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

/// Data of a report that the bake itself does not have.
#[derive(Clone, Debug)]
pub struct Circumstances {
    /// The input path as given.
    pub input: String,
    /// Its files, with sizes and hashes.
    pub input_files: Vec<InputFileReport>,
    /// Engine: `cpu` or `gpu`.
    pub engine: String,
    /// The graphics adapter, if the GPU engine was used.
    pub adapter: Option<String>,
    /// Repairs of the input.
    pub repaired: RepairReport,
    /// Layout of the input, in words.
    pub layout: String,
    /// Rotation about +Y in degrees.
    pub rotate_y: f64,
    /// Whether the input was flipped.
    pub mirror: bool,
    /// Factor applied to the radiance.
    pub scale: f64,
    /// Whether to remove black bars.
    pub crop: bool,
    /// Fill for a panorama that is not 2:1.
    pub pad: Option<Pad>,
    /// Whether to repair NaN and Inf.
    pub sanitize: bool,
    /// Whether repairs are errors.
    pub strict: bool,
    /// The suns to remove.
    pub extract_sun: Option<Suns>,
    /// Whether to write the environment without the sun.
    pub sunless: bool,
    /// Treatment of texels above the pixel format's maximum.
    pub overflow: Overflow,
    /// Whether to write a preview.
    pub preview: bool,
    /// The removed suns.
    pub suns: Vec<SunReport>,
    /// Format of the output.
    pub format: String,
    /// Requested pixel format.
    pub pixel: String,
    /// Pixel format of each level as stored.
    pub level_pixels: Vec<String>,
    /// Texels clamped.
    pub clamped: u64,
    /// Share of luminance energy removed by clamping, of the level that lost most.
    pub clamped_energy_share: f64,
    /// Warnings of reading and writing; those of the bake are appended.
    pub warnings: Vec<String>,
    /// Wall time from reading to writing.
    pub seconds: f64,
}

impl Report {
    /// Creates the report of `bake`.
    #[must_use]
    pub fn new(settings: &BakeSettings, bake: &Bake, circumstances: Circumstances) -> Self {
        let mean_luminance = mean_luminance(bake);
        let reports = |levels: &[Level], stats: &[LevelStats]| {
            level_reports(levels, stats, &circumstances.level_pixels, mean_luminance)
        };
        let levels = reports(&bake.chain.levels, &bake.stats);
        let sheen = bake.sheen.as_ref().map(|sheen| reports(&sheen.levels, &bake.sheen_stats));
        Self {
            schema_version: SCHEMA_VERSION,
            generator: concat!("octagloss ", env!("CARGO_PKG_VERSION")).to_owned(),
            input: circumstances.input,
            input_files: circumstances.input_files,
            engine: circumstances.engine,
            adapter: circumstances.adapter,
            oem: OemReport { size: bake.oem.inner, border: bake.oem.border },
            chain: settings.chain().name().to_owned(),
            levels,
            sheen: sheen.unwrap_or_default(),
            typical_error: bake.typical_error,
            energy: EnergyReport {
                source: bake.source_energy,
                oem: bake.oem_energy,
                relative_difference: relative_difference(bake.source_energy, bake.oem_energy),
                mean_luminance,
            },
            sh: ShReport {
                coefficients: bake.sh.clone(),
                order: order_text(bake.sh.len()),
                scale: "integrals of radiance times the real orthonormal basis without the Condon-Shortley \
                        phase: 0.282095, 0.488603 {y, z, x}, 1.092548 {xy, yz}, 0.315392 (3zz-1), 1.092548 \
                        xz, 0.546274 (xx-yy) and so on; no cosine, no division by pi"
                    .to_owned(),
                window: bake.sh_window.to_string(),
            },
            sun: circumstances.suns.first().cloned(),
            suns: circumstances.suns,
            repaired: circumstances.repaired,
            clamped: circumstances.clamped,
            clamped_energy_share: circumstances.clamped_energy_share,
            compressed: 0,
            warnings: circumstances.warnings.into_iter().chain(bake.warnings.iter().cloned()).collect(),
            options: OptionsReport {
                size: settings.size,
                levels: bake.stats.len() as u32,
                ladder: settings.ladder.name().to_owned(),
                lobe: settings.lobe.name().to_owned(),
                filter: filter_name(settings.filter),
                oem_size: bake.oem.inner,
                border: bake.oem.border,
                scan: settings.filter.reads_sat().then(|| settings.scan.to_string()),
                format: circumstances.format,
                pixel: circumstances.pixel,
                overflow: circumstances.overflow.name().to_owned(),
                layout: circumstances.layout,
                rotate_y: circumstances.rotate_y,
                mirror: circumstances.mirror,
                scale: circumstances.scale,
                crop: circumstances.crop,
                pad: circumstances.pad.map(|pad| pad.name().to_owned()),
                sanitize: circumstances.sanitize,
                strict: circumstances.strict,
                extract_sun: circumstances.extract_sun.is_some(),
                suns: circumstances.extract_sun.map(|suns| suns.to_string()),
                sunless: circumstances.sunless,
                irradiance: settings.irradiance,
                skybox: settings.skybox,
                sheen: settings.sheen,
                sh_order: settings.sh_order,
                sh_window: settings.sh_window.to_string(),
                bounds: settings.bounds,
                preview: circumstances.preview,
                out_layout: Some(out_layout(settings.map).to_owned()),
            },
            conventions: ConventionsReport::default(),
            target: None,
            outputs: Vec::new(),
            fingerprint: None,
            seconds: circumstances.seconds,
        }
    }
}

/// Mean luminance of the source over the sphere. A lobe is normalised and the same in every direction, so
/// every level has this mean up to its error.
fn mean_luminance(bake: &Bake) -> f64 {
    let energy: f64 = bake.source_energy.iter().zip(LUMINANCE).map(|(e, weight)| e * f64::from(weight)).sum();
    energy / (4.0 * std::f64::consts::PI)
}

/// `bound` over `mean`, finite in double precision; 0 for a black environment.
fn relative(bound: f64, mean: f64) -> f64 {
    if mean > 0.0 { bound / mean } else { 0.0 }
}

/// Default `--out-layout` of levels over `map`.
const fn out_layout(map: Map) -> &'static str {
    match map {
        Map::Cube => "faces",
        Map::Panorama => "equirect",
        Map::Octahedral => "octahedral",
    }
}

/// Creates the reports of levels.
fn level_reports(
    levels: &[Level],
    stats: &[LevelStats],
    pixels: &[String],
    mean_luminance: f64,
) -> Vec<LevelReport> {
    let over_mean = |bound: Option<f64>| bound.map(|bound| relative(bound, mean_luminance));
    let levels = (0..).zip(levels.iter().zip(stats).zip(pixels));
    let report = levels.map(|(index, ((level, stats), pixel))| LevelReport {
        level: index,
        size: level.size(),
        roughness: level.roughness,
        pixel: pixel.clone(),
        engine: stats.processor.name().to_owned(),
        seconds: stats.seconds,
        leaves_per_texel: stats.leaves_per_texel,
        error_bound_max: stats.error_bound_max,
        error_bound_mean: stats.error_bound_mean,
        error_bound_p99: stats.error_bound_p99,
        error_bound_max_relative: over_mean(stats.error_bound_max),
        error_bound_mean_relative: over_mean(stats.error_bound_mean),
        error_bound_p99_relative: over_mean(stats.error_bound_p99),
        error_bound_max_channels: stats.error_bound_max_channels,
    });
    report.collect()
}

/// The filter in command-line syntax.
#[must_use]
pub fn filter_name(filter: Filter) -> String {
    match filter {
        Filter::Adaptive(error) => format!("adaptive:{error}"),
        Filter::Fitted(count) => format!("fitted:{count}"),
        Filter::Box => "box".to_owned(),
        Filter::Reference => "reference".to_owned(),
    }
}

fn unscaled() -> f64 {
    1.0
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

fn relative_difference(source: [f64; 3], oem: [f64; 3]) -> f64 {
    // A black channel cannot lose energy.
    let channel = |c: usize| if source[c] > 0.0 { ((oem[c] - source[c]) / source[c]).abs() } else { 0.0 };
    (0..3).map(channel).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    #[test]
    fn numbers_of_reports_come_back_as_they_were() {
        let mut bits = 1_u64;
        for _ in 0..20_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let value = f64::from_bits(bits);
            if value.is_finite() {
                let text = serde_json::to_string(&value).expect("a number");
                assert_eq!(serde_json::from_str::<f64>(&text).expect("a number").to_bits(), bits, "{text}");
            }
        }
    }
}
