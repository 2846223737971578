//! `octagloss compare`: measures a bake against its source or another bake.

use super::args::CompareArgs;
use super::compare_sources::Sources;
use super::console::Console;
use super::input::{is_chain_file, read_bake};
use super::look_ups::{self, Delivered, Overlay};
use super::outcome::{Outcome, check_not_input, on_threads, print, usage};
use super::values::Texels;
use crate::analysis::compare::{
    LevelErrors, Sampling, errors_against_bake, errors_against_source, grid_of, is_measurable,
};
use crate::chain::{Chain, ChainKind, Level};
use crate::image::drawing::scene::Scene;
use crate::image::error_sheet;
use crate::io::ldr::write::write_png;
use crate::io::regular::open_regular;
use crate::io::{
    self, LoadedChain,
    output::{self, Existing},
};
use crate::lobe::Lobe;
use crate::{Environment, Layout};
use anyhow::anyhow;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// The output of `--json`.
#[derive(Serialize)]
struct Comparison {
    bake: String,
    against: String,
    /// `source` or `bake`.
    reference: &'static str,
    /// The lobe integrated over a source.
    lobe: Option<&'static str>,
    /// Levels whose lobe is narrower than two texels of the source, and those that are solved.
    skipped: Vec<usize>,
    /// The content of the texels, as recorded in the bake.
    chain: Option<&'static str>,
    levels: Vec<LevelErrors>,
    /// Errors of look-ups; absent unless requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    delivered: Option<Delivered>,
    /// Further bakes of the chart.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    overlays: Vec<Overlay>,
}

pub(super) fn run(args: CompareArgs) -> Outcome {
    let console = Console::new(args.quiet);
    let existing = if args.force { Existing::Replace } else { Existing::Keep };
    if let Some(path) = &args.picture {
        if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
            return usage(format!("--picture {} must end in .png", path.display()));
        }
        check_not_input(path, [&args.bake, &args.against])?;
        output::recover(path);
        output::check_file(path, existing)?;
    }
    if let Some(path) = &args.chart {
        check_not_input(path, [&args.bake, &args.against].into_iter().chain(&args.overlay))?;
        look_ups::check_chart(path, existing)?;
    }
    on_threads(args.threads, || {
        let bake = bake_in(&args.bake, &console)?;
        let is_cube = |level: &Level| matches!(level.layout, Layout::Cube { .. });
        if args.picture.is_some() && !bake.chain.levels.iter().all(is_cube) {
            return usage(format!("--picture shows cubes; {} is not one", args.bake.display()));
        }
        let comparison = match read_bake(&args.against)? {
            Some(reference) => against_bake(&args, &bake.chain, &reference.chain)?,
            None => against_source(&args, &bake, &console)?,
        };
        if let Some(path) = &args.picture {
            write_png(path, existing, &picture(&args, &bake.chain, &comparison.levels)?.picture())?;
        }
        if let (Some(path), Some(delivered)) = (&args.chart, &comparison.delivered) {
            let overlays = comparison.overlays.iter().map(|overlay| (&overlay.bake[..], &overlay.delivered));
            let curves: Vec<_> = [(&comparison.bake[..], delivered)].into_iter().chain(overlays).collect();
            look_ups::draw_chart(path, existing, &curves, &args.against)?;
        }
        if args.json {
            print(&(serde_json::to_string(&comparison).map_err(anyhow::Error::from)? + "\n"))?;
        } else {
            print(&comparison.text())?;
        }
        judge(&comparison, args.fail_above)
    })
}

/// Reads the bake in `path`.
fn bake_in(path: &Path, console: &Console) -> Outcome<LoadedChain> {
    if let Some(bake) = read_bake(path)? {
        for warning in &bake.warnings {
            console.warn(&format!("{}: {warning}", path.display()));
        }
        return Ok(bake);
    }
    // Report why a candidate file or folder is not a valid bake.
    if path.is_dir() || is_chain_file(path) {
        io::read_chain(path)?;
    }
    open_regular(path)?;
    Err(anyhow!(
        "{}: not a bake; name a .ktx2, .ktx, .dds or .exr cube of octagloss bake, or a folder of levels",
        path.display()
    )
    .into())
}

