//! Outputs of a bake: paths, planned contents, and writing all files in one step.

use super::console::{Console, escaped};
use super::fingerprint::{self, fingerprint};
use super::input::InputFiles;
use super::outcome::{Outcome, failed, print_bytes, usage};
use crate::files::{Container, Existing, Made, Pixel};
use crate::recipes::{BakePlan, OutputFileReport, Products, Report, SunFile, json_bytes, report_path};
use crate::targets::{Content, LevelName, Shown};
use crate::{Error, Layout, LevelSpec, Result};
use blake3::Hash;
use octagloss_core::files::export::produce::{beside, within};
use octagloss_core::files::export::write::outputs;
use octagloss_core::files::io::output::{self, Output};
use serde_json::json;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Settings shared by the outputs of all inputs.
pub(super) struct Common {
    pub(super) plans: Vec<BakePlan>,
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
    /// The folder of `main` that is created if missing.
    pub(super) folder: Option<PathBuf>,
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

impl Outputs {
    /// The place of the file `path` of the output.
    fn at(&self, path: &str) -> PathBuf {
        match self.place {
            Destination::Folder => self.main.join(path),
            _ if path == self.name => self.main.clone(),
            _ => self.main.with_file_name(path),
        }
    }

    /// The files and folders that hold `files` and the `preview`, which comes first: a report is last.
    fn holding<'a>(
        &self,
        files: impl IntoIterator<Item = (String, &'a [u8])>,
        preview: Option<&'a [u8]>,
    ) -> Vec<(PathBuf, Output<'a>)> {
        let preview = self.preview.iter().cloned().zip(preview.map(Output::File));
        preview.chain(outputs(&self.main, self.place != Destination::Folder, files)).collect()
    }

    /// All files to write, but the preview and reports, with their contents in a few words, for a source of
    /// `layout` if known.
    fn planned(&self, common: &Common, layout: Option<Layout>) -> Result<Vec<(String, String)>> {
        let mut planned = Vec::new();
        for plan in &common.plans {
            let settled = layout.map(|layout| plan.settled(layout));
            let plan = settled.as_ref().unwrap_or(plan);
            let BakePlan { plan: files, settings, .. } = plan;
            let specs = settings.level_specs()?;
            // Mirror levels have no bounds.
            let bounded =
                |roughness: f64| settings.bounds && !(roughness == 0.0 && settings.lobe.has_mirror());
            let levels = (0..).zip(&specs).filter(|(_, spec)| bounded(spec.roughness));
            let bounded: Vec<u32> = levels.map(|(level, _)| level).collect();
            for (path, content) in files.files(&self.name, specs.len() as u32, &bounded) {
                let description = description(plan, &specs, content);
                planned.push((within(common.plans.len() > 1, plan, &path), description));
            }
        }
        let first = &common.plans[0];
        let suns = SunFile::requested(&first.recipe).into_iter();
        planned.extend(suns.map(|file| {
            let content = match file {
                SunFile::Sun => "the sun",
                SunFile::Gltf => "the sun as a light of glTF",
                SunFile::Sunless => "f32 environment without the sun",
            };
            (beside(first, &self.name, file.name()), content.to_owned())
        }));
        Ok(planned)
    }

    /// Paths of the reports to write.
    fn reports(&self, common: &Common) -> Vec<String> {
        let path = |plan: &BakePlan| report_path(common.plans.len() > 1, plan, &self.name);
        let is_written = !common.json && self.place != Destination::Stdout;
        common.plans.iter().filter(|_| is_written).map(path).collect()
    }

    /// Files and folders to write.
    fn places(&self, common: &Common) -> Result<Vec<(PathBuf, Output<'static>)>> {
        if self.place == Destination::Stdout {
            return Ok(Vec::new());
        }
        let files = self.planned(common, None)?.into_iter().map(|(path, _)| path);
        Ok(self.holding(files.chain(self.reports(common)).map(|path| (path, &[][..])), Some(&[])))
    }

    /// Sibling files and folders.
    pub(super) fn paths(&self, common: &Common) -> Result<Vec<PathBuf>> {
        Ok(self.places(common)?.into_iter().map(|(path, _)| path).collect())
    }

    /// Whether all outputs exist as written for `request`.
    pub(super) fn holds(&self, common: &Common, request: Hash) -> bool {
        let reports: Vec<PathBuf> = self.reports(common).iter().map(|report| self.at(report)).collect();
        let Ok(mut paths) = self.paths(common) else { return false };
        paths.retain(|path| !reports.contains(path));
        reports.iter().all(|report| fingerprint::holds(report, request, &paths))
    }

