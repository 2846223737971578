//! Parts of a bake besides its rough levels, as `octagloss compare` measures them: the mirror level, the
//! irradiance, the skybox, sheen and spherical harmonics.

use super::console::Console;
use super::input::file_name;
use super::look_ups::channel;
use super::outcome::Outcome;
use crate::harmonics::{MAX_ORDER, ShScale, ShWindow, scaled, spherical_harmonics};
use crate::maps::Face;
use crate::read::ReadOptions;
use crate::targets::{Content, Target};
use crate::{Environment, Error, Level, Lobe};
use octagloss_core::analysis::channels::{Relative, relative_to};
use octagloss_core::analysis::compare::{
    LevelErrors, Sampling, errors_against_footprints, errors_against_source, errors_against_texels,
};
use octagloss_core::files::io::regular::read_regular;
use octagloss_core::files::io::side_report::{MAX_REPORT_BYTES, REPORT};
use octagloss_core::files::io::{self, DEFAULT_MEMORY_LIMIT, LoadedChain};
use octagloss_core::light::environment::exact_luminance;
use octagloss_core::light::sh::{count, window};
use serde::{Deserialize, Serialize};
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
    Harmonics(HarmonicsErrors),
}

impl PartErrors {
    fn of_texels(errors: LevelErrors) -> Self {
        Self::Texels(Box::new(errors))
    }
}

