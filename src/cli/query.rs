//! `octagloss query`: radiance of a lobe around given directions.

use super::args::QueryArgs;
use super::console::Console;
use super::directions::read_directions;
use super::engine::Query;
use super::input;
use super::outcome::{Outcome, on_threads, print, usage};
use crate::filter::Filter;
use crate::lobe::Lobe;
use crate::reflector::ReflectorSettings;
use glam::DVec3;
use std::fmt::Write as _;

pub(super) fn run(args: QueryArgs) -> Outcome {
    args.engine.check()?;
    let lobe = args.lobe;
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
    let console = Console::new(args.quiet);
    on_threads(args.engine.threads, || {
        let asked = read_directions(&args.directions)?;
        let opened = source.open(&args.input, &console)?;
        let engine = args.engine.choose(&console)?;
        let settings = ReflectorSettings {
            oem_size: args.table.oem_size,
            border: args.table.border,
            sharpest: lobe.served_roughness(roughness),
            fitted: matches!(args.filter, Filter::Fitted(_)),
        };
        let directions: Vec<DVec3> = asked.iter().map(|asked| asked.direction).collect();
        let query = Query { lobe, roughness, filter: args.filter };
        let answers = engine.query(&opened.environment, &settings, &directions, query, &console)?;
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
