//! `octagloss info`: what is in an environment or in a bake.

use super::args::{InfoArgs, InputArgs};
use super::engine::list_adapters;
use super::input::{self, Opened, Source, layout_name, read_bake};
use super::talk::{self, Talk};
use super::{Failure, Outcome, print};
use octagloss::chain::{CubeChain, CubeLevel};
use octagloss::environment::LUMINANCE;
use octagloss::io::Repairs;
use octagloss::report::SunReport;
use octagloss::sphere::cube;
use octagloss::survey::Survey;
use serde::Serialize;
use std::fmt::Write as _;

/// What `--json` prints of an environment.
#[derive(Serialize)]
struct EnvironmentInfo {
    kind: &'static str,
    input: String,
    format: String,
    layout: &'static str,
    covers: &'static str,
    width: u32,
    height: u32,
    min: [f32; 3],
    max: [f32; 3],
    mean: [f64; 3],
    sun: Option<SunReport>,
    half_float: HalfInfo,
    repaired: Repairs,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct HalfInfo {
    clipped_texels: u64,
    lost_energy_share: f64,
}

/// What `--json` prints of a bake.
#[derive(Serialize)]
struct BakeInfo {
    kind: &'static str,
    input: String,
    levels: Vec<LevelInfo>,
}

#[derive(Serialize)]
struct LevelInfo {
    level: usize,
    size: u32,
    roughness: f64,
    min: [f32; 3],
    max: [f32; 3],
    mean: [f64; 3],
}

pub(super) fn run(mut args: InfoArgs) -> Outcome {
    // Warnings are part of the answer here.
    let talk = Talk::new(true);
    if args.adapters {
        let adapters = list_adapters()?;
        return print(&if args.json {
            json_line(&adapters)
        } else {
            adapters.iter().map(|adapter| format!("{adapter}\n")).collect()
        });
    }
    let sources = input::sources(std::mem::take(&mut args.inputs), &args.input)?;
    // NaN and Inf are counted and told here, unless repairs are to be errors.
    args.input.sanitize = !args.input.strict;
    let mut failed = false;
    for source in sources {
        match describe(&source, &args.input, args.json, &talk) {
            Ok(text) => print(&text)?,
            Err(error) => {
                talk::error(&error.to_string());
                failed = true;
            }
        }
    }
    if failed { Err(Failure::Told) } else { Ok(()) }
}

fn describe(source: &Source, args: &InputArgs, json: bool, talk: &Talk) -> octagloss::Result<String> {
    let input = source.path().display().to_string();
    if let Some(chain) = read_bake(source.path())? {
        let info = bake_info(input, &chain);
        return Ok(if json { json_line(&info) } else { info.text() });
    }
    let info = environment_info(input, source.open(args, talk)?);
    Ok(if json { json_line(&info) } else { info.text() })
}

fn json_line(info: &impl Serialize) -> String {
    serde_json::to_string(info).expect("keys are strings") + "\n"
}

fn bake_info(input: String, chain: &CubeChain) -> BakeInfo {
    let level = |(index, level): (usize, &CubeLevel)| {
        let mut info = LevelInfo {
            level: index,
            size: level.size,
            roughness: level.roughness,
            min: [f32::INFINITY; 3],
            max: [f32::NEG_INFINITY; 3],
            mean: [0.0; 3],
        };
        let (n, sphere) = (level.size, 4.0 * std::f64::consts::PI);
        let places = (0..6).flat_map(|_| (0..n).flat_map(|j| (0..n).map(move |i| (i, j))));
        for (texel, (i, j)) in level.texels.iter().zip(places) {
            let share = cube::texel_solid_angle(n, i, j) / sphere;
            for (c, value) in texel.iter().enumerate() {
                info.min[c] = info.min[c].min(*value);
                info.max[c] = info.max[c].max(*value);
                info.mean[c] += share * f64::from(*value);
            }
        }
        info
    };
    BakeInfo { kind: "bake", input, levels: chain.levels.iter().enumerate().map(level).collect() }
}

fn environment_info(input: String, opened: Opened) -> EnvironmentInfo {
    let survey = Survey::of(&opened.environment);
    let energy_share = survey.sun_share();
    EnvironmentInfo {
        kind: "environment",
        input,
        format: opened.format,
        layout: opened.layout,
        covers: layout_name(opened.environment.layout()),
        width: opened.width,
        height: opened.height,
        min: survey.min,
        max: survey.max,
        mean: survey.mean,
        sun: survey.sun.map(|sun| SunReport::new(&sun, energy_share)),
        half_float: HalfInfo {
            clipped_texels: survey.half.texels,
            lost_energy_share: survey.half.energy_share,
        },
        repaired: opened.repaired,
        warnings: opened.warnings,
    }
}

impl BakeInfo {
    fn text(&self) -> String {
        let mut text = format!("{}: bake, {} levels\n", self.input, self.levels.len());
        text.push_str("  level   size  roughness      least   greatest       mean  (luminance)\n");
        for level in &self.levels {
            writeln!(
                text,
                "  {:>5}  {:>5}  {:>9.4}  {:>9.3e}  {:>9.3e}  {:>9.3e}",
                level.level,
                level.size,
                level.roughness,
                weigh(level.min.map(f64::from)),
                weigh(level.max.map(f64::from)),
                weigh(level.mean),
            )
            .expect("a string takes all");
        }
        text
    }
}

impl EnvironmentInfo {
    fn text(&self) -> String {
        let mut text = format!(
            "{}: {}\n  layout      {}, {}x{}\n",
            self.input, self.format, self.layout, self.width, self.height
        );
        let mut row = |name: &str, value: String| {
            writeln!(text, "  {name:<11} {value}").expect("a string takes all");
        };
        let [r, g, b] = [0, 1, 2].map(|c| format!("{} to {}", figure(self.min[c]), figure(self.max[c])));
        row("range", format!("R {r}, G {g}, B {b}"));
        row("mean", format!("{} (radiance over the sphere)", triple(self.mean)));
        match &self.sun {
            None => row("sun", "none that stands out".to_owned()),
            Some(sun) => {
                let [x, y, z] = sun.direction;
                row("sun", format!("direction {x:.4} {y:.4} {z:.4}"));
                row(
                    "",
                    format!(
                        "azimuth {:.2} degrees from +X to +Z, elevation {:.2}",
                        sun.azimuth_degrees, sun.elevation_degrees
                    ),
                );
                row("", format!("peak radiance {}", triple(sun.peak.map(f64::from))));
                row(
                    "",
                    format!(
                        "irradiance {} from {} sr ({} texels)",
                        triple(sun.irradiance),
                        figure(sun.solid_angle as f32),
                        sun.texels
                    ),
                );
                row("", format!("{:.2} % of all energy", 100.0 * sun.energy_share));
            }
        }
        let half = &self.half_float;
        row(
            "half float",
            match half.clipped_texels {
                0 => "clips nothing".to_owned(),
                count => {
                    let percent = 100.0 * half.lost_energy_share;
                    format!("clips {count} texels above 65504, {percent:.2} % of all energy")
                }
            },
        );
        for warning in &self.warnings {
            row("note", warning.clone());
        }
        text
    }
}

/// Four digits, and exponents only where zeros would be many.
fn figure(value: f32) -> String {
    let size = value.abs();
    match value {
        0.0 => "0".to_owned(),
        _ if !(1e-3..1e6).contains(&size) => format!("{value:.3e}"),
        _ if size >= 1000.0 => format!("{value:.0}"),
        _ => format!("{value:.*}", (3 - size.log10().floor() as i32).max(0) as usize),
    }
}

fn triple(rgb: [f64; 3]) -> String {
    rgb.map(|c| figure(c as f32)).join(" ")
}

fn weigh(rgb: [f64; 3]) -> f64 {
    (0..3).map(|c| f64::from(LUMINANCE[c]) * rgb[c]).sum()
}
