//! Bakes in browsers and in Node.js: the library's CPU engine behind three functions.
//!
//! The module answers synchronously, on one thread. The package's JavaScript runs it in workers, and cancels
//! a call by ending its worker.

mod options;
mod query;

use js_sys::{Array, Error, Float32Array, Function, Object, Reflect, Uint8Array};
use octagloss::read::Repairs;
use octagloss::recipes::{
    Baked, InputOptions, Products, Recipe, Source, SunReport, json_bytes, name, produce, report_path,
};
use octagloss::suns::{Brightest, Sun};
use octagloss::targets::{TARGETS, Target};
use octagloss::{Progress, Statistics, bake_all};
use options::{parsed, with_options};
use query::Query;
use serde::Serialize;
use std::cell::RefCell;
use std::ops::ControlFlow;
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::{JsError, JsValue};
use web_time::Instant;

/// Most bytes that reading a file may take.
const MEMORY_LIMIT: u64 = 2 << 30;

thread_local! {
    /// Called with the share of a bake that is done. Not captured by the library's callback, which is shared
    /// between threads where there are several.
    static ON_PROGRESS: RefCell<Option<Function>> = const { RefCell::new(None) };
}

/// Throws panics as errors named `Panic`; without this they are traps without a message. The instance must
/// not be used again.
#[wasm_bindgen(start)]
fn start() {
    std::panic::set_hook(Box::new(|info| {
        let error = Error::new(&info.to_string());
        error.set_name("Panic");
        wasm_bindgen::throw_val(error.into())
    }));
}

/// The version of the library.
#[wasm_bindgen]
#[must_use]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// The targets as JSON: `name`, `reader`, `size`, and `verified`, the engine that loads it in a test.
///
/// # Errors
/// None in practice: texts and numbers always serialise.
#[wasm_bindgen]
pub fn targets() -> Result<String, JsError> {
    answered(|| {
        let target = |target: &Target| {
            let Target { name, reader, size, verified, .. } = target;
            serde_json::json!({"name": name, "reader": reader, "size": size, "verified": verified})
        };
        json(&TARGETS.iter().map(target).collect::<Vec<_>>())
    })
}

/// Bakes the environment in `bytes`, the file `input`. `options` is JSON. Calls `read` once the file is read,
/// and `progress` with shares from 0 to 1.
///
/// # Errors
/// The library's message for wrong options, and for a file that is no environment.
#[wasm_bindgen]
pub fn bake(
    input: &str,
    bytes: Vec<u8>,
    options: &str,
    read: &Function,
    progress: Option<Function>,
) -> Result<Object, JsError> {
    answered(|| {
        let start = Instant::now();
        let recipe: Recipe = parsed(options)?;
        recipe.plans()?;
        let source = recipe.input.open_bytes(input, &bytes, MEMORY_LIMIT)?;
        drop(bytes);
        read.call0(&JsValue::NULL).ok();
        ON_PROGRESS.set(progress);
        let products = produce(&recipe, &source, start, |settings| {
            Ok(Baked::on_cpu(bake_all(&source.environment, settings, &advance)?))
        });
        ON_PROGRESS.set(None);
        object(products?, &source)
    })
}

/// The text of `value` as a JSON file.
fn json(value: &impl Serialize) -> octagloss::Result<String> {
    Ok(String::from_utf8(json_bytes(value)?).expect("JSON is UTF-8"))
}

/// The result of `work`, with options in messages named as here.
fn answered<T>(work: impl FnOnce() -> octagloss::Result<T>) -> Result<T, JsError> {
    work().map_err(|error| JsError::new(&with_options(&error.to_string())))
}

fn advance(Progress { done, total, .. }: Progress) -> ControlFlow<()> {
    ON_PROGRESS.with_borrow(|progress| {
        if let Some(progress) = progress {
            // Exceptions of the caller's function do not stop the bake.
            progress.call1(&JsValue::NULL, &JsValue::from_f64(done as f64 / total as f64)).ok();
        }
    });
    ControlFlow::Continue(())
}