fn against_bake(args: &CompareArgs, bake: &Chain, reference: &Chain) -> Outcome<Comparison> {
    if args.delivered.is_some() {
        return usage("--delivered needs a source environment, but both inputs are bakes");
    }
    Ok(Comparison {
        bake: args.bake.display().to_string(),
        against: args.against.display().to_string(),
        reference: "bake",
        lobe: None,
        skipped: Vec::new(),
        chain: None,
        levels: errors_against_bake(bake, reference)?,
        delivered: None,
        overlays: Vec::new(),
    })
}

fn against_source(args: &CompareArgs, bake: &LoadedChain, console: &Console) -> Outcome<Comparison> {
    let LoadedChain { chain: bake, provenance, .. } = bake;
    let sources = Sources::new(args, console);
    let (lobe, source) = sources.lobe_and_source(&args.bake, provenance)?;
    let kind = provenance.chain.unwrap_or(ChainKind::Sampled);
    let sampled = &bake.levels[..kind.first_solved(bake.levels.iter().map(|level| level.roughness))];
    // Solved texels are not lobes by design.
    let has_lobes = kind == ChainKind::Sampled
        || sampled.iter().any(|level| is_measurable(level, lobe, source.environment.layout()));
    let delivered = if !has_lobes || args.delivered.is_some() {
        let ladder = provenance.ladder.as_deref();
        Some(look_ups::measure(args, &args.bake, bake, lobe, ladder, &source, console)?)
    } else {
        None
    };
    let overlays =
        args.overlay.iter().map(|path| overlay(args, path, &sources, console)).collect::<Outcome<_>>()?;
    let (skipped, levels) = if has_lobes {
        texel_errors(args, bake, sampled, lobe, &source.environment, console)?
    } else if args.picture.is_some() || args.texels.is_some() {
        return usage(format!(
            "--texels and --picture compare texels with lobes, but {} is a {} chain; its texels are not \
             lobes",
            args.bake.display(),
            kind.name()
        ));
    } else {
        Default::default()
    };
    Ok(Comparison {
        bake: args.bake.display().to_string(),
        against: args.against.display().to_string(),
        reference: "source",
        lobe: Some(lobe.name()),
        skipped,
        chain: provenance.chain.map(ChainKind::name),
        levels,
        delivered,
        overlays,
    })
}

/// Measures the look-ups of a further bake.
fn overlay(args: &CompareArgs, path: &Path, sources: &Sources<'_>, console: &Console) -> Outcome<Overlay> {
    let LoadedChain { chain, provenance, .. } = bake_in(path, console)?;
    let (lobe, source) = sources.lobe_and_source(path, &provenance)?;
    let ladder = provenance.ladder.as_deref();
    let delivered = look_ups::measure(args, path, &chain, lobe, ladder, &source, console)?;
    Ok(Overlay { bake: path.display().to_string(), delivered })
}

/// Indices of the levels that cannot be measured, and the errors of the texels of the others; only the
/// `sampled` levels can.
fn texel_errors(
    args: &CompareArgs,
    bake: &Chain,
    sampled: &[Level],
    lobe: Lobe,
    source: &Environment,
    console: &Console,
) -> Outcome<(Vec<usize>, Vec<LevelErrors>)> {
    let mut skipped: Vec<usize> =
        (0..sampled.len()).filter(|level| !is_measurable(&sampled[*level], lobe, source.layout())).collect();
    if skipped.len() == bake.levels.len() {
        return Err(anyhow!(
            "no level of {} has a lobe at least two texels of {} wide; bake rougher levels to compare",
            args.bake.display(),
            args.against.display()
        )
        .into());
    }
    for level in &skipped {
        console
            .note(&format!("level {level} is skipped: its lobe is narrower than two texels of the source"));
    }
    if sampled.len() < bake.levels.len() {
        skipped.extend(sampled.len()..bake.levels.len());
        console.note(&format!(
            "levels from {} on are skipped: they are solved, so their texels are not lobes; --delivered \
             measures look-ups",
            sampled.len()
        ));
    }
    let sampling = sampling(args, lobe);
    if let (Sampling::Grid(count), true) = (sampling, args.picture.is_some()) {
        console.note(&format!(
            "the picture shows a grid of at most {count} texels per level; --texels all shows all"
        ));
    }
    let bar = console.bar("integrating");
    let progress = |done, total| bar.at(done, total);
    Ok((skipped, errors_against_source(sampled, source, lobe, sampling, &progress)))
}

