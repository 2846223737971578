//! `octagloss info`: describes an environment or a bake.

use super::args::InfoArgs;
use super::console::{self, Console};
use super::engine::list_adapters;
use super::info_other;
use super::input::{self, InputFiles, read_bake};
use super::outcome::{Failure, Outcome, print};
use crate::read::{InputLayout, Provenance, Repairs};
use crate::recipes::{InputOptions, Source, SunReport};
use crate::suns::Brightest;
use crate::{Chain, HalfLoss, Level, Statistics};
use octagloss_core::common::percent::percent;
use octagloss_core::light::environment::exact_luminance;
use serde::{Serialize, Serializer};
use serde_json::json;
use std::fs;
use std::path::Path;

/// `--json` output for an environment.
#[derive(Serialize)]
struct EnvironmentInfo {
    kind: &'static str,
    input: String,
    format: String,
    /// Size of the file, or of all files in the folder.
    bytes: u64,
    /// Present if the file belongs to a bake.
    #[serde(serialize_with = "origin")]
    origin: Option<Provenance>,
    layout: &'static str,
    covers: &'static str,
    width: u32,
    height: u32,
    min: [f32; 3],
    max: [f32; 3],
    mean: [f64; 3],
    sun: Option<SunReport>,
    /// The brightest region, if it is not a sun.
    brightest_region: Option<SunReport>,
    half_float: HalfLoss,
    repaired: Repairs,
    warnings: Vec<String>,
}

/// `--json` output for a bake.
#[derive(Serialize)]
struct BakeInfo {
    kind: &'static str,
    input: String,
    /// The file with the levels, if the input is a target's folder.
    file: Option<String>,
    format: String,
    /// Size of the file, or of all files in the folder.
    bytes: u64,
    #[serde(flatten, serialize_with = "origin")]
    origin: Option<Provenance>,
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
    if args.adapters {
        let adapters = list_adapters()?;
        return print(&if args.json {
            json_line(&adapters)
        } else {
            adapters.iter().map(|adapter| format!("{adapter}\n")).collect()
        });
    }
    let sources = input::sources(std::mem::take(&mut args.inputs), &args.input)?;
    // Count and report NaN and Inf, unless repairs are errors.
    args.input.sanitize = !args.input.strict;
    let mut failed = false;
    for source in sources {
        match describe(&source, &args.input, args.json) {
            Ok(text) => print(&text)?,
            Err(error) => {
                console::error(&error.to_string());
                failed = true;
            }
        }
    }
    if failed { Err(Failure::Reported) } else { Ok(()) }
}

fn describe(source: &InputFiles, args: &InputOptions, json: bool) -> crate::Result<String> {
    let input = source.path().display().to_string();
    let bytes = source.files().iter().map(|file| bytes_in(file)).sum();
    if let Some(bake) = read_bake(source.path())? {
        let file = (bake.path != source.path()).then(|| bake.path.display().to_string());
        let info = BakeInfo {
            kind: "bake",
            input,
            file,
            levels: levels_info(&bake.chain),
            format: bake.format,
            bytes,
            origin: Some(bake.provenance),
        };
        return Ok(if json { json_line(&info) } else { info.text() });
    }
    // Here, warnings are part of the output.
    let opened = match source.open(args, &Console::new(true)) {
        Ok(opened) => opened,
        Err(error) => {
            // Options of environments have errors of their own.
            let is_plain =
                args.layout == InputLayout::Auto && !args.strict && !args.crop && args.pad.is_none();
            let other = match source.files() {
                [path] if is_plain => info_other::described(path, bytes, &error),
                _ => None,
            };
            let other = other.ok_or(error)?;
            return Ok(if json { json_line(&other) } else { other.text() });
        }
    };
    let info = environment_info(input, bytes, opened);
    Ok(if json { json_line(&info) } else { info.text() })
}

fn json_line(info: &impl Serialize) -> String {
    serde_json::to_string(info).expect("keys are strings") + "\n"
}

/// Size of a file, or of a folder's files, recursively. Does not follow links, which may form cycles.
fn bytes_in(path: &Path) -> u64 {
    match fs::symlink_metadata(path) {
        Ok(entry) if entry.is_dir() => {
            fs::read_dir(path).into_iter().flatten().flatten().map(|entry| bytes_in(&entry.path())).sum()
        }
        Ok(_) => fs::metadata(path).map_or(0, |file| file.len()),
        Err(_) => 0,
    }
}

