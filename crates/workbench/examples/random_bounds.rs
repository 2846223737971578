//! Compares certified bounds with exhaustive integration for random cases: `cargo run --release -p
//! octagloss-workbench --example random_bounds [CASES] [SEED]`, 1,000,000 cases and seed 1 by default. Each
//! case is a lobe, a roughness, a tolerance and a direction. Light ranges from 1e-45 to 3.4e38, mixed within
//! one environment. Groups of environments share lobe and directions. Fails if a bound does not hold or a
//! number is not finite.

use octagloss_fixtures::scenes::lights::{Tally, examine, examine_unbounded};
use rayon::prelude::*;
use std::process::ExitCode;
use std::time::Instant;

/// Environments per group with the same queries.
const LIGHTS: u32 = 16;

/// Groups of environments between two lines of progress.
const BATCH: u64 = 100;

/// One group in this many is also queried with the filters without a bound.
const UNBOUNDED: u64 = 12;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u64>());
    let (Ok(cases), Ok(seed)) =
        (arguments.next().unwrap_or(Ok(1_000_000)), arguments.next().unwrap_or(Ok(1)))
    else {
        eprintln!("usage: random_bounds [CASES] [SEED], two whole numbers");
        return ExitCode::from(2);
    };
    let start = Instant::now();
    let mut all = Tally::default();
    let mut first = 0;
    while all.compared < cases {
        let tally = (first..first + BATCH)
            .into_par_iter()
            .map(|index| {
                let bounded = examine(seed, index, LIGHTS, &|answer| answer);
                if index % UNBOUNDED == 0 { bounded.join(examine_unbounded(seed, index)) } else { bounded }
            })
            .reduce(Tally::default, Tally::join);
        first += BATCH;
        for failure in tally.not_finite.iter().chain(&tally.violations).take(20) {
            println!("{failure}");
        }
        all = all.join(tally);
        println!(
            "{} bounds compared, {} answers without a bound, {} not finite, {} violations; \
             error/bound mean {:.4}, worst {:.4}; {:.0} s",
            all.compared,
            all.unbounded,
            all.not_finite.len(),
            all.violations.len(),
            all.ratios / all.compared.max(1) as f64,
            all.worst,
            start.elapsed().as_secs_f64()
        );
    }
    if all.is_sound() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
