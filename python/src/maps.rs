//! Maps of the sphere, for arrays of directions and points.

use crate::arrays::{array, directions, element, points, with_axis};
use crate::errors::{refused, wrong};
use glam::{DVec2, DVec3};
use numpy::PyArrayDyn;
use octagloss::maps::{MAPS, NamedMap, Place, named};
use pyo3::prelude::*;
use std::f64::consts::{PI, TAU};

type Doubles<'py> = Bound<'py, PyArrayDyn<f64>>;
/// Least and greatest coordinates.
type Rectangle = ((f64, f64), (f64, f64));
type Indices<'py> = Bound<'py, PyArrayDyn<i64>>;

/// An array of vectors of `N` components.
fn vectors<const N: usize>(
    py: Python<'_>,
    values: Vec<impl Into<[f64; N]>>,
    shape: Vec<usize>,
) -> PyResult<Doubles<'_>> {
    let rows: Vec<[f64; N]> = values.into_iter().map(Into::into).collect();
    array(py, rows.into_flattened(), with_axis(shape, N))
}

/// Rejects points outside the rectangle from `low` to `high`.
fn check_inside(uv: &[DVec2], shape: &[usize], low: DVec2, high: DVec2) -> PyResult<()> {
    let outside = uv.iter().position(|p| p.cmplt(low).any() || p.cmpgt(high).any());
    let Some(at) = outside else { return Ok(()) };
    let [given, low, high] = [uv[at], low, high].map(|p| format!("{}, {}", p.x, p.y));
    let place = element("uv", shape, at);
    Err(wrong(format!("{place} is {given}; it must be from {low} to {high}")))
}

/// The map that the package has a name of its own for.
fn known(name: &str) -> &'static NamedMap {
    named(name).expect("one of the maps")
}

/// The points of `map` at directions (..., 3): components, points in units of `unit`, and their shape.
fn places(
    map: &NamedMap,
    given: &Bound<'_, PyAny>,
    unit: DVec2,
) -> PyResult<(Vec<i64>, Vec<DVec2>, Vec<usize>)> {
    let (values, shape) = directions(given, "directions")?;
    let places = values.into_iter().map(|direction| map.place(direction));
    let places = places.collect::<octagloss::Result<Vec<_>>>().map_err(refused)?;
    let (components, uv) =
        places.into_iter().map(|place| (i64::from(place.component), place.uv / unit)).unzip();
    Ok((components, uv, shape))
}

/// Unit directions (..., 3) at points `uv` (..., 2) of `component`, in units of `unit`.
fn shown_at<'py>(
    map: &NamedMap,
    component: u32,
    uv: &Bound<'py, PyAny>,
    unit: DVec2,
) -> PyResult<Doubles<'py>> {
    let rectangle = map.component(component).map_err(refused)?;
    let (values, shape) = points(uv, "uv")?;
    check_inside(&values, &shape, rectangle.low / unit, rectangle.high / unit)?;
    let direction = |uv| map.direction(Place { component, uv: uv * unit });
    let found = values.into_iter().map(direction).collect::<octagloss::Result<Vec<DVec3>>>();
    vectors(uv.py(), found.map_err(refused)?, shape)
}

/// The map's own coordinates of a panorama are angles.
const PANORAMA: DVec2 = DVec2::new(TAU, PI);

/// Panorama coordinates (..., 2) of directions (..., 3): u and v in [0, 1], v downwards.
#[pyfunction]
#[pyo3(signature = (directions, /))]
pub(crate) fn equirect_from_direction<'py>(directions: &Bound<'py, PyAny>) -> PyResult<Doubles<'py>> {
    let (_, uv, shape) = places(known("equirect"), directions, PANORAMA)?;
    vectors(directions.py(), uv, shape)
}

/// Unit directions (..., 3) of panorama coordinates (..., 2) in [0, 1].
#[pyfunction]
#[pyo3(signature = (uv, /))]
pub(crate) fn direction_from_equirect<'py>(uv: &Bound<'py, PyAny>) -> PyResult<Doubles<'py>> {
    shown_at(known("equirect"), 0, uv, PANORAMA)
}

