//! `report.json`: the record of a bake, for people and programs.
//!
//! Two runs with the same input and options give the same report, except the keys named `seconds`.
//!
//! `docs/report.md` lists every key with its type; a test checks real reports against it.

use crate::bake::{Bake, LevelStats};
use crate::common::finite::finite;
use crate::files::io::Repairs;
use crate::files::recipe::Recipe;
use crate::files::recipe::plan::BakePlan;
use crate::files::recipe::source::{InputFileReport, Source, SunReport};
use crate::light::chain::{Chain, Level};
use crate::light::environment::LUMINANCE;
use crate::light::sh::order_text;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the schema in `docs/report.md`. It increases when a key is removed or changes its meaning, not
/// when one is added.
pub const SCHEMA_VERSION: u32 = 2;

/// A bake's report; its fields are the keys of `report.json`. [`crate::files::io::side_report`] reads those
/// of all versions.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// [`SCHEMA_VERSION`].
    pub schema_version: u32,
    /// The program and its version.
    pub generator: String,
    /// The input path as given; for six files the first.
    pub input: String,
    /// The input's files with their sizes and hashes.
    pub input_files: Vec<InputFileReport>,
    /// Layout of the input, in words.
    pub layout: String,
    /// Engine: `cpu` or `gpu`.
    pub engine: String,
    /// The graphics adapter; `null` on the CPU.
    pub adapter: Option<String>,
    /// Size of the octahedral map.
    pub oem: OemReport,
    /// The levels, the sharpest first.
    pub levels: Vec<LevelReport>,
    /// The sheen levels; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sheen: Vec<LevelReport>,
    /// [`Bake::typical_error`].
    #[serde(serialize_with = "finite")]
    pub typical_error: Option<f64>,
    /// Energy before and after reparameterisation.
    pub energy: EnergyReport,
    /// Spherical harmonics of the source.
    pub sh: ShReport,
    /// The first sun removed before the bake; `null` if none was found or requested.
    pub sun: Option<SunReport>,
    /// All suns removed before the bake.
    pub suns: Vec<SunReport>,
    /// Repairs of the input.
    pub repaired: Repairs,
    /// Texels with a channel above the pixel format's maximum.
    pub clamped: u64,
    /// Share of luminance energy removed by clamping, of the level that lost most.
    pub clamped_energy_share: f64,
    /// Texels scaled down for the pixel format; absent if there are none.
    #[serde(skip_serializing_if = "is_zero")]
    pub compressed: u64,
    /// Warnings, one line each.
    pub warnings: Vec<String>,
    /// The recipe of this bake, with its defaults filled in.
    pub recipe: Recipe,
    /// Conventions of the numbers and images.
    pub conventions: BTreeMap<&'static str, &'static str>,
    /// The target; absent without `--target`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<TargetReport>,
    /// The files written, except the report.
    pub outputs: Vec<OutputFileReport>,
    /// Hashes for `--skip-unchanged`; absent from the library's own reports.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fingerprint: Option<FingerprintReport>,
    /// Wall time from reading to writing.
    pub seconds: f64,
}

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct OutputFileReport {
    /// Path relative to the output's folder; a `--preview` picture as given.
    pub path: String,
    /// Its size.
    pub bytes: u64,
}

/// Size of an octahedral environment map.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct OemReport {
    /// Texels along an edge, without the border.
    pub size: u32,
    /// Border on every side, in texels.
    pub border: u32,
}

/// Figures of a level.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    /// cube, and lobes too narrow for float32, on the CPU.
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
    pub error_bound_p99: Option<f64>,
    /// `error_bound_max` over the environment's mean luminance.
    pub error_bound_max_relative: Option<f64>,
    /// `error_bound_mean` over the environment's mean luminance.
    pub error_bound_mean_relative: Option<f64>,
    /// `error_bound_p99` over the environment's mean luminance.
    pub error_bound_p99_relative: Option<f64>,
    /// Maximum certified error bounds of red, green and blue, absolute; `null` if the filter has none.
    pub error_bound_max_channels: Option<[f64; 3]>,
}

/// Total energy: radiance times solid angle, over the sphere.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
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
    pub mean_luminance: f64,
}

/// Spherical harmonics.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ShReport {
    /// Nine coefficients, or as many as requested; red, green and blue each.
    #[serde(serialize_with = "finite")]
    pub coefficients: Vec<[f64; 3]>,
    /// Order of the coefficients.
    pub order: String,
    /// Scaling of the coefficients.
    pub scale: String,
    /// Window applied to the bands: `none`, or its name and width in bands.
    pub window: String,
}

/// The target of a bake.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TargetReport {
    /// Name of the target.
    pub name: String,
    /// Name of the environment in the file names.
    pub environment: String,
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

/// Conventions of the numbers and images, by what they are about.
const CONVENTIONS: [(&str, &str); 4] = [
    ("space", "right-handed, y up"),
    ("cube", "+X -X +Y -Y +Z -Z, axes as in OpenGL, Vulkan and Direct3D, rows downwards"),
    ("roughness", "perceptual, alpha = roughness^2"),
    ("radiance", "linear RGB, Rec. 709 primaries, the input's own unit"),
];

impl Report {
    /// The report of `bake` of `source`, which the CPU made by `plan`, before anything is made of it.
    #[must_use]
    pub fn new(plan: &BakePlan, bake: &Bake, source: &Source) -> Self {
        let mean_luminance = mean_luminance(bake);
        let over_mean = |bound: Option<f64>| bound.map(|bound| relative(bound, mean_luminance));
        let report = |(level, (shown, stats)): (u32, (&Level, &LevelStats))| LevelReport {
            level,
            size: shown.size(),
            roughness: shown.roughness,
            pixel: plan.plan.pixel.stored(&shown.texels).name().to_owned(),
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
        };
        let reports = |chain: &Chain, stats| (0..).zip(chain.levels.iter().zip(stats)).map(report).collect();
        let mut recipe = plan.recipe.clone();
        (recipe.table.oem_size, recipe.table.border) = (Some(bake.oem.inner), Some(bake.oem.border));
        Self {
            schema_version: SCHEMA_VERSION,
            generator: concat!("octagloss ", env!("CARGO_PKG_VERSION")).to_owned(),
            input: source.input.clone(),
            input_files: source.files.clone(),
            layout: source.layout.to_owned(),
            engine: "cpu".to_owned(),
            oem: OemReport { size: bake.oem.inner, border: bake.oem.border },
            levels: reports(&bake.chain, &bake.stats),
            sheen: bake.sheen.as_ref().map_or_else(Vec::new, |sheen| reports(sheen, &bake.sheen_stats)),
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
            sun: source.suns.first().cloned(),
            suns: source.suns.clone(),
            repaired: source.repaired,
            recipe,
            conventions: CONVENTIONS.into(),
            ..Self::default()
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
    use super::{relative, relative_difference};

    #[test]
    fn differences_are_those_of_the_worst_channel_and_black_has_none() {
        assert_eq!(relative_difference([2.0, 4.0, 0.0], [3.0, 5.0, 0.0]), 0.5);
        assert_eq!(relative_difference([4.0, 4.0, 2.0], [5.0, 4.0, 1.0]), 0.5);
        assert_eq!((relative(3.0, 2.0), relative(3.0, 0.0)), (1.5, 0.0));
    }

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
