//! From bakes to files, reports and pictures: the same for every front end.

use super::files::{Made, Readers, files, metadata};
use super::lights;
use super::report::{OutputFileReport, Report, TargetReport};
use crate::analysis::extraction::Suns;
use crate::bake::{Bake, BakeSettings, memory};
use crate::common::error::{Error, Result, wrong};
use crate::common::percent::{percent, share_matters};
use crate::files::format::overflow::clamped_share;
use crate::files::format::{Pixel, RGBE_MAX};
use crate::files::image::preview;
use crate::files::io::environment_write::exact_exr_bytes;
use crate::files::io::ldr::png_bytes;
use crate::files::io::side_report::REPORT;
use crate::files::recipe::Recipe;
use crate::files::recipe::plan::BakePlan;
use crate::files::recipe::source::Source;
use crate::files::target::TargetPlan;
use crate::light::environment::Environment;
use glam::DVec3;
use serde::Serialize;
use std::path::Path;
use web_time::Instant;

/// Bakes, and the engine that made them.
pub struct Baked {
    /// One for each plan.
    pub bakes: Vec<Bake>,
    /// `cpu` or `gpu`.
    pub engine: &'static str,
    /// The graphics adapter.
    pub adapter: Option<String>,
    /// Why the CPU baked instead of the chosen GPU.
    pub fallback: Option<String>,
}

impl Baked {
    /// Bakes of the CPU.
    #[must_use]
    pub const fn on_cpu(bakes: Vec<Bake>) -> Self {
        Self { bakes, engine: "cpu", adapter: None, fallback: None }
    }
}

/// The files of one plan.
pub struct Product {
    /// The plan.
    pub plan: BakePlan,
    /// Its files, with paths in its own folder.
    pub made: Vec<Made>,
    /// Its report.
    pub report: Report,
    /// Losses of its pixel format that show, one line each.
    pub losses: Vec<String>,
}

/// Everything that a recipe makes of a source.
pub struct Products {
    /// One for each plan.
    pub per_plan: Vec<Product>,
    /// Files about the removed suns, with their paths.
    pub suns: Vec<(String, Vec<u8>)>,
    /// A PNG file.
    pub preview: Option<Vec<u8>>,
}

impl Products {
    /// The reports, one for each plan.
    pub fn reports(&self) -> impl Iterator<Item = &Report> {
        self.per_plan.iter().map(|product| &product.report)
    }

    /// All files with their paths in the output's folder, without reports and preview.
    pub fn files(&self) -> impl Iterator<Item = (String, &[u8])> {
        let several = self.per_plan.len() > 1;
        let made = self.per_plan.iter().flat_map(move |Product { plan, made, .. }| {
            made.iter().map(move |made| (within(several, plan, &made.path), &made.bytes[..]))
        });
        made.chain(self.suns.iter().map(|(path, bytes)| (path.clone(), &bytes[..])))
    }
}

/// A file about the removed suns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SunFile {
    /// Directions and irradiances of the suns.
    Sun,
    /// The suns as lights of glTF.
    Gltf,
    /// The environment without the suns.
    Sunless,
}

impl SunFile {
    /// The files that `recipe` requests.
    #[must_use]
    pub fn requested(recipe: &Recipe) -> Vec<Self> {
        let extracts = recipe.input.extract_sun.is_some();
        let asked = [(Self::Sun, extracts), (Self::Gltf, extracts), (Self::Sunless, recipe.sunless)];
        asked.into_iter().filter_map(|(file, asked)| asked.then_some(file)).collect()
    }

    /// Its name in a folder, or its name's suffix next to a file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sun => "sun.json",
            Self::Gltf => "sun.gltf",
            Self::Sunless => "sunless.exr",
        }
    }

    fn bytes(self, source: &Source) -> Result<Vec<u8>> {
        let is_list = source.options.extract_sun.as_ref().is_some_and(|suns| *suns != Suns::Brightest);
        match self {
            Self::Sun if is_list => json_bytes(&source.suns),
            Self::Sun => json_bytes(&source.suns.first()),
            Self::Gltf => json_bytes(&lights::gltf(&source.suns)),
            Self::Sunless => exact_exr_bytes(&source.environment, "an environment without its sun"),
        }
    }
}

/// The path of the file `path` of `plan`; in the target's folder for several targets.
pub fn within(several: bool, plan: &BakePlan, path: &str) -> String {
    if several { format!("{}/{path}", plan.plan.target.name) } else { path.to_owned() }
}