/// Errors of spherical harmonics as a function over the sphere.
#[derive(Debug, Serialize)]
pub(super) struct HarmonicsErrors {
    /// Number of coefficients.
    coefficients: usize,
    /// Root mean square errors over the mean.
    #[serde(flatten)]
    pub(super) rmse: Relative,
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
pub(super) struct Found {
    part: &'static str,
    path: PathBuf,
    content: FoundContent,
}

#[derive(Debug)]
enum FoundContent {
    /// A map of its own.
    Map(Level),
    Sheen(Vec<Level>),
    Harmonics(Harmonics),
}

/// Coefficients in one of the scalings that bakes write.
#[derive(Clone, Debug)]
struct Harmonics {
    coefficients: Vec<[f64; 3]>,
    scale: ShScale,
    window: ShWindow,
}

/// The keys of `sh.json`, and of `sh` in reports.
#[derive(Deserialize)]
struct HarmonicsText {
    coefficients: Vec<[f64; 3]>,
    scale: String,
    #[serde(default)]
    window: String,
}

#[derive(Deserialize)]
struct ReportText {
    sh: HarmonicsText,
}

/// Parts found beside a chain, and what cannot be judged.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) found: Vec<Found>,
    pub(super) unjudged: Vec<String>,
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
            let content = FoundContent::Map(level);
            parts.found.push(Found { part: "irradiance", path: bake.path.clone(), content });
        }
        if bake.path.is_file()
            && let Some(text) = io::filament_harmonics(&bake.path)?
        {
            let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            let window = parts.window();
            parts.add_filament(&bake.path, &numbers, window)?;
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
                Some(Content::Irradiance) => self.map("irradiance", path)?,
                Some(Content::Skybox | Content::SkyboxPanorama) => self.map("skybox", path)?,
                Some(Content::Sheen) => {
                    let levels = io::read_chain(&path)?.levels;
                    self.found.push(Found { part: "sheen", path, content: FoundContent::Sheen(levels) });
                }
                Some(Content::ShJson) => {
                    let bytes = read_regular(&path, MAX_REPORT_BYTES)?;
                    let text =
                        serde_json::from_slice(&bytes).map_err(|e| Error::input(&path, e.to_string()))?;
                    self.add_harmonics(path, text)?;
                }
                Some(Content::ShText) => {
                    let bytes = read_regular(&path, MAX_REPORT_BYTES)?;
                    let text = String::from_utf8_lossy(&bytes);
                    let numbers: Vec<f64> = text
                        .lines()
                        .filter_map(|line| line.split_once('(')?.1.split_once(')'))
                        .flat_map(|(numbers, _)| numbers.split(',').map(|word| word.trim().parse()))
                        .filter_map(Result::ok)
                        .collect();
                    let window = self.window();
                    self.add_filament(&path, &numbers, window)?;
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
        self.found.push(Found { part, path, content: FoundContent::Map(level) });
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

    fn add_harmonics(&mut self, path: PathBuf, text: HarmonicsText) -> Outcome {
        let HarmonicsText { coefficients, scale, window } = text;
        let scale = match &scale {
            scale if scale.starts_with("irradiance over pi") => ShScale::Filament,
            scale if scale.starts_with("irradiance") => ShScale::Irradiance,
            _ => ShScale::Radiance,
        };
        let window = window::parsed(&window).unwrap_or_default();
        if !(0..=MAX_ORDER).any(|order| count(order) == coefficients.len()) {
            let message = format!("{} coefficients; 1, 4, 9, 16 or 25 are needed", coefficients.len());
            return Err(Error::input(&path, message).into());
        }
        let content = FoundContent::Harmonics(Harmonics { coefficients, scale, window });
        self.found.push(Found { part: "harmonics", path, content });
        Ok(())
    }

    /// Adds Filament's nine coefficients.
    fn add_filament(&mut self, path: &Path, numbers: &[f64], window: ShWindow) -> Outcome {
        let coefficients: Vec<[f64; 3]> =
            numbers.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]).collect();
        if numbers.len() != 27 {
            let message = format!("its spherical harmonics have {} numbers; 27 are needed", numbers.len());
            return Err(Error::input(path, message).into());
        }
        let content = FoundContent::Harmonics(Harmonics { coefficients, scale: ShScale::Filament, window });
        self.found.push(Found { part: "harmonics", path: path.to_owned(), content });
        Ok(())
    }

    /// The window of harmonics without a record of their own: the report's.
    fn window(&self) -> ShWindow {
        let of = |found: &Found| match &found.content {
            FoundContent::Harmonics(harmonics) => Some(harmonics.window),
            _ => None,
        };
        self.found.iter().find_map(of).unwrap_or_default()
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
            let texels = |levels: &[Level], lobe| -> Vec<PartErrors> {
                let errors = errors_against_source(levels, source, lobe, sampling, &progress);
                errors.into_iter().map(PartErrors::of_texels).collect()
            };
            let errors = match content {
                FoundContent::Map(level) if *part == "irradiance" => {
                    texels(std::slice::from_ref(level), Lobe::Cosine)
                }
                FoundContent::Map(level) => {
                    vec![PartErrors::of_texels(errors_against_footprints(0, level, source)?)]
                }
                FoundContent::Sheen(levels) => texels(levels, Lobe::Charlie),
                FoundContent::Harmonics(harmonics) => vec![harmonics.errors_against(source)?],
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
            let errors: Option<Vec<PartErrors>> = like.into_iter().find_map(|found| {
                let pairs: Vec<(&Level, &Level)> = match (content, &found.content) {
                    (FoundContent::Map(a), FoundContent::Map(b)) => vec![(a, b)],
                    (FoundContent::Sheen(a), FoundContent::Sheen(b)) if a.len() == b.len() => {
                        a.iter().zip(b).collect()
                    }
                    (FoundContent::Harmonics(a), FoundContent::Harmonics(b)) => {
                        let is_like = a.scale == b.scale && a.coefficients.len() == b.coefficients.len();
                        return is_like.then(|| vec![harmonics_errors(a, &b.coefficients)]);
                    }
                    _ => return None,
                };
                let is_like = pairs.iter().all(|(a, b)| a.layout == b.layout);
                let errors = pairs.iter().enumerate().map(|(k, (a, b))| errors_against_texels(k, a, b));
                is_like.then(|| errors.map(PartErrors::of_texels).collect())
            });
            let file = file_name(path);
            match errors {
                Some(errors) => parts.extend(errors.into_iter().map(|errors| Part {
                    part,
                    file: Some(file.clone()),
                    errors,
                })),
                None => self.unjudged.push(format!("{part} ({file}; the other bake has none like it)")),
            }
        }
        parts
    }
}

/// The mirror level of a chain, the first one, against the mean of `source` over each texel.
pub(super) fn mirror(level: &Level, source: &Environment) -> crate::Result<Part> {
    let errors = PartErrors::of_texels(errors_against_footprints(0, level, source)?);
    Ok(Part { part: "mirror", file: None, errors })
}

impl Harmonics {
    fn errors_against(&self, source: &Environment) -> crate::Result<PartErrors> {
        let order = self.coefficients.len().isqrt() as u32 - 1;
        let exact = spherical_harmonics(source, order)?;
        let exact = self.window.apply(&exact)?;
        Ok(harmonics_errors(self, &scaled(&exact, self.scale)))
    }
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
    PartErrors::Harmonics(HarmonicsErrors { coefficients: expected.len(), rmse })
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
            PartErrors::Harmonics(e) => ("-".to_owned(), e.coefficients, e.rmse, None),
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
