//! Outputs of a bake: where they go, and writing them.

use super::args::{FormatArg, OutLayoutArg};
use octagloss::bake::{Bake, BakeSettings};
use octagloss::chain::{CubeChain, CubeLevel};
use octagloss::io::cube_write::{Container, cube_bytes};
use octagloss::io::exr_write::{self, ExrPixel, Samples};
use octagloss::io::level_images::{LevelImage, mips_bytes, write_exr_images, write_hdr_images};
use octagloss::io::output::{self, Existing};
use octagloss::io::pixels::Pixel;
use octagloss::io::{hdr_write, png_write};
use octagloss::report::{Circumstances, Report, filter_name};
use octagloss::sphere::cube::Face;
use octagloss::{Error, Result, preview};
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
    pub(super) preview: Option<PathBuf>,
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
        json: bool,
        preview: Option<PathBuf>,
    ) -> Self {
        let single = encoding.is_single();
        let report = if single { suffixed(&main, ".report.json") } else { main.join("report.json") };
        Self {
            encoding,
            existing,
            report: (!json).then_some(report),
            irradiance: (single && settings.irradiance.is_some())
                .then(|| main.with_extension(format!("irradiance.{}", encoding.format().name()))),
            bounds: (single && settings.bounds).then(|| suffixed(&main, ".bounds")),
            preview,
            main,
        }
    }

    const fn is_folder(&self) -> bool {
        !self.encoding.is_single()
    }

    /// Files and folders beside one another.
    pub(super) fn places(&self) -> impl Iterator<Item = &Path> {
        let report = self.report.as_ref().filter(|_| !self.is_folder());
        let others = [report, self.irradiance.as_ref(), self.bounds.as_ref(), self.preview.as_ref()];
        std::iter::once(&self.main).chain(others.into_iter().flatten()).map(PathBuf::as_path)
    }

    /// Fails where writing would before it begins. What is to stand in `fresh`, a folder that is yet to be made,
    /// replaces nothing.
    pub(super) fn check(&self, fresh: Option<&Path>) -> Result<()> {
        for place in self.places() {
            if fresh.is_some() && place.parent() == fresh {
                continue;
            }
            let folder = (place == self.main && self.is_folder()) || Some(place) == self.bounds.as_deref();
            if folder {
                output::check_folder(place, self.existing)?;
            } else {
                output::check_file(place, self.existing)?;
            }
        }
        Ok(())
    }

    /// Writes all; `told` is completed with what was stored, the report comes back with the bytes written.
    pub(super) fn write(
        &self,
        settings: &BakeSettings,
        bake: &Bake,
        compressed: u64,
        told: impl FnOnce(Stored) -> Circumstances,
    ) -> Result<(Report, u64)> {
        let report_of = |stored: Stored| {
            let mut report = Report { compressed, ..Report::new(settings, bake, told(stored)) };
            report.options.out_layout = self.encoding.layout_name().map(str::to_owned);
            report
        };
        let metadata = metadata(settings);
        let irradiance = bake.irradiance.as_ref();
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
                let pixels = vec![pixel; bake.chain.levels.len()];
                let report = report_of(Stored::new(&pixels, clamped));
                if let Some(path) = &self.report {
                    let text = report_text(&report);
                    output::write_file(path, self.existing, |file| file.write_all(text.as_bytes()))?;
                }
                report
            }
            Encoding::Exr(choice) => output::write_folder(&self.main, self.existing, |folder| {
                let stored =
                    exr_write::write_level_folder(folder, &bake.chain, irradiance, choice, &metadata)?;
                let pixels: Vec<Pixel> = stored.iter().map(|level| level.pixel).collect();
                let clamped = stored.iter().map(|level| level.clamped).sum();
                let report = report_of(Stored::new(&pixels, clamped));
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
                    let report = report_of(Stored::new(&pixels, clamped));
                    self.write_report_into(folder, &report)?;
                    Ok(report)
                })?
            }
            Encoding::HdrImages(layout) => output::write_folder(&self.main, self.existing, |folder| {
                write_hdr_images(folder, &level_images(layout, bake))?;
                let pixels = vec!["rgbe".to_owned(); bake.stats.len()];
                let report = report_of(Stored { pixels, clamped: 0, floats: 0 });
                self.write_report_into(folder, &report)?;
                Ok(report)
            })?,
            Encoding::Mips(pixel) => {
                output::check_file(&self.main, self.existing)?;
                let bytes = mips_bytes(&bake.images, pixel, &metadata)?;
                output::write_file(&self.main, self.existing, |file| file.write_all(&bytes))?;
                let clamped = bake.images.iter().map(|level| pixel.clamped(&level.texels)).sum();
                let report = report_of(Stored::new(&vec![pixel; bake.stats.len()], clamped));
                if let Some(path) = &self.report {
                    let text = report_text(&report);
                    output::write_file(path, self.existing, |file| file.write_all(text.as_bytes()))?;
                }
                report
            }
            Encoding::Hdr => output::write_folder(&self.main, self.existing, |folder| {
                hdr_write::write_level_folder(folder, &bake.chain, irradiance)?;
                if settings.bounds {
                    write_bounds(folder, &bake.chain)?;
                }
                let pixels = bake.chain.levels.iter().map(|_| "rgbe".to_owned()).collect();
                let report = report_of(Stored { pixels, clamped: 0, floats: 0 });
                self.write_report_into(folder, &report)?;
                Ok(report)
            })?,
        };
        if let Some(path) = &self.preview {
            png_write::write_png(path, self.existing, &preview::contact_sheet(&bake.chain)?)?;
        }
        Ok((report, self.places().map(bytes_in).sum()))
    }

    fn write_report_into(&self, folder: &Path, report: &Report) -> Result<()> {
        if self.report.is_none() {
            return Ok(());
        }
        let path = folder.join("report.json");
        fs::write(&path, report_text(report)).map_err(|e| Error::io(&path, e))
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
    /// Pixel format of each level.
    pub(super) pixels: Vec<String>,
    /// Texels clamped.
    pub(super) clamped: u64,
    /// Levels stored as floats.
    pub(super) floats: usize,
}

impl Stored {
    fn new(pixels: &[Pixel], clamped: u64) -> Self {
        let floats = pixels.iter().filter(|pixel| **pixel == Pixel::F32).count();
        Self { pixels: pixels.iter().map(|pixel| pixel.name().to_owned()).collect(), clamped, floats }
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

/// The key that names the lobe.
pub(super) const LOBE_KEY: &str = "octaglossLobe";

pub(super) fn report_text(report: &Report) -> String {
    serde_json::to_string_pretty(report).expect("keys are strings") + "\n"
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
