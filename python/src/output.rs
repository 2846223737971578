//! Files of a bake.

use crate::bake::Bake;
use crate::choices;
use crate::environment::Origin;
use crate::errors::{raised, wrong};
use crate::work::Cancel;
use octagloss::files::Overflow;
use octagloss::files::{Container, Existing, OutputLayout, Pixel};
use octagloss::internals::bake::report::{Circumstances, Report};
use octagloss::internals::export::files::{files, metadata};
use octagloss::internals::export::stored::{Stored, recorded};
use octagloss::internals::io::output::{self, Output as File};
use octagloss::targets::{Diffuse, Target, TargetPlan, UNTARGETED};
use octagloss::{Bake as CoreBake, BakeSettings, Error, Map, WriteOptions};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A bake and where to write it.
pub(crate) struct Output {
    bake: Arc<CoreBake>,
    settings: BakeSettings,
    origin: Origin,
    seconds: f64,
    target: Option<TargetPlan>,
    options: WriteOptions,
    path: PathBuf,
    /// Name of the environment in a target's files.
    name: String,
    overflow: Overflow,
}

/// Why an output cannot be written.
pub(crate) enum Refusal {
    Parameter(PyErr),
    Library(Error),
}

impl From<PyErr> for Refusal {
    fn from(error: PyErr) -> Self {
        Self::Parameter(error)
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self::Library(error)
    }
}

impl Refusal {
    pub(crate) fn into_raised(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Parameter(error) => error,
            Self::Library(error) => raised(py, &error),
        }
    }
}

/// Names of container, pixel format and treatment of overflow.
type Names<'a> = (Option<&'a str>, Option<&'a str>, &'a str);

/// Container, pixel format and treatment of overflow.
struct Format {
    container: Option<Container>,
    pixel: Option<Pixel>,
    overflow: Overflow,
}

impl Format {
    /// Parses the names; checks them against `target`.
    fn of((container, pixel, overflow): Names<'_>, target: Option<&'static Target>) -> PyResult<Self> {
        let container = container.map(choices::container).transpose()?;
        let pixel = pixel.map(choices::pixel).transpose()?;
        if let Some(target) = target {
            if !target.has_container() && (container.is_some() || pixel.is_some()) {
                let name = target.name;
                return Err(wrong(format!("target {name} has a fixed format; omit `container` and `pixel`")));
            }
            let is_octahedral = target.map == Map::Octahedral;
            let fits = |container| match container {
                Container::Hdr => false,
                Container::Ktx1 | Container::Dds => !is_octahedral,
                Container::Ktx2 | Container::Exr => true,
            };
            if let Some(container) = container.filter(|container| !fits(*container)) {
                let (own, name) = (container.name(), target.name);
                return Err(wrong(format!(
                    "target {name} does not support `container` {own}; use ktx2 or exr"
                )));
            }
        }
        Ok(Self { container, pixel, overflow: choices::overflow(overflow)? })
    }

    /// The plan of `target` in this format.
    fn plan(&self, target: &'static Target, bake: Option<&CoreBake>) -> octagloss::Result<TargetPlan> {
        let mut plan = TargetPlan::new(target);
        plan.container = self.container.unwrap_or(plan.container);
        plan.pixel = self.pixel.unwrap_or(plan.pixel);
        plan.skybox |= bake.is_some_and(|bake| bake.skybox.is_some());
        // An additional cube.
        plan.diffuse = match plan.diffuse {
            diffuse if bake.is_none_or(|bake| bake.irradiance.is_none()) => diffuse,
            Diffuse::Sh => Diffuse::Both,
            Diffuse::None => Diffuse::Cube,
            diffuse => diffuse,
        };
        plan.check()?;
        Ok(plan)
    }
}

/// The container of the extension of `path`.
fn named_container(path: &Path) -> Option<Container> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    Container::named(&extension)
}

/// The name of a target's files: letters that no file system refuses.
fn check_name(name: Option<&str>, target: Option<&'static Target>) -> PyResult<()> {
    match (name, target) {
        (Some(_), None) => Err(wrong("`name` is for targets; omit it")),
        (Some(name), _) if name.is_empty() || name.starts_with('.') || name.contains(['/', '\\', '\0']) => {
            Err(wrong(format!("`name` is {name:?}; it must be a file name without folders or a leading dot")))
        }
        _ => Ok(()),
    }
}

impl Output {
    /// Fails where [`Output::write`] would, as far as can be known before a bake.
    pub(crate) fn check(
        path: &Path,
        target: Option<&'static Target>,
        names: Names<'_>,
        (map, name): (Map, Option<&str>),
        force: bool,
    ) -> Result<(), Refusal> {
        let format = Format::of(names, target)?;
        check_name(name, target)?;
        let is_folder = match target {
            Some(target) => {
                format.plan(target, None)?;
                true
            }
            None => {
                let container =
                    format.container.or(named_container(path)).ok_or_else(|| no_container(path))?;
                !container.is_single()
            }
        };
        if map != Map::Cube && target.is_none() && !is_folder {
            return Err(not_a_cube().into());
        }
        if is_folder && named_container(path).is_some() {
            return Err(names_a_file(path).into());
        }
        let existing = if force { Existing::Replace } else { Existing::Keep };
        output::recover(path);
        if is_folder {
            output::check_folder(path, existing)?
        } else {
            output::check_file(path, existing)?
        }
        Ok(())
    }

