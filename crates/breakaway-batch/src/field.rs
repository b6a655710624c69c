//! The field of a run along the way, with its slope.

use breakaway_core::variation::{Field, FieldCell};
use breakaway_core::{Dual, Real};

use crate::draws::field_keys;

/// A field at some positions: a value for each.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldCourse {
    /// 1 + s.
    pub factor: Vec<f64>,
    /// ds/dx in 1/m.
    pub slope_per_m: Vec<f64>,
}

/// The field that run number `run` of a seed meets, at positions in m.
#[must_use]
pub fn field_course(field: &Field<f64>, seed: u64, run: u64, position_m: &[f64]) -> FieldCourse {
    let own = Field { keys: field_keys(seed, run), ..*field };
    let own = own.map(&mut |_, value| Dual::<f64, 1>::constant(value));
    let mut cell = FieldCell::nowhere();
    let (factor, slope_per_m) = position_m
        .iter()
        .map(|&x| own.factor(&mut cell, Dual::variable(x, 0)))
        .map(|at| (at.value, at.derivative[0]))
        .unzip();
    FieldCourse { factor, slope_per_m }
}
