//! Outputs of a bake: where they go, and writing them.

use super::args::BakeArgs;
use super::console::Talk;
use super::fingerprint::{self, fingerprint};
use super::input::Opened;
use super::outcome::{Failure, Outcome, print_bytes};
use crate::cli::input::Source;
use crate::cli::outcome::usage;
use blake3::Hash;
use octagloss::bake::report::{Circumstances, FingerprintReport, OutputFileReport, Report, filter_name};
use octagloss::bake::{Bake, BakeSettings};
use octagloss::chain::{Chain, Level, LevelSpec};
use octagloss::export::report_file::report_path;
use octagloss::format::container::Container;
use octagloss::format::{OutputLayout, Pixel};
use octagloss::image::exposure::Exposure;
use octagloss::image::preview;
use octagloss::io::cube_write::cube_bytes;
use octagloss::io::environment_write::exact_exr_bytes;
use octagloss::io::exr;
use octagloss::io::exr::write::Samples;
use octagloss::io::layout::Unfolding;
use octagloss::io::level_images::{LevelImage, mips_bytes, write_exr_images, write_hdr_images};
use octagloss::io::output::{self, Existing, Staged};
use octagloss::io::provenance::{Provenance, irradiance_pairs};
use octagloss::io::regular::read_regular;
use octagloss::io::side_report::MOST_REPORT_BYTES;
use octagloss::io::side_report::REPORT;
use octagloss::io::{hdr, ldr};
use octagloss::sphere::cube::Face;
use octagloss::{Error, Result};
use serde::Serialize;
use serde_json::json;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// How the levels are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Cube(Container, Pixel),
    Exr(Pixel),
    Hdr,
    /// An image a level.
    ExrImages(OutputLayout, Pixel),
    HdrImages(OutputLayout),
    /// Panoramas as the MIP levels of one file.
    Mips(Pixel),
}

/// Bytes of a texel of `pixel`, for estimates: formats of four bytes have copies of their own on the way.
pub(super) const fn texel_bytes(pixel: Pixel) -> u64 {
    match pixel {
        Pixel::F32 => 16,
        _ => 8,
    }
}

impl Encoding {
    pub(super) const fn format(self) -> Container {
        match self {
            Self::Cube(container, _) => container,
            Self::Exr(_) | Self::ExrImages(..) | Self::Mips(_) => Container::Exr,
            Self::Hdr | Self::HdrImages(_) => Container::Hdr,
        }
    }

    /// Whether all levels are in one file.
    pub(super) const fn is_single(self) -> bool {
        matches!(self, Self::Cube(..) | Self::Mips(_))
    }

    /// Bytes of a texel where a whole level is encoded at once.
    pub(super) const fn texel_bytes(self) -> u64 {
        match self {
            Self::Cube(_, pixel) | Self::Mips(pixel) => texel_bytes(pixel),
            _ => texel_bytes(Pixel::F16),
        }
    }

    /// How the levels lie in images, where it is not by faces.
    const fn layout_name(self) -> Option<&'static str> {
        match self {
            Self::ExrImages(layout, _) | Self::HdrImages(layout) => Some(layout.name()),
            Self::Mips(_) => Some(OutputLayout::Mips.name()),
            Self::Cube(Container::Exr, _) => Some(OutputLayout::Parts.name()),
            Self::Cube(..) | Self::Exr(_) | Self::Hdr => None,
        }
    }

    /// The pixel format asked for.
    pub(super) const fn pixel(self) -> Pixel {
        match self {
            Self::Cube(_, pixel) | Self::Mips(pixel) | Self::Exr(pixel) | Self::ExrImages(_, pixel) => pixel,
            Self::Hdr | Self::HdrImages(_) => Pixel::Rgbe,
        }
    }
}

