//! Every error of the binding, mapped to Python in one place.

use std::io;

use breakaway_batch::Ended;
use pyo3::{PyErr, import_exception};
use pythonize::PythonizeError;

import_exception!(breakaway.errors, BreakawayError);
import_exception!(breakaway.errors, StudyError);

/// A value whose shape the core does not know. The scenario models rule this out, so it is a
/// mismatch between the two and not a user's mistake.
pub(crate) fn unreadable(error: PythonizeError) -> PyErr {
    refused(format!(
        "the core cannot read this configuration: {error}; give the scenario model and the Rust \
         struct the same names, or compile the extension again: make .venv/.built"
    ))
}

/// What the core cannot take. The Python above rules this out, so it is no user's mistake.
pub(crate) fn refused(what: impl Into<String>) -> PyErr {
    BreakawayError::new_err(what.into())
}

/// The system starts fewer threads than were asked for.
pub(crate) fn no_thread(threads: usize, error: io::Error) -> PyErr {
    StudyError::new_err(format!(
        "threads: {threads} cannot be started ({error}); give a smaller number"
    ))
}

/// What ended a batch early.
pub(crate) fn ended(threads: usize, why: Ended<PyErr>) -> PyErr {
    match why {
        Ended::Told(error) => error,
        Ended::NoThread(error) => no_thread(threads, error),
    }
}