    /// Cleans up after killed runs next to the outputs, except in `folders` that are done.
    pub(super) fn recover(
        &self,
        common: &Common,
        folders: &mut BTreeSet<Option<PathBuf>>,
        console: &Console,
    ) -> Outcome {
        for path in self.paths(common)? {
            if folders.insert(path.parent().map(Path::to_owned)) {
                for restored in output::recover(&path) {
                    console.note(&format!("{}: restored after an interrupted run", restored.display()));
                }
            }
        }
        Ok(())
    }

    /// Fails where writing would, before it begins. Outputs in a folder that is created replace nothing.
    pub(super) fn check(&self, common: &Common) -> Outcome {
        let is_made = |path: &Path| self.folder.is_some() && path.parent() == self.folder.as_deref();
        for (path, output) in self.places(common)? {
            if is_made(&path) {
                let mut above = path.ancestors().skip(1).filter(|folder| !folder.as_os_str().is_empty());
                let there = above.find(|folder| folder.symlink_metadata().is_ok());
                if let Some(there) = there.filter(|there| !there.is_dir()) {
                    return failed(format!("{}: is a file, but a folder is needed", there.display()));
                }
                if there != path.parent() {
                    continue;
                }
            }
            match output {
                Output::Folder(_) => output::check_folder(&path, common.existing)?,
                Output::File(_) => output::check_file(&path, common.existing)?,
            }
        }
        Ok(())
    }

    /// Lists the outputs for `source`: one line per file, or with `--json` one line of JSON.
    pub(super) fn foretold(&self, common: &Common, source: &InputFiles, layout: Layout) -> Result<String> {
        let planned = self.planned(common, Some(layout))?.into_iter();
        let planned = planned.map(|(path, content)| (self.at(&path), content));
        let preview = self.preview.iter().map(|path| (path.clone(), "picture".to_owned()));
        let reports = self.reports(common).into_iter().map(|path| (self.at(&path), "report".to_owned()));
        let files = planned.chain(preview).chain(reports);
        let files = files.map(|(path, content)| (path.display().to_string(), content));
        if common.json {
            let files: Vec<_> =
                files.map(|(path, content)| json!({"path": path, "content": content})).collect();
            let input = source.path().display().to_string();
            return Ok(json!({"input": input, "files": files}).to_string() + "\n");
        }
        Ok(files.map(|(path, content)| format!("{}\t{content}\n", escaped(&path))).collect())
    }

    /// Writes `products` and their completed reports, and moves everything into place in one step. Returns
    /// the reports, and the bytes written without the preview.
    pub(super) fn write(
        &self,
        common: &Common,
        products: &Products,
        request: Hash,
    ) -> Outcome<(Vec<Report>, u64)> {
        if let Some(folder) = &self.folder {
            fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
        }
        let (files, preview) = (products.files().collect::<Vec<_>>(), products.preview.as_deref());
        if self.place == Destination::Stdout {
            print_bytes(files[0].1)?;
            return Ok((products.reports().cloned().collect(), files[0].1.len() as u64));
        }
        let places = self.holding(files.iter().cloned(), preview);
        let hash = |(_, output): &(PathBuf, Output<'_>)| match output {
            Output::File(bytes) => blake3::hash(bytes),
            Output::Folder(files) => fingerprint::hash_of_files(files),
        };
        let hashes: Vec<Hash> = places.iter().map(hash).collect();
        let joined = fingerprint::joined(hashes.iter().copied().map(Ok))?;
        // Readers find a file by its name next to the report.
        let by_name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let own_hashes = places.iter().zip(&hashes).map(|((path, _), hash)| (by_name(path), *hash));
        let is_folder = self.place == Destination::Folder;
        let own_hashes: Vec<(String, Hash)> = own_hashes.filter(|_| !is_folder).collect();
        let report = |path: String, bytes: &[u8]| OutputFileReport { path, bytes: bytes.len() as u64 };
        let picture = self.preview.iter().map(|path| path.display().to_string()).zip(preview);
        let own_files: Vec<OutputFileReport> =
            files.iter().cloned().chain(picture).map(|(path, bytes)| report(path, bytes)).collect();
        let (mut reports, mut texts) = (Vec::new(), Vec::new());
        for product in &products.per_plan {
            let mut report = product.report.clone();
            if product.plan.plan.is_targeted() {
                let of = |file: &Made| (file.path.clone(), blake3::hash(&file.bytes));
                report.fingerprint = Some(fingerprint(request, joined, product.made.iter().map(of)));
            } else {
                report.fingerprint = Some(fingerprint(request, joined, own_hashes.iter().cloned()));
                report.outputs.clone_from(&own_files);
            }
            if common.json {
                report.fingerprint.iter_mut().for_each(|fingerprint| fingerprint.report = None);
            } else {
                let text = String::from_utf8(json_bytes(&report)?).expect("JSON is UTF-8");
                texts.push(fingerprint::signed(&text));
            }
            reports.push(report);
        }
        let texts = self.reports(common).into_iter().zip(texts.iter().map(String::as_bytes));
        let all: Vec<_> = files.into_iter().chain(texts).collect();
        let bytes = all.iter().map(|(_, bytes)| bytes.len() as u64).sum();
        let staged = output::stage_all(&self.holding(all, preview), common.existing)?;
        self.remove_report_without_hashes(common)?;
        output::commit(staged)?;
        Ok((reports, bytes))
    }