/// Everything that one bake writes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outputs {
    pub(super) encoding: Encoding,
    pub(super) existing: Existing,
    /// The file or folder itself; `-` is standard output where `stream` says so.
    pub(super) main: PathBuf,
    stream: Stream,
    /// The report, where it has a file of its own or one in the folder.
    pub(super) report: Option<PathBuf>,
    /// The irradiance, where it is a file of its own.
    pub(super) irradiance: Option<PathBuf>,
    /// The bounds, where they have a folder of their own.
    pub(super) bounds: Option<PathBuf>,
    /// What is told of the sun.
    sun: Vec<SunFile>,
    pub(super) preview: Option<PathBuf>,
    /// The picture's exposure.
    pub(super) exposure: Exposure,
}

/// Where the main output goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stream {
    /// Into a file or folder.
    Place,
    /// To standard output.
    Stdout,
}

/// What a bake writes besides what its settings ask for.
pub(super) struct Extras {
    pub(super) stream: Stream,
    /// Whether the report is printed instead.
    pub(super) json: bool,
    pub(super) sun: Vec<SunFile>,
    pub(super) preview: Option<PathBuf>,
    pub(super) exposure: Exposure,
}

/// A file about the sun that was taken out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SunFile {
    /// What it is.
    Sun,
    /// The environment without it.
    Sunless,
}

impl SunFile {
    /// Those that `args` ask for.
    pub(super) fn asked(args: &BakeArgs) -> Vec<Self> {
        let asked = [(Self::Sun, args.input.extract_sun), (Self::Sunless, args.sunless)];
        asked.into_iter().filter_map(|(file, asked)| asked.then_some(file)).collect()
    }

    /// Its name in a folder, and the end of its name beside a file.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Sun => "sun.json",
            Self::Sunless => "sunless.exr",
        }
    }

    /// What it holds, in a few words.
    pub(super) const fn content(self) -> &'static str {
        match self {
            Self::Sun => "the sun",
            Self::Sunless => "f32 environment without the sun",
        }
    }

    fn bytes(self, opened: &Opened) -> Result<Vec<u8>> {
        match self {
            Self::Sun => Ok(json_text(&opened.sun)?.into_bytes()),
            Self::Sunless => exact_exr_bytes(&opened.environment, "an environment without its sun"),
        }
    }

    pub(super) fn write_into(self, folder: &Path, opened: &Opened) -> Result<()> {
        let path = folder.join(self.name());
        fs::write(&path, self.bytes(opened)?).map_err(|e| Error::io(&path, e))
    }
}

/// `path` with `suffix` after its whole name.
fn suffixed(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}

impl Outputs {
    /// The outputs around `main`, for a bake that keeps its report unless `json` prints it.
    pub(super) fn around(
        main: PathBuf,
        encoding: Encoding,
        existing: Existing,
        settings: &BakeSettings,
        extras: Extras,
    ) -> Self {
        let Extras { stream, json, sun, preview, exposure } = extras;
        let single = encoding.is_single();
        let report = if single { report_path(&main) } else { main.join(REPORT) };
        Self {
            encoding,
            existing,
            stream,
            report: (!json && stream == Stream::Place).then_some(report),
            irradiance: (single && settings.irradiance.is_some())
                .then(|| main.with_extension(format!("irradiance.{}", encoding.format().name()))),
            bounds: (single && settings.bounds).then(|| suffixed(&main, ".bounds")),
            sun,
            preview,
            exposure,
            main,
        }
    }

    /// Where a file about the sun goes that has a place of its own.
    fn sun_place(&self, file: SunFile) -> PathBuf {
        suffixed(&self.main, &format!(".{}", file.name()))
    }

    /// Whether the only output is standard output.
    pub(super) fn is_stdout(&self) -> bool {
        self.stream == Stream::Stdout
    }

    const fn is_folder(&self) -> bool {
        !self.encoding.is_single()
    }

    /// Files and folders beside one another.
    pub(super) fn places(&self) -> impl Iterator<Item = PathBuf> {
        let report = self.report.as_ref().filter(|_| !self.is_folder());
        let others = [report, self.irradiance.as_ref(), self.bounds.as_ref(), self.preview.as_ref()];
        let sun = self.sun.iter().filter(|_| !self.is_folder()).map(|file| self.sun_place(*file));
        let main = Some(&self.main).filter(|_| !self.is_stdout());
        main.into_iter().chain(others.into_iter().flatten()).cloned().chain(sun)
    }

