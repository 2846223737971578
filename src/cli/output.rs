//! Outputs of a bake: paths, planned contents, and writing all files in one step.

use super::console::{Console, escaped};
use super::fingerprint::{self, fingerprint};
use super::input::{InputFiles, Opened};
use super::outcome::{Outcome, print_bytes, usage};
use crate::bake::report::{OutputFileReport, Report};
use crate::export::files::Made;
use crate::export::lights;
use crate::export::plan::BakePlan;
use crate::format::container::Container;
use crate::format::{LevelName, Pixel, Shown};
use crate::io::environment_write::exact_exr_bytes;
use crate::io::output::{self, Existing, Output};
use crate::io::regular::read_regular;
use crate::io::side_report::{MAX_REPORT_BYTES, REPORT};
use crate::target::{Content, Naming};
use crate::{Error, Layout, Result};
use anyhow::anyhow;
use blake3::Hash;
use serde::Serialize;
use serde_json::json;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Settings shared by the outputs of all inputs.
pub(super) struct Common {
    pub(super) plans: Vec<BakePlan>,
    pub(super) sun: Vec<SunFile>,
    /// Whether sun.json is a list.
    pub(super) several_suns: bool,
    pub(super) existing: Existing,
    /// Whether reports are printed instead of written.
    pub(super) json: bool,
}

/// Paths of one bake's files.
pub(super) struct Outputs {
    /// The file or folder; `-` for standard output, according to `place`.
    pub(super) main: PathBuf,
    pub(super) place: Destination,
    /// Base name of the files: the environment's, or `main` if that is a file.
    pub(super) name: String,
    pub(super) preview: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Destination {
    /// A file, and further files with its name plus suffixes.
    File,
    /// A folder with all files.
    Folder,
    Stdout,
}

/// A file or folder that is replaced as a whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OutputPlace {
    pub(super) path: PathBuf,
    is_folder: bool,
}

/// A planned file.
struct Planned {
    /// Relative to [`Outputs::base`]; for a picture, the given path.
    path: PathBuf,
    /// Its content, in a few words.
    content: String,
    is_report: bool,
}

/// A file about the removed sun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SunFile {
    /// Directions and irradiances of the suns.
    Sun,
    /// The suns as lights of glTF.
    Gltf,
    /// The environment without the sun.
    Sunless,
}

impl SunFile {
    /// Its name in a folder, or its name's suffix next to a file.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Sun => "sun.json",
            Self::Gltf => "sun.gltf",
            Self::Sunless => "sunless.exr",
        }
    }

    /// Its content, in a few words.
    pub(super) const fn content(self) -> &'static str {
        match self {
            Self::Sun => "the sun",
            Self::Gltf => "the sun as a light of glTF",
            Self::Sunless => "f32 environment without the sun",
        }
    }

    fn bytes(self, opened: &Opened, several: bool) -> Result<Vec<u8>> {
        match self {
            Self::Sun if several => Ok(json_text(&opened.suns)?.into_bytes()),
            Self::Sun => Ok(json_text(&opened.suns.first())?.into_bytes()),
            Self::Gltf => Ok(json_text(&lights::gltf(&opened.suns))?.into_bytes()),
            Self::Sunless => exact_exr_bytes(&opened.environment, "an environment without its sun"),
        }
    }
}

impl Outputs {
    pub(super) fn new(
        main: PathBuf,
        place: Destination,
        environment: String,
        preview: Option<PathBuf>,
    ) -> Self {
        let file_name = || main.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let name = if place == Destination::Folder { environment } else { file_name() };
        Self { main, place, name, preview }
    }

    /// Base folder of the files' paths.
    fn base(&self) -> &Path {
        match self.place {
            Destination::Folder => &self.main,
            Destination::File | Destination::Stdout => self.main.parent().unwrap_or(Path::new("")),
        }
    }

    /// The path of a file next to the levels.
    fn sibling(&self, file: &str) -> String {
        if self.place == Destination::Folder { file.to_owned() } else { format!("{}.{file}", self.name) }
    }

