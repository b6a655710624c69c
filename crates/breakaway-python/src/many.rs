//! Runs a batch.

use breakaway_batch::draws::{Stream, fraction};
use breakaway_batch::{Batch, FIGURES, Figure, Instructions, Varied, Wanted, run_batch};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::{as_bytes, job, outcome_code};

/// The names of the instructions that this processor has, the fastest first.
#[pyfunction]
pub(crate) fn instructions() -> Vec<&'static str> {
    Instructions::available().into_iter().map(Instructions::name).collect()
}

/// The place of a number among the numbers of a job: that of the only one that is not a number.
#[pyfunction]
pub(crate) fn number_place(job: &Bound<'_, PyAny>) -> PyResult<usize> {
    let numbers = job::read(job)?.numbers();
    let mut places = numbers.iter().enumerate().filter(|(_, number)| number.is_nan());
    match (places.next(), places.next()) {
        (Some((place, _)), None) => Ok(place),
        _ => Err(PyValueError::new_err("not exactly one number of the job is not a number")),
    }
}

/// Uniform draws on (0, 1) for number `part` of each run, as bytes of f64. `runs` is bytes of u64.
#[pyfunction]
pub(crate) fn fractions<'py>(
    py: Python<'py>,
    seed: u64,
    runs: &[u8],
    part: u32,
) -> PyResult<Bound<'py, PyBytes>> {
    let draw = |run: &u64| fraction(seed, *run, Stream::Part(part));
    as_bytes(py, &words(runs).iter().map(draw).collect::<Vec<f64>>())
}

/// Runs a batch. `runs` is bytes of u64, `varied` are places and bytes of f64, one for each run.
/// Gives the figures by name as bytes of f64, and the outcomes as bytes of codes.
#[pyfunction]
#[pyo3(signature = (job, runs, varied, figures, outcome, threads, instructions, tell))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn run_many<'py>(
    py: Python<'py>,
    job: &Bound<'py, PyAny>,
    runs: &[u8],
    varied: Vec<(usize, Bound<'py, PyBytes>)>,
    figures: Vec<String>,
    outcome: bool,
    threads: usize,
    instructions: &str,
    tell: Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyBytes>)> {
    let common = job::read(job)?;
    let runs = words(runs);
    let columns: Vec<(usize, Vec<f64>)> =
        varied.iter().map(|(place, values)| (*place, numbers(values.as_bytes()))).collect();
    let varied = columns.iter().map(|(place, values)| Varied { place: *place, values }).collect();
    let batch = Batch { common, runs: &runs, varied };
    let wanted = Wanted { figures: named(&figures)?, outcome };
    let instructions = Instructions::available()
        .into_iter()
        .find(|one| one.name() == instructions)
        .ok_or_else(|| PyValueError::new_err(format!("{instructions} is not available")))?;
    let tell = tell.unbind();
    let results = py.detach(|| {
        run_batch(&batch, &wanted, threads, instructions, |done| {
            Python::attach(|py| {
                py.check_signals()?;
                tell.call1(py, (done,)).map(drop)
            })
        })
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
        found.ok_or_else(|| PyValueError::new_err(format!("{name} is not a figure")))
    };
    names.iter().map(find).collect()
}

fn words(bytes: &[u8]) -> Vec<u64> {
    let word = |chunk: &[u8]| chunk.iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte));
    bytes.chunks_exact(8).map(word).collect()
}

fn numbers(bytes: &[u8]) -> Vec<f64> {
    words(bytes).into_iter().map(f64::from_bits).collect()
}
