//! Bakes: prefiltered levels as arrays or files, and the DFG table.

use crate::arrays::{Shown, array, view};
use crate::choices;
use crate::environment::{Environment, shape_of};
use crate::errors::{raised, warn, wrong};
use crate::options;
use crate::output::{check, planned, write};
use crate::work::run;
use numpy::PyArrayDyn;
use octagloss::files::Overflow;
use octagloss::recipes::{Recipe, Source};
use octagloss::reflectance::{DfgBlue, dfg_table};
use octagloss::{Bake as CoreBake, BakeSettings, Level as CoreLevel, LevelStats, bake_all};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// A prefiltered chain of levels, and what belongs to it.
#[pyclass(frozen, module = "octagloss")]
pub(crate) struct Bake {
    pub(crate) core: Arc<CoreBake>,
    pub(crate) settings: BakeSettings,
    /// Without options of files.
    pub(crate) recipe: Recipe,
    pub(crate) source: Source,
    /// Wall time in seconds.
    pub(crate) seconds: f64,
}

/// One level of a bake.
#[pyclass(frozen, module = "octagloss")]
pub(crate) struct Level {
    bake: Arc<CoreBake>,
    part: Part,
}

/// A level's place in a bake.
#[derive(Clone, Copy)]
enum Part {
    Chain(usize),
    Sheen(usize),
    Irradiance,
    Skybox,
}

// The levels are those of a shared bake, which never changes.
impl Shown for Level {}

impl Level {
    fn core(&self) -> &CoreLevel {
        let CoreBake { chain, sheen, irradiance, skybox, .. } = &*self.bake;
        match self.part {
            Part::Chain(index) => &chain.levels[index],
            Part::Sheen(index) => &sheen.as_ref().expect("made with sheen").levels[index],
            Part::Irradiance => irradiance.as_ref().expect("made with irradiance"),
            Part::Skybox => skybox.as_ref().expect("made with a skybox"),
        }
    }

    fn stats(&self) -> Option<&LevelStats> {
        match self.part {
            Part::Chain(index) => self.bake.stats.get(index),
            Part::Sheen(index) => self.bake.sheen_stats.get(index),
            Part::Irradiance | Part::Skybox => None,
        }
    }
}

#[pymethods]
impl Level {
    /// Perceptual roughness in [0, 1].
    #[getter]
    fn roughness(&self) -> f64 {
        self.core().roughness
    }

    /// Layout of the texels: cube, panorama or octahedral.
    #[getter]
    fn layout(&self) -> &'static str {
        self.core().layout.map().name()
    }

    /// Radiance, float32: (6, n, n, 3) for a cube with the faces +X -X +Y -Y +Z -Z, else (height, width, 3).
    /// A read-only array, not a copy.
    #[getter]
    fn texels<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let shape = shape_of(slf.get().core().layout);
        view(slf, |level| level.core().texels.as_flattened(), &shape)
    }

    /// Certified bound on the luminance error of each texel, float32, shaped as the texels without channels;
    /// None for mirrors, and for bakes without bounds. A read-only array, not a copy.
    #[getter]
    fn bounds<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyAny>>> {
        if slf.get().core().bounds.is_none() {
            return Ok(None);
        }
        let shape = shape_of(slf.get().core().layout);
        let shape = &shape[..shape.len() - 1];
        view(slf, |level| level.core().bounds.as_deref().unwrap_or_default(), shape).map(Some)
    }

    /// Greatest certified bound, absolute luminance; None if the filter has none.
    #[getter]
    fn error_bound_max(&self) -> Option<f64> {
        self.stats()?.error_bound_max
    }

    /// Mean certified bound, absolute luminance; None if the filter has none.
    #[getter]
    fn error_bound_mean(&self) -> Option<f64> {
        self.stats()?.error_bound_mean
    }

    /// Leaves of the quadrature per texel; None if the filter has none.
    #[getter]
    fn leaves_per_texel(&self) -> Option<f64> {
        self.stats()?.leaves_per_texel
    }

    fn __repr__(&self) -> String {
        let (width, height) = self.core().layout.sides();
        format!("<octagloss.Level: {} {width}x{height}, roughness {:.4}>", self.layout(), self.roughness())
    }
}