    /// The path of the file `path` of `plan`; within the target's folder for several targets.
    fn within(common: &Common, plan: &BakePlan, path: &str) -> String {
        if common.plans.len() > 1 { format!("{}/{path}", plan.plan.target.name) } else { path.to_owned() }
    }

    fn report_path(&self, common: &Common, plan: &BakePlan) -> String {
        Self::within(common, plan, &self.sibling(REPORT))
    }

    /// All files to write, for a source of `layout` if known.
    fn planned(&self, common: &Common, layout: Option<Layout>) -> Result<Vec<Planned>> {
        let file = |path: String, content: String| Planned { path: path.into(), content, is_report: false };
        let mut planned = Vec::new();
        let mut reports = Vec::new();
        for plan in &common.plans {
            let settled = layout.map(|layout| plan.settled(layout));
            let plan = settled.as_ref().unwrap_or(plan);
            let BakePlan { plan: files, settings, .. } = plan;
            let specs = settings.level_specs()?;
            // Mirror levels have no bounds.
            let bounded =
                |roughness: f64| settings.bounds && !(roughness == 0.0 && settings.lobe.has_mirror());
            let bounded: Vec<u32> = (0..)
                .zip(&specs)
                .filter(|(_, spec)| bounded(spec.roughness))
                .map(|(level, _)| level)
                .collect();
            let shape = Naming { name: &self.name, levels: specs.len() as u32, bounded: &bounded };
            for (path, content) in files.files(&shape) {
                planned.push(file(Self::within(common, plan, &path), description(plan, content)?));
            }
            if !common.json && self.place != Destination::Stdout {
                let path = self.report_path(common, plan).into();
                reports.push(Planned { path, content: "report".to_owned(), is_report: true });
            }
        }
        let sun = common.sun.iter();
        planned.extend(sun.map(|sun| file(self.sibling(sun.name()), sun.content().to_owned())));
        let preview = self.preview.iter().cloned();
        planned.extend(preview.map(|path| Planned { path, content: "picture".to_owned(), is_report: false }));
        planned.extend(reports);
        Ok(planned)
    }

    /// The unit that contains the file `path`: the file, or the folder that is replaced as a whole.
    fn place_of(&self, path: &Path) -> OutputPlace {
        if self.preview.as_deref() == Some(path) {
            return OutputPlace { path: path.to_owned(), is_folder: false };
        }
        if self.place == Destination::Folder {
            return OutputPlace { path: self.main.clone(), is_folder: true };
        }
        let mut components = path.components();
        let first = components.next().map_or(path, |first| Path::new(first.as_os_str()));
        let own =
            if first.as_os_str() == self.name.as_str() { self.main.clone() } else { self.base().join(first) };
        OutputPlace { path: own, is_folder: components.next().is_some() }
    }

    /// Sibling files and folders.
    pub(super) fn places(&self, common: &Common) -> Result<Vec<OutputPlace>> {
        self.places_where(common, |_| true)
    }

    /// The units of the files for which `counts` is true.
    fn places_where(&self, common: &Common, counts: impl Fn(&Planned) -> bool) -> Result<Vec<OutputPlace>> {
        let mut places = Vec::new();
        if self.place == Destination::Stdout {
            return Ok(places);
        }
        for file in self.planned(common, None)?.iter().filter(|file| counts(file)) {
            let place = self.place_of(&file.path);
            if !places.contains(&place) || !place.is_folder {
                places.push(place);
            }
        }
        Ok(places)
    }

    /// Whether all outputs exist as written for `request`.
    pub(super) fn holds(&self, common: &Common, request: Hash) -> bool {
        let Ok(places) = self.places_where(common, |file| !file.is_report) else { return false };
        common.plans.iter().all(|plan| {
            let report = self.base().join(self.report_path(common, plan));
            fingerprint::holds(&report, request, places.iter().map(|place| place.path.clone()))
        })
    }

    /// Cleans up after killed runs next to the outputs, except in `folders` that are done.
    pub(super) fn recover(
        &self,
        common: &Common,
        folders: &mut BTreeSet<Option<PathBuf>>,
        console: &Console,
    ) -> Outcome {
        for place in self.places(common)? {
            if folders.insert(place.path.parent().map(Path::to_owned)) {
                for restored in output::recover(&place.path) {
                    console.note(&format!("{}: restored after an interrupted run", restored.display()));
                }
            }
        }
        Ok(())
    }

