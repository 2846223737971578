//! Tests every reader with mutated inputs: `cargo run --release -p octagloss-workbench --example fuzz_readers
//! [COUNT] [READER]`, with READER named as in the output; 100,000 inputs and all readers by default. Fails if
//! a reader panics or exceeds its time or memory limit.

use octagloss_fixtures::files::mutation;
use std::process::ExitCode;

#[global_allocator]
static MEMORY: peakmem_alloc::PeakMemAlloc<std::alloc::System> = peakmem_alloc::PeakMemAlloc::system();

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let count = arguments.next().map_or(Ok(100_000), |count| count.parse());
    let Ok(count) = count else {
        eprintln!("usage: fuzz_readers [COUNT] [READER], with COUNT inputs per reader");
        return ExitCode::from(2);
    };
    let only = arguments.next();
    let folder = tempfile::tempdir().expect("a temporary folder");
    println!(
        "{:<14}{:>10}{:>10}{:>10}{:>8}{:>12}{:>12}",
        "reader", "inputs", "errors", "read", "panics", "worst ms", "peak MiB"
    );
    let mut holds = true;
    for reader in mutation::readers(folder.path()) {
        if only.as_ref().is_some_and(|only| only != reader.name) {
            continue;
        }
        let tally = mutation::fuzz(&reader, count, &MEMORY);
        println!(
            "{:<14}{:>10}{:>10}{:>10}{:>8}{:>12.1}{:>12.2}",
            reader.name,
            tally.mutations,
            tally.errors,
            tally.reads,
            tally.panics,
            1e3 * tally.slowest.as_secs_f64(),
            tally.peak_bytes as f64 / f64::from(1 << 20),
        );
        holds &= tally.holds();
    }
    println!(
        "limits: no panics, {} ms, {} MiB",
        mutation::TIME_LIMIT.as_millis(),
        mutation::PEAK_LIMIT >> 20
    );
    if holds { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
