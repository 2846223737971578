//! Parts of a bake besides its rough levels, as `octagloss compare` measures them: the mirror level, the
//! irradiance, the skybox, sheen and spherical harmonics.

use super::console::Console;
use super::input::file_name;
use super::look_ups::channel;
use super::outcome::Outcome;
use crate::harmonics::{MAX_ORDER, ShScale, ShWindow, scaled, spherical_harmonics};
use crate::maps::Face;
use crate::read::ReadOptions;
use crate::targets::{Content as FileContent, Target};
use crate::{Environment, Error, Level, Lobe};
use octagloss_core::analysis::channels::{Relative, relative_to};
use octagloss_core::analysis::compare::{
    LevelErrors, Sampling, errors_against_footprints, errors_against_source, errors_against_texels,
};
use octagloss_core::files::io::regular::read_regular;
use octagloss_core::files::io::side_report::{MAX_REPORT_BYTES, REPORT};
use octagloss_core::files::io::{self, DEFAULT_MEMORY_LIMIT, LoadedChain};
use octagloss_core::light::environment::exact_luminance;
use octagloss_core::light::sh::count;
use serde::{Deserialize, Deserializer, Serialize};
use std::path::{Path, PathBuf};

/// Errors of a part.
#[derive(Debug, Serialize)]
pub(super) struct Part {
    /// `mirror`, `irradiance`, `skybox`, `sheen` or `harmonics`.
    pub(super) part: &'static str,
    /// Its file; absent for a level of the chain.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(flatten)]
    pub(super) errors: PartErrors,
}

/// Errors of texels or of coefficients.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(super) enum PartErrors {
    Texels(Box<LevelErrors>),
    /// Of spherical harmonics as a function over the sphere.
    Harmonics {
        /// Number of coefficients.
        coefficients: usize,
        /// Root mean square errors over the mean.
        #[serde(flatten)]
        rmse: Relative,
    },
}

impl From<LevelErrors> for PartErrors {
    fn from(errors: LevelErrors) -> Self {
        Self::Texels(Box::new(errors))
    }
}

impl Part {
    /// Its name in messages.
    pub(super) fn name(&self) -> String {
        let what = match &self.errors {
            PartErrors::Texels(errors) if self.part == "mirror" => return format!("level {}", errors.level),
            PartErrors::Texels(errors) if self.part == "sheen" => format!("sheen level {}", errors.level),
            _ => self.part.to_owned(),
        };
        self.file.as_ref().map_or_else(|| what.clone(), |file| format!("{what} ({file})"))
    }
}

/// A part in a file.
#[derive(Debug)]
struct Found {
    part: &'static str,
    path: PathBuf,
    content: Content,
}

#[derive(Debug)]
enum Content {
    /// The levels of sheen, or the one of a map of its own.
    Levels(Vec<Level>),
    Harmonics(Harmonics),
}

/// Coefficients in one of the scalings that bakes write: `sh.json`, and `sh` in reports.
#[derive(Debug, Deserialize)]
struct Harmonics {
    coefficients: Vec<[f64; 3]>,
    #[serde(deserialize_with = "scale")]
    scale: ShScale,
    #[serde(default)]
    window: ShWindow,
}

#[derive(Deserialize)]
struct ReportText {
    sh: Harmonics,
}

/// The scale that a text describes.
fn scale<'de, D: Deserializer<'de>>(deserializer: D) -> Result<ShScale, D::Error> {
    Ok(match &String::deserialize(deserializer)? {
        text if text.starts_with("irradiance over pi") => ShScale::Filament,
        text if text.starts_with("irradiance") => ShScale::Irradiance,
        _ => ShScale::Radiance,
    })
}

/// Parts found beside a chain, and what cannot be judged.
#[derive(Debug, Default)]
pub(super) struct Parts {
    found: Vec<Found>,
    pub(super) unjudged: Vec<String>,
    /// The window of the first harmonics, the report's; that of harmonics without a record of their own.
    window: Option<ShWindow>,
}