    /// Whether all is there as it was written for `request`.
    pub(super) fn holds(&self, request: Hash) -> bool {
        self.report.as_deref().is_some_and(|report| fingerprint::holds(report, request, self.hashed()))
    }

    /// The places without the report.
    fn hashed(&self) -> impl Iterator<Item = PathBuf> {
        self.places().filter(|place| Some(place) != self.report.as_ref())
    }

    /// Cleans up after killed runs beside the outputs.
    pub(super) fn recover(&self, talk: &Talk) {
        let mut folders = BTreeSet::new();
        for place in self.places() {
            if folders.insert(place.parent().map(Path::to_owned)) {
                recover(&place, talk);
            }
        }
    }

    /// Fails where writing would before it begins. What is to stand in `fresh`, a folder that is yet to be
    /// made, replaces nothing.
    pub(super) fn check(&self, fresh: Option<&Path>) -> Result<()> {
        for place in self.places() {
            if fresh.is_some() && place.parent() == fresh {
                continue;
            }
            let folder = (place == self.main && self.is_folder()) || Some(&place) == self.bounds.as_ref();
            if folder {
                output::check_folder(&place, self.existing)?;
            } else {
                output::check_file(&place, self.existing)?;
            }
        }
        Ok(())
    }

    /// The files that will be written, and what each will be.
    pub(super) fn files(&self, settings: &BakeSettings) -> Result<Vec<(PathBuf, String)>> {
        let pixel = self.encoding.pixel().name();
        let specs = settings.level_specs()?;
        let faces = |folder: &Path, name: String, told: String| {
            Face::ALL.map(|face| (folder.join(name.replace("{face}", face.short_name())), told.clone()))
        };
        let mut files = Vec::new();
        let extension = self.encoding.format().name();
        match self.encoding {
            Encoding::ExrImages(layout, _) | Encoding::HdrImages(layout) => {
                let told = |what: &str, size: u32| format!("{pixel} {what}{} {size}", layout.name());
                let image =
                    |name: String, told: String| (self.main.join(format!("{name}.{extension}")), told);
                let levels = specs.iter().enumerate();
                files.extend(levels.map(|(k, spec)| image(format!("m{k}"), told("", spec.layout.sides().1))));
                let irradiance = settings.irradiance.filter(|_| unfolding(layout).is_some());
                files
                    .extend(irradiance.map(|size| image("irradiance".to_owned(), told("irradiance ", size))));
            }
            Encoding::Exr(_) | Encoding::Hdr => {
                for (index, spec) in specs.iter().enumerate() {
                    let told = format!("{pixel} face {}", spec.layout.sides().0);
                    files.extend(faces(&self.main, format!("m{index}_{{face}}.{extension}"), told));
                }
                if let Some(size) = settings.irradiance {
                    let told = format!("{pixel} irradiance face {size}");
                    files.extend(faces(&self.main, format!("irradiance_{{face}}.{extension}"), told));
                }
            }
            Encoding::Mips(_) => {
                let told = format!("{pixel} panorama {}, {} levels", settings.size, specs.len());
                files.push((self.main.clone(), told));
            }
            Encoding::Cube(..) => {
                files.push((self.main.clone(), cube_told(pixel, settings.size, specs.len())));
                if let (Some(path), Some(size)) = (&self.irradiance, settings.irradiance) {
                    files.push((path.clone(), cube_told(&format!("{pixel} irradiance"), size, 1)));
                }
            }
        }
        // A mirror has no bounds.
        let bounded =
            |spec: &LevelSpec| settings.bounds && !(spec.roughness == 0.0 && settings.lobe.has_mirror());
        for (index, spec) in specs.iter().enumerate().filter(|(_, spec)| bounded(spec)) {
            let folder = self.bounds.as_ref().unwrap_or(&self.main);
            let told = format!("f32 error bounds {}", spec.layout.sides().0);
            files.extend(faces(folder, format!("m{index}_{{face}}_bound.exr"), told));
        }
        for file in &self.sun {
            let path = if self.is_folder() { self.main.join(file.name()) } else { self.sun_place(*file) };
            files.push((path, file.content().to_owned()));
        }
        files.extend(self.preview.iter().map(|path| (path.clone(), "picture".to_owned())));
        files.extend(self.report.iter().map(|path| (path.clone(), "report".to_owned())));
        Ok(files)
    }

