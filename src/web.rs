//! The library in a browser: what the page calls.

use crate::bake::Filter;
use crate::gpu::engine::{Engine, Reflector};
use crate::gpu::{Context, adapters, shader};
use crate::io::{self, ReadOptions};
use crate::lobe::Lobe;
use crate::reflector::ReflectorSettings;
use glam::DVec3;
use std::path::Path;
use wasm_bindgen::JsError;
use wasm_bindgen::prelude::wasm_bindgen;

/// What a tab can well give, of the 4 GiB that WebAssembly addresses.
const MEMORY_LIMIT: u64 = 1 << 30;

/// Panics go to the console.
#[wasm_bindgen(start)]
fn start() {
    console_error_panic_hook::set_once();
}

/// All passes on the browser's GPU.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Gpu(Engine);

#[wasm_bindgen]
impl Gpu {
    /// Compiles all passes.
    ///
    /// # Errors
    /// Where there is no WebGPU.
    pub async fn open() -> Result<Self, JsError> {
        let adapter = adapters().await.into_iter().next().ok_or_else(|| JsError::new("no WebGPU adapter"))?;
        Ok(Self(Engine::new(Context::new(&adapter).await?)?))
    }

    /// The adapter.
    #[must_use]
    pub fn adapter(&self) -> String {
        self.0.context().describe()
    }

    /// Red, green and blue of the GGX lobe of `roughness` around each of `directions` (x, y, z) in `environment`, by
    /// `filter` (`box`, or else adaptive) over an OEM of `size`: OEM, table and answers on the GPU.
    ///
    /// # Errors
    /// Where a parameter is out of its range, or the device fails.
    pub async fn query(
        &self,
        environment: &Environment,
        directions: Vec<f64>,
        roughness: f64,
        filter: &str,
        size: u32,
    ) -> Result<Vec<f32>, JsError> {
        let filter = if filter == "box" { Filter::Box } else { Filter::Adaptive(0.005) };
        let settings = ReflectorSettings { oem_size: Some(size), ..ReflectorSettings::default() };
        let reflector = Reflector::new(&self.0, &environment.0, &settings)?;
        let directions: Vec<DVec3> =
            directions.as_chunks().0.iter().copied().map(DVec3::from_array).collect();
        let answers = reflector.query(&directions, Lobe::Ggx, roughness, filter).await?;
        Ok(answers.iter().flat_map(|answer| answer.radiance).collect())
    }
}

/// An environment as read.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Environment(crate::Environment);

#[wasm_bindgen]
impl Environment {
    /// Reads `bytes`, the file called `name`.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, JsError> {
        let options = ReadOptions { memory_limit: MEMORY_LIMIT, ..ReadOptions::default() };
        Ok(Self(io::read_from_memory(Path::new(name), bytes, &options)?.environment))
    }
}

/// The paths of all shaders that have entry points.
#[wasm_bindgen]
#[must_use]
pub fn shader_paths() -> Vec<String> {
    let paths = shader::FILES.iter().map(|(path, _)| *path);
    paths.filter(|path| !path.starts_with("common/")).map(str::to_owned).collect()
}

/// The text of the shader `path`, its includes in place.
#[wasm_bindgen]
#[must_use]
pub fn shader_source(path: &str) -> String {
    shader::source(path)
}
