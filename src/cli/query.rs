//! `octagloss query`: computes the radiance of a lobe around given directions.

use super::args::QueryArgs;
use super::console::{self, Console};
use super::engine::EngineArg;
use super::input::{self, InputFiles};
use super::outcome::{
    Outcome, check_not_input, check_output, on_threads, or_usage, print, usage, write_output,
};
use super::output::extension;
use super::rows::{DIRECTIONS, Direction, FRAMES, Rows};
use crate::queries::{Query, sharpest};
use crate::{Answer, Bound, Filter, Lobe, Oracle, Reflector, Rgb};
use glam::DVec3;
use octagloss_core::analysis::oracle::reflection::reflection;
use octagloss_core::common::frame::Frame;
use octagloss_core::common::parallel;
use octagloss_core::cpu::reflection::{LEAST_ROUGHNESS, ReflectedLight};
use octagloss_core::files::io::npy;
use std::fmt::Write as _;

pub(super) fn run(args: QueryArgs) -> Outcome {
    args.engine.check()?;
    let lobe = args.lobe;
    if lobe == Lobe::Cosine && args.roughness.is_some() {
        return usage("--lobe cosine has no roughness; omit --roughness");
    }
    if args.bound && !matches!(args.filter, Filter::Adaptive(_)) {
        return usage("--bound needs --filter adaptive:E; other filters have no certified bounds");
    }
    or_usage(args.filter.check(lobe, args.table.oem_size))?;
    or_usage(args.table.check(args.filter))?;
    let source = input::single_source(args.inputs.clone(), &args.input)?;
    let output = match &args.output {
        Some(path) => {
            let is_array = match extension(path).as_deref() {
                Some("csv") => false,
                Some("npy") => true,
                _ if path.as_os_str() == "-" => return usage("omit -o to write CSV to standard output"),
                _ => return usage(format!("-o {} must end in .csv or .npy", path.display())),
            };
            check_not_input(path, source.files().iter().chain(&args.directions).chain(&args.frames))?;
            Some((path, check_output(path, args.force)?, is_array))
        }
        None => None,
    };
    let console = Console::new(args.quiet);
    on_threads(args.engine.threads, || {
        let (header, typed, answers, asked) = match &args.frames {
            Some(path) => {
                let frames = FRAMES.read(path)?;
                let answers = reflected(&args, &frames, &source, &console)?;
                (frames.header, frames.typed, answers, "frames")
            }
            None => {
                let path = args.directions.as_deref().expect("required without frames");
                let directions = DIRECTIONS.read(path)?;
                let answers = lobes(&args, &directions, &source, &console)?;
                (directions.header, directions.typed, answers, "directions")
            }
        };
        let csv = || csv(&header, &typed, &answers, args.bound);
        let Some((path, existing, is_array)) = output else { return print(&csv()) };
        let bytes = if is_array { array(&answers, args.bound) } else { csv().into_bytes() };
        write_output(path, existing, &bytes)?;
        let (count, size) = (answers.len(), console::bytes(bytes.len() as u64));
        console.note(&format!("{}: {count} {asked}, {size}", path.display()));
        Ok(())
    })
}

/// The radiance of lobes around `rows`.
fn lobes(
    args: &QueryArgs,
    rows: &Rows<Direction>,
    source: &InputFiles,
    console: &Console,
) -> Outcome<Vec<Answer>> {
    let lobe = args.lobe;
    let shared = match (lobe, args.roughness, rows.is_full) {
        (Lobe::Cosine, _, false) => 1.0,
        (Lobe::Cosine, _, true) => {
            return usage("--lobe cosine has no roughness; omit the column of roughness");
        }
        (_, Some(roughness), false) => roughness,
        (_, Some(_), true) => {
            return usage("--roughness and the column of roughness contradict each other; omit one");
        }
        (_, None, false) => {
            return usage("--roughness R, R in [0, 1], or a column of roughness in --directions is required");
        }
        // Unused: the rows have their own.
        (_, None, true) => 1.0,
    };
    let (directions, roughness): (Vec<DVec3>, Vec<f64>) =
        rows.values.iter().map(|(direction, roughness)| (*direction, roughness.unwrap_or(shared))).unzip();
    let opened = source.open(&args.input, console)?;
    let engine = args.engine.choose(console)?;
    let sharpest = sharpest(lobe, &roughness).unwrap_or_else(|| lobe.served_roughness(shared));
    let settings = args.table.reflector(args.filter, sharpest);
    let query = Query { lobe, filter: args.filter, directions: &directions, roughness: &roughness };
    Ok(engine.query(&opened.environment, &settings, &query, console)?)
}

