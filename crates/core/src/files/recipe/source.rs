//! An environment as it is baked: read, mirrored, rotated, without its suns; and what is known of it.

use super::InputOptions;
use crate::analysis::extraction::{Lamp, Suns, extract};
use crate::analysis::sun::Sun;
use crate::common::error::Result;
use crate::common::finite::finite;
use crate::files::io::provenance::{Provenance, TakenSun};
use crate::files::io::{self, Loaded, Repairs};
use crate::light::environment::Environment;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An environment as it is baked.
#[derive(Clone, Debug)]
pub struct Source {
    /// The light.
    pub environment: Arc<Environment>,
    /// The input's path as given; for six files the first.
    pub input: String,
    /// Its files with their sizes and hashes.
    pub files: Vec<InputFileReport>,
    /// How it was read and turned.
    pub options: InputOptions,
    /// Origin recorded in the input.
    pub origin: Provenance,
    /// The removed suns.
    pub suns: Vec<SunReport>,
    /// Repairs made.
    pub repaired: Repairs,
    /// Removals, one line each.
    pub notes: Vec<String>,
    /// Warnings, one line each: assumptions of the reader, and suns that were not removed.
    pub warnings: Vec<String>,
    /// The encoding in words.
    pub format: String,
    /// The layout in words.
    pub layout: &'static str,
    /// Columns of the image, or of one face for a file of faces.
    pub width: u32,
    /// Rows of the image, or of one face for a file of faces.
    pub height: u32,
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct InputFileReport {
    /// Path as given.
    pub path: String,
    /// Its size; for a folder, that of its level 0.
    pub bytes: u64,
    /// BLAKE3 hash of its content in hexadecimal; for a folder, of the names and hashes of its level 0.
    pub blake3: String,
}

/// A sun, see [`Sun`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SunReport {
    /// Unit vector towards it, in the world.
    #[serde(serialize_with = "finite")]
    pub direction: [f64; 3],
    /// Degrees from +X towards +Z.
    #[serde(serialize_with = "finite")]
    pub azimuth_degrees: f64,
    /// Degrees above the horizon.
    #[serde(serialize_with = "finite")]
    pub elevation_degrees: f64,
    /// Radiance of its brightest texel.
    #[serde(serialize_with = "finite")]
    pub peak: [f32; 3],
    /// Irradiance on a surface that faces it.
    #[serde(serialize_with = "finite")]
    pub irradiance: [f64; 3],
    /// Irradiance over its maximum channel, which is a directional light's intensity.
    #[serde(serialize_with = "finite")]
    pub color: [f64; 3],
    /// Steradians.
    #[serde(serialize_with = "finite")]
    pub solid_angle: f64,
    /// Number of texels.
    pub texels: usize,
    /// Its share of the environment's energy, by luminance.
    #[serde(serialize_with = "finite")]
    pub energy_share: f64,
    /// Median luminance around it.
    pub surroundings: f64,
}

impl SunReport {
    /// Creates the report of `sun` with its share of the total energy.
    #[must_use]
    pub fn new(sun: &Sun, energy_share: f64) -> Self {
        let intensity = sun.irradiance.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        Self {
            direction: sun.direction.to_array(),
            azimuth_degrees: sun.azimuth_degrees(),
            elevation_degrees: sun.elevation_degrees(),
            peak: sun.peak,
            irradiance: sun.irradiance,
            color: sun.irradiance.map(|channel| channel / intensity),
            solid_angle: sun.solid_angle,
            texels: sun.texels,
            energy_share,
            surroundings: sun.surroundings,
        }
    }
}

impl From<&SunReport> for TakenSun {
    fn from(sun: &SunReport) -> Self {
        Self { direction: sun.direction, irradiance: sun.irradiance, solid_angle: sun.solid_angle }
    }
}

impl InputOptions {
    /// Reads the environment in `paths`, one file or folder, or the six faces of a cube, and turns it.
    ///
    /// # Errors
    /// Those of [`Self::check`], [`io::read`] and [`io::read_faces`].
    pub fn open(&self, paths: &[PathBuf]) -> Result<Source> {
        self.check()?;
        let loaded = match paths {
            [path] => io::read(path, &self.read_options())?,
            faces => io::read_faces(faces, &self.read_options())?,
        };
        self.turned(paths.first().map_or_else(String::new, |path| path.display().to_string()), loaded)
    }

    /// [`Self::open`] of the file `input`, which is in memory, in at most `memory_limit` bytes.
    ///
    /// # Errors
    /// Those of [`Self::check`] and [`io::read_from_memory`].
    pub fn open_bytes(&self, input: &str, bytes: &[u8], memory_limit: u64) -> Result<Source> {
        self.check()?;
        let options = io::ReadOptions { memory_limit, ..self.read_options() };
        let source =
            self.turned(input.to_owned(), io::read_from_memory(Path::new(input), bytes, &options)?)?;
        let blake3 = blake3::hash(bytes).to_hex().to_string();
        let file = InputFileReport { path: input.to_owned(), bytes: bytes.len() as u64, blake3 };
        Ok(Source { files: vec![file], ..source })
    }

    /// Mirrors and rotates `loaded`, and removes its suns, in this order.
    fn turned(&self, input: String, loaded: Loaded) -> Result<Source> {
        let Loaded { environment, repaired, warnings, format, layout, width, height, provenance } = loaded;
        let options = Self { mirror: false, rotate_y: None, extract_sun: None, ..self.clone() };
        let source = Source {
            options,
            origin: provenance,
            repaired,
            warnings,
            format,
            width,
            height,
            ..Source::new(environment, input, layout)
        };
        source.turned(self.mirror, self.rotate_y.unwrap_or(0.0))?.without(self.extract_sun.as_ref())
    }
}

impl Source {
    /// An `environment` that is in no file; `input` names it, and `layout` its layout.
    #[must_use]
    pub fn new(environment: Environment, input: String, layout: &'static str) -> Self {
        let (width, height) = environment.layout().sides();
        Self {
            environment: Arc::new(environment),
            input,
            files: Vec::new(),
            options: InputOptions::default(),
            origin: Provenance::default(),
            suns: Vec::new(),
            repaired: Repairs::default(),
            notes: Vec::new(),
            warnings: Vec::new(),
            format: String::new(),
            layout,
            width,
            height,
        }
    }

    /// The source mirrored, if `mirror`, and then rotated about +Y by `degrees`.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for an angle that is not finite.
    pub fn turned(mut self, mirror: bool, degrees: f64) -> Result<Self> {
        if mirror || degrees != 0.0 {
            let environment = Arc::unwrap_or_clone(self.environment);
            let mirrored = if mirror { environment.mirrored() } else { environment };
            self.environment =
                Arc::new(if degrees == 0.0 { mirrored } else { mirrored.rotated_y(degrees)? });
        }
        self.options.mirror |= mirror;
        self.options.rotate_y = Some(self.options.rotate_y.unwrap_or(0.0) + degrees);
        Ok(self)
    }

    /// The source without the suns that `asked` selects.
    ///
    /// # Errors
    /// Those of [`extract`].
    pub fn without(mut self, asked: Option<&Suns>) -> Result<Self> {
        let Some(asked) = asked else { return Ok(self) };
        let extraction = extract(&self.environment, asked)?;
        self.options.extract_sun = Some(asked.clone());
        self.notes.extend(extraction.notes());
        self.warnings.extend(extraction.warnings());
        let report = |lamp: &Lamp| SunReport::new(&lamp.sun, lamp.energy_share);
        self.suns.extend(extraction.lamps.iter().map(report));
        Ok(Self { environment: Arc::new(extraction.sunless), ..self })
    }
}