/// Octahedral coordinates (..., 2) in [-1, 1] of directions (..., 3): u along x, v along z, +Y at the centre.
#[pyfunction]
#[pyo3(signature = (directions, /))]
pub(crate) fn oct_from_direction<'py>(directions: &Bound<'py, PyAny>) -> PyResult<Doubles<'py>> {
    let (_, uv, shape) = places(known("octahedral"), directions, DVec2::ONE)?;
    vectors(directions.py(), uv, shape)
}

/// Unit directions (..., 3) of octahedral coordinates (..., 2) in [-1, 1].
#[pyfunction]
#[pyo3(signature = (uv, /))]
pub(crate) fn direction_from_oct<'py>(uv: &Bound<'py, PyAny>) -> PyResult<Doubles<'py>> {
    shown_at(known("octahedral"), 0, uv, DVec2::ONE)
}

/// Faces (...) and coordinates (..., 2) in [-1, 1] of directions (..., 3). Faces are +X -X +Y -Y +Z -Z.
#[pyfunction]
#[pyo3(signature = (directions, /))]
pub(crate) fn cube_from_direction<'py>(
    directions: &Bound<'py, PyAny>,
) -> PyResult<(Indices<'py>, Doubles<'py>)> {
    map_from_direction("cube", directions)
}

/// Unit directions (..., 3) of coordinates (..., 2) in [-1, 1] on one face, 0 to 5, of a cube.
#[pyfunction]
#[pyo3(signature = (face, uv, /))]
pub(crate) fn direction_from_cube<'py>(face: u32, uv: &Bound<'py, PyAny>) -> PyResult<Doubles<'py>> {
    if face > 5 {
        return Err(wrong(format!("`face` is {face}; it must be 0 to 5, for +X -X +Y -Y +Z -Z")));
    }
    shown_at(known("cube"), face, uv, DVec2::ONE)
}

fn map_named(name: &str) -> PyResult<&'static NamedMap> {
    named(name).ok_or_else(|| wrong(format!("`name` is {name:?}; choose one of {}", map_names().join(", "))))
}

/// Names of all maps of the sphere.
#[pyfunction]
pub(crate) fn map_names() -> Vec<&'static str> {
    MAPS.iter().map(|row| row.name).collect()
}

/// Rectangles of a map, one for each component: ((u, v) least, (u, v) greatest).
#[pyfunction]
pub(crate) fn map_components(name: &str) -> PyResult<Vec<Rectangle>> {
    let map = map_named(name)?;
    let rectangle =
        |index| map.component(index).map(|component| (component.low.into(), component.high.into()));
    (0..map.components()).map(rectangle).collect::<octagloss::Result<_>>().map_err(refused)
}

/// Components (...) and coordinates (..., 2) of directions (..., 3) on a map.
#[pyfunction]
#[pyo3(signature = (name, directions, /))]
pub(crate) fn map_from_direction<'py>(
    name: &str,
    directions: &Bound<'py, PyAny>,
) -> PyResult<(Indices<'py>, Doubles<'py>)> {
    let (components, uv, shape) = places(map_named(name)?, directions, DVec2::ONE)?;
    Ok((array(directions.py(), components, shape.clone())?, vectors(directions.py(), uv, shape)?))
}

/// Unit directions (..., 3) of coordinates (..., 2) on one component of a map.
#[pyfunction]
#[pyo3(signature = (name, uv, /, component=0))]
pub(crate) fn direction_from_map<'py>(
    name: &str,
    uv: &Bound<'py, PyAny>,
    component: u32,
) -> PyResult<Doubles<'py>> {
    shown_at(map_named(name)?, component, uv, DVec2::ONE)
}

/// Steradians per unit of area (...) at coordinates (..., 2) of one component of a map; 0 where the map
/// shows no direction.
#[pyfunction]
#[pyo3(signature = (name, uv, /, component=0))]
pub(crate) fn map_density<'py>(name: &str, uv: &Bound<'py, PyAny>, component: u32) -> PyResult<Doubles<'py>> {
    let map = map_named(name)?;
    let rectangle = map.component(component).map_err(refused)?;
    let (values, shape) = points(uv, "uv")?;
    check_inside(&values, &shape, rectangle.low, rectangle.high)?;
    let found =
        values.into_iter().map(|uv| map.density(Place { component, uv })).collect::<octagloss::Result<_>>();
    array(uv.py(), found.map_err(refused)?, shape)
}
