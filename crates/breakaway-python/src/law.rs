//! What a friction law answers: its curve, its breakaway force, and what it does when it is moved.

use breakaway_batch::{breakaway_forces, imposed_motion};
use breakaway_core::joint::{Form, Joint, form};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::bytes::as_bytes;
use crate::error::{refused, unreadable};

type Bytes<'py> = Bound<'py, PyBytes>;

fn read(joint: &Bound<'_, PyAny>) -> PyResult<Joint<f64>> {
    pythonize::depythonize(joint).map_err(unreadable)
}

/// Positions and velocities, as many of each.
fn points(
    py: Python<'_>,
    position_m: PyBuffer<f64>,
    velocity_m_per_s: PyBuffer<f64>,
) -> PyResult<(Vec<f64>, Vec<f64>)> {
    let (x, v) = (position_m.to_vec(py)?, velocity_m_per_s.to_vec(py)?);
    if x.len() == v.len() { Ok((x, v)) } else { Err(refused("columns differ in length")) }
}

/// Imposes velocities on a joint. Gives position, bristle and joint force as bytes of f64.
#[pyfunction]
pub(crate) fn impose<'py>(
    py: Python<'py>,
    joint: &Bound<'py, PyAny>,
    start_m: f64,
    period_s: f64,
    velocity_m_per_s: PyBuffer<f64>,
) -> PyResult<[Bytes<'py>; 3]> {
    let (joint, velocity) = (read(joint)?, velocity_m_per_s.to_vec(py)?);
    let motion = py.detach(|| imposed_motion(&joint, start_m, period_s, &velocity));
    Ok([
        as_bytes(py, &motion.position_m)?,
        as_bytes(py, &motion.bristle_m)?,
        as_bytes(py, &motion.joint_force_n)?,
    ])
}

/// F_s(x) in N at each position, equation (5), as bytes of f64.
#[pyfunction]
pub(crate) fn breakaway_force<'py>(
    py: Python<'py>,
    joint: &Bound<'py, PyAny>,
    position_m: PyBuffer<f64>,
) -> PyResult<Bytes<'py>> {
    as_bytes(py, &breakaway_forces(&read(joint)?, &position_m.to_vec(py)?))
}

/// Level, viscous friction, damping, rate and lead of steady sliding, as bytes of f64.
#[pyfunction]
pub(crate) fn steady_friction<'py>(
    py: Python<'py>,
    joint: &Bound<'py, PyAny>,
    position_m: PyBuffer<f64>,
    velocity_m_per_s: PyBuffer<f64>,
) -> PyResult<[Bytes<'py>; 5]> {
    let (joint, (x, v)) = (read(joint)?, points(py, position_m, velocity_m_per_s)?);
    let found = py.detach(|| breakaway_batch::steady_friction(&joint, &x, &v));
    Ok([
        as_bytes(py, &found.level_n)?,
        as_bytes(py, &found.viscous_n_s_per_m)?,
        as_bytes(py, &found.damping_n_s_per_m)?,
        as_bytes(py, &found.rate_per_s)?,
        as_bytes(py, &found.lead)?,
    ])
}

/// Force, slope and curvature of the steady friction curve, as bytes of f64.
#[pyfunction]
pub(crate) fn friction_curve<'py>(
    py: Python<'py>,
    joint: &Bound<'py, PyAny>,
    position_m: PyBuffer<f64>,
    velocity_m_per_s: PyBuffer<f64>,
) -> PyResult<[Bytes<'py>; 3]> {
    let (joint, (x, v)) = (read(joint)?, points(py, position_m, velocity_m_per_s)?);
    let found = py.detach(|| breakaway_batch::friction_curve(&joint, &x, &v));
    Ok([
        as_bytes(py, &found.force_n)?,
        as_bytes(py, &found.slope_n_s_per_m)?,
        as_bytes(py, &found.curvature_n_s2_per_m2)?,
    ])
}

/// What a law is to the plant: `bristle`, `elements` or `rigid`.
#[pyfunction]
pub(crate) fn law_form(joint: &Bound<'_, PyAny>) -> PyResult<&'static str> {
    Ok(match form(&read(joint)?) {
        Form::Bristle => "bristle",
        Form::Elements => "elements",
        Form::Rigid => "rigid",
    })
}
