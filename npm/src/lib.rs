//! Bakes in browsers and in Node.js: the library's CPU engine behind three functions.
//!
//! The module answers synchronously, on one thread. The package's JavaScript runs it in workers, and cancels
//! a call by ending its worker.

mod given;
mod output;
mod plan;
mod query;
mod source;

use given::{Given, with_options};
use js_sys::{Array, Error, Float32Array, Function, Object, Reflect, Uint8Array};
use octagloss::internals::bake::report::{RepairReport, SunReport};
use octagloss::suns::{Brightest, Sun};
use octagloss::targets::{TARGETS, Target};
use octagloss::{Progress, Statistics, bake_all};
use output::{Baked, Output, output};
use plan::Request;
use query::Query;
use serde::Serialize;
use source::{Opened, Reading};
use std::cell::RefCell;
use std::ops::ControlFlow;
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::{JsError, JsValue};
use web_time::Instant;

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
        output::json(&TARGETS.iter().map(target).collect::<Vec<_>>())
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
        let mut given = Given::parsed(options)?;
        let reading = Reading::of(&mut given)?;
        let request = Request::of(&mut given, reading.extract_sun.is_some())?;
        given.finish()?;
        let opened = reading.open(input, &bytes)?;
        drop(bytes);
        read.call0(&JsValue::NULL).ok();
        let plans = request.plans(opened.environment.layout());
        let settings: Vec<_> = plans.iter().map(|plan| plan.settings.clone()).collect();
        ON_PROGRESS.set(progress);
        let bakes = bake_all(&opened.environment, &settings, &advance);
        ON_PROGRESS.set(None);
        let seconds = start.elapsed().as_secs_f64();
        let baked = Baked { input, reading: &reading, opened: &opened, seconds };
        Ok(object(output(&request, &plans, bakes?, &baked)?))
    })
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
fn object(Output { files, reports, warnings, preview }: Output) -> Object {
    let array = Array::new();
    // Freed one after the other, for JavaScript has copies.
    for (name, bytes) in files {
        array.push(&object_of([
            ("name", JsValue::from_str(&name)),
            ("bytes", Uint8Array::from(&bytes[..]).into()),
        ]));
    }
    let texts = |texts: Vec<String>| -> Array { texts.iter().map(|text| JsValue::from_str(text)).collect() };
    let preview = preview.map_or(JsValue::NULL, |bytes| Uint8Array::from(&bytes[..]).into());
    object_of([
        ("files", array.into()),
        ("reports", texts(reports).into()),
        ("warnings", texts(warnings).into()),
        ("preview", preview),
    ])
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
            repaired: RepairReport,
            warnings: &'a [String],
        }
        let mut given = Given::parsed(options)?;
        let mut reading = Reading::of(&mut given)?;
        given.finish()?;
        // Counts NaN and Inf, unless repairs are errors.
        reading.options.sanitize = !reading.options.strict;
        let Opened { environment, loaded, warnings, bytes, .. } = reading.open(input, &bytes)?;
        let statistics = Statistics::new(&environment);
        let share = statistics.sun_share();
        let is_sun = |sun: &&Sun| sun.kind == Brightest::Sun;
        let info = Info {
            input,
            format: &loaded.format,
            bytes,
            layout: loaded.layout,
            width: loaded.width,
            height: loaded.height,
            min: statistics.min,
            max: statistics.max,
            mean: statistics.mean,
            sun: statistics.sun.as_ref().filter(is_sun).map(|sun| SunReport::new(sun, share)),
            repaired: loaded.repaired.into(),
            warnings: &warnings,
        };
        output::json(&info)
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
        let mut given = Given::parsed(options)?;
        let reading = Reading::of(&mut given)?;
        let query = Query::of(&mut given)?;
        given.finish()?;
        let opened = reading.open(input, &bytes)?;
        drop(bytes);
        Ok(Float32Array::from(&query.answer(&opened.environment, directions, roughness)?[..]))
    })
}
