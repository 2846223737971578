//! Maps of the sphere, for arrays of directions and points.

use crate::arrays::{array, directions, element, points, with_axis};
use crate::errors::wrong;
use glam::{DVec2, DVec3};
use numpy::PyArrayDyn;
use octagloss::maps::cube::{Face, cube_from_direction as to_cube, direction_from_cube as from_cube};
use octagloss::maps::equirect::{
    direction_from_equirect as from_equirect, equirect_from_direction as to_equirect,
};
use octagloss::maps::octahedral::{direction_from_oct as from_oct, oct_from_direction as to_oct};
use octagloss::maps::{MAPS, SphereMap, named};
use pyo3::prelude::*;

type Doubles<'py> = Bound<'py, PyArrayDyn<f64>>;
/// Least and greatest coordinates.
type Rectangle = ((f64, f64), (f64, f64));
type Indices<'py> = Bound<'py, PyArrayDyn<i64>>;

fn vectors(py: Python<'_>, values: Vec<DVec3>, shape: Vec<usize>) -> PyResult<Doubles<'_>> {
    let flat = values.into_iter().map(|v| v.to_array()).collect::<Vec<_>>().into_flattened();
    array(py, flat, with_axis(shape, 3))
}

fn pairs(py: Python<'_>, values: Vec<DVec2>, shape: Vec<usize>) -> PyResult<Doubles<'_>> {
    let flat = values.into_iter().map(|v| v.to_array()).collect::<Vec<_>>().into_flattened();
    array(py, flat, with_axis(shape, 2))
}

/// Rejects points outside the rectangle from `low` to `high`.
fn check_inside(uv: &[DVec2], shape: &[usize], low: DVec2, high: DVec2) -> PyResult<()> {
    match uv.iter().position(|p| p.cmplt(low).any() || p.cmpgt(high).any()) {
        None => Ok(()),
        Some(at) => Err(wrong(format!(
            "{} is {}, {}; it must be from {}, {} to {}, {}",
            element("uv", shape, at),
            uv[at].x,
            uv[at].y,
            low.x,
            low.y,
            high.x,
            high.y
        ))),
    }
}

/// Panorama coordinates (..., 2) of directions (..., 3): u and v in [0, 1], v downwards.
#[pyfunction]
#[pyo3(signature = (directions, /))]
pub(crate) fn equirect_from_direction<'py>(directions: &Bound<'py, PyAny>) -> PyResult<Doubles<'py>> {
    let (values, shape) = self::directions(directions, "directions")?;
    let uv = values.into_iter().map(|d| to_equirect(d).into()).collect();
    pairs(directions.py(), uv, shape)
}

/// Unit directions (..., 3) of panorama coordinates (..., 2) in [0, 1].
#[pyfunction]
#[pyo3(signature = (uv, /))]
pub(crate) fn direction_from_equirect<'py>(uv: &Bound<'py, PyAny>) -> PyResult<Doubles<'py>> {
    let (values, shape) = points(uv, "uv")?;
    check_inside(&values, &shape, DVec2::ZERO, DVec2::ONE)?;
    vectors(uv.py(), values.into_iter().map(|uv| from_equirect(uv.x, uv.y)).collect(), shape)
}

/// Octahedral coordinates (..., 2) in [-1, 1] of directions (..., 3): u along x, v along z, +Y at the centre.
#[pyfunction]
#[pyo3(signature = (directions, /))]
pub(crate) fn oct_from_direction<'py>(directions: &Bound<'py, PyAny>) -> PyResult<Doubles<'py>> {
    let (values, shape) = self::directions(directions, "directions")?;
    pairs(directions.py(), values.into_iter().map(to_oct).collect(), shape)
}

/// Unit directions (..., 3) of octahedral coordinates (..., 2) in [-1, 1].
#[pyfunction]
#[pyo3(signature = (uv, /))]
pub(crate) fn direction_from_oct<'py>(uv: &Bound<'py, PyAny>) -> PyResult<Doubles<'py>> {
    let (values, shape) = points(uv, "uv")?;
    check_inside(&values, &shape, DVec2::NEG_ONE, DVec2::ONE)?;
    vectors(uv.py(), values.into_iter().map(from_oct).collect(), shape)
}

