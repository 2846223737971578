//! Comparisons of a bake with its source or another bake, as text and as JSON.

use super::args::CompareArgs;
use super::compare_parts::{self, Part, Parts};
use super::compare_sources::Sources;
use super::console::Console;
use super::gate::{Verdict, levels};
use super::input::read_bake;
use super::look_ups::{self, Delivered, Overlay, channel};
use super::measures::{Measures, is_from};
use super::outcome::{Outcome, failed, usage};
use crate::ChainKind;
use octagloss_core::analysis::compare::{
    LevelErrors, Sampling, errors_against_bake, errors_against_source, is_measurable,
};
use octagloss_core::files::io::regular::open_regular;
use octagloss_core::files::io::{self, LoadedChain};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// The output of `--json`.
#[derive(Default, Serialize)]
pub(super) struct Comparison {
    pub(super) bake: String,
    pub(super) against: String,
    /// `source` or `bake`.
    reference: &'static str,
    /// The lobe integrated over a source.
    lobe: Option<&'static str>,
    /// Levels whose texels are not compared with lobes: the mirror, those whose lobe is narrower than two
    /// texels of the source, and those that are solved.
    skipped: Vec<usize>,
    /// The content of the texels, as recorded in the bake.
    chain: Option<&'static str>,
    pub(super) levels: Vec<LevelErrors>,
    /// The mirror level and what the bake has besides its levels.
    pub(super) parts: Vec<Part>,
    /// Errors of look-ups; absent unless requested or judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) delivered: Option<Delivered>,
    /// Further bakes of the chart.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) overlays: Vec<Overlay>,
    /// Absent unless judged.
    #[serde(flatten)]
    pub(super) verdict: Option<Verdict>,
}

impl Comparison {
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        if !self.levels.is_empty() {
            text += "level   size  roughness   texels   relRMSE   worst channel        L1     seam  \
                     reference's seam\n";
        }
        let ratio = |seam: Option<f64>| seam.map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.3}"));
        for errors in &self.levels {
            let worst = &errors.worst;
            let [x, y, z] = worst.direction;
            let radiance = |rgb: [f64; 3]| rgb.map(|c| format!("{c:.4e}")).join(" ");
            text += &format!(
                "{:>5}  {:>5}  {:>9.4}  {:>7}  {:>8.6}  {:>14}  {:>8.6}  {:>7}  {:>16}\n       worst: {} \
                 {:.4} off at {} ({}, {}), direction {x:.4} {y:.4} {z:.4}: {} for {}\n",
                errors.level,
                errors.size,
                errors.roughness,
                errors.texels,
                errors.rmse.luminance,
                channel(errors.rmse.worst_channel()),
                errors.l1,
                ratio(errors.seam),
                ratio(errors.reference_seam),
                worst.of,
                worst.relative,
                worst.face.unwrap_or("texel"),
                worst.i,
                worst.j,
                radiance(worst.value),
                radiance(worst.reference),
            );
        }
        text += &compare_parts::text(&self.parts);
        if let Some(delivered) = &self.delivered {
            text += &delivered.text(if self.overlays.is_empty() { "delivered" } else { &self.bake });
        }
        for Overlay { bake, delivered } in &self.overlays {
            text += &delivered.text(bake);
        }
        text
    }
}

/// Reads the bake in `path`.
pub(super) fn bake_in(path: &Path, console: &Console) -> Outcome<LoadedChain> {
    if let Some(bake) = read_bake(path)? {
        console.warn_of(path, &bake.warnings);
        return Ok(bake);
    }
    if let Some(panorama) = io::target_panorama(path)? {
        return Ok(panorama);
    }
    // Report why a candidate file or folder is not a valid bake.
    if path.is_dir() || io::may_hold_chain(path) {
        io::read_chain(path)?;
    }
    open_regular(path)?;
    failed(format!(
        "{}: not a bake; name a .ktx2, .ktx, .dds or .exr cube of octagloss bake, or a folder of levels",
        path.display()
    ))
}

pub(super) fn against_bake(
    args: &CompareArgs,
    bake: &LoadedChain,
    reference: &LoadedChain,
    from: Option<f64>,
) -> Outcome<Comparison> {
    if args.delivered.is_some() {
        return usage("--delivered needs a source environment, but both inputs are bakes");
    }
    let mut parts = Parts::read(&args.bake, bake)?;
    let errors = parts.errors_against(&Parts::read(&args.against[0], reference)?);
    let mut comparison = Comparison {
        bake: args.bake.display().to_string(),
        against: args.against[0].display().to_string(),
        reference: "bake",
        levels: errors_against_bake(&bake.chain, &reference.chain)?,
        parts: errors,
        ..Comparison::default()
    };
    comparison.verdict = from.map(|from| Verdict::new(&comparison, from, Vec::new(), parts.unjudged));
    Ok(comparison)
}

