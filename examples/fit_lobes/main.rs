//! Fits the parameters of the real-time tier: `cargo run --release --example fit_lobes K [FILE]` for K = 1,
//! 2, 4 or 8 boxes, or `cone` for the boxes around cone points. Writes FILE, by default the file of the
//! library in `src/realtime/tables`. Takes two to fifteen minutes on two cores.

#[allow(dead_code, reason = "a test uses the rest")]
mod fit;

use fit::{bytes, fit};
use octagloss::internals::realtime::tables::Table;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let name = match arguments.first().map(String::as_str) {
        Some("1") => "one",
        Some("2") => "two",
        Some("4") => "four",
        Some("8") => "eight",
        Some("cone") => "cone",
        _ => {
            eprintln!("usage: fit_lobes K [FILE], with K = 1, 2, 4 or 8 boxes, or cone");
            return ExitCode::from(2);
        }
    };
    let path = arguments.get(1).cloned().unwrap_or_else(|| format!("src/realtime/tables/{name}.bin"));
    let known = match arguments[0].parse() {
        Ok(count) => Table::of(count).expect("one of them"),
        Err(_) => Table::around_cone_points(),
    };
    let start = Instant::now();
    let progress = |done: &str| println!("{done} after {:.0} s", start.elapsed().as_secs_f64());
    let table = fit(known.shape(), &progress);
    if let Err(error) = std::fs::write(&path, bytes(&table)) {
        eprintln!("{path}: {error}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
