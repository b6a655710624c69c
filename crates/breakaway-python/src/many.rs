//! Runs a batch.

use breakaway_batch::draws::{Stream, fraction};
use breakaway_batch::{Batch, FIGURES, Figure, Instructions, Varied, Wanted, run_batch};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyBytes, PyDict};

use crate::bytes::as_bytes;
use crate::error::{ended, refused};
use crate::job;
use crate::outcome::outcome_code;

/// The names of the instructions that this processor has, the fastest first.
#[pyfunction]
pub(crate) fn instructions() -> Vec<&'static str> {
    Instructions::available().into_iter().map(Instructions::name).collect()
}

/// The place of each number of a job by its path, such as `extraction.joint.stiction_n`, in order.
#[pyfunction]
pub(crate) fn number_places<'py>(
    py: Python<'py>,
    job: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    job::read(job)?.number_paths().into_iter().zip(0_usize..).into_py_dict(py)
}

/// Uniform draws on (0, 1) for number `part` of each run, as bytes of f64.
#[pyfunction]
pub(crate) fn fractions<'py>(
    py: Python<'py>,
    seed: u64,
    runs: PyBuffer<u64>,
    part: u32,
) -> PyResult<Bound<'py, PyBytes>> {
    let draw = |run: u64| fraction(seed, run, Stream::Part(part));
    as_bytes(py, &runs.to_vec(py)?.into_iter().map(draw).collect::<Vec<f64>>())
}

/// Runs a batch. `varied` are places of numbers and their values, one for each run.
/// Gives the figures by name as bytes of f64, and the outcomes as bytes of codes.
#[pyfunction]
#[pyo3(signature = (job, runs, varied, figures, outcome, threads, instructions, tell))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn run_many<'py>(
    py: Python<'py>,
    job: &Bound<'py, PyAny>,
    runs: PyBuffer<u64>,
    varied: Vec<(usize, PyBuffer<f64>)>,
    figures: Vec<String>,
    outcome: bool,
    threads: usize,
    instructions: &str,
    tell: Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyBytes>)> {
    let common = job::read(job)?;
    let runs = runs.to_vec(py)?;
    let mut columns = Vec::new();
    let numbers = common.numbers().len();
    for (place, values) in varied {
        let values = values.to_vec(py)?;
        if place >= numbers || values.len() != runs.len() {
            return Err(refused(format!(
                "number {place} of {numbers} has {} values for {} runs",
                values.len(),
                runs.len()
            )));
        }
        columns.push((place, values));
    }
    let varied = columns.iter().map(|(place, values)| Varied { place: *place, values }).collect();
    let batch = Batch { common, runs: &runs, varied };
    let wanted = Wanted { figures: named(&figures)?, outcome };
    let instructions = Instructions::available()
        .into_iter()
        .find(|one| one.name() == instructions)
        .ok_or_else(|| refused(format!("{instructions} is not available")))?;
    let tell = tell.unbind();
    let results = py.detach(|| {
        run_batch(&batch, &wanted, threads, instructions, |done| {
            Python::attach(|py| {
                py.check_signals()?;
                tell.call1(py, (done,)).map(drop)
            })
        })
        .map_err(|why| ended(threads, why))
    })?;
    let by_name = PyDict::new(py);
    for (name, column) in figures.iter().zip(&results.figures) {
        by_name.set_item(name, as_bytes(py, column)?)?;
    }
    let codes: Vec<u8> = results.outcomes.into_iter().map(outcome_code).collect();
    Ok((by_name, PyBytes::new(py, &codes)))
}

fn named(names: &[String]) -> PyResult<Vec<Figure>> {
    let find = |name: &String| {
        let found = FIGURES.iter().find(|figure| figure.name == name).copied();
        found.ok_or_else(|| refused(format!("{name} is not a figure")))
    };
    names.iter().map(find).collect()
}
