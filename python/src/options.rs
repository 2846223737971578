//! Keyword arguments as options of the library, by the command line's words; those of files are named as
//! parameters here.

use crate::choices;
use crate::errors::{NAMES, raised, wrong};
use octagloss::files::OutputLayout;
use octagloss::recipes::{InputOptions, Recipe, from_json};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

/// The options of a bake.
pub(crate) fn recipe(py: Python<'_>, given: Option<&Bound<'_, PyDict>>) -> PyResult<Recipe> {
    let mut options = values(given)?;
    let others = ["format", "out_layout", "preview", "exposure", "sunless"];
    let of_input = json!(InputOptions::default());
    let is_foreign = |name: &&String| {
        others.contains(&name.as_str()) || (*name != "layout" && of_input.get(name.as_str()).is_some())
    };
    if let Some(name) = options.keys().find(is_foreign) {
        return Err(wrong(format!(
            "a bake has no option `{name}`; Environment.from_file has those of reading"
        )));
    }
    if let Some(layout) = options.get("layout").filter(|layout| !layout.is_null()) {
        let map = choices::layout(layout.as_str().unwrap_or_default())?;
        let target = options.get("target").and_then(Value::as_str);
        let layout = match target.map(choices::target).transpose()? {
            // The first layout of files with this map.
            None => json!(OutputLayout::ALL.into_iter().find(|layout| layout.map() == map)),
            Some(target) if target.map == map => Value::Null,
            Some(target) => {
                let (name, needed) = (target.name, target.map);
                return Err(wrong(format!("`layout` is {map}, but target {name} needs {needed}; omit it")));
            }
        };
        options.insert("layout".to_owned(), layout);
    }
    let named = |(name, value): (String, Value)| {
        let own = NAMES.iter().find(|(own, _)| *own == name);
        (own.map_or(name, |(_, theirs)| (*theirs).to_owned()), value)
    };
    let recipe: Recipe = parsed(py, options.into_iter().map(named).collect())?;
    recipe.check().map_err(|error| raised(py, &error))?;
    if recipe.target.len() > 1 {
        return Err(wrong("`target` names several; a bake is for one"));
    }
    Ok(recipe)
}

/// The options of reading.
pub(crate) fn input(py: Python<'_>, given: Option<&Bound<'_, PyDict>>) -> PyResult<InputOptions> {
    let options: InputOptions = parsed(py, values(given)?)?;
    options.check().map_err(|error| raised(py, &error))?;
    match options.extract_sun {
        Some(_) => Err(wrong("`extract_sun` is a method of Environment")),
        None => Ok(options),
    }
}

pub(crate) fn parsed<T: Default + Serialize + DeserializeOwned>(
    py: Python<'_>,
    options: Map<String, Value>,
) -> PyResult<T> {
    from_json(options).map_err(|error| raised(py, &error))
}

/// The arguments as JSON: numbers, texts, `True`, `False` and `None`.
fn values(given: Option<&Bound<'_, PyDict>>) -> PyResult<Map<String, Value>> {
    let value = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let name: String = name.extract()?;
        let value = if value.is_none() {
            Value::Null
        } else if let Ok(flag) = value.extract::<bool>() {
            json!(flag)
        } else if let Ok(number) = value.extract::<u64>() {
            json!(number)
        } else if let Ok(number) = value.extract::<f64>() {
            // JSON has no NaN; as a text it is refused by name.
            if number.is_finite() { json!(number) } else { json!(number.to_string()) }
        } else {
            json!(value.str()?.to_string())
        };
        Ok((name, value))
    };
    given.into_iter().flat_map(|given| given.iter()).map(value).collect()
}
