//! `octagloss query`: radiance of a lobe around given directions.

use super::args::QueryArgs;
use super::engine::Query;
use super::input;
use super::talk::Talk;
use super::{Outcome, on_threads, print, usage};
use anyhow::{Context as _, anyhow, bail};
use glam::DVec3;
use octagloss::bake::Filter;
use octagloss::lobe::Lobe;
use octagloss::reflector::ReflectorSettings;
use std::fmt::Write as _;
use std::io::Read;
use std::path::Path;

/// A direction as it was typed and as it is meant.
struct Asked {
    typed: [String; 3],
    direction: DVec3,
}

pub(super) fn run(args: QueryArgs) -> Outcome {
    args.engine.check()?;
    let lobe = Lobe::from(args.lobe);
    let roughness = match (lobe, args.roughness) {
        (Lobe::Cosine, None) => 1.0,
        (Lobe::Cosine, Some(_)) => return usage("--lobe cosine has no roughness; leave --roughness out"),
        (_, Some(roughness)) => roughness,
        (_, None) => return usage("--roughness R is needed, R in [0, 1]"),
    };
    if args.bound && !matches!(args.filter, Filter::Adaptive(_)) {
        return usage("--bound needs --filter adaptive:E; the others certify nothing");
    }
    if let Err(error) = args.filter.check(lobe, args.table.oem_size) {
        return usage(error.to_string());
    }
    let source = input::single_source(args.inputs, &args.input)?;
    let talk = Talk::new(args.quiet);
    on_threads(args.engine.threads, || {
        let asked = read_directions(&args.directions)?;
        let opened = source.open(&args.input, &talk)?;
        let engine = args.engine.choose(&talk)?;
        let settings = ReflectorSettings {
            oem_size: args.table.oem_size,
            border: args.table.border,
            sharpest: lobe.served_roughness(roughness),
            fitted: matches!(args.filter, Filter::Fitted(_)),
        };
        let directions: Vec<DVec3> = asked.iter().map(|asked| asked.direction).collect();
        let query = Query { lobe, roughness, filter: args.filter };
        let answers = engine.query(&opened.environment, &settings, &directions, query, &talk)?;
        let bound = args.bound;
        let rows: Vec<String> = asked
            .iter()
            .zip(answers)
            .map(|(asked, answer)| {
                let [r, g, b] = answer.radiance;
                let [x, y, z] = &asked.typed;
                let mut row = format!("{x},{y},{z},{r:?},{g:?},{b:?}");
                if bound {
                    row.push(',');
                    // A mirror is a look-up: it has no bound, and the field is empty.
                    if let Some(bound) = answer.bound {
                        write!(row, "{bound:?}").expect("a string takes all");
                    }
                }
                row.push('\n');
                row
            })
            .collect();
        let header = if bound { "x,y,z,r,g,b,bound\n" } else { "x,y,z,r,g,b\n" };
        print(&(header.to_owned() + &rows.concat()))
    })
}

/// The directions in the CSV file `path`, or on standard input where that is `-`.
fn read_directions(path: &Path) -> anyhow::Result<Vec<Asked>> {
    if path == Path::new("-") {
        return parse_directions(std::io::stdin().lock()).context("standard input");
    }
    let file = std::fs::File::open(path).with_context(|| path.display().to_string())?;
    parse_directions(file).with_context(|| path.display().to_string())
}

fn parse_directions(mut from: impl Read) -> anyhow::Result<Vec<Asked>> {
    let mut text = Vec::new();
    from.read_to_end(&mut text)?;
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(&text[..]);
    let mut records = reader.records();
    let header = records.next().transpose()?.ok_or_else(|| anyhow!("empty; a line x,y,z must come first"))?;
    // A byte order mark is no part of the name.
    let names: Vec<&str> = header.iter().map(|name| name.trim_start_matches('\u{feff}')).collect();
    if names != ["x", "y", "z"] {
        bail!("line 1 is {:?}; the header must be x,y,z", names.join(","));
    }
    let mut asked = Vec::new();
    for record in records {
        let record = record?;
        let line = record.position().map_or(0, |position| line_of(position, &text));
        if record.len() != 3 {
            bail!("line {line} has {} values; x,y,z are three", record.len());
        }
        let mut direction = [0.0_f64; 3];
        for ((value, text), name) in direction.iter_mut().zip(&record).zip(names.iter()) {
            *value = text.parse().map_err(|_| anyhow!("line {line}: {name} is {text:?}, not a number"))?;
            if !value.is_finite() {
                bail!("line {line}: {name} is {text}; it must be finite");
            }
        }
        // Scaled first: squares of tiny and huge lengths leave the range of floats.
        let direction = DVec3::from_array(direction);
        let longest = direction.abs().max_element();
        if longest == 0.0 {
            bail!("line {line}: 0,0,0 points nowhere");
        }
        asked.push(Asked {
            typed: std::array::from_fn(|c| record[c].to_owned()),
            direction: (direction / longest).normalize(),
        });
    }
    Ok(asked)
}

/// The line a record stands on: its position is that of the empty lines before it.
fn line_of(position: &csv::Position, text: &[u8]) -> u64 {
    let rest = text.get(position.byte() as usize..).unwrap_or_default();
    let empty = rest.iter().take_while(|byte| b"\r\n".contains(byte)).filter(|byte| **byte == b'\n').count();
    position.line() + empty as u64
}