/// The path of `file` next to the levels of `plan`, whose output is called `name`.
pub fn beside(plan: &BakePlan, name: &str, file: &str) -> String {
    if plan.is_file() { format!("{name}.{file}") } else { file.to_owned() }
}

/// The path of the report of `plan`.
#[must_use]
pub fn report_path(several: bool, plan: &BakePlan, name: &str) -> String {
    within(several, plan, &beside(plan, name, REPORT))
}

/// Checks that the bakes of `plans` and their files fit into memory.
///
/// # Errors
/// [`Error::Limit`] if they do not.
pub fn check_memory(plans: &[BakePlan], environment: &Environment) -> Result<()> {
    // Four-byte formats need intermediate copies.
    let bytes = |plan: &BakePlan| if matches!(plan.plan.pixel, Pixel::F32 | Pixel::Auto) { 16 } else { 8 };
    let settings: Vec<BakeSettings> = plans.iter().map(|plan| plan.settings.clone()).collect();
    memory::check_bake(environment, &settings, plans.iter().map(bytes).max().unwrap_or(0))
}

/// Makes everything that `recipe` asks for from `source`; `bake` bakes it with the given settings. `start` is
/// when the source began to be read, `readers` gives the shaders that read files.
///
/// # Errors
/// Those of [`Recipe::plans`], of `bake`, and of [`products`].
pub fn produce(
    recipe: &Recipe,
    source: &Source,
    start: Instant,
    readers: Readers,
    bake: impl FnOnce(&[BakeSettings]) -> Result<Baked>,
) -> Result<Products> {
    let layout = source.environment.layout();
    let plans: Vec<BakePlan> = recipe.plans()?.iter().map(|plan| plan.settled(layout)).collect();
    check_memory(&plans, &source.environment)?;
    let settings: Vec<BakeSettings> = plans.iter().map(|plan| plan.settings.clone()).collect();
    products(&plans, source, bake(&settings)?, &name(&plans[0], source), start, readers)
}

/// The name of the output of `plan` by default: that of the recipe, else that of `source`.
#[must_use]
pub fn name(plan: &BakePlan, source: &Source) -> String {
    // Paths of WebAssembly have no `\`, but Node.js on Windows does.
    let is_web = cfg!(target_arch = "wasm32");
    let input = if is_web { source.input.replace('\\', "/") } else { source.input.clone() };
    let stem = || Path::new(&input).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let name = plan.recipe.name.clone().or_else(stem).unwrap_or_else(|| "environment".to_owned());
    if plan.is_file() { format!("{name}.{}", plan.plan.container.name()) } else { name }
}