    /// Fails where writing would, before it begins. Outputs in `folder`, which is created if missing, then
    /// replace nothing.
    pub(super) fn check(&self, common: &Common, folder: Option<&Path>) -> Outcome {
        let is_made = |path: &Path| folder.is_some() && path.parent() == folder;
        for OutputPlace { path, is_folder } in self.places(common)? {
            if is_made(&path) {
                let mut above = path.ancestors().skip(1).filter(|folder| !folder.as_os_str().is_empty());
                let there = above.find(|folder| folder.symlink_metadata().is_ok());
                if let Some(there) = there.filter(|there| !there.is_dir()) {
                    return Err(anyhow!("{}: is a file, but a folder is needed", there.display()).into());
                }
                if there != path.parent() {
                    continue;
                }
            }
            if is_folder {
                output::check_folder(&path, common.existing)?;
            } else {
                output::check_file(&path, common.existing)?;
            }
        }
        Ok(())
    }

    /// Lists the outputs for `source`: one line per file, or with `--json` one line of JSON.
    pub(super) fn foretold(&self, common: &Common, source: &InputFiles, layout: Layout) -> Result<String> {
        let full = |file: &Planned| {
            if self.preview.as_deref() == Some(&file.path) {
                return file.path.display().to_string();
            }
            if file.path.as_os_str() == self.name.as_str() && self.place != Destination::Folder {
                return self.main.display().to_string();
            }
            self.base().join(&file.path).display().to_string()
        };
        let planned = self.planned(common, Some(layout))?;
        if common.json {
            let files: Vec<_> =
                planned.iter().map(|file| json!({"path": full(file), "content": file.content})).collect();
            let input = source.path().display().to_string();
            return Ok(json!({"input": input, "files": files}).to_string() + "\n");
        }
        Ok(planned.iter().map(|file| format!("{}\t{}\n", escaped(&full(file)), file.content)).collect())
    }

