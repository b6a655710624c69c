//! Friction along the way, as a run meets it.

use breakaway_batch::field_course;
use breakaway_core::variation::Field;
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::bytes::as_bytes;
use crate::error::unreadable;

/// The factor on the friction levels and its slope in 1/m at each position, as bytes of f64.
#[pyfunction]
pub(crate) fn friction_field<'py>(
    py: Python<'py>,
    field: &Bound<'py, PyAny>,
    seed: u64,
    run: u64,
    position_m: PyBuffer<f64>,
) -> PyResult<[Bound<'py, PyBytes>; 2]> {
    let field: Field<f64> = pythonize::depythonize(field).map_err(unreadable)?;
    let position_m = position_m.to_vec(py)?;
    let course = py.detach(|| field_course(&field, seed, run, &position_m));
    Ok([as_bytes(py, &course.factor)?, as_bytes(py, &course.slope_per_m)?])
}
