//! Python binding: converts values and maps errors. No loops, no defaults, no physics.

mod bytes;
mod error;
mod export;
mod field;
mod job;
mod law;
mod many;
mod outcome;
mod rig;

use breakaway_batch::{FIGURES, Run, TRACE_COLUMNS, run};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::bytes::as_bytes;
use crate::outcome::{OUTCOMES, outcome_code};

/// Runs one extraction. Gives (outcome, figures by name, trace columns by name as bytes of f64).
#[pyfunction]
fn run_one<'py>(
    py: Python<'py>,
    job: &Bound<'py, PyAny>,
) -> PyResult<(&'static str, Bound<'py, PyDict>, Bound<'py, PyDict>)> {
    let job = job::read(job)?;
    let finished = py.detach(|| run(&job, || Python::attach(|py| py.check_signals())))?;
    let figures = PyDict::new(py);
    for figure in FIGURES {
        figures.set_item(figure.name, (figure.value)(&job, &finished))?;
    }
    let outcome = OUTCOMES[usize::from(outcome_code(finished.outcome))];
    Ok((outcome, figures, trace_columns(py, &finished)?))
}

fn trace_columns<'py>(py: Python<'py>, run: &Run) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    for (name, values) in TRACE_COLUMNS.iter().zip(&run.trace) {
        columns.set_item(name, as_bytes(py, values)?)?;
    }
    Ok(columns)
}

/// The compiled core of breakaway.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("OUTCOMES", OUTCOMES)?;
    module.add("RIG_NUMBERS", breakaway_core::rig::RIG_NUMBERS)?;
    module.add_class::<rig::RigRecord>()?;
    module.add_function(wrap_pyfunction!(run_one, module)?)?;
    module.add_function(wrap_pyfunction!(many::run_many, module)?)?;
    module.add_function(wrap_pyfunction!(many::instructions, module)?)?;
    module.add_function(wrap_pyfunction!(many::number_places, module)?)?;
    module.add_function(wrap_pyfunction!(many::fractions, module)?)?;
    module.add_function(wrap_pyfunction!(export::export_code, module)?)?;
    module.add_function(wrap_pyfunction!(export::export_reference, module)?)?;
    module.add_function(wrap_pyfunction!(field::friction_field, module)?)?;
    module.add_function(wrap_pyfunction!(law::impose, module)?)?;
    module.add_function(wrap_pyfunction!(law::breakaway_force, module)?)?;
    module.add_function(wrap_pyfunction!(law::steady_friction, module)?)?;
    module.add_function(wrap_pyfunction!(law::friction_curve, module)?)?;
    module.add_function(wrap_pyfunction!(law::law_form, module)?)
}