    /// Writes all aside, then puts it into place. `told` is completed with how it is stored. Returns the
    /// report and the bytes written.
    pub(super) fn write(
        &self,
        settings: &BakeSettings,
        bake: &Bake,
        compressed: u64,
        request: Hash,
        opened: &Opened,
        told: impl Fn(Stored) -> Circumstances,
    ) -> Outcome<(Report, u64)> {
        let report_of =
            |stored: Stored, outputs: Vec<OutputFileReport>, fingerprint: Option<FingerprintReport>| {
                let report = Report::new(settings, bake, told(stored));
                let mut report = Report { compressed, fingerprint, outputs, ..report };
                if let Some(layout) = self.encoding.layout_name() {
                    report.options.out_layout = Some(layout.to_owned());
                }
                report
            };
        let preview = match &self.preview {
            Some(_) => Some(ldr::write::png_bytes(&preview::contact_sheet(&bake.chain, self.exposure)?)?),
            None => None,
        };
        let metadata = metadata(settings, opened);
        let irradiance = bake.irradiance.as_ref();
        let stage =
            |path: &Path, bytes: &[u8]| output::stage_file(path, self.existing, |file| file.write_all(bytes));
        let stage_preview = || {
            let preview = self.preview.as_deref().zip(preview.as_deref());
            preview.map(|(path, bytes)| stage(path, bytes)).transpose()
        };
        let (format, pixel_name) = (self.encoding.format().name(), self.encoding.pixel().name());
        // A single file, the files beside it in the order of `hashed`, and the report that knows their
        // hashes.
        let write_files = |main: &[u8], mut beside: Vec<Staged>, pixel: Pixel, clamped: u64| {
            let pixels = vec![pixel; bake.stats.len()];
            let stored = Stored::new(format, pixel_name, &pixels, clamped);
            if self.is_stdout() {
                print_bytes(main)?;
                let output = OutputFileReport { path: "-".to_owned(), bytes: main.len() as u64 };
                return Ok((report_of(stored, vec![output], None), main.len() as u64));
            }
            let mut staged = vec![stage(&self.main, main)?];
            staged.append(&mut beside);
            staged.extend(stage_preview()?);
            for file in &self.sun {
                staged.push(stage(&self.sun_place(*file), &file.bytes(opened)?)?);
            }
            let hashes = staged.iter().map(|output| fingerprint::hash_of(&output.path()));
            let hashes = hashes.collect::<Result<Vec<_>>>()?;
            let named = staged.iter().zip(&hashes).map(|(output, hash)| {
                let name = output.named().file_name().unwrap_or_default().to_string_lossy();
                (name.into_owned(), *hash)
            });
            let outputs = fingerprint::joined(hashes.iter().copied().map(Ok))?;
            let mut sizes = Vec::new();
            for output in &staged {
                let name = if Some(output.named()) == self.preview.as_deref() {
                    output.named().display().to_string()
                } else {
                    output.named().file_name().unwrap_or_default().to_string_lossy().into_owned()
                };
                sizes.extend(fingerprint::sizes(&output.path(), &name)?);
            }
            let report = report_of(stored, sizes, Some(fingerprint(request, outputs, named)));
            if let Some(path) = &self.report {
                staged.push(stage(path, json_text(&report)?.as_bytes())?);
            }
            self.remove_report_without_hashes()?;
            output::commit(staged)?;
            Ok::<_, Failure>((report, self.written()))
        };
        // A folder, which is complete but for its report when `fill` returns how it is stored.
        let write_folder = |fill: &dyn Fn(&Path) -> Result<Stored>| {
            let (staged, report) = output::stage_folder(&self.main, self.existing, |folder| {
                let stored = fill(folder)?;
                self.sun.iter().try_for_each(|file| file.write_into(folder, opened))?;
                let hash = preview.iter().map(|bytes| Ok(blake3::hash(bytes)));
                let outputs = fingerprint::joined(std::iter::once(fingerprint::hash_of(folder)).chain(hash))?;
                let mut sizes = fingerprint::sizes(folder, "")?;
                let preview = self.preview.as_deref().zip(preview.as_deref());
                sizes.extend(preview.map(|(path, bytes)| OutputFileReport {
                    path: path.display().to_string(),
                    bytes: bytes.len() as u64,
                }));
                let report = report_of(stored, sizes, Some(fingerprint(request, outputs, [])));
                self.write_report_into(folder, &report)?;
                Ok(report)
            })?;
            output::commit(std::iter::once(staged).chain(stage_preview()?).collect())?;
            Ok((report, self.written()))
        };
        let sum = |clamped: &[u64]| clamped.iter().sum::<u64>();
        match self.encoding {
            Encoding::Cube(container, pixel) => {
                let main = cube_bytes(container, &bake.chain, pixel, &metadata)?;
                let mut clamped = sum(&main.clamped);
                let mut beside = Vec::new();
                if let (Some(path), Some(level)) = (&self.irradiance, irradiance) {
                    let chain = Chain { levels: vec![level.clone()] };
                    let metadata = irradiance_pairs(&metadata);
                    let made = cube_bytes(container, &chain, pixel, &metadata)?;
                    clamped += sum(&made.clamped);
                    beside.push(stage(path, &made.bytes)?);
                }
                if let Some(path) = &self.bounds {
                    let write = |folder: &Path| write_bounds(folder, &bake.chain);
                    beside.push(output::stage_folder(path, self.existing, write)?.0);
                }
                write_files(&main.bytes, beside, pixel, clamped)
            }
            Encoding::Mips(pixel) => {
                let clamped = bake.chain.levels.iter().map(|level| pixel.clamped(&level.texels)).sum();
                write_files(&mips_bytes(&bake.chain.levels, pixel, &metadata)?, Vec::new(), pixel, clamped)
            }
            Encoding::Exr(choice) => write_folder(&|folder| {
                let levels =
                    exr::write::write_level_folder(folder, &bake.chain, irradiance, choice, &metadata)?;
                let pixels: Vec<Pixel> = levels.iter().map(|level| level.pixel).collect();
                let clamped = levels.iter().map(|level| level.clamped).sum();
                Ok(Stored::new(format, pixel_name, &pixels, clamped))
            }),
            Encoding::ExrImages(layout, choice) => write_folder(&|folder| {
                let images = write_exr_images(folder, &level_images(layout, bake), choice, &metadata)?;
                let levels = &images[..bake.stats.len()];
                let pixels: Vec<Pixel> = levels.iter().map(|level| level.pixel).collect();
                let clamped = images.iter().map(|level| level.clamped).sum();
                Ok(Stored::new(format, pixel_name, &pixels, clamped))
            }),
            Encoding::HdrImages(layout) => write_folder(&|folder| {
                write_hdr_images(folder, &level_images(layout, bake), &metadata)?;
                Ok(Stored::rgbe(format, pixel_name, bake))
            }),
            Encoding::Hdr => write_folder(&|folder| {
                hdr::write::write_level_folder(folder, &bake.chain, irradiance, &metadata)?;
                if settings.bounds {
                    write_bounds(folder, &bake.chain)?;
                }
                Ok(Stored::rgbe(format, pixel_name, bake))
            }),
        }
    }

