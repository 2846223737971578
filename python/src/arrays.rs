//! NumPy arrays in and out.

use crate::errors::wrong;
use glam::{DVec2, DVec3};
use numpy::ndarray::{ArrayViewD, IxDyn};
use numpy::{
    Element, PyArray1, PyArrayDyn, PyArrayMethods as _, PyReadonlyArrayDyn, PyUntypedArrayMethods as _,
};
use octagloss::queries::unit;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict as _, PyDict, PyTuple};

/// An array of real numbers, row-major.
pub(crate) enum Reals<'py> {
    Single(PyReadonlyArrayDyn<'py, f32>),
    Double(PyReadonlyArrayDyn<'py, f64>),
}

impl<'py> Reals<'py> {
    /// What `numpy.asarray` makes of `object`, the parameter `name`. Copies only what is not an aligned,
    /// row-major array of float32 or float64.
    pub(crate) fn of(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let py = object.py();
        let numpy = py.import("numpy")?;
        let array = numpy.call_method1("asarray", (object,))?;
        let dtype = array.getattr("dtype")?;
        let kind: String = dtype.getattr("kind")?.extract()?;
        if !["f", "i", "u"].contains(&kind.as_str()) {
            return Err(PyTypeError::new_err(format!(
                "`{name}` has the dtype {}; real numbers are needed",
                dtype.str()?
            )));
        }
        let required = |dtype: &str| -> PyResult<Bound<'py, PyAny>> {
            let options = [("requirements", ["C", "A"])].into_py_dict(py)?;
            numpy.call_method("require", (&array, dtype), Some(&options))
        };
        // An array of the other byte order has another dtype.
        let single = numpy.getattr("float32")?;
        if dtype.eq(single)? {
            return Ok(Self::Single(required("float32")?.extract()?));
        }
        Ok(Self::Double(required("float64")?.extract()?))
    }

    pub(crate) fn shape(&self) -> &[usize] {
        match self {
            Self::Single(array) => array.shape(),
            Self::Double(array) => array.shape(),
        }
    }

    /// The numbers in double precision.
    pub(crate) fn doubles(&self) -> PyResult<Vec<f64>> {
        Ok(match self {
            Self::Single(array) => array.as_slice()?.iter().map(|value| f64::from(*value)).collect(),
            Self::Double(array) => array.as_slice()?.to_vec(),
        })
    }
}

/// `name[i, j]` for the element `index` of an array of `shape`, which is a flat index.
pub(crate) fn element(name: &str, shape: &[usize], index: usize) -> String {
    let mut rest = index;
    let mut indices = Vec::with_capacity(shape.len());
    for extent in shape.iter().rev() {
        indices.push((rest % extent).to_string());
        rest /= extent;
    }
    indices.reverse();
    if indices.is_empty() { name.to_owned() } else { format!("{name}[{}]", indices.join(", ")) }
}

/// A shape as Python writes it.
pub(crate) fn shown(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        many => format!("({})", many.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// The numbers of the array `name` whose last axis has `N` elements, and the shape without it.
fn rows<const N: usize>(object: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<[f64; N]>, Vec<usize>)> {
    let array = Reals::of(object, name)?;
    let shape = array.shape().to_vec();
    if shape.last() != Some(&N) {
        return Err(wrong(format!("`{name}` has the shape {}; (..., {N}) is needed", shown(&shape))));
    }
    let values = array.doubles()?;
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        let place = element(name, &shape, at);
        return Err(wrong(format!("{place} is {}; it must be finite", values[at])));
    }
    let rows = values.chunks_exact(N).map(|row| row.try_into().expect("N numbers")).collect();
    Ok((rows, shape[..shape.len() - 1].to_vec()))
}

/// Unit vectors of an array of directions of any length but zero, and the shape without its last axis.
pub(crate) fn directions(object: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<DVec3>, Vec<usize>)> {
    let (rows, shape) = rows::<3>(object, name)?;
    let along = |(index, row): (usize, [f64; 3])| {
        unit(DVec3::from_array(row)).ok_or_else(|| {
            let place = element(name, &shape, index);
            wrong(format!("{place} is 0, 0, 0, which is not a direction"))
        })
    };
    let directions = rows.into_iter().enumerate().map(along).collect::<PyResult<_>>()?;
    Ok((directions, shape))
}

/// Points of an array of coordinates, and the shape without its last axis.
pub(crate) fn points(object: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<DVec2>, Vec<usize>)> {
    let (rows, shape) = rows::<2>(object, name)?;
    Ok((rows.into_iter().map(DVec2::from_array).collect(), shape))
}

/// The shape that arrays of the two shapes have together by NumPy's rules of broadcasting; `None` if they do
/// not fit.
pub(crate) fn common_shape(py: Python<'_>, one: &[usize], other: &[usize]) -> PyResult<Option<Vec<usize>>> {
    let shapes = (PyTuple::new(py, one)?, PyTuple::new(py, other)?);
    match py.import("numpy")?.call_method1("broadcast_shapes", shapes) {
        Ok(common) => common.extract().map(Some),
        Err(error) if error.is_instance_of::<PyValueError>(py) => Ok(None),
        Err(error) => Err(error),
    }
}

/// The array `object` repeated to `shape`, a shape that it fits.
pub(crate) fn repeated<'py>(object: &Bound<'py, PyAny>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let shape = PyTuple::new(object.py(), shape)?;
    object.py().import("numpy")?.call_method1("broadcast_to", (object, shape))
}

/// An array of `values`, which it takes over.
pub(crate) fn array<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    shape: Vec<usize>,
) -> PyResult<Bound<'_, PyArrayDyn<T>>> {
    PyArray1::from_vec(py, values).reshape(IxDyn(&shape))
}

/// `shape` with a last axis of `last`.
pub(crate) fn with_axis(mut shape: Vec<usize>, last: usize) -> Vec<usize> {
    shape.push(last);
    shape
}

/// An object whose numbers arrays may show without a copy.
///
/// An implementor must be a frozen class that keeps the numbers unchanged, at their place, for as long as it
/// lives.
pub(crate) trait Shown: Sync + pyo3::PyClass<Frozen = pyo3::pyclass::boolean_struct::True> {}

/// A read-only array over `values` of `owner`, without a copy. The array keeps `owner` alive.
pub(crate) fn view<'py, T: Shown>(
    owner: &Bound<'py, T>,
    values: impl FnOnce(&T) -> &[f32],
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let values = values(owner.get());
    let view = ArrayViewD::from_shape(IxDyn(shape), values).map_err(|error| wrong(error.to_string()))?;
    #[expect(unsafe_code, reason = "NumPy cannot know who owns the numbers")]
    // SAFETY: `values` borrows from `owner`, a frozen class that keeps them as `Shown` demands; the array
    // holds a reference to `owner`, and is made read-only before anyone sees it.
    let array = unsafe { PyArrayDyn::borrow_from_array(&view, owner.clone().into_any()) };
    let options = PyDict::new(owner.py());
    options.set_item("write", false)?;
    array.call_method("setflags", (), Some(&options))?;
    Ok(array.into_any())
}
