//! Single queries: lobes around directions.

use crate::arrays::{Reals, array, common_shape, directions, element, repeated, shown, with_axis};
use crate::errors::wrong;
use crate::work::{held, run};
use glam::DVec3;
use octagloss::queries::{Query, sharpest};
use octagloss::{Answer, Environment as Light, Filter, Lobe, OemSize, Reflector, ReflectorSettings};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex};

/// A prepared reflector, and what it was prepared for.
pub(crate) struct Tables {
    plan: (OemSize, u32),
    reflector: Reflector<'static>,
}

/// The reflector of `tables`; replaced if it was made for other settings.
fn prepared<'t>(
    tables: &'t mut Option<Tables>,
    light: &Light,
    settings: &ReflectorSettings,
) -> octagloss::Result<&'t Reflector<'static>> {
    let plan = settings.plan(light.layout())?;
    if tables.as_ref().is_none_or(|tables| tables.plan != plan) {
        // Free the old one first.
        *tables = None;
        *tables = Some(Tables { plan, reflector: Reflector::owning(light.clone(), settings)? });
    }
    Ok(&tables.as_ref().expect("made above").reflector)
}

/// What a call asks for.
pub(crate) struct Asked {
    pub(crate) directions: Vec<DVec3>,
    /// Shape of the answers without their channels.
    pub(crate) shape: Vec<usize>,
    /// Of each direction.
    pub(crate) roughness: Vec<f64>,
}

impl Asked {
    /// Directions and their roughness, in [0, 1], which broadcast against each other; the cosine lobe has
    /// none.
    pub(crate) fn of(
        lobe: Lobe,
        given: &Bound<'_, PyAny>,
        roughness: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (directions, shape) = directions(given, "directions")?;
        let roughness = match (lobe, roughness) {
            (Lobe::Cosine, None) => {
                return Ok(Self { roughness: vec![1.0; directions.len()], directions, shape });
            }
            (Lobe::Cosine, Some(_)) => {
                return Err(wrong("the lobe cosine has no roughness; omit `roughness`"));
            }
            (lobe, None) => return Err(wrong(format!("the lobe {} needs `roughness`", lobe.name()))),
            (_, Some(roughness)) => roughness,
        };
        let array = Reals::of(roughness, "roughness")?;
        let values = array.doubles()?;
        if let Some(at) = values.iter().position(|value| !(0.0..=1.0).contains(value)) {
            let place = element("roughness", array.shape(), at);
            return Err(wrong(format!("{place} is {}; it must be between 0 and 1", values[at])));
        }
        let Some(common) = common_shape(given.py(), &shape, array.shape())? else {
            return Err(wrong(format!(
                "`roughness` has the shape {}, which does not fit {} directions; one number, or one for each \
                 is needed",
                shown(array.shape()),
                shown(&shape)
            )));
        };
        let directions = if common == shape {
            directions
        } else {
            self::directions(&repeated(given, &with_axis(common.clone(), 3))?, "directions")?.0
        };
        let roughness = if array.shape() == common {
            values
        } else {
            Reals::of(&repeated(roughness, &common)?, "roughness")?.doubles()?
        };
        Ok(Self { directions, shape: common, roughness })
    }
}

/// The least roughness above 0, as the command line takes it; `asked` if given.
pub(crate) fn sharpest_of(lobe: Lobe, roughness: &[f64], asked: Option<f64>) -> PyResult<f64> {
    let least = sharpest(lobe, roughness);
    match asked {
        None => Ok(least.unwrap_or(1.0)),
        Some(asked) if !(0.0..=1.0).contains(&asked) => {
            Err(wrong(format!("`sharpest` is {asked}; it must be between 0 and 1")))
        }
        Some(asked) => match least.filter(|least| (f64::MIN_POSITIVE..asked).contains(least)) {
            Some(least) => Err(wrong(format!(
                "`roughness` has {least}, below `sharpest`, {asked}; lower `sharpest` to it"
            ))),
            None => Ok(asked),
        },
    }
}

/// Tables that are kept from one query to the next.
pub(crate) type Kept = Arc<Mutex<Option<Tables>>>;

/// The answers of `light` for `directions` times `factor`: an array, or with `bounds` two.
pub(crate) fn answers<'py>(
    py: Python<'py>,
    (light, tables): (Arc<Light>, Kept),
    Asked { directions, shape, roughness }: Asked,
    (lobe, filter): (Lobe, Filter),
    settings: ReflectorSettings,
    (bounds, factor): (bool, f64),
) -> PyResult<Bound<'py, PyAny>> {
    if bounds && !matches!(filter, Filter::Adaptive(_)) {
        return Err(wrong("`bounds` needs `filter` adaptive:E; other filters have no certified bounds"));
    }
    let (radiance, certified) = run(py, move |cancel, pool| {
        filter.check(lobe, settings.oem_size)?;
        // Taken outside the pool, whose threads must not wait for one another.
        let mut tables = held(&tables);
        let tables = &mut *tables;
        pool.install(|| {
            let reflector = prepared(tables, &light, &settings)?;
            let query = Query { lobe, filter, directions: &directions, roughness: &roughness };
            let answers = query.answered_unless(reflector, &|| cancel.check())?;
            let scaled = |value: f32| (f64::from(value) * factor) as f32;
            let radiance: Vec<f32> = answers.iter().flat_map(|answer| answer.radiance.map(scaled)).collect();
            let bound =
                |answer: &Answer| answer.bound.map_or([f32::INFINITY; 4], |bound| bound.values().map(scaled));
            let certified: Vec<f32> =
                if bounds { answers.iter().flat_map(bound).collect() } else { Vec::new() };
            Ok((radiance, certified))
        })
    })?;
    let radiance = array(py, radiance, with_axis(shape.clone(), 3))?;
    if !bounds {
        return Ok(radiance.into_any());
    }
    Ok((radiance, array(py, certified, with_axis(shape, 4))?).into_pyobject(py)?.into_any())
}