/// The radiance that the surfaces of `frames` reflect.
fn reflected(
    args: &QueryArgs,
    frames: &Rows<Frame>,
    source: &InputFiles,
    console: &Console,
) -> Outcome<Vec<Answer>> {
    let Some(roughness) = args.roughness else {
        return usage("--roughness R, R in [0, 1], is required with --frames");
    };
    let anisotropy = args.anisotropy.unwrap_or(0.0);
    if anisotropy > 0.0 && !frames.is_full {
        return usage("--anisotropy needs tangents: columns tx,ty,tz in --frames");
    }
    if args.engine.engine == EngineArg::Gpu {
        return usage("--frames is answered by the CPU; omit --engine gpu");
    }
    let f0 = args.f0.unwrap_or(1.0);
    let unbounded = |radiance: Rgb| Answer { radiance, bound: None };
    match args.filter {
        Filter::Pyramid => {
            let environment = source.open(&args.input, console)?.environment;
            // Reads are narrower than lobes, and a map holds the suns apart.
            let settings = args.table.reflector(args.filter, roughness.min(0.2));
            let reflector = Reflector::new(&environment, &settings)?;
            let reflect = |frame: &Frame| {
                unbounded(reflector.reflect(frame, roughness as f32, anisotropy as f32, f0 as f32))
            };
            Ok(parallel::map(&frames.values, reflect))
        }
        Filter::Reference | Filter::Adaptive(_) if roughness < LEAST_ROUGHNESS => {
            usage(format!("--filter {} reflects from roughness {LEAST_ROUGHNESS} up", args.filter))
        }
        Filter::Reference => {
            let environment = source.open(&args.input, console)?.environment;
            let oracle = Oracle::new(&environment);
            let reflect = |frame: &Frame| {
                let [all, grazing] = reflection(&oracle, frame, roughness, anisotropy);
                unbounded([0, 1, 2].map(|c| (f0 * all[c] + (1.0 - f0) * grazing[c]) as f32))
            };
            Ok(parallel::map(&frames.values, reflect))
        }
        Filter::Adaptive(error) => {
            let environment = source.open(&args.input, console)?.environment;
            let light = ReflectedLight::new(&environment);
            let reflect = |frame: &Frame| light.reflect(frame, roughness, anisotropy, [f0; 3], error);
            Ok(parallel::map(&frames.values, reflect))
        }
        Filter::Box => usage("--frames has no --filter box; use adaptive:E, pyramid or reference"),
    }
}

/// Names of the columns of `--bound`: the luminance's, then the channels'.
const BOUNDS: &str = ",bound,bound_r,bound_g,bound_b";

/// The answers to `rows` as text, a line each, with `header`.
fn csv(header: &str, rows: &[String], answers: &[Answer], bound: bool) -> String {
    let more = if bound { BOUNDS } else { "" };
    let mut text = format!("{header},r,g,b{more}\n");
    for (typed, answer) in rows.iter().zip(answers) {
        text += typed;
        let bounds = answer.bound.filter(|_| bound).map(Bound::values);
        for value in answer.radiance.iter().chain(bounds.iter().flatten()) {
            write!(text, ",{value:?}").expect("writing to a string cannot fail");
        }
        // Mirrors are look-ups without bounds; leave the fields empty.
        text += if bound && bounds.is_none() { ",,,,\n" } else { "\n" };
    }
    text
}

/// The answers as a .npy file, a row each.
fn array(answers: &[Answer], bound: bool) -> Vec<u8> {
    let row = |answer: &Answer| {
        let bounds = bound.then(|| answer.bound.unwrap_or(Bound::NONE).values());
        answer.radiance.into_iter().chain(bounds.into_iter().flatten())
    };
    let values: Vec<f32> = answers.iter().flat_map(row).collect();
    npy::table_bytes(if bound { 7 } else { 3 }, &values)
}
