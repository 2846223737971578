//! `octagloss query`: prints the radiance of a lobe around given directions.

use super::args::QueryArgs;
use super::console::Console;
use super::directions::{Directions, read_directions};
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
    if lobe == Lobe::Cosine && args.roughness.is_some() {
        return usage("--lobe cosine has no roughness; omit --roughness");
    }
    if args.bound && !matches!(args.filter, Filter::Adaptive(_)) {
        return usage("--bound needs --filter adaptive:E; other filters have no certified bounds");
    }
    if let Err(error) = args.filter.check(lobe, args.table.oem_size) {
        return usage(error.to_string());
    }
    args.table.check_scan(args.filter)?;
    let source = input::single_source(args.inputs, &args.input)?;
    let console = Console::new(args.quiet);
    on_threads(args.engine.threads, || {
        let Directions { asked, has_roughness } = read_directions(&args.directions)?;
        let shared = match (lobe, args.roughness, has_roughness) {
            (Lobe::Cosine, _, false) => 1.0,
            (Lobe::Cosine, _, true) => return usage("--lobe cosine has no roughness; omit the column"),
            (_, Some(roughness), false) => roughness,
            (_, Some(_), true) => {
                return usage("--roughness and the column roughness contradict each other; omit one");
            }
            (_, None, false) => {
                return usage(
                    "--roughness R, R in [0, 1], or a column roughness in --directions is required",
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
            sharpest: sharpest(lobe, &roughness, shared),
            fitted: matches!(args.filter, Filter::Fitted(_)),
        };
        let directions: Vec<DVec3> = asked.iter().map(|asked| asked.direction).collect();
        let query = Query { lobe, filter: args.filter, directions: &directions, roughness: &roughness };
        let answers = engine.query(&opened.environment, &settings, &query, &console)?;
        let bound = args.bound;
        let rows: Vec<String> = asked
            .iter()
            .zip(answers)
            .map(|(asked, answer)| {
                let [r, g, b] = answer.radiance;
                let mut row = format!("{},{r:?},{g:?},{b:?}", asked.typed);
                if bound {
                    row.push(',');
                    // Mirrors are look-ups without a bound; leave the field empty.
                    if let Some(bound) = answer.bound {
                        write!(row, "{bound:?}").expect("writing to a string cannot fail");
                    }
                }
                row.push('\n');
                row
            })
            .collect();
        let (own, more) = (if has_roughness { ",roughness" } else { "" }, if bound { ",bound" } else { "" });
        print(&(format!("x,y,z{own},r,g,b{more}\n") + &rows.concat()))
    })
}

/// The smallest roughness of the lobe, ignoring mirrors; `shared` if no row has one.
fn sharpest(lobe: Lobe, roughness: &[f64], shared: f64) -> f64 {
    let served = roughness.iter().map(|roughness| lobe.served_roughness(*roughness));
    let (mirrors, lobes): (Vec<f64>, Vec<f64>) = served.partition(|roughness| *roughness == 0.0);
    let least = lobes.into_iter().reduce(f64::min).or(mirrors.first().copied());
    least.unwrap_or_else(|| lobe.served_roughness(shared))
}
