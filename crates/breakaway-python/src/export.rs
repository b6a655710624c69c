//! Hands recorded steps to Python as text, and runs the core for what they have to give.

use breakaway_export::c::{
    Body, Code, Precision, code, draw_bodies, exp2_bodies, names, round_constant,
};
use breakaway_export::reference::{Seeded, reference};
use breakaway_export::{Program, What};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};

use crate::bytes::as_bytes;
use crate::error::refused;
use crate::job;

/// The C of a part of an extraction: numbers with their names, and function bodies.
#[pyfunction]
pub(crate) fn export_code<'py>(
    py: Python<'py>,
    job: &Bound<'py, PyAny>,
    what: &str,
    real: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let (what, precision) = (what_of(what)?, precision_of(real)?);
    let program = precision.program(what, &job::read(job)?.drawn().extraction);
    let code = code(&program, precision);
    let dict = PyDict::new(py);
    numbers(&dict, &program, precision, &code)?;
    bodies(&dict, what, precision, &code)?;
    Ok(dict)
}

fn numbers(
    dict: &Bound<'_, PyDict>,
    program: &Program,
    precision: Precision,
    code: &Code,
) -> PyResult<()> {
    let py = dict.py();
    let parameters = PyList::empty(py);
    for one in &program.parameters {
        let literal = precision.literal(one.value);
        parameters.append((&one.path, code.parameters.get(&one.path), one.value, literal))?;
    }
    let states = PyList::empty(py);
    for one in &program.states {
        let literal = precision.literal(one.value);
        states.append((&one.path, names::state(&one.path), one.value, literal))?;
    }
    dict.set_item("parameters", parameters)?;
    dict.set_item("states", states)?;
    dict.set_item("inputs", &program.inputs)?;
    dict.set_item("outputs", &program.outputs)?;
    dict.set_item(
        "signals",
        program.signals.iter().map(|name| names::joined(name)).collect::<Vec<_>>(),
    )
}

fn bodies(dict: &Bound<'_, PyDict>, what: What, precision: Precision, code: &Code) -> PyResult<()> {
    let py = dict.py();
    let derived: Vec<_> = code.derived.iter().map(|one| (&one.name, &one.formula)).collect();
    let routines = PyList::empty(py);
    for (name, times, body) in &code.routines {
        routines.append((name, times, body_of(py, body)?))?;
    }
    let [fraction, power] = exp2_bodies(precision, what.prefix());
    dict.set_item("derived", derived)?;
    dict.set_item("derive", body_of(py, &code.derive)?)?;
    dict.set_item("routines", routines)?;
    dict.set_item("exp2_fraction", fraction.text)?;
    dict.set_item("exp2_power", power.text)?;
    let draws = draw_bodies(what.prefix());
    let draws: Vec<_> =
        draws.into_iter().map(|(name, arguments, body)| (name, arguments, body.text)).collect();
    dict.set_item("draw_functions", draws)?;
    dict.set_item("round", round_constant(precision))
}

fn body_of<'py>(py: Python<'py>, body: &Body) -> PyResult<Bound<'py, PyDict>> {
    let (dict, used) = (PyDict::new(py), &body.used);
    dict.set_item("text", &body.text)?;
    for (name, used) in [
        ("parameters", used.parameters),
        ("derived", used.derived),
        ("state", used.state),
        ("input", used.input),
        ("signals", used.signals),
        ("output", used.output),
        ("exp2", used.exp2),
        ("round", used.round),
    ] {
        dict.set_item(name, used)?;
    }
    Ok(dict)
}

/// What exported code has to give: outputs by name as bytes of f64, for consecutive steps from rest whose
/// inputs are rows of three.
#[pyfunction]
pub(crate) fn export_reference<'py>(
    py: Python<'py>,
    job: &Bound<'py, PyAny>,
    what: &str,
    real: &str,
    inputs: PyBuffer<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let (what, precision, job) = (what_of(what)?, precision_of(real)?, job::read(job)?);
    let rows: Vec<[f64; 3]> =
        inputs.to_vec(py)?.chunks_exact(3).map(|row| [row[0], row[1], row[2]]).collect();
    let draws = Seeded { seed: job.seed, run: job.run };
    let given = py.detach(|| reference(what, precision, &job.extraction, draws, &rows));
    let columns = PyDict::new(py);
    for (place, name) in what.outputs().iter().enumerate() {
        let column: Vec<f64> = given.iter().map(|row| row[place]).collect();
        let bytes: Bound<'py, PyBytes> = as_bytes(py, &column)?;
        columns.set_item(name, bytes)?;
    }
    Ok(columns)
}

fn what_of(name: &str) -> PyResult<What> {
    let found = What::ALL.into_iter().find(|what| what.prefix() == name);
    found.ok_or_else(|| refused(format!("{name} cannot be exported")))
}

fn precision_of(name: &str) -> PyResult<Precision> {
    let found = [Precision::Single, Precision::Double].into_iter().find(|one| one.name() == name);
    found.ok_or_else(|| refused(format!("{name} is no real type")))
}
