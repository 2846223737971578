//! Environments, and what single queries answer.

use crate::arrays::{Reals, Shown, array, directions, element, shown, view};
use crate::choices;
use crate::errors::{refused, warn, wrong};
use crate::options;
use crate::query::{Asked, Kept, answers, sharpest_of};
use crate::sun::Sun;
use crate::work::run;
use numpy::PyArrayDyn;
use octagloss::harmonics::{MAX_ORDER, scaled, spherical_harmonics};
use octagloss::read::Repairs;
use octagloss::recipes::{Source, TableOptions};
use octagloss::suns::{Sun as FoundSun, Suns};
use octagloss::{
    Environment as Light, Layout, Lobe, MAX_DEGREES, Map, ReflectorSettings, Rgb, exact_luminance, luminance,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::f64::consts::PI;
use std::path::PathBuf;
use std::sync::Arc;

/// Radiance from every direction, for reflections and bakes.
///
/// Make one with from_file or from_array. An environment never changes; its methods may be called from
/// several threads.
#[pyclass(frozen, module = "octagloss")]
pub(crate) struct Environment {
    /// The light, where it comes from, and how it was changed.
    pub(crate) source: Source,
    /// The tables of the last query.
    tables: Kept,
}

impl Shown for Environment {}

impl Environment {
    fn new(source: Source) -> Self {
        Self { source, tables: Arc::default() }
    }

    pub(crate) fn light(&self) -> Arc<Light> {
        Arc::clone(&self.source.environment)
    }
}

/// Shape of the array of an environment's texels.
pub(crate) fn shape_of(layout: Layout) -> Vec<usize> {
    let (width, height) = layout.sides();
    let image = [height as usize, width as usize, 3];
    match layout {
        Layout::Cube { .. } => [&[6], &image[..]].concat(),
        _ => image.to_vec(),
    }
}

/// The layout of an array of `shape`.
fn layout_of(map: Map, shape: &[usize]) -> PyResult<Layout> {
    let side = |length: usize| {
        u32::try_from(length)
            .ok()
            .filter(|length| (1..=1 << 16).contains(length))
            .ok_or_else(|| wrong(format!("`array` has the shape {}; sides must be 1 to 65536", shown(shape))))
    };
    match (map, shape) {
        (Map::Panorama, [height, width, 3]) => {
            Ok(Layout::Panorama { width: side(*width)?, height: side(*height)? })
        }
        (Map::Cube, [6, rows, columns, 3]) if rows == columns => Ok(Layout::Cube { size: side(*rows)? }),
        (Map::Octahedral, [rows, columns, 3]) if rows == columns => {
            Ok(Layout::Octahedral { size: side(*rows)? })
        }
        _ => {
            let needed = match map {
                Map::Panorama => "(height, width, 3)",
                Map::Cube => "(6, n, n, 3)",
                Map::Octahedral => "(n, n, 3)",
            };
            let shape = shown(shape);
            Err(wrong(format!("`array` has the shape {shape}; the layout {map} needs {needed}")))
        }
    }
}

/// The texels of an array: finite, not negative, and within float32.
fn texels_of(array: &Reals<'_>) -> PyResult<Vec<Rgb>> {
    let values: Vec<f32> = match array {
        Reals::Single(array) => array.as_slice()?.to_vec(),
        Reals::Double(array) => array.as_slice()?.iter().map(|value| *value as f32).collect(),
    };
    if let Some(at) = values.iter().position(|value| !(value.is_finite() && *value >= 0.0)) {
        let value = match array {
            Reals::Single(_) => f64::from(values[at]),
            Reals::Double(array) => array.as_slice()?[at],
        };
        let place = element("array", array.shape(), at);
        let most = f32::MAX;
        return Err(wrong(format!(
            "{place} is {value:?}; radiance must be finite, not negative, and at most {most:e}"
        )));
    }
    let (texels, rest) = values.as_chunks::<3>();
    debug_assert!(rest.is_empty(), "three channels");
    Ok(texels.to_vec())
}

type Doubles<'py> = Bound<'py, PyArrayDyn<f64>>;

/// A path, or the six of a cube's faces.
fn paths_of(object: &Bound<'_, PyAny>) -> PyResult<Vec<PathBuf>> {
    if let Ok(path) = object.extract() {
        return Ok(vec![path]);
    }
    if let Ok(paths) = object.extract() {
        return Ok(paths);
    }
    let given = object.get_type().name()?;
    Err(PyTypeError::new_err(format!("`path` is of the type {given}; a path, or a list of six, is needed")))
}

#[pymethods]
impl Environment {
    /// Reads an image (.exr, .hdr, .png, .jpg), a cube (.ktx2, .ktx, .dds), a bake, or six images as one
    /// cube.
    ///
    /// layout: auto (the map that the header names, else by the aspect ratio), equirect, cross, strip, faces
    /// or octahedral. rotate_y: degrees about +Y; +90 maps +Z to +X. mirror: flip left to right. scale: a
    /// factor for the radiance. crop: remove the black bars of a panorama that is not 2:1. pad: black or
    /// edge, fill one up to 2:1. sanitize: repair NaN and Inf. strict: treat any repair as an error.
    ///
    /// Raises OSError for a file that cannot be read, InputError for one that is not an environment.
    #[staticmethod]
    #[pyo3(signature = (path, **options))]
    fn from_file(
        py: Python<'_>,
        path: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let options = options::input(py, options)?;
        let paths = paths_of(path)?;
        let source = run(py, move |_, pool| pool.install(|| options.open(&paths)))?;
        for warning in &source.warnings {
            warn(py, &format!("{}: {warning}", source.input))?;
        }
        Ok(Self::new(source))
    }

    /// Takes linear radiance from an array of real numbers.
    ///
    /// layout: panorama, of shape (height, width, 3); cube, (6, n, n, 3) with the faces +X -X +Y -Y +Z -Z; or
    /// octahedral, (n, n, 3). The numbers are copied, as float32.
    #[staticmethod]
    #[pyo3(signature = (array, layout="panorama", *, rotate_y=0.0, mirror=false))]
    fn from_array(array: &Bound<'_, PyAny>, layout: &str, rotate_y: f64, mirror: bool) -> PyResult<Self> {
        check_degrees("rotate_y", rotate_y)?;
        let map = choices::layout(layout)?;
        let array = Reals::of(array, "array")?;
        let layout = layout_of(map, array.shape())?;
        let light = Light::new(layout, texels_of(&array)?).map_err(refused)?;
        let source = Source::new(light, "array".to_owned(), map.name());
        Ok(Self::new(source.turned(mirror, rotate_y).map_err(refused)?))
    }

    /// Layout of the texels: panorama, cube or octahedral.
    #[getter]
    fn layout(&self) -> &'static str {
        self.source.environment.layout().map().name()
    }

    /// Shape of the texels: (height, width, 3), or (6, n, n, 3) for a cube.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, shape_of(self.source.environment.layout()))
    }

    /// The texels as stored, float32, without rotation and mirroring: a read-only array, not a copy.
    #[getter]
    fn texels<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let shape = shape_of(slf.get().source.environment.layout());
        view(slf, |environment| environment.source.environment.texels().as_flattened(), &shape)
    }

    /// Warnings of reading the file.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.source.warnings.clone()
    }

    /// Repairs of reading the file: how many values were negative, nan or infinite, and
    /// negative_energy_share.
    #[getter]
    fn repaired<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Repairs { negative, nan, infinite, negative_energy_share } = self.source.repaired;
        let repaired = PyDict::new(py);
        repaired.set_item("negative", negative)?;
        repaired.set_item("nan", nan)?;
        repaired.set_item("infinite", infinite)?;
        repaired.set_item("negative_energy_share", negative_energy_share)?;
        Ok(repaired)
    }

    /// World directions of the texels' centres and their solid angles, shaped as the texels: (..., 3) and
    /// (...), float64.
    fn texel_directions<'py>(&self, py: Python<'py>) -> PyResult<(Doubles<'py>, Doubles<'py>)> {
        let light = self.light();
        let (centres, solid_angles) = run(py, move |_, _| {
            let (mut centres, mut solid_angles) = (Vec::new(), Vec::new());
            light.for_each_texel(|direction, solid_angle, _| {
                centres.extend(direction.to_array());
                solid_angles.push(solid_angle);
            });
            Ok((centres, solid_angles))
        })?;
        let shape = shape_of(self.source.environment.layout());
        let without_channels = shape[..shape.len() - 1].to_vec();
        Ok((array(py, centres, shape)?, array(py, solid_angles, without_channels)?))
    }

    /// The same environment rotated about +Y; +90 degrees maps +Z to +X.
    fn rotated_y(&self, degrees: f64) -> PyResult<Self> {
        check_degrees("degrees", degrees)?;
        Ok(Self::new(self.source.clone().turned(false, degrees).map_err(refused)?))
    }

    /// Radiance of a lobe around each direction: float32 of shape (..., 3) for directions (..., 3) of any
    /// length but zero.
    ///
    /// roughness: perceptual, in [0, 1], 0 for a mirror: one number, or one for each direction; its shape and
    /// that of the directions broadcast, so (n, 1, 3) and (9,) give (n, 9, 3). The cosine lobe has none.
    /// lobe: ggx, phong, cone, cosine or charlie. filter: adaptive:E (certified, E the relative RMS error
    /// over the sphere), pyramid (the real-time tier), box, or reference (exhaustive integration).
    ///
    /// bounds: return (radiance, bounds), where bounds (..., 4) certify the errors of luminance, red, green
    /// and blue. They need adaptive:E. Mirrors are look-ups without bounds: theirs are infinite.
    ///
    /// oem_size, border: edge and border of the octahedral map. sharpest: the least roughness above 0 that
    /// the tables are made for; by default the least of roughness. Tables are kept until a call needs other
    /// ones: pass the same sharpest to calls of different roughness to share them.
    #[pyo3(signature = (directions, roughness=None, *, lobe="ggx", filter="adaptive:0.005", bounds=false,
        oem_size=None, border=None, sharpest=None))]
    #[expect(clippy::too_many_arguments, reason = "named in Python")]
    fn reflect<'py>(
        &self,
        py: Python<'py>,
        directions: &Bound<'py, PyAny>,
        roughness: Option<&Bound<'py, PyAny>>,
        lobe: &str,
        filter: &str,
        bounds: bool,
        oem_size: Option<u32>,
        border: Option<u32>,
        sharpest: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (lobe, filter) = (choices::lobe(lobe)?, choices::filter(filter)?);
        let asked = Asked::of(lobe, directions, roughness)?;
        let sharpest = sharpest_of(lobe, &asked.roughness, sharpest)?;
        let settings = TableOptions { oem_size, border, scan: None }.reflector(filter, sharpest);
        answers(py, (self.light(), Arc::clone(&self.tables)), asked, (lobe, filter), settings, (bounds, 1.0))
    }

    /// Irradiance on surfaces of the given normals (..., 3): the integral of radiance times the cosine,
    /// float32 of shape (..., 3). Divide by pi for the radiance of a white diffuse surface.
    ///
    /// filter and bounds as in reflect.
    #[pyo3(signature = (normals, *, filter="adaptive:0.005", bounds=false, oem_size=None))]
    fn irradiance<'py>(
        &self,
        py: Python<'py>,
        normals: &Bound<'py, PyAny>,
        filter: &str,
        bounds: bool,
        oem_size: Option<u32>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let filter = choices::filter(filter)?;
        let (directions, shape) = directions(normals, "normals")?;
        let asked = Asked { roughness: vec![1.0; directions.len()], directions, shape };
        let settings = ReflectorSettings { oem_size, sharpest: 1.0, ..ReflectorSettings::default() };
        let light = (self.light(), Arc::clone(&self.tables));
        answers(py, light, asked, (Lobe::Cosine, filter), settings, (bounds, PI))
    }

    /// Spherical harmonics: float64 of shape ((order + 1)^2, 3), real and orthonormal, in the order L0; L1 by
    /// y, z, x; L2 by xy, yz, 3z^2 - 1, zx, x^2 - y^2; and so on up to order 4.
    ///
    /// window: none, hanning:W, lanczos:W, sinc4:W or nonnegative. scale: radiance; irradiance, multiplied by
    /// the cosine lobe's pi, 2 pi/3, pi/4, 0, -pi/24; or filament, irradiance over pi with the constants of
    /// the basis (order 2 only).
    #[pyo3(signature = (order=2, *, window="none", scale="radiance"))]
    fn sh<'py>(&self, py: Python<'py>, order: u32, window: &str, scale: &str) -> PyResult<Doubles<'py>> {
        if order > MAX_ORDER {
            return Err(wrong(format!("`order` is {order}; it must be 0 to {MAX_ORDER}")));
        }
        let (window, name, scale) = (choices::sh_window("window", window)?, scale, choices::sh_scale(scale)?);
        if name == "filament" && order != 2 {
            return Err(wrong(format!("`scale` filament is for `order` 2, not {order}")));
        }
        let light = self.light();
        let coefficients = run(py, move |_, pool| {
            let radiance = pool.install(|| spherical_harmonics(&light, order))?;
            Ok(scaled(&window.apply(&radiance)?, scale))
        })?;
        let count = coefficients.len();
        array(py, coefficients.into_flattened(), vec![count, 3])
    }

    /// The brightest region: a Sun, whose is_sun says whether it is one; None if nothing stands out.
    fn sun(&self, py: Python<'_>) -> PyResult<Option<Sun>> {
        let light = self.light();
        run(py, move |_, pool| {
            Ok(pool.install(|| {
                let sun = FoundSun::find(&light)?;
                let mut energy = 0.0;
                light.for_each_texel(|_, solid_angle, texel| {
                    energy += solid_angle * f64::from(luminance(texel));
                });
                let share = exact_luminance(sun.irradiance) / energy;
                Some(Sun::new(&sun, share))
            }))
        })
    }

    /// Splits off the sun: (environment without it, Sun), or None if there is no sun. Their energies add up.
    fn extract_sun(&self, py: Python<'_>) -> PyResult<Option<(Self, Sun)>> {
        let (rest, mut suns) = self.parted(py, Suns::Brightest)?;
        Ok(suns.pop().map(|sun| (rest, sun)))
    }

    /// Splits off the lights that `which` selects: (environment without them, list of Suns). `which` is their
    /// number (those of the greatest irradiance), or text as for the command line's --extract-sun. Warns
    /// about lights that stay.
    fn extract_suns(&self, py: Python<'_>, which: &Bound<'_, PyAny>) -> PyResult<(Self, Vec<Sun>)> {
        let text = which.str()?.to_string();
        let suns = Suns::parsed(&text).map_err(|needed| wrong(format!("`which` is {text:?}; {needed}")))?;
        self.parted(py, suns)
    }

    fn __repr__(&self) -> String {
        let shape = shown(&shape_of(self.source.environment.layout()));
        format!("<octagloss.Environment: {} {shape} of {}>", self.layout(), self.source.input)
    }
}

impl Environment {
    /// Splits off `suns`; warns about lights that stay.
    fn parted(&self, py: Python<'_>, suns: Suns) -> PyResult<(Self, Vec<Sun>)> {
        let (source, asked) = (self.source.clone(), suns.clone());
        let (known, warned) = (source.suns.len(), source.warnings.len());
        let mut source = run(py, move |_, pool| pool.install(|| source.without(Some(&asked))))?;
        let warnings = source.warnings.split_off(warned);
        let found: Vec<Sun> = source.suns[known..].iter().map(|sun| Sun::of(sun, true)).collect();
        if suns != Suns::Brightest || !found.is_empty() {
            for warning in warnings {
                warn(py, &warning)?;
            }
        }
        if found.is_empty() {
            source.options.extract_sun.clone_from(&self.source.options.extract_sun);
        }
        Ok((Self::new(source), found))
    }
}

fn check_degrees(name: &str, value: f64) -> PyResult<()> {
    if value.abs() <= MAX_DEGREES {
        return Ok(());
    }
    Err(wrong(format!("`{name}` is {value}; it must be finite and at most {MAX_DEGREES} either way")))
}