    /// Removes an old report without a hash of its file, as in version 0.1; it could be mistaken for the new
    /// file's.
    fn remove_report_without_hashes(&self, common: &Common) -> Result<()> {
        if self.place != Destination::File || common.existing != Existing::Replace {
            return Ok(());
        }
        let path = self.at(&report_path(false, &common.plans[0], &self.name));
        let old = fingerprint::recorded(&path);
        let believed = old.is_some_and(|(_, hashes)| hashes.is_none_or(|hashes| hashes.files.is_empty()));
        if believed { fs::remove_file(&path).map_err(|e| Error::io(&path, e)) } else { Ok(()) }
    }
}

/// Describes a file of `plan`, whose levels are `specs`.
fn description(BakePlan { plan, settings, .. }: &BakePlan, specs: &[LevelSpec], content: Content) -> String {
    let (pixel, size, levels) = (plan.pixel.name(), settings.size, specs.len());
    let skybox = settings.skybox.unwrap_or(size);
    let irradiance = settings.irradiance.unwrap_or(plan.target.irradiance_size);
    match content {
        Content::Specular => cube_words(pixel, size, levels),
        Content::Sheen => cube_words(&format!("{pixel} sheen"), size, levels),
        Content::Skybox if !plan.target.has_container() => cube_words(Pixel::F16.name(), skybox, 1),
        Content::Skybox => cube_words(pixel, skybox, 1),
        Content::SkyboxPanorama => format!("panorama {}x{}", 4 * skybox, 2 * skybox),
        Content::Irradiance => cube_words(&format!("{pixel} irradiance"), irradiance, 1),
        Content::ShJson | Content::ShText => "spherical harmonics".to_owned(),
        Content::Oem => format!("{pixel} octahedral map {size}, {levels} levels, with borders"),
        Content::Pyramid => format!("{pixel} pyramid {size}, with borders"),
        Content::PyramidCube => cube_words(&format!("{pixel} pyramid on a"), size, levels + 2),
        Content::PyramidLight => "suns and harmonics".to_owned(),
        Content::PyramidTables | Content::PyramidCubeTables => "tables of the look-ups".to_owned(),
        Content::Reader => "shader code".to_owned(),
        Content::Panorama => format!("panorama {}x{size}", 2 * size),
        Content::Mips => format!("{pixel} panorama {size}, {levels} levels"),
        Content::Image(LevelName { shown, face, is_bound }) => {
            let (size, what) = match shown {
                Shown::Level(level) => (specs[level as usize].layout.sides().1, ""),
                Shown::Irradiance => (irradiance, "irradiance "),
                Shown::Skybox => (skybox, "skybox "),
            };
            match face {
                _ if is_bound => format!("f32 error bounds {size}"),
                Some(_) => format!("{pixel} {what}face {size}"),
                None => format!("{pixel} {what}{} {size}", plan.layout.name()),
            }
        }
        Content::Atlas => format!("{pixel} atlas {}, {levels} levels", 2 * size),
        Content::Env | Content::Glb => {
            format!("{pixel} cube {size}, {levels} levels, and spherical harmonics")
        }
    }
}

/// Describes a cube in a few words.
fn cube_words(kind: &str, size: u32, levels: usize) -> String {
    match levels {
        1 => format!("{kind} cube {size}"),
        _ => format!("{kind} cube {size}, {levels} levels"),
    }
}

/// Extensions of formats that are not written; such a name would not match the content.
pub(super) const FOREIGN: [&str; 11] =
    ["basis", "bmp", "gif", "jpeg", "jpg", "pfm", "png", "tga", "tif", "tiff", "webp"];

/// Whether `path` ends in a slash and therefore names a folder.
pub(super) fn names_folder(path: &Path) -> bool {
    path.as_os_str().to_string_lossy().ends_with(std::path::is_separator)
}

/// Rejects a file extension for the folder `path`, such as `bake.hdr`, and names the remedy.
pub fn check_folder_name(path: &Path, remedy: &str) -> Outcome {
    let names_file = Container::of_path(path).is_some() && !names_folder(path);
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
