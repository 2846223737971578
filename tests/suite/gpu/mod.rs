//! Tests of the GPU engine against the CPU engine and the oracle, on every adapter of the system.
//!
//! A machine without an adapter fails these tests: `tests/run` installs software drivers first. Drivers named
//! in OCTAGLOSS_REQUIRE_ADAPTERS (parts of names, separated by commas) must be present. Drivers named in
//! OCTAGLOSS_BRIEF_ADAPTERS run only the tests of `brief`: every entry point over small inputs.

mod adaptive;
mod atlas;
mod bake;
mod bench;
mod boxes;
mod brief;
mod cells;
mod direct;
mod errors;
mod lamp;
mod lights;
mod live;
mod live_draw;
mod live_probes;
mod look;
mod oem;
mod oem_lookup;
mod oem_reader;
#[cfg(feature = "view")]
mod present;
mod pyramid;
mod pyramid_reader;
mod reflection;
mod reflections;
mod sat;
mod scenes;
mod shadow;
mod stages;
mod transfer;
mod twins;
mod unwrap;
#[cfg(feature = "view")]
mod view;
#[cfg(feature = "view")]
mod view_meshes;
#[cfg(feature = "view")]
mod view_scenes;
#[cfg(feature = "view")]
mod view_textures;

use octagloss::internals::gpu::engine::Engine;
use octagloss::internals::gpu::{Context, adapters, block_on};
use octagloss::wgpu;
use std::io::Write as _;
use std::sync::{LazyLock, OnceLock};

/// One context per adapter, with the baseline limits of a browser.
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

/// One value per adapter, made on first use: some drivers compile for seconds, and no test waits for another
/// driver's.
struct PerAdapter<T> {
    values: LazyLock<Vec<OnceLock<T>>>,
    make: fn(&Context) -> T,
}

impl<T> PerAdapter<T> {
    const fn new(make: fn(&Context) -> T) -> Self {
        Self { values: LazyLock::new(|| CONTEXTS.iter().map(|_| OnceLock::new()).collect()), make }
    }

    fn get(&self, context: &Context) -> &T {
        let own = |other: &Context| other.device() == context.device();
        let index = CONTEXTS.iter().position(own).expect("a context of the list");
        self.values[index].get_or_init(|| (self.make)(context))
    }
}

/// Every pass.
static ENGINES: PerAdapter<Engine> =
    PerAdapter::new(|context| Engine::new(context.clone()).expect("shaders that compile"));

/// Returns all passes, compiled for `context`.
fn passes(context: &Context) -> &'static Engine {
    ENGINES.get(context)
}

/// Returns whether the adapter `name` runs only the tests of `brief`.
fn is_brief(name: &str) -> bool {
    let brief = std::env::var("OCTAGLOSS_BRIEF_ADAPTERS").unwrap_or_default().to_lowercase();
    let mut parts = brief.split(',').filter(|part| !part.is_empty());
    parts.any(|part| name.to_lowercase().contains(part))
}

/// Runs `test` with all passes on every adapter that runs all tests, and prints its time.
fn with_passes(name: &str, test: impl Fn(&Context, &Engine)) {
    in_full(name, |context| test(context, passes(context)));
}

/// 2^-24: half the distance between 1 and the next float32.
const UNIT: f64 = 1.0 / (1_u32 << 24) as f64;

/// Returns whether `off` exceeds `allowed`, or either is not a number.
fn exceeds(off: f64, allowed: f64) -> bool {
    off.partial_cmp(&allowed).is_none_or(std::cmp::Ordering::is_gt)
}

/// Runs `test` on every adapter that runs all tests, and prints its time.
fn in_full(name: &str, test: impl Fn(&Context)) {
    run_on(name, |context| !is_brief(&context.device().adapter_info().name), test);
}

/// Runs `test` on every adapter, those of OCTAGLOSS_BRIEF_ADAPTERS included, and prints its time.
fn on_every_adapter(name: &str, test: impl Fn(&Context)) {
    run_on(name, |_| true, test);
}

fn run_on(name: &str, is_asked: impl Fn(&Context) -> bool, test: impl Fn(&Context)) {
    for context in CONTEXTS.iter().filter(|context| is_asked(context)) {
        let start = std::time::Instant::now();
        test(context);
        context.check().unwrap_or_else(|error| panic!("{name}: {error}"));
        let seconds = start.elapsed().as_secs_f64();
        say(&format!("{name}: {seconds:.1} s on {}", context.device().adapter_info().name));
    }
}

/// Writes straight to standard error: the harness hides the output of passing tests.
fn say(line: &str) {
    writeln!(std::io::stderr(), "gpu: {line}").expect("standard error is open");
}

/// Waits for a future on `context`.
fn wait<T>(context: &Context, future: impl Future<Output = octagloss::Result<T>>) -> T {
    block_on(Some(context), future).and_then(|outcome| outcome).unwrap_or_else(|error| panic!("{error}"))
}
