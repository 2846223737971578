//! Errors of the library as Python exceptions, with the library's text.

use octagloss::Error;
use octagloss::recipes::with_settings;
use pyo3::PyTypeInfo as _;
use pyo3::exceptions::{PyMemoryError, PyOSError, PyRuntimeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use std::ffi::CString;

/// The exception for `error`.
pub(crate) fn raised(py: Python<'_>, error: &Error) -> PyErr {
    let text = with_parameters(&error.to_string());
    match error {
        // With its number, Python chooses FileNotFoundError, PermissionError and so on.
        Error::Io { error: system, .. } => match system.raw_os_error() {
            Some(number) => PyOSError::new_err((number, text)),
            None => std::io::Error::new(system.kind(), text).into(),
        },
        Error::Input { .. } | Error::NonFinite { .. } => input_error(py, text),
        Error::Parameter(_) => PyValueError::new_err(text),
        Error::Limit { .. } => PyMemoryError::new_err(text),
        _ => PyRuntimeError::new_err(text),
    }
}

/// Names of options here, and in the library.
pub(crate) const NAMES: [(&str, &str); 2] = [("container", "format"), ("layout", "out_layout")];

/// `text` of the library with its settings named as parameters.
pub(crate) fn with_parameters(text: &str) -> String {
    with_settings(text, &|setting| {
        let own = NAMES.iter().find(|(_, theirs)| *theirs == setting);
        format!("`{}`", own.map_or(setting, |(own, _)| own))
    })
}

/// A `ValueError` about a parameter.
pub(crate) fn wrong(text: impl Into<String>) -> PyErr {
    PyValueError::new_err(text.into())
}

/// A `ValueError` of the library about a parameter.
pub(crate) fn refused(error: Error) -> PyErr {
    wrong(error.to_string())
}

/// An `octagloss.InputError`, which is both an `OSError` and a `ValueError`.
fn input_error(py: Python<'_>, text: String) -> PyErr {
    let class = py.import("octagloss._errors").and_then(|module| module.getattr("InputError"));
    match class.and_then(|class| class.call1((text,))) {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// Issues `text` as a `UserWarning` of the caller.
pub(crate) fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let text = CString::new(text.replace('\0', "")).expect("zeros are removed");
    PyErr::warn(py, &PyUserWarning::type_object(py), &text, 1)
}