    /// Removes the old report where it holds no hash of its file, as those of version 0.1, and so could be
    /// taken for the new file's.
    fn remove_report_without_hashes(&self) -> Result<()> {
        let path = report_path(&self.main);
        let text = read_regular(&path, MOST_REPORT_BYTES).unwrap_or_default();
        let old = serde_json::from_slice::<Report>(&text).ok();
        let believed = old.is_some_and(|old| old.fingerprint.is_none_or(|hashes| hashes.files.is_empty()));
        if believed && self.existing == Existing::Replace {
            return fs::remove_file(&path).map_err(|e| Error::io(&path, e));
        }
        Ok(())
    }

    /// Bytes of all outputs.
    fn written(&self) -> u64 {
        self.places().map(|place| bytes_in(&place)).sum()
    }

    fn write_report_into(&self, folder: &Path, report: &Report) -> Result<()> {
        if self.report.is_none() {
            return Ok(());
        }
        let path = folder.join(REPORT);
        fs::write(&path, json_text(report)?).map_err(|e| Error::io(&path, e))
    }
}

/// Cleans up after killed runs beside `place`.
pub(super) fn recover(place: &Path, talk: &Talk) {
    for restored in output::recover(place) {
        talk.note(&format!("{}: put back, as a killed run had set it aside", restored.display()));
    }
}

