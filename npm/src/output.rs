//! The files and reports of a bake, by the names of the command line.

use crate::given::with_options;
use crate::plan::Request;
use crate::source::{Opened, Reading};
use glam::DVec3;
use octagloss::internals::bake::report::{Circumstances, InputFileReport, Report};
use octagloss::internals::export::files::{Made, files as made_files, metadata};
use octagloss::internals::export::lights;
use octagloss::internals::export::plan::BakePlan;
use octagloss::internals::export::stored::{Stored, recorded};
use octagloss::internals::image::preview;
use octagloss::internals::io::environment_write::exact_exr_bytes;
use octagloss::internals::io::ldr::write::png_bytes;
use octagloss::suns::Suns;
use octagloss::{Bake, Error, Result};
use serde::Serialize;
use std::path::Path;

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
    plans: &[BakePlan],
    bakes: Vec<Bake>,
    baked: &Baked<'_>,
) -> Result<Output> {
    let mut output = Output { warnings: baked.opened.warnings.clone(), ..Output::default() };
    let stem = Path::new(baked.input).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let environment = request.name.clone().or(stem).unwrap_or_else(|| "environment".to_owned());
    let several = plans.len() > 1;
    let mut sheets = Vec::new();
    let mut prefix = String::new();
    for (plan, mut bake) in plans.iter().zip(bakes) {
        let files = &plan.plan;
        let is_file = !files.is_targeted() && files.is_single();
        let name = match is_file {
            true => format!("{environment}.{}", files.container.name()),
            false => environment.clone(),
        };
        let folder = if several { format!("{}/", files.target.name) } else { String::new() };
        if is_file {
            prefix = format!("{name}.");
        }
        bake.warnings.dedup();
        let compressed = request.overflow.apply_all(&mut bake, files.pixel)?;
        if request.preview {
            let name = Path::new(baked.input).file_name().unwrap_or_default().to_string_lossy();
            let removed: Vec<DVec3> = baked.opened.suns.iter().map(|sun| sun.direction.into()).collect();
            let origin = preview::Origin {
                name: &name,
                target: files.target.name,
                source: Some(&baked.opened.environment),
                removed: &removed,
            };
            sheets.push(preview::contact_sheet(&bake.chain, origin, request.exposure)?);
        }
        let made = made_files(files, &name, &bake, &metadata(&plan.settings, &baked.opened.turned))?;
        let stored = Stored::new(files, &bake, &made);
        for warning in plan.warning.iter().chain(&bake.warnings).chain(&stored.warnings) {
            let warning = with_options(warning);
            if !output.warnings.contains(&warning) {
                output.warnings.push(warning);
            }
        }
        let report = report(request, plan, (&bake, &made), (&environment, compressed), stored, baked);
        let report = json(&report)?;
        output.files.extend(made.into_iter().map(|made| (format!("{folder}{}", made.path), made.bytes)));
        output.files.push((format!("{folder}{prefix}report.json"), report.clone().into_bytes()));
        output.reports.push(report);
    }
    if let Some(asked) = &baked.reading.extract_sun {
        let suns = &baked.opened.suns;
        let text = if *asked == Suns::Brightest { json(&suns.first())? } else { json(suns)? };
        output.files.push((format!("{prefix}sun.json"), text.into_bytes()));
        output.files.push((format!("{prefix}sun.gltf"), json(&lights::gltf(suns))?.into_bytes()));
    }
    if request.sunless {
        let bytes = exact_exr_bytes(&baked.opened.environment, "an environment without its sun")?;
        output.files.push((format!("{prefix}sunless.exr"), bytes));
    }
    output.preview = match &sheets[..] {
        [] => None,
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

/// The report of one plan's files.
fn report(
    request: &Request,
    BakePlan { plan: files, settings, warning, .. }: &BakePlan,
    (bake, made): (&Bake, &[Made]),
    (environment, compressed): (&str, u64),
    stored: Stored,
    Baked { input, reading, opened, seconds }: &Baked<'_>,
) -> Report {
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
        extract_sun: reading.extract_sun.clone(),
        sunless: request.sunless,
        overflow: request.overflow,
        preview: request.preview,
        suns: opened.suns.clone(),
        format: files.format_name().to_owned(),
        pixel: files.pixel.name().to_owned(),
        level_pixels: stored.pixels,
        clamped: stored.clamped,
        clamped_energy_share: stored.clamped_share,
        warnings: [&opened.warnings[..], warning.as_slice(), &stored.warnings].concat(),
        seconds: *seconds,
    };
    recorded(Report { compressed, ..Report::new(settings, bake, circumstances) }, files, environment, made)
}
