//! Outputs of a bake: where they go, and writing them.

use super::args::BakeArgs;
use super::input::Opened;
use super::unchanged::{self, REPORT, fingerprint};
use super::values::{FormatArg, OutLayoutArg};
use blake3::Hash;
use octagloss::bake::{Bake, BakeSettings, Rung};
use octagloss::chain::{CubeChain, CubeLevel};
use octagloss::io::cube_write::{Container, cube_bytes};
use octagloss::io::environment_write::exact_exr_bytes;
use octagloss::io::exr_write::{self, ExrPixel, Samples};
use octagloss::io::level_images::{LevelImage, mips_bytes, write_exr_images, write_hdr_images};
use octagloss::io::output::{self, Existing};
use octagloss::io::pixels::Pixel;
use octagloss::io::{hdr_write, png_write};
use octagloss::lobe::LOBE_KEY;
use octagloss::report::{Circumstances, Report, filter_name};
use octagloss::sphere::cube::Face;
use octagloss::{Error, Result, preview};
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};

/// How the levels are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Cube(Container, Pixel),
    Exr(ExrPixel),
    Hdr,
    /// An image a level.
    ExrImages(OutLayoutArg, ExrPixel),
    HdrImages(OutLayoutArg),
    /// Panoramas as the MIP levels of one file.
    Mips(Pixel),
}

impl Encoding {
    pub(super) const fn format(self) -> FormatArg {
        match self {
            Self::Cube(Container::Ktx2, _) => FormatArg::Ktx2,
            Self::Cube(Container::Ktx1, _) => FormatArg::Ktx,
            Self::Cube(Container::Dds, _) => FormatArg::Dds,
            Self::Cube(Container::Exr, _) | Self::Exr(_) | Self::ExrImages(..) | Self::Mips(_) => {
                FormatArg::Exr
            }
            Self::Hdr | Self::HdrImages(_) => FormatArg::Hdr,
        }
    }

    /// Whether all levels are in one file.
    pub(super) const fn is_single(self) -> bool {
        matches!(self, Self::Cube(..) | Self::Mips(_))
    }

    /// How the levels lie in images, where it is not by faces.
    const fn layout_name(self) -> Option<&'static str> {
        match self {
            Self::ExrImages(layout, _) | Self::HdrImages(layout) => Some(layout.name()),
            Self::Mips(_) => Some(OutLayoutArg::Mips.name()),
            Self::Cube(Container::Exr, _) => Some(OutLayoutArg::Parts.name()),
            Self::Cube(..) | Self::Exr(_) | Self::Hdr => None,
        }
    }

    /// The pixel format whose greatest value is a limit: those of a single kind, but floats.
    pub(super) const fn clamping_pixel(self) -> Option<Pixel> {
        match self {
            Self::Cube(_, pixel) | Self::Mips(pixel) => Some(pixel),
            Self::Exr(ExrPixel::F16) | Self::ExrImages(_, ExrPixel::F16) => Some(Pixel::F16),
            Self::Exr(_) | Self::ExrImages(..) | Self::Hdr | Self::HdrImages(_) => None,
        }
    }

    pub(super) const fn pixel_name(self) -> &'static str {
        match self {
            Self::Cube(_, pixel) | Self::Mips(pixel) => pixel.name(),
            Self::Exr(ExrPixel::Auto) | Self::ExrImages(_, ExrPixel::Auto) => "auto",
            Self::Exr(ExrPixel::F16) | Self::ExrImages(_, ExrPixel::F16) => "f16",
            Self::Exr(ExrPixel::F32) | Self::ExrImages(_, ExrPixel::F32) => "f32",
            Self::Hdr | Self::HdrImages(_) => "rgbe",
        }
    }
}

/// Everything that one bake writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Outputs {
    pub(super) encoding: Encoding,
    pub(super) existing: Existing,
    /// The file or folder itself.
    pub(super) main: PathBuf,
    /// The report, where it has a file of its own or one in the folder.
    pub(super) report: Option<PathBuf>,
    /// The irradiance, where it is a file of its own.
    pub(super) irradiance: Option<PathBuf>,
    /// The bounds, where they have a folder of their own.
    pub(super) bounds: Option<PathBuf>,
    /// What is told of the sun.
    sun: Vec<SunFile>,
    pub(super) preview: Option<PathBuf>,
}

