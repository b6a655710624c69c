//! The naive way: push harder until something gives.

use super::{Control, Measurement};
use crate::actuator::Command;
use crate::parameters::parameters;
use crate::real::Real;
use crate::states::states;

parameters! {
    /// A force that grows at a constant rate until the part is out.
    ///
    /// ```text
    /// F = r t  while x < l,  then 0
    /// ```
    ///
    /// What breaks loose under it meets a force that goes on growing: it is thrown out. The baseline
    /// that shows why a force alone is not gentle.
    pub struct ForceRamp {
        /// r in N/s.
        pub rate_n_per_s,
        /// l in m: where the part is out.
        pub travel_m,
    }
}

states! {
    /// What moves in a force ramp.
    pub struct ForceRampState {
        /// F in N.
        pub force_n,
    }
}

impl<R: Real> Control<R> for ForceRamp<R> {
    type State = ForceRampState<R>;

    #[inline(always)]
    fn step(&self, state: &mut ForceRampState<R>, measured: &Measurement<R>) -> Command<R> {
        R::section("ramp: F = F + r T_s while x < l, then 0");
        let inside = measured.position_m.lt(self.travel_m);
        let grown = self.rate_n_per_s.mul_add(measured.period_s, state.force_n).named("grown_n");
        state.force_n = R::select(inside, measured.range.limit(grown), R::zero()).named("ramp_n");
        Command::force(state.force_n)
    }
}
