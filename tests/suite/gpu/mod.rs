//! The GPU engine against the CPU engine and the oracle, on every adapter that the system has.
//!
//! A machine without an adapter fails these tests: `tests/run` installs software drivers first. The drivers named in
//! OCTAGLOSS_REQUIRE_ADAPTERS (parts of names, separated by commas) must be there.

mod adaptive;
mod bake;
mod boxes;
mod cells;
mod emitters;
mod entry_points;
mod errors;
mod fitted;
mod lamp;
mod oem;
mod oem_reader;
mod reflection;
mod sat;
mod scenes;
mod stages;
#[cfg(feature = "view")]
mod view;

use octagloss::gpu::engine::Engine;
use octagloss::gpu::{Context, adapters, block_on};
use octagloss::wgpu;
use std::io::Write as _;
use std::sync::LazyLock;

/// A context on every adapter, with baseline limits: what passes here passes in a browser.
static CONTEXTS: LazyLock<Vec<Context>> = LazyLock::new(|| {
    let adapters = block_on(None, adapters()).expect("no device to wait for");
    let contexts: Vec<Context> = adapters
        .iter()
        .map(|adapter| {
            let context = Context::with_limits(adapter, wgpu::Limits::default());
            block_on(None, context).and_then(|context| context).expect("a device with baseline limits")
        })
        .collect();
    let names: Vec<String> = contexts.iter().map(Context::describe).collect();
    for name in &names {
        say(&format!("adapter: {name}"));
    }
    assert!(!names.is_empty(), "no adapter: tests/run installs a software Vulkan driver");
    for required in std::env::var("OCTAGLOSS_REQUIRE_ADAPTERS").unwrap_or_default().split(',') {
        let found = names.iter().any(|name| name.to_lowercase().contains(&required.to_lowercase()));
        assert!(found, "no adapter is called {required}; there are {names:?}");
    }
    contexts
});

/// Every pass on every adapter: compiled once, for some drivers take seconds.
static ENGINES: LazyLock<Vec<Engine>> = LazyLock::new(|| {
    let compiled = |context: &Context| Engine::new(context.clone()).expect("shaders that compile");
    CONTEXTS.iter().map(compiled).collect()
});

/// Runs `test` on every adapter, with all passes, and says so.
fn with_passes(name: &str, test: impl Fn(&Context, &Engine)) {
    on_every_adapter(name, |context| test(context, &ENGINES[index(context)]));
}

/// Place of one of [`CONTEXTS`].
fn index(context: &Context) -> usize {
    let own = |other: &Context| other.device() == context.device();
    CONTEXTS.iter().position(own).expect("a context of the list")
}

/// 2^-24: half the distance between 1 and the next float32.
const UNIT: f64 = 1.0 / (1_u32 << 24) as f64;

/// Whether `off` is more than `allowed`, or either is not a number.
fn exceeds(off: f64, allowed: f64) -> bool {
    off.partial_cmp(&allowed).is_none_or(std::cmp::Ordering::is_gt)
}

/// Runs `test` on every adapter and says so.
fn on_every_adapter(name: &str, test: impl Fn(&Context)) {
    for context in CONTEXTS.iter() {
        let start = std::time::Instant::now();
        test(context);
        context.check().unwrap_or_else(|error| panic!("{name}: {error}"));
        let seconds = start.elapsed().as_secs_f64();
        say(&format!("{name}: {seconds:.1} s on {}", context.device().adapter_info().name));
    }
}

/// Straight to the log, passing tests' output being swallowed.
fn say(line: &str) {
    writeln!(std::io::stderr(), "gpu: {line}").expect("standard error is open");
}

/// The outcome of a future on `context`.
fn wait<T>(context: &Context, future: impl Future<Output = octagloss::Result<T>>) -> T {
    block_on(Some(context), future).and_then(|outcome| outcome).unwrap_or_else(|error| panic!("{error}"))
}
