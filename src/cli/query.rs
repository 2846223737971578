//! `octagloss query`: computes the radiance of a lobe around given directions.

use super::args::QueryArgs;
use super::console::{self, Console};
use super::directions::{Asked, Directions, read_directions};
use super::input;
use super::outcome::{Outcome, check_not_input, check_output, on_threads, print, usage, write_output};
use crate::bake::query::Query;
use crate::filter::{Answer, Bound, Filter};
use crate::io::npy;
use crate::io::output::Existing;
use crate::lobe::Lobe;
use crate::reflector::{ReflectorSettings, sharpest};
use glam::DVec3;
use std::fmt::Write as _;
use std::path::Path;

pub(super) fn run(args: QueryArgs) -> Outcome {
    args.engine.check()?;
    let lobe = args.lobe;
    if lobe == Lobe::Cosine && args.roughness.is_some() {
        return usage("--lobe cosine has no roughness; omit --roughness");
    }
    if args.bound && !matches!(args.filter, Filter::Adaptive(_)) {
        return usage("--bound needs --filter adaptive:E; other filters have no certified bounds");
    }
    if let Err(error) = args.filter.check(lobe, args.table.oem_size) {
        return usage(error.to_string());
    }
    args.table.check(args.filter).or_else(|error| usage(error.to_string()))?;
    let source = input::single_source(args.inputs, &args.input)?;
    let existing = if args.force { Existing::Replace } else { Existing::Keep };
    let output = match &args.output {
        Some(path) => {
            let form = Form::from_path(path)?;
            check_not_input(path, source.files().iter().chain([&args.directions]))?;
            check_output(path, existing)?;
            Some((path, form))
        }
        None => None,
    };
    let console = Console::new(args.quiet);
    on_threads(args.engine.threads, || {
        let Directions { asked, has_roughness } = read_directions(&args.directions)?;
        let shared = match (lobe, args.roughness, has_roughness) {
            (Lobe::Cosine, _, false) => 1.0,
            (Lobe::Cosine, _, true) => {
                return usage("--lobe cosine has no roughness; omit the column of roughness");
            }
            (_, Some(roughness), false) => roughness,
            (_, Some(_), true) => {
                return usage("--roughness and the column of roughness contradict each other; omit one");
            }
            (_, None, false) => {
                return usage(
                    "--roughness R, R in [0, 1], or a column of roughness in --directions is required",
                );
            }
            // Unused: the rows have their own.
            (_, None, true) => 1.0,
        };
        let roughness: Vec<f64> = asked.iter().map(|asked| asked.roughness.unwrap_or(shared)).collect();
        let opened = source.open(&args.input, &console)?;
        let engine = args.engine.choose(&console)?;
        let settings = ReflectorSettings {
            oem_size: args.table.oem_size,
            border: args.table.border,
            scan: args.table.scan.unwrap_or_default(),
            sharpest: sharpest(lobe, &roughness).unwrap_or_else(|| lobe.served_roughness(shared)),
            pyramid: args.filter == Filter::Pyramid,
        };
        let directions: Vec<DVec3> = asked.iter().map(|asked| asked.direction).collect();
        let query = Query { lobe, filter: args.filter, directions: &directions, roughness: &roughness };
        let answers = engine.query(&opened.environment, &settings, &query, &console)?;
        let Some((path, form)) = output else {
            return print(&csv(&asked, &answers, has_roughness, args.bound));
        };
        let bytes = match form {
            Form::Csv => csv(&asked, &answers, has_roughness, args.bound).into_bytes(),
            Form::Array => array(&answers, args.bound),
        };
        write_output(path, existing, &bytes)?;
        let (count, size) = (answers.len(), console::bytes(bytes.len() as u64));
        console.note(&format!("{}: {count} directions, {size}", path.display()));
        Ok(())
    })
}

/// Form of an output file.
#[derive(Clone, Copy)]
enum Form {
    Csv,
    Array,
}

impl Form {
    /// The form of the extension of `path`.
    fn from_path(path: &Path) -> Outcome<Self> {
        let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
        match extension.as_deref().and_then(|extension| extension.to_str()) {
            Some("csv") => Ok(Self::Csv),
            Some("npy") => Ok(Self::Array),
            _ if path.as_os_str() == "-" => usage("omit -o to write CSV to standard output"),
            _ => usage(format!("-o {} must end in .csv or .npy", path.display())),
        }
    }
}

/// Names of the columns of `--bound`: the luminance's, then the channels'.
const BOUNDS: &str = ",bound,bound_r,bound_g,bound_b";

/// The answers as text, a line each, with a header.
fn csv(asked: &[Asked], answers: &[Answer], has_roughness: bool, bound: bool) -> String {
    let (own, more) = (if has_roughness { ",roughness" } else { "" }, if bound { BOUNDS } else { "" });
    let mut text = format!("x,y,z{own},r,g,b{more}\n");
    for (asked, answer) in asked.iter().zip(answers) {
        let [r, g, b] = answer.radiance;
        write!(text, "{},{r:?},{g:?},{b:?}", asked.typed).expect("writing to a string cannot fail");
        if bound {
            // Mirrors are look-ups without bounds; leave the fields empty.
            match answer.bound {
                Some(bound) => {
                    let [luminance, r, g, b] = bound.values();
                    write!(text, ",{luminance:?},{r:?},{g:?},{b:?}")
                        .expect("writing to a string cannot fail");
                }
                None => text.push_str(",,,,"),
            }
        }
        text.push('\n');
    }
    text
}

/// The answers as a .npy file, a row each.
fn array(answers: &[Answer], bound: bool) -> Vec<u8> {
    let bounds = |answer: &Answer| {
        let bounds = bound.then(|| answer.bound.unwrap_or(Bound::NONE).values());
        bounds.into_iter().flatten()
    };
    let row = |answer: &Answer| answer.radiance.into_iter().chain(bounds(answer));
    let values: Vec<f32> = answers.iter().flat_map(row).collect();
    npy::table_bytes(if bound { 7 } else { 3 }, &values)
}