/// Texels of a level to integrate by default,
const TEXELS: usize = 400;
/// and of cones, whose edge takes an integration as long as ten of another lobe.
const CONE_TEXELS: usize = 40;

/// The texels to compare: those requested, else few enough for a quick run.
fn sampling(args: &CompareArgs, lobe: Lobe) -> Sampling {
    let count = match args.texels {
        Some(Texels::All) => return Sampling::All,
        Some(Texels::Some(count)) => count,
        None if lobe == Lobe::Cone => CONE_TEXELS,
        None => TEXELS,
    };
    if args.picture.is_some() { Sampling::Grid(count) } else { Sampling::Random(count) }
}

/// The sheet of the errors of the levels.
fn picture(args: &CompareArgs, bake: &Chain, levels: &[LevelErrors]) -> crate::Result<Scene> {
    let pairs: Vec<(&LevelErrors, &Level, Level)> = (levels.iter())
        .filter_map(|errors| {
            let reference = errors.reference.as_ref()?;
            Some((errors, reference, grid_of(&bake.levels[errors.level], reference.size())))
        })
        .collect();
    let shown: Vec<_> = (pairs.iter())
        .map(|(errors, reference, level)| error_sheet::LevelErrors {
            number: errors.level,
            size: errors.size,
            rel_rmse: errors.rel_rmse,
            level,
            reference,
        })
        .collect();
    let name = |path: &Path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    error_sheet::error_sheet(&format!("Errors of {}", name(&args.bake)), &name(&args.against), &shown)
}

fn judge(comparison: &Comparison, limit: Option<f64>) -> Outcome {
    let Some(limit) = limit else { return Ok(()) };
    let levels = &comparison.levels;
    if let (Some(delivered), true) = (&comparison.delivered, levels.is_empty()) {
        let bad =
            delivered.roughnesses.iter().filter(|error| error.rel_rmse.is_nan() || error.rel_rmse > limit);
        return match bad.max_by(|a, b| a.rel_rmse.total_cmp(&b.rel_rmse)) {
            None => Ok(()),
            Some(error) => Err(anyhow!(
                "delivered relRMSE {:.6} at roughness {:.4} is above {limit}",
                error.rel_rmse,
                error.roughness
            )
            .into()),
        };
    }
    // NaN fails, too.
    let bad = levels.iter().filter(|errors| errors.rel_rmse.is_nan() || errors.rel_rmse > limit);
    match bad.max_by(|a, b| a.rel_rmse.total_cmp(&b.rel_rmse)) {
        None => Ok(()),
        Some(errors) => {
            Err(anyhow!("relRMSE {:.6} of level {} is above {limit}", errors.rel_rmse, errors.level).into())
        }
    }
}

impl Comparison {
    fn text(&self) -> String {
        let mut text = String::new();
        if !self.levels.is_empty() {
            text += "level   size  roughness   texels   relRMSE        L1     seam  reference's seam\n";
        }
        let ratio = |seam: Option<f64>| seam.map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.3}"));
        for errors in &self.levels {
            let worst = &errors.worst;
            let [x, y, z] = worst.direction;
            let radiance = |rgb: [f64; 3]| rgb.map(|c| format!("{c:.4e}")).join(" ");
            writeln!(
                text,
                "{:>5}  {:>5}  {:>9.4}  {:>7}  {:>8.6}  {:>8.6}  {:>7}  {:>16}\n       worst: {:.4} off at \
                 {} ({}, {}), direction {x:.4} {y:.4} {z:.4}: {} for {}",
                errors.level,
                errors.size,
                errors.roughness,
                errors.texels,
                errors.rel_rmse,
                errors.l1,
                ratio(errors.seam),
                ratio(errors.reference_seam),
                worst.relative,
                worst.face.unwrap_or("texel"),
                worst.i,
                worst.j,
                radiance(worst.value),
                radiance(worst.reference),
            )
            .expect("writing to a string cannot fail");
        }
        if let Some(delivered) = &self.delivered {
            text += &delivered.text(if self.overlays.is_empty() { "delivered" } else { &self.bake });
        }
        for Overlay { bake, delivered } in &self.overlays {
            text += &delivered.text(bake);
        }
        text
    }
}