/// Makes the files of `plans`, which are settled for `source`, from their bakes, for an output called `name`.
/// `start` is when the source began to be read, `readers` gives the shaders that read files.
///
/// # Errors
/// [`Error::Parameter`] for no plans, for other than one sound bake for each, for light that
/// [`crate::files::format::overflow::Overflow::Error`] refuses, and for levels that a container cannot hold;
/// [`Error::NonFiniteResult`] for a report with NaN.
pub fn products(
    plans: &[BakePlan],
    source: &Source,
    baked: Baked,
    name: &str,
    start: Instant,
    readers: Readers,
) -> Result<Products> {
    let Baked { bakes, engine, adapter, fallback } = baked;
    if plans.is_empty() || plans.len() != bakes.len() {
        let (plans, bakes) = (plans.len(), bakes.len());
        return wrong(format!("{bakes} bakes for {plans} plans; one for each is needed"));
    }
    bakes.iter().try_for_each(Bake::check)?;
    let (mut products, mut sheets) = (Vec::new(), Vec::new());
    for (plan, mut bake) in plans.iter().zip(bakes) {
        let BakePlan { recipe, plan: files_plan, .. } = plan;
        bake.warnings.dedup();
        // Those of a pyramid's map serve the report and the preview; its own texels are scaled to their
        // range.
        let unwritten = if plan.settings.pyramid { bake.chain.levels.len() } else { 0 };
        let levels = bake.levels_mut().enumerate().skip(unwritten);
        let applied = levels.map(|(index, level)| recipe.overflow.apply(index, level, files_plan.pixel));
        let compressed = applied.sum::<Result<_>>().map_err(|error| match error {
            Error::Parameter(message) if files_plan.is_targeted() => {
                Error::Parameter(format!("target {}: {message}", files_plan.target.name))
            }
            other => other,
        })?;
        if recipe.preview {
            let removed: Vec<DVec3> = source.suns.iter().map(|sun| sun.direction.into()).collect();
            let origin = preview::Origin {
                name: &Path::new(&source.input).file_name().unwrap_or_default().to_string_lossy(),
                target: files_plan.target.name,
                source: Some(&source.environment),
                removed: &removed,
            };
            sheets.push(preview::contact_sheet(&bake.chain, origin, recipe.exposure)?);
        }
        let mut report = Report::new(plan, &bake, source);
        let made = files(files_plan, name, &bake, &metadata(&report.recipe, &source.suns), readers)?;
        report.engine = engine.to_owned();
        report.adapter.clone_from(&adapter);
        report.clamped = made.iter().flat_map(|file| &file.clamped).sum();
        let share = |level| clamped_share(level, files_plan.pixel);
        report.clamped_energy_share = bake.levels().skip(unwritten).map(share).fold(0.0, f64::max);
        report.compressed = compressed;
        let losses = if plan.settings.pyramid { Vec::new() } else { losses(files_plan, &bake, &report) };
        let warnings = [&source.warnings[..], plan.warning.as_slice(), fallback.as_slice(), &losses[..]];
        report.warnings = [&warnings.concat()[..], &bake.warnings].concat();
        let output =
            |file: &Made| OutputFileReport { path: file.path.clone(), bytes: file.bytes.len() as u64 };
        report.outputs = made.iter().map(output).collect();
        report.target = files_plan.is_targeted().then(|| TargetReport {
            name: files_plan.target.name.to_owned(),
            environment: name.to_owned(),
            verified: files_plan.target.verified.is_some(),
            files: made.iter().map(|file| file.path.clone()).collect(),
        });
        report.seconds = start.elapsed().as_secs_f64();
        products.push(Product { plan: plan.clone(), made, report, losses });
    }
    let sun = |file: SunFile| Ok((beside(&plans[0], name, file.name()), file.bytes(source)?));
    let suns = SunFile::requested(&plans[0].recipe).into_iter().map(sun).collect::<Result<_>>()?;
    let preview = match &sheets[..] {
        [] => None,
        sheets => Some(png_bytes(&preview::stacked(sheets))?),
    };
    Ok(Products { per_plan: products, suns, preview })
}

/// Visible losses of the pixel format in `bake`, one line each.
fn losses(plan: &TargetPlan, bake: &Bake, report: &Report) -> Vec<String> {
    let (pixel, clamped, share) = (plan.pixel, report.clamped, report.clamped_energy_share);
    let mut losses = Vec::new();
    if clamped > 0 && pixel == Pixel::Rgbe {
        losses.push(format!(
            "{clamped} texels exceed the RGBE maximum of {RGBE_MAX:.1e} and were clamped; `format` exr keeps \
             them",
        ));
    } else if clamped > 0 && share_matters(share) {
        let remedy = if plan.target.has_container() { "; `pixel` f32 keeps them" } else { "" };
        losses.push(format!(
            "{clamped} texels exceed the range of {} and were clamped, {} of a level's energy{remedy}",
            pixel.name(),
            percent(share),
        ));
    }
    let floats = report.levels.iter().filter(|level| level.pixel == Pixel::F32.name()).count();
    if floats > 0 && pixel == Pixel::Auto {
        losses.push(format!(
            "{floats} of {} levels are stored as float, since they exceed the range of half floats",
            report.levels.len()
        ));
    }
    // All light rounds to 0.
    let is_above =
        |most: f32| bake.levels().any(|level| level.texels.as_flattened().iter().any(|value| *value > most));
    let rounded_to_zero = pixel.rounded_to_zero();
    if is_above(0.0) && !is_above(rounded_to_zero) {
        losses.push(format!(
            "all light is below {}, which rounds {rounded_to_zero:e} and less to 0: the output is black; \
             `pixel` f32 with ktx2 or exr keeps it",
            pixel.name()
        ));
    }
    losses
}

/// Serializes `value` as a JSON file.
///
/// # Errors
/// [`Error::NonFiniteResult`] if one of its numbers is NaN or infinite.
pub fn json_bytes(value: &impl Serialize) -> Result<Vec<u8>> {
    let mut bytes = serde_json::to_vec_pretty(value)
        .map_err(|error| Error::NonFiniteResult { place: format!("JSON, {error}"), value: f64::NAN })?;
    bytes.push(b'\n');
    Ok(bytes)
}
