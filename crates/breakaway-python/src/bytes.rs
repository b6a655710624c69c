//! Numbers as bytes of f64, which Python reads without a copy for each.

use pyo3::prelude::*;
use pyo3::types::PyBytes;

pub(crate) fn as_bytes<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyBytes>> {
    PyBytes::new_with(py, values.len() * 8, |buffer| {
        for (slot, value) in buffer.chunks_exact_mut(8).zip(values) {
            slot.copy_from_slice(&value.to_ne_bytes());
        }
        Ok(())
    })
}
