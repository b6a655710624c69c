//! Models of a rig, run against a record of it.

use breakaway_batch::{Instructions, Kept, Record, differentiate_rig, rig_misfits, simulate_rig};
use breakaway_core::rig::Row;
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::bytes::as_bytes;
use crate::error::{no_thread, refused, unreadable};

/// A record of a rig, and how models of it are run.
#[pyclass(frozen, module = "breakaway._core")]
pub(crate) struct RigRecord(Record);

type Bytes<'py> = Bound<'py, PyBytes>;

#[pymethods]
impl RigRecord {
    /// `columns` are those of a row in the core's order; `segments` are first and last-but-one rows.
    #[new]
    fn new(
        py: Python<'_>,
        columns: [PyBuffer<f64>; 11],
        segments: Vec<(usize, usize)>,
        drive: &Bound<'_, PyAny>,
        elasto_plastic: bool,
        steps: u32,
    ) -> PyResult<Self> {
        let mut values = Vec::new();
        for column in columns {
            values.push(column.to_vec(py)?);
        }
        let count = values[0].len();
        if values.iter().any(|column| column.len() != count) {
            return Err(refused("columns differ in length"));
        }
        if steps == 0 || segments.is_empty() {
            return Err(refused("there must be steps and segments"));
        }
        if segments.iter().any(|&(first, end)| first >= end || end > count) {
            return Err(refused("a segment is empty or beyond the rows"));
        }
        let row = |i: usize| Row {
            position_m: values[0][i],
            velocity_m_per_s: values[1][i],
            acceleration_m_per_s2: values[2][i],
            force_n: values[3][i],
            reference_m: values[4][i],
            reference_rate_m_per_s: values[5][i],
            period_s: values[6][i],
            mean_velocity_m_per_s: values[7][i],
            held_force_n: values[8][i],
            outside_force_n: values[9][i],
            time_s: values[10][i],
        };
        Ok(Self(Record {
            rows: (0..count).map(row).collect(),
            segments: segments.into_iter().map(|(first, end)| first..end).collect(),
            drive: pythonize::depythonize(drive).map_err(unreadable)?,
            elasto_plastic,
            steps,
        }))
    }

    /// Position and force of each row, as bytes of f64.
    fn simulate<'py>(&self, py: Python<'py>, numbers: Vec<f64>) -> PyResult<[Bytes<'py>; 2]> {
        self.check(numbers.len())?;
        let out = py.detach(|| simulate_rig(&self.0, &numbers, Instructions::fastest()));
        Ok([as_bytes(py, &out.position_m)?, as_bytes(py, &out.force_n)?])
    }

    /// A channel of every so many-th row and its derivatives, as bytes of f64. `variable` is the
    /// variable that each number is, or none.
    fn differentiate<'py>(
        &self,
        py: Python<'py>,
        numbers: Vec<f64>,
        variable: Vec<Option<usize>>,
        position: bool,
        every: usize,
    ) -> PyResult<[Bytes<'py>; 2]> {
        self.check(numbers.len())?;
        self.check(variable.len())?;
        if every == 0 || variable.iter().flatten().any(|&index| index >= 24) {
            return Err(refused("no rows are kept, or there are over 24 variables"));
        }
        let kept = Kept { position, every };
        let instructions = Instructions::fastest();
        let out = py.detach(|| differentiate_rig(&self.0, &numbers, &variable, kept, instructions));
        Ok([as_bytes(py, &out.values)?, as_bytes(py, &out.slopes)?])
    }

    /// Sums of squared differences of position and of force for each of many models, as bytes of
    /// f64: position and force in turn.
    fn misfits<'py>(
        &self,
        py: Python<'py>,
        models: PyBuffer<f64>,
        threads: usize,
    ) -> PyResult<Bytes<'py>> {
        let models = models.to_vec(py)?;
        if models.len() % self.0.numbers() != 0 {
            return Err(refused("not a whole number of models"));
        }
        let misfits = py
            .detach(|| rig_misfits(&self.0, &models, threads, Instructions::fastest()))
            .map_err(|error| no_thread(threads, error))?;
        let pairs: Vec<f64> =
            misfits.iter().flat_map(|one| [one.position_m2, one.force_n2]).collect();
        as_bytes(py, &pairs)
    }
}

impl RigRecord {
    fn check(&self, numbers: usize) -> PyResult<()> {
        if numbers == self.0.numbers() {
            return Ok(());
        }
        Err(refused(format!("{} numbers are needed", self.0.numbers())))
    }
}