/// What a bake writes besides what its settings ask for.
pub(super) struct Extras {
    /// Whether the report is printed instead.
    pub(super) json: bool,
    pub(super) sun: Vec<SunFile>,
    pub(super) preview: Option<PathBuf>,
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
            Self::Sun => Ok(json_text(&opened.sun).into_bytes()),
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
        let Extras { json, sun, preview } = extras;
        let single = encoding.is_single();
        let report = if single { suffixed(&main, ".report.json") } else { main.join(REPORT) };
        Self {
            encoding,
            existing,
            report: (!json).then_some(report),
            irradiance: (single && settings.irradiance.is_some())
                .then(|| main.with_extension(format!("irradiance.{}", encoding.format().name()))),
            bounds: (single && settings.bounds).then(|| suffixed(&main, ".bounds")),
            sun,
            preview,
            main,
        }
    }

    /// Where a file about the sun goes that has a place of its own.
    fn sun_place(&self, file: SunFile) -> PathBuf {
        suffixed(&self.main, &format!(".{}", file.name()))
    }

    const fn is_folder(&self) -> bool {
        !self.encoding.is_single()
    }

    /// Files and folders beside one another.
    pub(super) fn places(&self) -> impl Iterator<Item = PathBuf> {
        let report = self.report.as_ref().filter(|_| !self.is_folder());
        let others = [report, self.irradiance.as_ref(), self.bounds.as_ref(), self.preview.as_ref()];
        let sun = self.sun.iter().filter(|_| !self.is_folder()).map(|file| self.sun_place(*file));
        std::iter::once(&self.main).chain(others.into_iter().flatten()).cloned().chain(sun)
    }

    /// Whether all is there as it was written for `request`.
    pub(super) fn holds(&self, request: Hash) -> bool {
        self.report.as_deref().is_some_and(|report| unchanged::holds(report, request, self.hashed()))
    }

    /// The places without the report.
    fn hashed(&self) -> impl Iterator<Item = PathBuf> {
        self.places().filter(|place| Some(place) != self.report.as_ref())
    }

    /// Fails where writing would before it begins. What is to stand in `fresh`, a folder that is yet to be made,
    /// replaces nothing.
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
        let pixel = self.encoding.pixel_name();
        let rungs = settings.rungs()?;
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
                let levels = rungs.iter().enumerate();
                files.extend(levels.map(|(k, rung)| image(format!("m{k}"), told("", rung.layout.sides().1))));
                let irradiance = settings.irradiance.filter(|_| layout.unfolding().is_some());
                files
                    .extend(irradiance.map(|size| image("irradiance".to_owned(), told("irradiance ", size))));
            }
            Encoding::Exr(_) | Encoding::Hdr => {
                for (index, rung) in rungs.iter().enumerate() {
                    let told = format!("{pixel} face {}", rung.layout.sides().0);
                    files.extend(faces(&self.main, format!("m{index}_{{face}}.{extension}"), told));
                }
                if let Some(size) = settings.irradiance {
                    let told = format!("{pixel} irradiance face {size}");
                    files.extend(faces(&self.main, format!("irradiance_{{face}}.{extension}"), told));
                }
            }
            Encoding::Mips(_) => {
                let told = format!("{pixel} panorama {}, {} levels", settings.size, rungs.len());
                files.push((self.main.clone(), told));
            }
            Encoding::Cube(..) => {
                files.push((self.main.clone(), cube_told(pixel, settings.size, rungs.len())));
                if let (Some(path), Some(size)) = (&self.irradiance, settings.irradiance) {
                    files.push((path.clone(), cube_told(&format!("{pixel} irradiance"), size, 1)));
                }
            }
        }
        // A mirror has no bounds.
        let bounded = |rung: &Rung| settings.bounds && !(rung.roughness == 0.0 && settings.lobe.has_mirror());
        for (index, rung) in rungs.iter().enumerate().filter(|(_, rung)| bounded(rung)) {
            let folder = self.bounds.as_ref().unwrap_or(&self.main);
            let told = format!("f32 error bounds {}", rung.layout.sides().0);
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

    /// Writes all; `told` is completed with what was stored, the report comes back with the bytes written.
    pub(super) fn write(
        &self,
        settings: &BakeSettings,
        bake: &Bake,
        compressed: u64,
        request: Hash,
        opened: &Opened,
        told: impl FnOnce(Stored) -> Circumstances,
    ) -> Result<(Report, u64)> {
        let report_of = |stored: Stored, outputs: Hash| {
            let mut report = Report {
                compressed,
                fingerprint: Some(fingerprint(request, outputs)),
                ..Report::new(settings, bake, told(stored))
            };
            report.options.out_layout = self.encoding.layout_name().map(str::to_owned);
            report
        };
        let preview = match &self.preview {
            Some(_) => Some(png_write::png_bytes(&preview::contact_sheet(&bake.chain)?)?),
            None => None,
        };
        let metadata = metadata(settings);
        let irradiance = bake.irradiance.as_ref();
        let write_sun = |folder: &Path| self.sun.iter().try_for_each(|file| file.write_into(folder, opened));
        let write_preview = |preview: &Option<Vec<u8>>| match (&self.preview, preview) {
            (Some(path), Some(bytes)) => {
                output::write_file(path, self.existing, |file| file.write_all(bytes))
            }
            _ => Ok(()),
        };
        // What stands beside a single file.
        let write_beside = || {
            for file in &self.sun {
                let bytes = file.bytes(opened)?;
                output::write_file(&self.sun_place(*file), self.existing, |out| out.write_all(&bytes))?;
            }
            write_preview(&preview)
        };
        let write_report = |report: &Report| match &self.report {
            Some(path) => {
                let text = json_text(report);
                output::write_file(path, self.existing, |file| file.write_all(text.as_bytes()))
            }
            None => Ok(()),
        };
        // The folder is complete but for its report, and a preview comes later.
        let hash_of = |folder: &Path| {
            let preview = preview.iter().map(|bytes| Ok(blake3::hash(bytes)));
            unchanged::joined(std::iter::once(unchanged::hash_of(folder)).chain(preview))
        };
        let (format, pixel_name) = (self.encoding.format().name(), self.encoding.pixel_name());
        let report = match self.encoding {
            Encoding::Cube(container, pixel) => {
                let cube = |path: &Path, chain: &CubeChain, metadata: &[(String, String)]| {
                    output::check_file(path, self.existing)?;
                    let made = cube_bytes(container, chain, pixel, metadata)?;
                    output::write_file(path, self.existing, |file| file.write_all(&made.bytes))?;
                    Ok::<u64, Error>(made.clamped.iter().sum())
                };
                let mut clamped = cube(&self.main, &bake.chain, &metadata)?;
                if let (Some(path), Some(level)) = (&self.irradiance, irradiance) {
                    let chain = CubeChain { levels: vec![level.clone()] };
                    let metadata = [("octaglossContent".to_owned(), "irradiance over pi".to_owned())];
                    clamped += cube(path, &chain, &metadata)?;
                }
                if let Some(path) = &self.bounds {
                    output::write_folder(path, self.existing, |folder| write_bounds(folder, &bake.chain))?;
                }
                write_beside()?;
                let pixels = vec![pixel; bake.chain.levels.len()];
                let hash = unchanged::joined(self.hashed().map(|place| unchanged::hash_of(&place)))?;
                let report = report_of(Stored::new(format, pixel_name, &pixels, clamped), hash);
                write_report(&report)?;
                report
            }
            Encoding::Exr(choice) => output::write_folder(&self.main, self.existing, |folder| {
                let stored =
                    exr_write::write_level_folder(folder, &bake.chain, irradiance, choice, &metadata)?;
                write_sun(folder)?;
                let pixels: Vec<Pixel> = stored.iter().map(|level| level.pixel).collect();
                let clamped = stored.iter().map(|level| level.clamped).sum();
                let report = report_of(Stored::new(format, pixel_name, &pixels, clamped), hash_of(folder)?);
                self.write_report_into(folder, &report)?;
                Ok(report)
            })?,
            Encoding::ExrImages(layout, choice) => {
                output::write_folder(&self.main, self.existing, |folder| {
                    let images = level_images(layout, bake);
                    let stored = write_exr_images(folder, &images, choice, &metadata)?;
                    let levels = &stored[..bake.stats.len()];
                    let pixels: Vec<Pixel> = levels.iter().map(|level| level.pixel).collect();
                    let clamped = stored.iter().map(|level| level.clamped).sum();
                    write_sun(folder)?;
                    let stored = Stored::new(format, pixel_name, &pixels, clamped);
                    let report = report_of(stored, hash_of(folder)?);
                    self.write_report_into(folder, &report)?;
                    Ok(report)
                })?
            }
            Encoding::HdrImages(layout) => output::write_folder(&self.main, self.existing, |folder| {
                write_hdr_images(folder, &level_images(layout, bake))?;
                write_sun(folder)?;
                let pixels = vec!["rgbe".to_owned(); bake.stats.len()];
                let stored = Stored { format, pixel: pixel_name, pixels, clamped: 0, floats: 0 };
                let report = report_of(stored, hash_of(folder)?);
                self.write_report_into(folder, &report)?;
                Ok(report)
            })?,
            Encoding::Mips(pixel) => {
                output::check_file(&self.main, self.existing)?;
                let bytes = mips_bytes(&bake.images, pixel, &metadata)?;
                output::write_file(&self.main, self.existing, |file| file.write_all(&bytes))?;
                let clamped = bake.images.iter().map(|level| pixel.clamped(&level.texels)).sum();
                write_beside()?;
                let hash = unchanged::joined(self.hashed().map(|place| unchanged::hash_of(&place)))?;
                let pixels = vec![pixel; bake.stats.len()];
                let report = report_of(Stored::new(format, pixel_name, &pixels, clamped), hash);
                write_report(&report)?;
                report
            }
            Encoding::Hdr => output::write_folder(&self.main, self.existing, |folder| {
                hdr_write::write_level_folder(folder, &bake.chain, irradiance)?;
                if settings.bounds {
                    write_bounds(folder, &bake.chain)?;
                }
                write_sun(folder)?;
                let pixels = bake.chain.levels.iter().map(|_| "rgbe".to_owned()).collect();
                let report = report_of(
                    Stored { format, pixel: pixel_name, pixels, clamped: 0, floats: 0 },
                    hash_of(folder)?,
                );
                self.write_report_into(folder, &report)?;
                Ok(report)
            })?,
        };
        if self.is_folder() {
            write_preview(&preview)?;
        }
        Ok((report, self.places().map(|place| bytes_in(&place)).sum()))
    }

    fn write_report_into(&self, folder: &Path, report: &Report) -> Result<()> {
        if self.report.is_none() {
            return Ok(());
        }
        let path = folder.join(REPORT);
        fs::write(&path, json_text(report)).map_err(|e| Error::io(&path, e))
    }
}