/// The object that JavaScript gets: `files`, `reports`, `warnings` and `preview`.
fn object(products: Products, source: &Source) -> octagloss::Result<Object> {
    let (files, reports, several) = (Array::new(), Array::new(), products.per_plan.len() > 1);
    let mut warnings: Vec<String> = Vec::new();
    let add = |name: &str, bytes: &[u8]| {
        let bytes: JsValue = Uint8Array::from(bytes).into();
        files.push(&object_of([("name", JsValue::from_str(name)), ("bytes", bytes)]));
    };
    for (name, bytes) in products.files() {
        add(&name, bytes);
    }
    for product in &products.per_plan {
        let text = json(&product.report)?;
        add(&report_path(several, &product.plan, &name(&product.plan, source)), text.as_bytes());
        reports.push(&JsValue::from_str(&text));
        for warning in product.report.warnings.iter().map(|warning| with_options(warning)) {
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
    }
    let warnings: Array = warnings.iter().map(|text| JsValue::from_str(text)).collect();
    let preview = products.preview.map_or(JsValue::NULL, |bytes| Uint8Array::from(&bytes[..]).into());
    Ok(object_of([
        ("files", files.into()),
        ("reports", reports.into()),
        ("warnings", warnings.into()),
        ("preview", preview),
    ]))
}

fn object_of<const N: usize>(entries: [(&str, JsValue); N]) -> Object {
    let object = Object::new();
    for (key, value) in entries {
        Reflect::set(&object, &JsValue::from_str(key), &value).expect("a new object takes any key");
    }
    object
}

/// Describes the environment in `bytes`, the file `input`, as JSON. `options` is JSON with options of
/// reading.
///
/// # Errors
/// The library's message for wrong options, and for a file that is no environment.
#[wasm_bindgen]
pub fn info(input: &str, bytes: Vec<u8>, options: &str) -> Result<String, JsError> {
    answered(|| {
        #[derive(Serialize)]
        struct Info<'a> {
            input: &'a str,
            format: &'a str,
            bytes: u64,
            layout: &'a str,
            width: u32,
            height: u32,
            min: [f32; 3],
            max: [f32; 3],
            mean: [f64; 3],
            sun: Option<SunReport>,
            repaired: Repairs,
            warnings: &'a [String],
        }
        let mut options: InputOptions = parsed(options)?;
        options.check()?;
        // Counts NaN and Inf, unless repairs are errors.
        options.sanitize = !options.strict;
        let source = options.open_bytes(input, &bytes, MEMORY_LIMIT)?;
        let statistics = Statistics::new(&source.environment);
        let share = statistics.sun_share();
        let is_sun = |sun: &&Sun| sun.kind == Brightest::Sun;
        let info = Info {
            input,
            format: &source.format,
            bytes: bytes.len() as u64,
            layout: source.layout,
            width: source.width,
            height: source.height,
            min: statistics.min,
            max: statistics.max,
            mean: statistics.mean,
            sun: statistics.sun.as_ref().filter(is_sun).map(|sun| SunReport::new(sun, share)),
            repaired: source.repaired,
            warnings: &source.warnings,
        };
        json(&info)
    })
}

/// Radiance of a lobe around each of `directions`, three numbers each, of the environment in `bytes`.
/// `roughness` has one number, or one for each direction. `options` is JSON with options of reading, and
/// `lobe`, `filter`, `bound`, `oemSize` and `border`.
///
/// # Errors
/// The library's message for wrong options, and for a file that is no environment.
#[wasm_bindgen]
pub fn query(
    input: &str,
    bytes: Vec<u8>,
    options: &str,
    directions: &[f64],
    roughness: &[f64],
) -> Result<Float32Array, JsError> {
    answered(|| {
        let query: Query = parsed(options)?;
        query.check()?;
        let source = query.input.open_bytes(input, &bytes, MEMORY_LIMIT)?;
        drop(bytes);
        Ok(Float32Array::from(&query.answer(&source.environment, directions, roughness)?[..]))
    })
}
