//! Every error of the binding, mapped to Python in one place.

use pyo3::PyErr;
use pyo3::exceptions::PyValueError;
use pythonize::PythonizeError;

/// A value whose shape the core does not know. The scenario models rule this out, so it is a
/// mismatch between the two and not a user's mistake.
pub(crate) fn unreadable(error: PythonizeError) -> PyErr {
    PyValueError::new_err(format!(
        "the core can not read this configuration: {error}; give the scenario model and the Rust \
         struct the same names, or compile the extension again: make .venv/.built"
    ))
}
