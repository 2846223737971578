//! The files and reports of a bake, by the names of the command line.

use crate::plan::{Plan, Request};
use crate::source::{Opened, Reading};
use octagloss::files::Pixel;
use octagloss::internals::bake::overflow::clamped_share;
use octagloss::internals::bake::report::{
    Circumstances, InputFileReport, OutputFileReport, Report, TargetReport,
};
use octagloss::internals::export::files::{Made, files, metadata};
use octagloss::internals::image::preview;
use octagloss::internals::io::environment_write::exact_exr_bytes;
use octagloss::internals::io::ldr::write::png_bytes;
use octagloss::{Bake, BakeSettings, Error, Result};
use serde::Serialize;
use std::path::Path;

/// Least share of energy lost to clamping that deserves a warning: 0.01 %, rounded.
const SHARE_THAT_MATTERS: f64 = 5e-5;

/// A bake as JavaScript gets it.
#[derive(Default)]
pub(crate) struct Output {
    pub(crate) files: Vec<(String, Vec<u8>)>,
    /// JSON, one report per target.
    pub(crate) reports: Vec<String>,
    pub(crate) warnings: Vec<String>,
    /// A PNG file.
    pub(crate) preview: Option<Vec<u8>>,
}

/// A source, and when its bake began.
pub(crate) struct Baked<'a> {
    pub(crate) input: &'a str,
    pub(crate) reading: &'a Reading,
    pub(crate) opened: &'a Opened,
    pub(crate) seconds: f64,
}

/// Encodes the files of all plans.
pub(crate) fn output(
    request: &Request,
    settings: &[BakeSettings],
    bakes: Vec<Bake>,
    baked: &Baked<'_>,
) -> Result<Output> {
    let mut output = Output { warnings: baked.opened.warnings.clone(), ..Output::default() };
    let stem = Path::new(baked.input).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let environment = request.name.clone().or(stem).unwrap_or_else(|| "environment".to_owned());
    let several = request.plans.len() > 1;
    let mut sheets = Vec::new();
    let mut beside = String::new();
    for ((plan, settings), mut bake) in request.plans.iter().zip(settings).zip(bakes) {
        let is_targeted = !plan.files.target.name.is_empty();
        let is_file = !is_targeted && plan.files.is_single();
        let name = match is_file {
            true => format!("{environment}.{}", plan.files.container.name()),
            false => environment.clone(),
        };
        let folder = if several { format!("{}/", plan.files.target.name) } else { String::new() };
        if is_file {
            beside = format!("{name}.");
        }
        bake.warnings.dedup();
        let compressed = request.overflow.apply_all(&mut bake, plan.files.pixel)?;
        if request.preview {
            sheets.push((plan.files.target.name, preview::contact_sheet(&bake.chain, request.exposure)?));
        }
        let made = files(&plan.files, &name, &bake, &metadata(settings, &baked.opened.turned))?;
        let stored = Stored::new(plan, &bake, &made);
        for warning in plan.warning.iter().chain(&bake.warnings).chain(&stored.warnings) {
            if !output.warnings.contains(warning) {
                output.warnings.push(warning.clone());
            }
        }
        let report =
            report(request, (plan, settings), (&bake, &made), (&environment, compressed), stored, baked);
        let report = json(&report)?;
        output.files.extend(made.into_iter().map(|made| (format!("{folder}{}", made.path), made.bytes)));
        output.files.push((format!("{folder}{beside}report.json"), report.clone().into_bytes()));
        output.reports.push(report);
    }
    if baked.reading.extract_sun {
        output.files.push((format!("{beside}sun.json"), json(&baked.opened.sun)?.into_bytes()));
    }
    if request.sunless {
        let bytes = exact_exr_bytes(&baked.opened.environment, "an environment without its sun")?;
        output.files.push((format!("{beside}sunless.exr"), bytes));
    }
    output.preview = match &sheets[..] {
        [] => None,
        [(_, sheet)] => Some(png_bytes(sheet)?),
        sheets => Some(png_bytes(&preview::stacked(sheets))?),
    };
    Ok(output)
}

/// Serializes `value` as the text of a JSON file.
pub(crate) fn json(value: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Error::NonFiniteResult { place: format!("JSON, {error}"), value: f64::NAN })?;
    Ok(text + "\n")
}