    /// Writes the files `made` of each plan and the completed `reports`, and moves everything into place in
    /// one step. Returns the bytes written, without the picture.
    pub(super) fn write(
        &self,
        common: &Common,
        (made, reports): (&[Vec<Made>], &mut [Report]),
        picture: Option<&[u8]>,
        request: Hash,
        opened: &Opened,
    ) -> Outcome<u64> {
        if self.place == Destination::Stdout {
            let main = &made[0][0];
            print_bytes(&main.bytes)?;
            return Ok(main.bytes.len() as u64);
        }
        let mut sibling: Vec<(PathBuf, Vec<u8>)> = Vec::new();
        for sun in &common.sun {
            sibling.push((self.sibling(sun.name()).into(), sun.bytes(opened, common.several_suns)?));
        }
        sibling.extend(self.preview.iter().cloned().zip(picture.map(<[u8]>::to_vec)));
        let mut report_files: Vec<(PathBuf, Vec<u8>)> = Vec::new();
        let mut files: Files<'_> = Vec::new();
        for (plan, made) in common.plans.iter().zip(made) {
            files.extend(made.iter().map(|m| (Self::within(common, plan, &m.path).into(), &m.bytes[..])));
        }
        files.extend(sibling.iter().map(|(path, bytes)| (path.clone(), &bytes[..])));
        let places = self.in_places(files);
        let hash = |(place, files): &(OutputPlace, Files<'_>)| match files[..] {
            [(_, bytes)] if !place.is_folder => blake3::hash(bytes),
            _ => fingerprint::hash_of_files(&self.inside(files)),
        };
        let hashes: Vec<Hash> = places.iter().map(hash).collect();
        let joined = fingerprint::joined(hashes.iter().copied().map(Ok))?;
        // Readers find a file by its name next to the report.
        let by_name =
            |place: &OutputPlace| place.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let own_files: Vec<OutputFileReport> = places
            .iter()
            .flat_map(|(_, files)| files.iter().map(|(path, bytes)| (path, bytes.len() as u64)))
            .map(|(path, bytes)| OutputFileReport { path: slashed(path), bytes })
            .collect();
        let own_hashes: Vec<(String, Hash)> = match self.place {
            Destination::Folder => Vec::new(),
            _ => places.iter().zip(&hashes).map(|((place, _), hash)| (by_name(place), *hash)).collect(),
        };
        let mut bytes: u64 = own_files.iter().map(|file| file.bytes).sum();
        for ((plan, made), report) in common.plans.iter().zip(made).zip(reports) {
            if plan.plan.is_targeted() {
                let of = |file: &Made| (file.path.clone(), blake3::hash(&file.bytes));
                report.fingerprint = Some(fingerprint(request, joined, made.iter().map(of)));
                let of = |file: &Made| OutputFileReport {
                    path: file.path.clone(),
                    bytes: file.bytes.len() as u64,
                };
                report.outputs = made.iter().map(of).collect();
            } else {
                report.fingerprint = Some(fingerprint(request, joined, own_hashes.iter().cloned()));
                report.outputs.clone_from(&own_files);
            }
            if common.json {
                report.fingerprint.iter_mut().for_each(|fingerprint| fingerprint.report = None);
            } else {
                let text = fingerprint::signed(&json_text(report)?);
                report_files.push((self.report_path(common, plan).into(), text.into_bytes()));
            }
        }
        bytes -= picture.map_or(0, |picture| picture.len() as u64);
        bytes += report_files.iter().map(|(_, bytes)| bytes.len() as u64).sum::<u64>();
        let files = places.into_iter().flat_map(|(_, files)| files);
        let all = files.chain(report_files.iter().map(|(path, bytes)| (path.clone(), &bytes[..]))).collect();
        let all = self.in_places(all);
        let inside: Vec<Vec<(String, &[u8])>> = all.iter().map(|(_, files)| self.inside(files)).collect();
        let mut outputs = Vec::with_capacity(all.len());
        for ((place, files), inside) in all.iter().zip(inside) {
            let output = if place.is_folder { Output::Folder(inside) } else { Output::File(files[0].1) };
            outputs.push((place.path.clone(), output));
        }
        let staged = output::stage_all(&outputs, common.existing)?;
        self.remove_report_without_hashes(common)?;
        output::commit(staged)?;
        Ok(bytes)
    }

    /// Groups `files` by unit, sorted within each.
    fn in_places<'a>(&self, files: Vec<(PathBuf, &'a [u8])>) -> Vec<(OutputPlace, Files<'a>)> {
        let mut places: Vec<(OutputPlace, Files<'a>)> = Vec::new();
        for (path, bytes) in files {
            let place = self.place_of(&path);
            match places.iter_mut().find(|(other, _)| *other == place) {
                Some((_, files)) => files.push((path, bytes)),
                None => places.push((place, vec![(path, bytes)])),
            }
        }
        places.iter_mut().for_each(|(_, files)| files.sort());
        places
    }

    /// `files` of a folder that is replaced as a whole, by relative path.
    fn inside<'a>(&self, files: &Files<'a>) -> Vec<(String, &'a [u8])> {
        let outer = usize::from(self.place != Destination::Folder);
        let within = |path: &Path| path.components().skip(outer).collect::<PathBuf>();
        files.iter().map(|(path, bytes)| (slashed(&within(path)), *bytes)).collect()
    }

    /// Removes an old report without a hash of its file, as in version 0.1; it could be mistaken for the new
    /// file's.
    fn remove_report_without_hashes(&self, common: &Common) -> Result<()> {
        if self.place != Destination::File || common.existing != Existing::Replace {
            return Ok(());
        }
        let path = self.base().join(self.sibling(REPORT));
        let text = read_regular(&path, MAX_REPORT_BYTES).unwrap_or_default();
        let old = serde_json::from_slice::<Report>(&text).ok();
        let believed = old.is_some_and(|old| old.fingerprint.is_none_or(|hashes| hashes.files.is_empty()));
        if believed { fs::remove_file(&path).map_err(|e| Error::io(&path, e)) } else { Ok(()) }
    }
}

/// `path` with `/` separators.
fn slashed(path: &Path) -> String {
    path.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/")
}

/// Files by their paths.
type Files<'a> = Vec<(PathBuf, &'a [u8])>;