impl Parts {
    /// The parts of the bake in `path`, a file or a folder, with its chain.
    pub(super) fn read(path: &Path, bake: &LoadedChain) -> Outcome<Self> {
        let mut parts = Self::default();
        let target = bake.provenance.target.as_deref().and_then(Target::named);
        if !path.is_dir() {
            parts.beside_file(path)?;
        } else if let Some(target) = target {
            parts.of_target(path, target)?;
        } else {
            for part in ["irradiance", "skybox"] {
                parts.of_images(path, part)?;
            }
            parts.report(&path.join(REPORT), None)?;
            parts.lamp(&path.join("sun.json"));
        }
        if target.is_some_and(Target::has_pyramid)
            && let Some(level) = io::pyramid_irradiance(&bake.path)?
        {
            parts.add_levels("irradiance", bake.path.clone(), vec![level]);
        }
        if bake.path.is_file()
            && let Some(text) = io::filament_harmonics(&bake.path)?
        {
            let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            parts.add_filament(&bake.path, &numbers)?;
        }
        Ok(parts)
    }

    /// Adds files named after the file `path`.
    fn beside_file(&mut self, path: &Path) -> Outcome {
        let (Some(stem), Some(extension)) = (path.file_stem(), path.extension()) else { return Ok(()) };
        for part in ["irradiance", "skybox"] {
            let name = format!("{}.{part}.{}", stem.to_string_lossy(), extension.to_string_lossy());
            self.map(part, path.with_file_name(name))?;
        }
        let beside = |what: &str| {
            path.with_file_name(format!("{}.{what}", path.file_name().unwrap_or_default().display()))
        };
        self.report(&beside(REPORT), Some(path))?;
        self.lamp(&beside("sun.json"));
        Ok(())
    }

    /// Adds the files of `target` in `folder`.
    fn of_target(&mut self, folder: &Path, target: &Target) -> Outcome {
        self.report(&folder.join(REPORT), None)?;
        for name in files_in(folder)? {
            let path = folder.join(&name);
            match target.content_of(&name) {
                Some(FileContent::Irradiance) => self.map("irradiance", path)?,
                Some(FileContent::Skybox | FileContent::SkyboxPanorama) => self.map("skybox", path)?,
                Some(FileContent::Sheen) => {
                    let levels = io::read_chain(&path)?.levels;
                    self.add_levels("sheen", path, levels);
                }
                Some(FileContent::ShJson) => {
                    let bytes = read_regular(&path, MAX_REPORT_BYTES)?;
                    let text =
                        serde_json::from_slice(&bytes).map_err(|e| Error::input(&path, e.to_string()))?;
                    self.add_harmonics(path, text)?;
                }
                Some(FileContent::ShText) => {
                    let bytes = read_regular(&path, MAX_REPORT_BYTES)?;
                    let text = String::from_utf8_lossy(&bytes);
                    let numbers: Vec<f64> = text
                        .lines()
                        .filter_map(|line| line.split_once('(')?.1.split_once(')'))
                        .flat_map(|(numbers, _)| numbers.split(',').map(|word| word.trim().parse()))
                        .filter_map(Result::ok)
                        .collect();
                    self.add_filament(&path, &numbers)?;
                }
                _ if name == "sun.json" => self.lamp(&path),
                _ => {}
            }
        }
        Ok(())
    }

    /// Adds the map in the images `part` of a level folder.
    fn of_images(&mut self, folder: &Path, part: &'static str) -> Outcome {
        for extension in ["exr", "hdr"] {
            self.map(part, folder.join(format!("{part}.{extension}")))?;
            let faces: Vec<PathBuf> = Face::ALL
                .into_iter()
                .map(|face| folder.join(format!("{part}_{}.{extension}", face.short_name())))
                .collect();
            if faces[0].is_file() {
                let cube = io::read_faces(&faces, &ReadOptions::default())?.environment;
                self.add_map(part, faces[0].clone(), cube);
            }
        }
        Ok(())
    }

    /// Adds the map in the file `path`, if there is one.
    fn map(&mut self, part: &'static str, path: PathBuf) -> Outcome {
        if path.is_file() {
            let map = io::read(&path, &ReadOptions::default())?.environment;
            self.add_map(part, path, map);
        }
        Ok(())
    }

