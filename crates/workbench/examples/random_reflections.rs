//! Compares certified bounds of reflections with exhaustive integration for random cases: `cargo run
//! --release -p octagloss-workbench --example random_reflections [CASES] [SEED]`, 10,000 cases and seed 1 by
//! default. Each case is a small environment, a frame, a roughness, an anisotropy, a reflectance and a
//! tolerance. Fails if a bound does not hold.

use octagloss_fixtures::scenes::reflections::{Reflections, reflections};
use rayon::prelude::*;
use std::process::ExitCode;

/// Environments between two lines of progress.
const BATCH: u64 = 100;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u64>());
    let (Ok(cases), Ok(seed)) = (arguments.next().unwrap_or(Ok(10_000)), arguments.next().unwrap_or(Ok(1)))
    else {
        eprintln!("usage: random_reflections [CASES] [SEED], two whole numbers");
        return ExitCode::from(2);
    };
    let (mut all, mut first) = (Reflections::default(), 0);
    while all.compared < cases {
        let own = (first..first + BATCH).into_par_iter().map(|index| reflections(seed, index));
        all = all.join(own.reduce(Reflections::default, Reflections::join));
        first += BATCH;
        println!("{} reflections, {} violations", all.compared, all.violations.len());
    }
    for failure in all.violations.iter().take(20) {
        println!("{failure}");
    }
    if all.violations.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
