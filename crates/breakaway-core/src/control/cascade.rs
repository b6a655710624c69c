//! Cascaded position and velocity loops, as in servo drives.

use crate::actuator::ForceRange;
use crate::real::Real;

/// A position loop whose output is the set point of a velocity loop, both proportional.
///
/// ```text
/// F = clip(K_v (K_p (r − x) − v̂), ± F_max)       v̂ = (x_k − x_{k−2}) / (2 T_s)
/// ```
///
/// v̂ is the backward difference of the mean of the last two positions. Source: A. Janot, M. Gautier,
/// M. Brunot, "Data Set and Reference Models of EMPS", Workshop on Nonlinear System Identification
/// Benchmarks, 2019; K_v here is in force units, drive gain included.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Cascade<R> {
    /// K_p in 1/s.
    pub position_gain_per_s: R,
    /// K_v in N s/m.
    pub velocity_gain_n_s_per_m: R,
    /// F_max in N, where the drive saturates.
    pub force_limit_n: R,
}

/// What moves in a cascade: the last two measured positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CascadeState<R> {
    /// x one sample ago, m.
    pub previous_position_m: R,
    /// x two samples ago, m.
    pub position_before_m: R,
}

impl<R: Real> CascadeState<R> {
    /// Before the sample at which the part is at `x` and moves at `v`, with samples every `period_s`.
    #[inline(always)]
    pub fn moving(x: R, v: R, period_s: R) -> Self {
        let travel = v * period_s;
        Self { previous_position_m: x - travel, position_before_m: x - travel - travel }
    }
}

impl<R: Real> Cascade<R> {
    /// The force in N for a sample.
    ///
    /// # Example
    /// ```
    /// use breakaway_core::control::{Cascade, CascadeState};
    /// let cascade = Cascade {
    ///     position_gain_per_s: 160.0,
    ///     velocity_gain_n_s_per_m: 8000.0,
    ///     force_limit_n: 350.0,
    /// };
    /// let mut state = CascadeState::moving(0.0, 0.0, 1e-3);
    /// // At rest 0.1 mm short of the reference: 8000 · 160 · 1e-4 = 128 N.
    /// assert!((cascade.step(&mut state, 1e-4, 0.0, 1e-3) - 128.0_f64).abs() < 1e-9);
    /// assert_eq!(cascade.step(&mut state, 1.0, 0.0, 1e-3), 350.0);
    /// ```
    #[inline(always)]
    pub fn step(&self, state: &mut CascadeState<R>, reference: R, x: R, period_s: R) -> R {
        let velocity = (x - state.position_before_m) / (period_s + period_s);
        *state =
            CascadeState { previous_position_m: x, position_before_m: state.previous_position_m };
        let wanted = self.position_gain_per_s * (reference - x);
        let force = self.velocity_gain_n_s_per_m * (wanted - velocity);
        ForceRange { min_n: -self.force_limit_n, max_n: self.force_limit_n }.limit(force)
    }
}