/// Describes a file of `plan`.
fn description(BakePlan { plan, settings, .. }: &BakePlan, content: Content) -> Result<String> {
    let pixel = plan.pixel.name();
    let skybox = settings.skybox.unwrap_or(settings.size);
    Ok(match content {
        Content::Specular => cube_words(pixel, settings.size, settings.level_specs()?.len()),
        Content::Sheen => cube_words(&format!("{pixel} sheen"), settings.size, settings.level_specs()?.len()),
        Content::Skybox if !plan.target.has_container() => cube_words(Pixel::F16.name(), skybox, 1),
        Content::Skybox => cube_words(pixel, skybox, 1),
        Content::SkyboxPanorama => format!("panorama {}x{}", 4 * skybox, 2 * skybox),
        Content::Irradiance => {
            let size = settings.irradiance.unwrap_or(plan.target.irradiance_size);
            cube_words(&format!("{pixel} irradiance"), size, 1)
        }
        Content::ShJson | Content::ShText => "spherical harmonics".to_owned(),
        Content::Oem => {
            let specs = settings.level_specs()?;
            format!("{pixel} octahedral map {}, {} levels, with borders", settings.size, specs.len())
        }
        Content::Reader => "shader code".to_owned(),
        Content::Panorama => format!("panorama {}x{}", 2 * settings.size, settings.size),
        Content::Mips => {
            format!("{pixel} panorama {}, {} levels", settings.size, settings.level_specs()?.len())
        }
        Content::Image(LevelName { shown, face, is_bound }) => {
            let specs = settings.level_specs()?;
            let (size, what) = match shown {
                Shown::Level(level) => (specs[level as usize].layout.sides().1, ""),
                Shown::Irradiance => (settings.irradiance.unwrap_or(0), "irradiance "),
                Shown::Skybox => (skybox, "skybox "),
            };
            if is_bound {
                return Ok(format!("f32 error bounds {size}"));
            }
            let layout = if face.is_some() { "face" } else { plan.layout.name() };
            format!("{pixel} {what}{layout} {size}")
        }
        Content::Atlas => {
            format!("{pixel} atlas {}, {} levels", 2 * settings.size, settings.level_specs()?.len())
        }
        Content::Env | Content::Glb => {
            let specs = settings.level_specs()?;
            format!("{pixel} cube {}, {} levels, and spherical harmonics", settings.size, specs.len())
        }
    })
}

/// Describes a cube in a few words.
fn cube_words(kind: &str, size: u32, levels: usize) -> String {
    match levels {
        1 => format!("{kind} cube {size}"),
        _ => format!("{kind} cube {size}, {levels} levels"),
    }
}

/// Serializes `value` as a JSON file.
///
/// # Errors
/// [`Error::NonFiniteResult`] if one of its numbers is NaN or infinite.
fn json_text(value: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Error::NonFiniteResult { place: format!("JSON, {error}"), value: f64::NAN })?;
    Ok(text + "\n")
}

/// Extensions of formats that are not written; such a name would not match the content.
pub(super) const FOREIGN: [&str; 11] =
    ["basis", "bmp", "gif", "jpeg", "jpg", "pfm", "png", "tga", "tif", "tiff", "webp"];

/// The format of the extension of `path`.
pub(super) fn named_format(path: &Path) -> Option<Container> {
    Container::named(&extension(path)?)
}

/// Whether `path` ends in a slash and therefore names a folder.
pub(super) fn names_folder(path: &Path) -> bool {
    path.as_os_str().to_string_lossy().ends_with(std::path::is_separator)
}

/// Rejects a file extension for the folder `path`, such as `bake.hdr`, and names the remedy.
pub(super) fn check_folder_name(path: &Path, remedy: &str) -> Outcome {
    let names_file = named_format(path).is_some() && !names_folder(path);
    if names_file || extension(path).is_some_and(|name| FOREIGN.contains(&name.as_str())) {
        let folder = path.with_extension("");
        return usage(format!(
            "the output {} has a file extension but must be a folder; use -o {}{remedy}",
            path.display(),
            folder.display(),
        ));
    }
    Ok(())
}

pub(super) fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}
