//! Times that `bench --engine gpu` prints.

use crate::cli::{done, json};
use serde_json::Value;
use std::time::Instant;
use tempfile::TempDir;

/// Sum of the medians of `timings`.
fn sum<'a>(timings: impl IntoIterator<Item = &'a Value>) -> f64 {
    timings.into_iter().map(|timing| timing["median_seconds"].as_f64().expect("a number")).sum()
}

/// One after another, stages take as long as all of them: times that leave out work, as lavapipe's timestamps
/// do, add up to less.
#[test]
fn times_of_stages_add_up_to_the_time_that_passes() {
    let folder = TempDir::new().expect("a temporary folder");
    let adapters = json(&done(folder.path(), &["info", "--adapters", "--json"]).out);
    for adapter in adapters.as_array().expect("adapters") {
        // Without what stands in brackets.
        let adapter = adapter.as_str().expect("a name").split(" (").next().expect("a part");
        let args = ["bench", "--engine", "gpu", "--adapter", adapter, "--size", "64", "--runs", "1"];
        let start = Instant::now();
        let bench = json(&done(folder.path(), &args).out);
        let passed = start.elapsed().as_secs_f64();
        let stages = bench["stages"].as_object().expect("stages").values().chain([&bench["copy"]]);
        let levels = bench["bake"]["levels"].as_array().expect("levels");
        let mut walls = 0.0;
        for (name, sum) in [("stages", sum(stages)), ("bake", sum(levels))] {
            let wall = bench["wall"][name]["median_seconds"].as_f64().expect("a number");
            // Half may be overhead. One run is its own median.
            assert!(sum > 0.5 * wall && sum <= wall, "{name}: {sum} s of {wall} s by {}", bench["clock"]);
            walls += wall;
        }
        // Each list has run twice at least: to warm up and to be timed.
        assert!(passed > walls, "{walls} s in {passed} s");
    }
}