/// Compares the bake in `path` with its source.
pub(super) fn against_source(
    measures: &Measures,
    path: &Path,
    bake: &LoadedChain,
    sources: &Sources<'_>,
) -> Outcome<Comparison> {
    let console = sources.console;
    let (name, against) = (path.display(), sources.path().display());
    let LoadedChain { chain, provenance, .. } = bake;
    let (lobe, source) = sources.lobe_and_source(path, provenance)?;
    let kind = provenance.chain.unwrap_or(ChainKind::Sampled);
    let solved = kind.first_solved(chain.levels.iter().map(|level| level.roughness));
    let sampled = &chain.levels[..solved];
    let is_mirror = chain.levels[0].roughness == 0.0 && lobe.has_mirror();
    let has_solved = solved < chain.levels.len();
    // Solved texels are not lobes by design.
    let has_lobes = sampled.iter().any(|level| is_measurable(level, lobe, source.environment.layout()));
    if !has_lobes
        && has_solved
        && (measures.is_drawn || (measures.texels.is_some() && measures.from.is_none()))
    {
        return usage(format!(
            "--texels and --picture compare texels with lobes, but {name} is a {kind} chain; its texels are \
             not lobes"
        ));
    }
    let is_delivered =
        measures.delivered.is_some() || (has_solved && (!has_lobes || measures.from.is_some()));
    let measured = || look_ups::measure(measures, path, bake, lobe, &source, console);
    let delivered = is_delivered.then(measured).transpose()?;
    let overlay = |path: &PathBuf| -> Outcome<Overlay> {
        let bake = bake_in(path, console)?;
        let (lobe, source) = sources.lobe_and_source(path, &bake.provenance)?;
        let unjudged = Measures { from: None, ..measures.clone() };
        let delivered = look_ups::measure(&unjudged, path, &bake, lobe, &source, console)?;
        Ok(Overlay { bake: path.display().to_string(), delivered })
    };
    let overlays = measures.overlays.iter().map(overlay).collect::<Outcome<_>>()?;
    let sampling = measures.sampling(lobe);
    let mut parts = Vec::new();
    if is_mirror {
        parts.push(compare_parts::mirror(&chain.levels[0], &source.environment)?);
    }
    let found = Parts::read(path, bake)?;
    parts.extend(found.errors(&source.environment, sampling, console)?);
    let narrow: Vec<usize> = (usize::from(is_mirror)..solved)
        .filter(|level| !is_measurable(&sampled[*level], lobe, source.environment.layout()))
        .collect();
    if !has_lobes && !has_solved && !is_mirror {
        return failed(format!(
            "no level of {name} has a lobe at least two texels of {against} wide; bake rougher levels to \
             compare"
        ));
    }
    if !narrow.is_empty() && measures.from.is_none() {
        let their =
            if narrow.len() == 1 { "is skipped: its lobe is" } else { "are skipped: their lobes are" };
        console.note(&format!("{} {their} narrower than two texels of the source", levels(&narrow)));
    }
    if has_solved && delivered.is_none() {
        console.note(&format!(
            "levels from {solved} on are skipped: they are solved, so their texels are not lobes; \
             --delivered measures look-ups",
        ));
    }
    if let Sampling::Grid(count) = sampling {
        console.note(&format!(
            "the picture shows a grid of at most {count} texels per level; --texels all shows all"
        ));
    }
    let bar = console.bar("integrating");
    let progress = |done, total| bar.at(done, total);
    let levels = errors_against_source(sampled, &source.environment, lobe, sampling, &progress);
    drop(bar);
    let is_compared = |level: &usize| levels.iter().any(|errors| errors.level == *level);
    let mut comparison = Comparison {
        bake: name.to_string(),
        against: against.to_string(),
        reference: "source",
        lobe: Some(lobe.name()),
        skipped: (0..chain.levels.len()).filter(|level| !is_compared(level)).collect(),
        chain: provenance.chain.map(ChainKind::name),
        levels,
        parts,
        delivered,
        overlays,
        verdict: None,
    };
    if let Some(from) = measures.from {
        let (narrow, sharp): (Vec<usize>, Vec<usize>) =
            narrow.iter().partition(|level| is_from(from, chain.levels[**level].roughness));
        let mut unjudged = unmeasured(measures, &comparison, &narrow, from);
        unjudged.extend(found.unjudged);
        comparison.verdict = Some(Verdict::new(&comparison, from, sharp, unjudged));
    }
    Ok(comparison)
}

/// What `comparison` did not measure from the roughness `from` on, and why; the levels `narrow` have too
/// narrow lobes.
fn unmeasured(measures: &Measures, comparison: &Comparison, narrow: &[usize], from: f64) -> Vec<String> {
    let mut all = Vec::new();
    if !narrow.is_empty() {
        all.push(format!("{} (lobes narrower than two texels of the source)", levels(narrow)));
    }
    let judged = comparison.delivered.iter().flat_map(|delivered| &delivered.roughnesses);
    let sharpest = judged.map(|error| error.roughness).filter(|r| is_from(from, *r)).reduce(f64::min);
    match sharpest {
        _ if measures.delivered.as_ref().is_some_and(|asked| !asked.is_empty()) => {
            all.push("look-ups at roughnesses that --delivered does not name".to_owned());
        }
        Some(sharpest) => all.push(format!("look-ups sharper than roughness {sharpest:.3}")),
        None if comparison.levels.len() + comparison.skipped.len() > 1 => {
            all.push("look-ups between texels and levels (--delivered judges those of ggx)".to_owned());
        }
        None => {}
    }
    if !comparison.overlays.is_empty() {
        all.push("overlays".to_owned());
    }
    all
}