/// Faces (...) and coordinates (..., 2) in [-1, 1] of directions (..., 3). Faces are +X -X +Y -Y +Z -Z.
#[pyfunction]
#[pyo3(signature = (directions, /))]
pub(crate) fn cube_from_direction<'py>(
    directions: &Bound<'py, PyAny>,
) -> PyResult<(Indices<'py>, Doubles<'py>)> {
    let (values, shape) = self::directions(directions, "directions")?;
    let places = values.into_iter().map(to_cube);
    let (faces, uv): (Vec<i64>, Vec<DVec2>) =
        places.map(|(face, s, t)| (face.index() as i64, DVec2::new(s, t))).unzip();
    Ok((array(directions.py(), faces, shape.clone())?, pairs(directions.py(), uv, shape)?))
}

/// Unit directions (..., 3) of coordinates (..., 2) in [-1, 1] on one face, 0 to 5, of a cube.
#[pyfunction]
#[pyo3(signature = (face, uv, /))]
pub(crate) fn direction_from_cube<'py>(face: usize, uv: &Bound<'py, PyAny>) -> PyResult<Doubles<'py>> {
    let Some(face) = Face::ALL.get(face).copied() else {
        return Err(wrong(format!("`face` is {face}; it must be 0 to 5, for +X -X +Y -Y +Z -Z")));
    };
    let (values, shape) = points(uv, "uv")?;
    check_inside(&values, &shape, DVec2::NEG_ONE, DVec2::ONE)?;
    vectors(uv.py(), values.into_iter().map(|uv| from_cube(face, uv.x, uv.y)).collect(), shape)
}

fn map_named(name: &str) -> PyResult<&'static dyn SphereMap> {
    named(name)
        .map(|row| row.map)
        .ok_or_else(|| wrong(format!("`name` is {name:?}; choose one of {}", map_names().join(", "))))
}

/// A map and one of its components.
fn component(name: &str, component: u32) -> PyResult<&'static dyn SphereMap> {
    let map = map_named(name)?;
    if component >= map.components() {
        let last = map.components() - 1;
        return Err(wrong(format!("`component` is {component}; {name} has 0 to {last}")));
    }
    Ok(map)
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
    let rectangle = |index| {
        let component = map.component(index);
        (component.low.into(), component.high.into())
    };
    Ok((0..map.components()).map(rectangle).collect())
}

/// Components (...) and coordinates (..., 2) of directions (..., 3) on a map.
#[pyfunction]
#[pyo3(signature = (name, directions, /))]
pub(crate) fn map_from_direction<'py>(
    name: &str,
    directions: &Bound<'py, PyAny>,
) -> PyResult<(Indices<'py>, Doubles<'py>)> {
    let map = map_named(name)?;
    let (values, shape) = self::directions(directions, "directions")?;
    let places = values.into_iter().map(|direction| map.locate(direction));
    let (components, uv): (Vec<i64>, Vec<DVec2>) =
        places.map(|place| (i64::from(place.component), place.uv)).unzip();
    Ok((array(directions.py(), components, shape.clone())?, pairs(directions.py(), uv, shape)?))
}

/// Unit directions (..., 3) of coordinates (..., 2) on one component of a map.
#[pyfunction]
#[pyo3(signature = (name, uv, /, component=0))]
pub(crate) fn direction_from_map<'py>(
    name: &str,
    uv: &Bound<'py, PyAny>,
    component: u32,
) -> PyResult<Doubles<'py>> {
    let map = self::component(name, component)?;
    let (values, shape) = points(uv, "uv")?;
    let rectangle = map.component(component);
    check_inside(&values, &shape, rectangle.low, rectangle.high)?;
    vectors(uv.py(), values.into_iter().map(|uv| map.direction(component, uv)).collect(), shape)
}

/// Steradians per unit of area (...) at coordinates (..., 2) of one component of a map; 0 where the map
/// shows no direction.
#[pyfunction]
#[pyo3(signature = (name, uv, /, component=0))]
pub(crate) fn map_density<'py>(name: &str, uv: &Bound<'py, PyAny>, component: u32) -> PyResult<Doubles<'py>> {
    let map = self::component(name, component)?;
    let (values, shape) = points(uv, "uv")?;
    let rectangle = map.component(component);
    check_inside(&values, &shape, rectangle.low, rectangle.high)?;
    let density = |uv: DVec2| if map.contains(component, uv) { map.density(component, uv) } else { 0.0 };
    array(uv.py(), values.into_iter().map(density).collect(), shape)
}