/// What a cube is, in a few words.
pub(super) fn cube_told(kind: &str, size: u32, levels: usize) -> String {
    match levels {
        1 => format!("{kind} cube {size}"),
        _ => format!("{kind} cube {size}, {levels} levels"),
    }
}

/// How a cube's faces lie in a level's one image.
const fn unfolding(layout: OutputLayout) -> Option<Unfolding> {
    match layout {
        OutputLayout::Cross => Some(Unfolding::Cross),
        OutputLayout::CrossVertical => Some(Unfolding::CrossVertical),
        OutputLayout::Strip => Some(Unfolding::Strip),
        OutputLayout::StripVertical => Some(Unfolding::StripVertical),
        _ => None,
    }
}

/// The levels of `bake` in `layout`, and its irradiance where there is some.
fn level_images(layout: OutputLayout, bake: &Bake) -> Vec<LevelImage<'_>> {
    let name = |index: usize| format!("m{index}");
    let Some(unfolding) = unfolding(layout) else {
        return bake
            .chain
            .levels
            .iter()
            .enumerate()
            .map(|(k, level)| LevelImage::whole(name(k), level))
            .collect();
    };
    let levels = bake.chain.levels.iter().enumerate();
    let levels =
        levels.map(|(k, level)| LevelImage::unfolded(name(k), level, unfolding, Some(level.roughness)));
    let irradiance = bake.irradiance.iter();
    let irradiance =
        irradiance.map(|level| LevelImage::unfolded("irradiance".to_owned(), level, unfolding, None));
    levels.chain(irradiance).collect()
}

/// How a bake was stored.
pub(super) struct Stored {
    /// Format of the output.
    pub(super) format: &'static str,
    /// Pixel format asked for.
    pub(super) pixel: &'static str,
    /// Pixel format of each level.
    pub(super) pixels: Vec<String>,
    /// Texels clamped.
    pub(super) clamped: u64,
    /// Levels stored as floats.
    pub(super) floats: usize,
}

impl Stored {
    fn rgbe(format: &'static str, pixel: &'static str, bake: &Bake) -> Self {
        let clamped = bake.levels().map(|level| Pixel::Rgbe.clamped(&level.texels)).sum();
        Self { format, pixel, pixels: vec!["rgbe".to_owned(); bake.stats.len()], clamped, floats: 0 }
    }

    pub(super) fn new(format: &'static str, pixel: &'static str, pixels: &[Pixel], clamped: u64) -> Self {
        let floats = pixels.iter().filter(|pixel| **pixel == Pixel::F32).count();
        let pixels = pixels.iter().map(|pixel| pixel.name().to_owned()).collect();
        Self { format, pixel, pixels, clamped, floats }
    }
}

