//! Reads a job from Python values whose names are those of the core.

use breakaway_batch::Job;
use breakaway_core::Extraction;
use breakaway_core::metrics::Limits;
use pyo3::prelude::*;
use serde::Deserialize;

use crate::error::unreadable;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JobValues {
    extraction: Extraction<f64>,
    limits: Limits<f64>,
    samples: u64,
    seed: u64,
    run: u64,
    trace_every: u64,
}

pub(crate) fn read(values: &Bound<'_, PyAny>) -> PyResult<Job> {
    let values: JobValues = pythonize::depythonize(values).map_err(unreadable)?;
    Ok(Job {
        extraction: values.extraction,
        limits: values.limits,
        samples: values.samples,
        seed: values.seed,
        run: values.run,
        trace_every: values.trace_every,
    })
}