fn levels_info(chain: &Chain) -> Vec<LevelInfo> {
    let level = |(index, level): (usize, &Level)| {
        let mut info = LevelInfo {
            level: index,
            size: level.size(),
            roughness: level.roughness,
            min: [f32::INFINITY; 3],
            max: [f32::NEG_INFINITY; 3],
            mean: [0.0; 3],
        };
        for (at, texel) in level.texels.iter().enumerate() {
            let share = level.layout.solid_angle_at(at) / (4.0 * std::f64::consts::PI);
            for (c, value) in texel.iter().enumerate() {
                info.min[c] = info.min[c].min(*value);
                info.max[c] = info.max[c].max(*value);
                info.mean[c] += share * f64::from(*value);
            }
        }
        info
    };
    chain.levels.iter().enumerate().map(level).collect()
}

fn environment_info(input: String, bytes: u64, opened: Source) -> EnvironmentInfo {
    let statistics = Statistics::new(&opened.environment);
    let energy_share = statistics.sun_share();
    let brightest = |kind: Brightest| {
        let found = statistics.sun.as_ref().filter(|region| region.kind == kind);
        found.map(|region| SunReport::new(region, energy_share))
    };
    EnvironmentInfo {
        kind: "environment",
        input,
        format: opened.format,
        bytes,
        origin: Some(opened.origin).filter(|origin| !origin.is_empty()),
        layout: opened.layout,
        covers: opened.environment.layout().map().name(),
        width: opened.width,
        height: opened.height,
        min: statistics.min,
        max: statistics.max,
        mean: statistics.mean,
        sun: brightest(Brightest::Sun),
        brightest_region: brightest(Brightest::Region),
        half_float: statistics.half,
        repaired: opened.repaired,
        warnings: opened.warnings,
    }
}

/// Writes what a bake's file records, with defaults. Texel statistics are in the file's world, with flips
/// undone.
fn origin<S: Serializer>(origin: &Option<Provenance>, serializer: S) -> Result<S::Ok, S::Error> {
    let Some(origin) = origin else { return serializer.serialize_none() };
    let Provenance { target, content, flip, quarter_turns, rotate_y, mirror, suns, .. } = origin;
    let Provenance { scale, crop, pad, lobe, filter, scan, ladder, .. } = origin;
    let json = json!({
        "target": target,
        "content": content,
        "flip": flip.unwrap_or_default(),
        "quarter_turns": quarter_turns.unwrap_or(0),
        "rotate_y": rotate_y,
        "mirror": mirror,
        "sun": suns.first(),
        "suns": suns,
        "scale": scale.unwrap_or(1.0),
        "crop": crop.unwrap_or(false),
        "pad": pad,
        "lobe": lobe,
        "filter": filter,
        "scan": scan,
        "ladder": ladder,
    });
    json.serialize(serializer)
}