/// What every output says of itself.
pub(super) fn metadata(settings: &BakeSettings, opened: &Opened) -> Vec<(String, String)> {
    let conventions = "right-handed, y up; faces +X -X +Y -Y +Z -Z as in OpenGL, Vulkan and Direct3D; linear RGB, \
                       Rec. 709; perceptual roughness, alpha = roughness^2";
    let provenance = Provenance {
        lobe: Some(settings.lobe),
        filter: Some(filter_name(settings.filter)),
        ladder: Some(settings.ladder.name().to_owned()),
        ..opened.turned.clone()
    };
    let conventions = ("octaglossConventions".to_owned(), conventions.to_owned());
    std::iter::once(conventions).chain(provenance.pairs()).collect()
}

/// `value` as a file of its own.
///
/// # Errors
/// [`Error::NonFiniteResult`] where a number of it is NaN or infinite.
pub(super) fn json_text(value: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Error::NonFiniteResult { place: format!("JSON, {error}"), value: f64::NAN })?;
    Ok(text + "\n")
}

/// `m{level}_{face}_bound.exr` of every level.
fn write_bounds(folder: &Path, chain: &Chain) -> Result<()> {
    let bounds = |level: &'_ Level| level.bounds.clone();
    for (index, level) in chain.levels.iter().enumerate() {
        let Some(bounds) = bounds(level) else { continue };
        for (face, values) in Face::ALL.iter().zip(bounds.chunks_exact(bounds.len() / 6)) {
            let path = folder.join(format!("m{index}_{}_bound.exr", face.short_name()));
            let bytes = exr::write::exr_bytes(
                level.size(),
                level.size(),
                Samples::Luminance(values),
                Pixel::F32,
                &[],
            )?;
            fs::write(&path, bytes).map_err(|e| Error::io(&path, e))?;
        }
    }
    Ok(())
}

/// Size of a file, or of the files in a folder.
fn bytes_in(path: &Path) -> u64 {
    let Ok(metadata) = fs::metadata(path) else { return 0 };
    if !metadata.is_dir() {
        return metadata.len();
    }
    let files = fs::read_dir(path).into_iter().flatten().flatten();
    files.filter_map(|file| file.metadata().ok()).map(|metadata| metadata.len()).sum()
}

/// What would be written for `source`: a line a file, or one of JSON.
pub(super) fn foretold(source: &Source, files: Vec<(PathBuf, String)>, json: bool) -> String {
    let text = |path: &Path| path.display().to_string();
    if json {
        let files = files.iter().map(|(path, content)| json!({"path": text(path), "content": content}));
        let files: Vec<_> = files.collect();
        return json!({"input": text(source.path()), "files": files}).to_string() + "\n";
    }
    files.iter().map(|(path, content)| format!("{}\t{content}\n", text(path))).collect()
}

/// Extensions of formats that are not written: a file so named would belie its content.
pub(super) const FOREIGN: [&str; 11] =
    ["basis", "bmp", "gif", "jpeg", "jpg", "pfm", "png", "tga", "tif", "tiff", "webp"];

/// The format that the extension of `path` names.
pub(super) fn named_format(path: &Path) -> Option<Container> {
    Container::named(&extension(path)?)
}

/// Whether `path` ends in a slash, and so names a folder.
pub(super) fn names_folder(path: &Path) -> bool {
    path.as_os_str().to_string_lossy().ends_with(std::path::is_separator)
}

/// Refuses the extension of a file for the folder `path`, such as `bake.hdr`, and names the remedy.
pub(super) fn check_folder_name(path: &Path, remedy: &str) -> Outcome {
    let names_file = named_format(path).is_some() && !names_folder(path);
    if names_file || extension(path).is_some_and(|name| FOREIGN.contains(&name.as_str())) {
        let folder = path.with_extension("");
        return usage(format!(
            "the output {} is named as a file and would be a folder; -o {} names a folder{remedy}",
            path.display(),
            folder.display(),
        ));
    }
    Ok(())
}

pub(super) fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}
