//! The reference integrator.

use crate::arrays::{array, with_axis};
use crate::choices;
use crate::environment::Environment;
use crate::query::Asked;
use crate::work::run;
use glam::DVec3;
use numpy::PyArrayDyn;
use octagloss::Oracle;
use pyo3::prelude::*;
use rayon::ThreadPool;
use rayon::prelude::*;

/// Radiance of a lobe around each direction by exhaustive integration over the source in double precision:
/// float64 of shape (..., 3). Slow, and independent of every filter: audit others with it.
///
/// roughness and lobe as in Environment.reflect.
#[pyfunction]
#[pyo3(signature = (environment, directions, roughness=None, *, lobe="ggx"))]
pub(crate) fn reference<'py>(
    py: Python<'py>,
    environment: &Environment,
    directions: &Bound<'py, PyAny>,
    roughness: Option<&Bound<'py, PyAny>>,
    lobe: &str,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let lobe = choices::lobe(lobe)?;
    let Asked { directions, shape, roughness } = Asked::of(lobe, directions, roughness)?;
    let light = environment.light();
    let radiance = run(py, move |cancel, pool: &ThreadPool| {
        pool.install(|| {
            let oracle = Oracle::new(&light);
            let at = |(index, direction): (usize, &DVec3)| {
                cancel.check()?;
                oracle.reflect(lobe, roughness[index], *direction)
            };
            directions.par_iter().enumerate().map(at).collect::<octagloss::Result<Vec<[f64; 3]>>>()
        })
    })?;
    array(py, radiance.into_flattened(), with_axis(shape, 3))
}