#[pymethods]
impl Bake {
    /// The levels, the sharpest first.
    #[getter]
    fn levels(&self) -> Vec<Level> {
        (0..self.core.chain.levels.len()).map(|index| self.level(Part::Chain(index))).collect()
    }

    /// The levels of the Charlie lobe, for targets with sheen; else empty.
    #[getter]
    fn sheen(&self) -> Vec<Level> {
        let count = self.core.sheen.as_ref().map_or(0, |sheen| sheen.levels.len());
        (0..count).map(|index| self.level(Part::Sheen(index))).collect()
    }

    /// The irradiance cube, over pi; None if not requested.
    #[getter]
    fn irradiance(&self) -> Option<Level> {
        self.core.irradiance.is_some().then(|| self.level(Part::Irradiance))
    }

    /// The unfiltered environment; None if not requested.
    #[getter]
    fn skybox(&self) -> Option<Level> {
        self.core.skybox.is_some().then(|| self.level(Part::Skybox))
    }

    /// Spherical harmonics of the source, windowed, as of Environment.sh.
    #[getter]
    fn sh<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        array(py, self.core.sh.as_flattened().to_vec(), vec![self.core.sh.len(), 3])
    }

    /// Edge of the octahedral map.
    #[getter]
    fn oem_size(&self) -> u32 {
        self.core.oem.inner
    }

    /// Energy of the source, radiance times solid angle: red, green and blue.
    #[getter]
    fn source_energy(&self) -> (f64, f64, f64) {
        self.core.source_energy.into()
    }

    /// Energy of the octahedral map.
    #[getter]
    fn oem_energy(&self) -> (f64, f64, f64) {
        self.core.oem_energy.into()
    }

    /// Warnings of the bake.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.core.warnings.clone()
    }

    /// Name of the target; None without one.
    #[getter]
    fn target(&self) -> Option<&'static str> {
        self.recipe.target.first().map(|target| target.name)
    }

    /// Writes the bake. All files appear whole, or none does.
    ///
    /// Without a target: a .ktx2, .ktx or .dds file, or with container exr or hdr a folder of images. With a
    /// target: a folder with the target's files and report.json, named after name, by default the input.
    ///
    /// container: ktx2, ktx, dds, exr or hdr; by default that of the path, or the target's. pixel: f16, f32,
    /// rgb9e5, r11g11b10f or bc6h. overflow: clamp, compress or error, for radiance above the range of pixel.
    /// force: replace existing files.
    #[pyo3(signature = (path, *, container=None, pixel=None, overflow="clamp", name=None, force=false))]
    #[expect(clippy::too_many_arguments, reason = "named in Python")]
    fn write(
        &self,
        py: Python<'_>,
        path: PathBuf,
        container: Option<&str>,
        pixel: Option<&str>,
        overflow: &str,
        name: Option<String>,
        force: bool,
    ) -> PyResult<()> {
        let files = json!({"format": container, "pixel": pixel, "overflow": overflow, "name": name});
        let files = files.as_object().expect("an object").clone();
        self.write_by(py, path, options::parsed(py, files)?, force)
    }

    fn __repr__(&self) -> String {
        let levels = &self.core.chain.levels;
        let of = self.target().map_or_else(String::new, |target| format!(" for {target}"));
        let (size, count) = (self.settings.size, levels.len());
        format!("<octagloss.Bake: {} {size}, {count} levels{of}>", self.settings.map)
    }
}

impl Bake {
    fn level(&self, part: Part) -> Level {
        Level { bake: Arc::clone(&self.core), part }
    }

    /// Writes the bake with the options of `files` that are about files.
    fn write_by(&self, py: Python<'_>, path: PathBuf, files: Recipe, force: bool) -> PyResult<()> {
        let place = path.display().to_string();
        let Recipe { format, pixel, overflow, name, .. } = files;
        let recipe = Recipe { format, pixel, overflow, name, ..self.recipe.clone() };
        let plan = planned(py, &path, &recipe, &self.source)?;
        let (bake, source, seconds) = (Arc::clone(&self.core), self.source.clone(), self.seconds);
        let warnings = run(py, move |cancel, pool| {
            pool.install(|| write(&bake, seconds, &plan, &source, &path, force, cancel))
        })?;
        warnings.iter().try_for_each(|warning| warn(py, &format!("{place}: {warning}")))
    }
}

