//! Parameters with a few values, by the names of the command line.

use crate::errors::wrong;
use octagloss::harmonics::{ShScale, ShWindow, parsed_window};
use octagloss::queries::parsed_filter;
use octagloss::reflectance::DfgForm;
use octagloss::targets::{TARGETS, Target};
use octagloss::{Filter, LOBES, Lobe, Map};
use pyo3::PyResult;

/// The value of `choices` named `text`, for the parameter `setting`.
fn choice<T: Copy>(setting: &str, text: &str, choices: &[(&'static str, T)]) -> PyResult<T> {
    choices.iter().find(|(name, _)| *name == text).map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<_> = choices.iter().map(|(name, _)| *name).collect();
        wrong(format!("`{setting}` is {text:?}; choose one of {}", names.join(", ")))
    })
}

pub(crate) fn lobe(text: &str) -> PyResult<Lobe> {
    choice("lobe", text, &LOBES.map(|lobe| (lobe.name(), lobe)))
}

pub(crate) fn filter(text: &str) -> PyResult<Filter> {
    parsed_filter(text).map_err(|message| wrong(format!("`filter` is {text:?}; {message}")))
}

pub(crate) fn sh_window(setting: &str, text: &str) -> PyResult<ShWindow> {
    parsed_window(text).map_err(|message| wrong(format!("`{setting}` is {text:?}; {message}")))
}

pub(crate) fn sh_scale(text: &str) -> PyResult<ShScale> {
    let all = [
        ("radiance", ShScale::Radiance),
        ("irradiance", ShScale::Irradiance),
        ("filament", ShScale::Filament),
    ];
    choice("scale", text, &all)
}

/// Layout of an array, or of a baked level.
pub(crate) fn layout(text: &str) -> PyResult<Map> {
    choice("layout", text, &Map::ALL.map(|map| (map.name(), map)))
}

pub(crate) fn target(text: &str) -> PyResult<&'static Target> {
    let all: Vec<_> = TARGETS.iter().map(|target| (target.name, target)).collect();
    choice("target", text, &all)
}

pub(crate) fn dfg_form(text: &str) -> PyResult<DfgForm> {
    let all = [("split-sum", DfgForm::SplitSum), ("multiple-scattering", DfgForm::MultipleScattering)];
    choice("form", text, &all)
}