/// What a cube is, in a few words.
pub(super) fn cube_told(kind: &str, size: u32, levels: usize) -> String {
    match levels {
        1 => format!("{kind} cube {size}"),
        _ => format!("{kind} cube {size}, {levels} levels"),
    }
}

/// The levels of `bake` in `layout`, and its irradiance where there is some.
fn level_images(layout: OutLayoutArg, bake: &Bake) -> Vec<LevelImage<'_>> {
    let name = |index: usize| format!("m{index}");
    let Some(unfolding) = layout.unfolding() else {
        return bake.images.iter().enumerate().map(|(k, level)| LevelImage::whole(name(k), level)).collect();
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
    pub(super) fn new(format: &'static str, pixel: &'static str, pixels: &[Pixel], clamped: u64) -> Self {
        let floats = pixels.iter().filter(|pixel| **pixel == Pixel::F32).count();
        let pixels = pixels.iter().map(|pixel| pixel.name().to_owned()).collect();
        Self { format, pixel, pixels, clamped, floats }
    }
}

/// What every output tells of itself.
pub(super) fn metadata(settings: &BakeSettings) -> Vec<(String, String)> {
    let conventions = "right-handed, y up; faces +X -X +Y -Y +Z -Z as in OpenGL, Vulkan and Direct3D; linear RGB, \
                       Rec. 709; perceptual roughness, alpha = roughness^2";
    [
        ("octaglossConventions", conventions.to_owned()),
        ("octaglossFilter", filter_name(settings.filter)),
        (LOBE_KEY, settings.lobe.name().to_owned()),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .to_vec()
}

/// `value` as a file of its own.
pub(super) fn json_text(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).expect("keys are strings") + "\n"
}

/// `m{level}_{face}_bound.exr` of every level.
fn write_bounds(folder: &Path, chain: &CubeChain) -> Result<()> {
    let bounds = |level: &'_ CubeLevel| level.bounds.clone();
    for (index, level) in chain.levels.iter().enumerate() {
        let Some(bounds) = bounds(level) else { continue };
        for (face, values) in Face::ALL.iter().zip(bounds.chunks_exact(bounds.len() / 6)) {
            let path = folder.join(format!("m{index}_{}_bound.exr", face.short_name()));
            let bytes =
                exr_write::exr_bytes(level.size, level.size, Samples::Luminance(values), Pixel::F32, &[])?;
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