    /// # Errors
    /// `ValueError` for names that are none, and for a format that the path or the target contradicts.
    pub(crate) fn new(
        bake: &Bake,
        path: PathBuf,
        names: Names<'_>,
        name: Option<String>,
        force: bool,
    ) -> PyResult<Self> {
        let format = Format::of(names, bake.target)?;
        check_name(name.as_deref(), bake.target)?;
        let target = bake.target.map(|target| format.plan(target, Some(&bake.core))).transpose();
        let target = target.map_err(|error| wrong(error.to_string()))?;
        let container = format.container.or_else(|| named_container(&path));
        let is_folder = target.is_some() || container.is_some_and(|container| !container.is_single());
        if is_folder && named_container(&path).is_some() {
            return Err(names_a_file(&path));
        }
        if target.is_none() {
            if container.is_none() {
                return Err(no_container(&path));
            }
            if bake.settings.map != Map::Cube && !is_folder {
                return Err(not_a_cube());
            }
        }
        let layout = match bake.settings.map {
            Map::Cube => OutputLayout::Faces,
            Map::Panorama => OutputLayout::Equirect,
            Map::Octahedral => OutputLayout::Octahedral,
        };
        let options = WriteOptions {
            container,
            pixel: format.pixel,
            layout,
            existing: if force { Existing::Replace } else { Existing::Keep },
            metadata: metadata(&bake.settings, &bake.origin.turned),
        };
        let own =
            || Path::new(&bake.origin.input).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        Ok(Self {
            bake: Arc::clone(&bake.core),
            settings: bake.settings.clone(),
            origin: bake.origin.clone(),
            seconds: bake.seconds,
            target,
            options,
            path,
            name: name.or_else(own).unwrap_or_else(|| "environment".to_owned()),
            overflow: format.overflow,
        })
    }

    /// Writes the files; returns warnings, one line each.
    pub(crate) fn write(&self, cancel: &Cancel) -> octagloss::Result<Vec<String>> {
        let Some(plan) = &self.target else {
            // As the library chooses them.
            let pixel = self.options.pixel.unwrap_or(match self.options.container {
                Some(Container::Hdr) => Pixel::Rgbe,
                Some(Container::Exr) => Pixel::Auto,
                _ => Pixel::F16,
            });
            let fitted = self.fitted(pixel)?;
            let bake = fitted.as_ref().map_or(&*self.bake, |(bake, _)| bake);
            cancel.check()?;
            bake.write(&self.path, &self.options)?;
            let clamped = bake.levels().map(|level| pixel.clamped(&level.texels)).sum();
            let plan = TargetPlan { pixel, ..TargetPlan::new(&UNTARGETED) };
            return Ok(Stored::counted(&plan, bake, clamped).warnings);
        };
        let fitted = self.fitted(plan.pixel)?;
        let (bake, compressed) = fitted.as_ref().map_or((&*self.bake, 0), |(bake, count)| (bake, *count));
        let made = files(plan, &self.name, bake, &self.options.metadata)?;
        let stored = Stored::new(plan, bake, &made);
        let warnings = stored.warnings.clone();
        let report = Report::new(&self.settings, bake, self.circumstances(plan, stored));
        let report = recorded(Report { compressed, ..report }, plan, &self.name, &made);
        let report = serde_json::to_string_pretty(&report)
            .map_err(|error| Error::NonFiniteResult { place: format!("JSON, {error}"), value: f64::NAN })?;
        let report = (report + "\n").into_bytes();
        let mut inside: Vec<_> = made.iter().map(|file| (file.path.clone(), &file.bytes[..])).collect();
        inside.push(("report.json".to_owned(), &report));
        cancel.check()?;
        let outputs = [(self.path.clone(), File::Folder(inside))];
        output::commit(output::stage_all(&outputs, self.options.existing)?)?;
        Ok(warnings)
    }

    /// The bake with light that `pixel` can hold, and how many texels were compressed; `None` if it is the
    /// bake itself.
    fn fitted(&self, pixel: Pixel) -> octagloss::Result<Option<(CoreBake, u64)>> {
        if self.overflow == Overflow::Clamp {
            return Ok(None);
        }
        let mut bake = (*self.bake).clone();
        let count = self.overflow.apply_all(&mut bake, pixel)?;
        Ok(Some((bake, count)))
    }

    fn circumstances(&self, plan: &TargetPlan, stored: Stored) -> Circumstances {
        let Origin { input, layout, turned, suns, extract_sun, repaired, warnings: own, sanitize, strict } =
            &self.origin;
        Circumstances {
            input: input.clone(),
            // Arrays have no files.
            input_files: Vec::new(),
            engine: "cpu".to_owned(),
            adapter: None,
            repaired: (*repaired).into(),
            layout: layout.clone(),
            rotate_y: turned.rotate_y.unwrap_or(0.0),
            mirror: turned.mirror.unwrap_or(false),
            scale: turned.scale.unwrap_or(1.0),
            crop: turned.crop.unwrap_or(false),
            pad: turned.pad,
            sanitize: *sanitize,
            strict: *strict,
            extract_sun: extract_sun.clone(),
            sunless: false,
            overflow: self.overflow,
            preview: false,
            suns: suns.clone(),
            format: plan.format_name().to_owned(),
            pixel: plan.pixel.name().to_owned(),
            level_pixels: stored.pixels,
            clamped: stored.clamped,
            clamped_energy_share: stored.clamped_share,
            warnings: [&own[..], &stored.warnings].concat(),
            seconds: self.seconds,
        }
    }
}

fn no_container(path: &Path) -> PyErr {
    wrong(format!("{}: the name ends in none of .ktx2 .ktx .dds; set `container`", path.display()))
}

fn names_a_file(path: &Path) -> PyErr {
    wrong(format!("{}: the output is a folder of files; omit the extension", path.display()))
}

fn not_a_cube() -> PyErr {
    wrong("panoramas and octahedral squares are written as images: set `container` to exr or hdr")
}