    fn add_map(&mut self, part: &'static str, path: PathBuf, map: Environment) {
        let roughness = if part == "irradiance" { 1.0 } else { 0.0 };
        let level = Level { layout: map.layout(), roughness, texels: map.texels().to_vec(), bounds: None };
        self.add_levels(part, path, vec![level]);
    }

    fn add_levels(&mut self, part: &'static str, path: PathBuf, levels: Vec<Level>) {
        self.found.push(Found { part, path, content: Content::Levels(levels) });
    }

    /// Adds the harmonics of the report `path`, unless it is that of another file than `of`.
    fn report(&mut self, path: &Path, of: Option<&Path>) -> Outcome {
        if !path.is_file() {
            return Ok(());
        }
        if let Some(of) = of {
            let bytes = read_regular(of, DEFAULT_MEMORY_LIMIT)?;
            if io::reported(of, blake3::hash(&bytes)).is_none() {
                self.unjudged.push(format!("{} (it describes another file)", file_name(path)));
                return Ok(());
            }
        }
        let bytes = read_regular(path, MAX_REPORT_BYTES)?;
        match serde_json::from_slice::<ReportText>(&bytes) {
            Ok(report) => self.add_harmonics(path.to_owned(), report.sh),
            Err(error) => {
                self.unjudged.push(format!("{} ({error})", file_name(path)));
                Ok(())
            }
        }
    }

    fn lamp(&mut self, path: &Path) {
        if path.is_file() {
            self.unjudged.push(format!("{} (a lamp)", file_name(path)));
        }
    }

    fn add_harmonics(&mut self, path: PathBuf, harmonics: Harmonics) -> Outcome {
        let given = harmonics.coefficients.len();
        if !(0..=MAX_ORDER).any(|order| count(order) == given) {
            let message = format!("{given} coefficients; 1, 4, 9, 16 or 25 are needed");
            return Err(Error::input(&path, message).into());
        }
        self.window.get_or_insert(harmonics.window);
        self.found.push(Found { part: "harmonics", path, content: Content::Harmonics(harmonics) });
        Ok(())
    }

    /// Adds Filament's nine coefficients.
    fn add_filament(&mut self, path: &Path, numbers: &[f64]) -> Outcome {
        if numbers.len() != 27 {
            let message = format!("its spherical harmonics have {} numbers; 27 are needed", numbers.len());
            return Err(Error::input(path, message).into());
        }
        let (coefficients, window) = (numbers.as_chunks().0.to_vec(), self.window.unwrap_or_default());
        self.add_harmonics(path.to_owned(), Harmonics { coefficients, scale: ShScale::Filament, window })
    }

    /// Measures the parts against `source`.
    pub(super) fn errors(
        &self,
        source: &Environment,
        sampling: Sampling,
        console: &Console,
    ) -> Outcome<Vec<Part>> {
        let bar = console.bar("parts");
        let progress = |done, total| bar.at(done, total);
        let mut parts = Vec::new();
        for Found { part, path, content } in &self.found {
            let errors: Vec<PartErrors> = match content {
                Content::Levels(levels) if *part == "skybox" => {
                    vec![errors_against_footprints(0, &levels[0], source)?.into()]
                }
                Content::Levels(levels) => {
                    let lobe = if *part == "sheen" { Lobe::Charlie } else { Lobe::Cosine };
                    let errors = errors_against_source(levels, source, lobe, sampling, &progress);
                    errors.into_iter().map(PartErrors::from).collect()
                }
                Content::Harmonics(harmonics) => {
                    let order = harmonics.coefficients.len().isqrt() as u32 - 1;
                    let exact = harmonics.window.apply(&spherical_harmonics(source, order)?)?;
                    vec![harmonics_errors(harmonics, &scaled(&exact, harmonics.scale))]
                }
            };
            let file = Some(file_name(path));
            parts.extend(errors.into_iter().map(|errors| Part { part, file: file.clone(), errors }));
        }
        Ok(parts)
    }