/// How a bake was stored.
struct Stored {
    /// Pixel format of each level.
    pixels: Vec<String>,
    /// Texels clamped.
    clamped: u64,
    /// Greatest share of a level's energy lost to clamping.
    share: f64,
    warnings: Vec<String>,
}

impl Stored {
    fn new(plan: &Plan, bake: &Bake, made: &[Made]) -> Self {
        let pixel = plan.files.pixel;
        let levels = || bake.chain.levels.iter().map(|level| pixel.stored(&level.texels));
        let clamped: u64 = made.iter().flat_map(|file| &file.clamped).sum();
        let share = clamped_share(bake, pixel);
        let name = pixel.name();
        let mut warnings = Vec::new();
        if clamped > 0 && pixel == Pixel::Rgbe {
            warnings.push(format!(
                "{clamped} texels exceed the RGBE maximum of {:.1e} and were clamped; `format` exr keeps \
                 them",
                pixel.max()
            ));
        } else if clamped > 0 && share >= SHARE_THAT_MATTERS {
            let remedy = if plan.files.target.has_container() { "; `pixel` f32 keeps them" } else { "" };
            let percent = 100.0 * share;
            warnings.push(format!(
                "{clamped} texels exceed the range of {name} and were clamped, {percent:.2} % of a level's \
                 energy{remedy}"
            ));
        }
        let floats = levels().filter(|pixel| *pixel == Pixel::F32).count();
        if floats > 0 && pixel == Pixel::Auto {
            let count = bake.chain.levels.len();
            warnings.push(format!(
                "{floats} of {count} levels are stored as float, since they exceed the range of half floats"
            ));
        }
        let greatest =
            bake.levels().flat_map(|level| level.texels.as_flattened()).copied().fold(0.0, f32::max);
        let least = pixel.rounded_to_zero();
        if greatest > 0.0 && greatest <= least {
            warnings.push(format!(
                "all light is below {name}, which rounds {least:e} and less to 0: the output is black; `pixel` \
                 f32 with ktx2 or exr keeps it"
            ));
        }
        let pixels = levels().map(|pixel| pixel.name().to_owned()).collect();
        Self { pixels, clamped, share, warnings }
    }
}

/// The report of one plan's files.
fn report(
    request: &Request,
    (plan, settings): (&Plan, &BakeSettings),
    (bake, made): (&Bake, &[Made]),
    (environment, compressed): (&str, u64),
    stored: Stored,
    Baked { input, reading, opened, seconds }: &Baked<'_>,
) -> Report {
    let files = &plan.files;
    let circumstances = Circumstances {
        input: (*input).to_owned(),
        input_files: vec![InputFileReport {
            path: (*input).to_owned(),
            bytes: opened.bytes,
            blake3: opened.hash.clone(),
        }],
        engine: "cpu".to_owned(),
        adapter: None,
        repaired: opened.loaded.repaired.into(),
        layout: opened.loaded.layout.to_owned(),
        rotate_y: reading.rotate_y,
        mirror: reading.mirror,
        scale: reading.options.scale,
        crop: reading.options.crop,
        pad: reading.options.pad,
        sanitize: reading.options.sanitize,
        strict: reading.options.strict,
        extract_sun: reading.extract_sun,
        sunless: request.sunless,
        overflow: request.overflow,
        preview: request.preview,
        sun: opened.sun.clone(),
        format: files.format_name().to_owned(),
        pixel: files.pixel.name().to_owned(),
        level_pixels: stored.pixels,
        clamped: stored.clamped,
        clamped_energy_share: stored.share,
        warnings: [&opened.warnings[..], plan.warning.as_slice(), &stored.warnings].concat(),
        seconds: *seconds,
    };
    let outputs =
        made.iter().map(|file| OutputFileReport { path: file.path.clone(), bytes: file.bytes.len() as u64 });
    let mut report =
        Report { compressed, outputs: outputs.collect(), ..Report::new(settings, bake, circumstances) };
    if files.target.name.is_empty() {
        report.options.out_layout = Some(files.layout.name().to_owned());
    } else {
        report.target = Some(TargetReport {
            name: files.target.name.to_owned(),
            environment: environment.to_owned(),
            flip: files.flip.name().to_owned(),
            diffuse: files.diffuse.name().to_owned(),
            verified: files.target.verified.is_some(),
            files: made.iter().map(|file| file.path.clone()).collect(),
        });
    }
    report
}