/// Text of rows of names and values below a title.
pub(super) fn listed(title: &str, rows: impl IntoIterator<Item = (&'static str, String)>) -> String {
    let row = |(name, value): (&str, String)| format!("  {name:<11} {value}\n");
    format!("{title}\n") + &rows.into_iter().map(row).collect::<String>()
}

/// Names and values of `origin` as text.
fn origin_rows(origin: &Provenance) -> Vec<(&'static str, String)> {
    let unknown = || "not recorded".to_owned();
    let mut rows = vec![("target", origin.target.clone().unwrap_or_else(|| "none".to_owned()))];
    rows.extend(origin.content.clone().map(|content| ("content", content)));
    rows.push(("flip", origin.flip.unwrap_or_default().name().to_owned()));
    let moved = origin.quarter_turns.filter(|turns| *turns > 0);
    rows.extend(moved.map(|turns| ("columns", format!("moved by {turns} quarters of the width"))));
    let rotation = origin.rotate_y.map(|degrees| format!("{degrees} degrees about +Y"));
    rows.push(("rotation", rotation.unwrap_or_else(unknown)));
    rows.push(("mirrored", origin.mirror.map_or_else(unknown, |m| if m { "yes" } else { "no" }.to_owned())));
    rows.extend(origin.suns.iter().map(|sun| {
        let [x, y, z] = sun.direction;
        ("sun", format!("removed, direction {x:.4} {y:.4} {z:.4}, irradiance {}", triple(sun.irradiance)))
    }));
    let scale = origin.scale.filter(|scale| *scale != 1.0);
    rows.extend(scale.map(|scale| ("scale", format!("radiance times {scale}"))));
    rows.extend((origin.crop == Some(true)).then(|| ("cropped", "black bars".to_owned())));
    rows.extend(origin.pad.map(|pad| ("padded", pad.name().to_owned())));
    rows.push(("lobe", origin.lobe.map_or_else(unknown, |lobe| lobe.name().to_owned())));
    rows.push(("filter", origin.filter.clone().unwrap_or_else(unknown)));
    rows.extend(origin.scan.clone().map(|scan| ("scan", scan)));
    rows.extend(origin.ladder.clone().map(|ladder| ("ladder", ladder)));
    rows
}

impl BakeInfo {
    fn text(&self) -> String {
        let mut rows = Vec::new();
        rows.extend(self.file.clone().map(|file| ("file", file)));
        rows.extend([("format", self.format.clone()), ("size", console::bytes(self.bytes))]);
        rows.extend(self.origin.iter().flat_map(origin_rows));
        let mut text = listed(&format!("{}: bake, {} levels", self.input, self.levels.len()), rows);
        text.push_str("  level   size  roughness      least   greatest       mean  (luminance)\n");
        for level in &self.levels {
            text += &format!(
                "  {:>5}  {:>5}  {:>9.4}  {:>9.3e}  {:>9.3e}  {:>9.3e}\n",
                level.level,
                level.size,
                level.roughness,
                exact_luminance(level.min),
                exact_luminance(level.max),
                exact_luminance(level.mean),
            );
        }
        text
    }
}

impl EnvironmentInfo {
    fn text(&self) -> String {
        let mut rows = vec![
            ("layout", format!("{}, {}x{}", self.layout, self.width, self.height)),
            ("size", console::bytes(self.bytes)),
        ];
        rows.extend(self.origin.iter().flat_map(origin_rows));
        let [r, g, b] = [0, 1, 2]
            .map(|c| format!("{} to {}", figure(f64::from(self.min[c])), figure(f64::from(self.max[c]))));
        rows.push(("range", format!("R {r}, G {g}, B {b}")));
        rows.push(("mean", format!("{} (radiance over the sphere)", triple(self.mean))));
        let mut name = "sun";
        if self.brightest_region.is_some() {
            rows.push(("sun", "none".to_owned()));
            rows.push(("brightest", "a region larger or dimmer than a sun".to_owned()));
            name = "";
        }
        match self.sun.as_ref().or(self.brightest_region.as_ref()) {
            None => rows.push(("sun", "none detected".to_owned())),
            Some(sun) => {
                let [x, y, z] = sun.direction;
                let (azimuth, elevation) = (sun.azimuth_degrees, sun.elevation_degrees);
                let (irradiance, angle) = (triple(sun.irradiance), figure(sun.solid_angle));
                rows.extend([
                    (name, format!("direction {x:.4} {y:.4} {z:.4}")),
                    ("", format!("azimuth {azimuth:.2} degrees from +X to +Z, elevation {elevation:.2}")),
                    ("", format!("peak radiance {}", triple(sun.peak.map(f64::from)))),
                    ("", format!("irradiance {irradiance} from {angle} sr ({} texels)", sun.texels)),
                    ("", format!("{} of all energy", percent(sun.energy_share))),
                ]);
            }
        }
        let share = percent(self.half_float.energy_share);
        let half = match self.half_float.texels {
            0 => "clips nothing".to_owned(),
            count => format!("clips {count} texels above 65504, {share} of all energy"),
        };
        rows.push(("half float", half));
        rows.extend(self.warnings.iter().map(|warning| ("note", warning.clone())));
        listed(&format!("{}: {}", self.input, self.format), rows)
    }
}

/// Formats four digits; uses exponents only for very small or large values.
fn figure(value: f64) -> String {
    let size = value.abs();
    match value {
        0.0 => "0".to_owned(),
        _ if !(1e-3..1e6).contains(&size) => format!("{value:.3e}"),
        _ if size >= 1000.0 => format!("{value:.0}"),
        _ => format!("{value:.*}", (3 - size.log10().floor() as i32).max(0) as usize),
    }
}

fn triple(rgb: [f64; 3]) -> String {
    rgb.map(figure).join(" ")
}