    /// Measures the parts against those of another bake; parts without a like one are not judged.
    pub(super) fn errors_against(&mut self, other: &Self) -> Vec<Part> {
        let mut parts = Vec::new();
        for Found { part, path, content } in &self.found {
            let like = other.found.iter().filter(|found| found.part == *part);
            let errors: Option<Vec<PartErrors>> =
                like.into_iter().find_map(|found| match (content, &found.content) {
                    (Content::Levels(a), Content::Levels(b)) => {
                        let is_like =
                            a.iter().map(|level| level.layout).eq(b.iter().map(|level| level.layout));
                        let pairs = a.iter().zip(b).enumerate();
                        let errors = pairs.map(|(k, (a, b))| errors_against_texels(k, a, b).into());
                        is_like.then(|| errors.collect())
                    }
                    (Content::Harmonics(a), Content::Harmonics(b)) => {
                        let is_like = a.scale == b.scale && a.coefficients.len() == b.coefficients.len();
                        is_like.then(|| vec![harmonics_errors(a, &b.coefficients)])
                    }
                    _ => None,
                });
            let file = file_name(path);
            let Some(errors) = errors else {
                self.unjudged.push(format!("{part} ({file}; the other bake has none like it)"));
                continue;
            };
            parts.extend(errors.into_iter().map(|errors| Part { part, file: Some(file.clone()), errors }));
        }
        parts
    }
}

/// The mirror level of a chain, the first one, against the mean of `source` over each texel.
pub(super) fn mirror(level: &Level, source: &Environment) -> crate::Result<Part> {
    let errors = errors_against_footprints(0, level, source)?.into();
    Ok(Part { part: "mirror", file: None, errors })
}

/// Errors of `got` against `expected` in the same scale.
fn harmonics_errors(got: &Harmonics, expected: &[[f64; 3]]) -> PartErrors {
    let ones = vec![[1.0; 3]; expected.len()];
    // Filament's polynomials are not orthonormal.
    let orthonormal: Vec<f64> = match got.scale {
        ShScale::Filament => {
            let pairs = scaled(&ones, ShScale::Irradiance).into_iter().zip(scaled(&ones, ShScale::Filament));
            pairs.map(|(to, from)| to[0] / from[0]).collect()
        }
        _ => vec![1.0; expected.len()],
    };
    let mut squares = [0.0; 4];
    for ((got, expected), factor) in got.coefficients.iter().zip(expected).zip(&orthonormal) {
        let [r, g, b] = std::array::from_fn(|c| factor * (got[c] - expected[c]));
        for (sum, error) in squares.iter_mut().zip([exact_luminance([r, g, b]), r, g, b]) {
            *sum += error * error;
        }
    }
    let mean = expected[0].map(|c| (orthonormal[0] * c).max(0.0));
    let rmse = relative_to(squares.map(f64::sqrt), mean);
    PartErrors::Harmonics { coefficients: expected.len(), rmse }
}

/// Files in `folder` and the folders in it, by relative path, sorted.
fn files_in(folder: &Path) -> crate::Result<Vec<String>> {
    let mut all = Vec::new();
    for name in io::names_in(folder)? {
        let path = folder.join(&name);
        if path.is_dir() {
            all.extend(io::names_in(&path)?.into_iter().map(|inner| format!("{name}/{inner}")));
        } else {
            all.push(name);
        }
    }
    Ok(all)
}

/// The figures of `parts` as lines of text.
pub(super) fn text(parts: &[Part]) -> String {
    let mut text = String::new();
    if !parts.is_empty() {
        text += "part         size   texels   relRMSE   worst channel        L1   worst channel  file\n";
    }
    for part in parts {
        let (size, texels, rmse, mean) = match &part.errors {
            PartErrors::Texels(e) => (e.size.to_string(), e.texels, e.rmse, Some(e.mean())),
            PartErrors::Harmonics { coefficients, rmse } => ("-".to_owned(), *coefficients, *rmse, None),
        };
        let file = part.file.as_deref().unwrap_or("level 0");
        let columns = |errors: Option<Relative>| {
            errors.map_or_else(
                || format!("{:>8}  {:>14}", "-", "-"),
                |errors| format!("{:>8.6}  {:>14}", errors.luminance, channel(errors.worst_channel())),
            )
        };
        let (rmse, mean) = (columns(Some(rmse)), columns(mean));
        text += &format!("{:<10}  {size:>5}  {texels:>7}  {rmse}  {mean}  {file}\n", part.part);
    }
    text
}