/// Bakes an environment into prefiltered levels.
///
/// size: edge of level 0, for a panorama its height. levels: their number. ladder: linear, filament, unity or
/// babylon, the roughness of each. layout: cube, panorama or octahedral. lobe and filter as in
/// Environment.reflect. chain: sampled, solved for trilinear look-ups, or mixed, sampled
/// where sharp and solved above; by default mixed for cubes of ggx without a target, bounds or another ladder
/// or filter, else sampled. bounds: keep every texel's certified
/// bound. irradiance, skybox: edges of additional cubes; skybox may be "source". sh_order, sh_window: of the
/// spherical harmonics. oem_size, border, scan: of the octahedral map and its summed-area table.
///
/// target: the preset of an engine; it sets size, levels, ladder and layout unless given; flip and diffuse
/// change it, and map, octahedral or cube, that of a pyramid. output: a path to write to, as Bake.write does,
/// with container, pixel, overflow, name and force.
#[pyfunction]
#[pyo3(signature = (environment, *, output=None, force=false, **options))]
pub(crate) fn bake(
    py: Python<'_>,
    environment: &Environment,
    output: Option<PathBuf>,
    force: bool,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Bake> {
    let recipe = options::recipe(py, options)?;
    let Recipe { format, pixel, name, .. } = &recipe;
    if output.is_none() && (format.is_some() || pixel.is_some() || name.is_some() || force) {
        return Err(wrong("`container`, `pixel`, `name` and `force` are for `output`, which is missing"));
    }
    let levels =
        Recipe { format: None, pixel: None, overflow: Overflow::default(), name: None, ..recipe.clone() };
    let settings = match levels.target.first() {
        Some(target) => levels.targeted(target).map(|plan| plan.settings),
        None => levels.untargeted_settings(),
    };
    let source = environment.source.clone();
    let settings = BakeSettings {
        skybox: levels.skybox.map(|skybox| skybox.edge(source.environment.layout())),
        ..settings.map_err(|error| raised(py, &error))?
    };
    let (light, theirs) = (Arc::clone(&source.environment), settings.clone());
    let start = Instant::now();
    // An output that cannot be written is reported before the bake.
    if let Some(path) = &output {
        let plan = planned(py, path, &recipe, &source)?;
        check(path, &plan, force).map_err(|error| raised(py, &error))?;
    }
    let core = run(py, move |cancel, pool| {
        let progress = |_| if cancel.is_set() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let mut bakes = pool.install(|| bake_all(&light, std::slice::from_ref(&theirs), &progress))?;
        Ok(bakes.pop().expect("one bake for one settings"))
    })?;
    for warning in &core.warnings {
        warn(py, warning)?;
    }
    let seconds = start.elapsed().as_secs_f64();
    let bake = Bake { core: Arc::new(core), settings, recipe: levels, source, seconds };
    if let Some(path) = output {
        bake.write_by(py, path, recipe, force)?;
    }
    Ok(bake)
}

/// The split-sum DFG (BRDF integration) table: float32 of shape (size, size, 2), with charlie (size, size,
/// 3).
///
/// Row j has the perceptual roughness (j + 1/2)/size, column i the cosine of the view angle (i + 1/2)/size.
/// form: split-sum, specular = f0 red + f90 green; or multiple-scattering, specular = mix(red, green, f0),
/// times 1 + f0 (1/green - 1). charlie: the third channel is the directional albedo of Charlie (sheen).
#[pyfunction]
#[pyo3(signature = (size=128, *, form="split-sum", charlie=false))]
pub(crate) fn dfg<'py>(
    py: Python<'py>,
    size: u32,
    form: &str,
    charlie: bool,
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let form = choices::dfg_form(form)?;
    let blue = if charlie { DfgBlue::Charlie } else { DfgBlue::Empty };
    let table = run(py, move |_, pool| pool.install(|| dfg_table(size, form, blue)))?;
    let channels = if charlie { 3 } else { 2 };
    let values: Vec<f32> = table.texels.iter().flat_map(|texel| &texel[..channels]).copied().collect();
    array(py, values, vec![size as usize, size as usize, channels])
}
