//! The naive way: push harder until something gives.

use super::Measurement;
use crate::actuator::Command;
use crate::parameters::parameters;
use crate::real::Real;

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

impl<R: Real> ForceRamp<R> {
    /// The command at a sample; `force_n` is what moves.
    #[inline(always)]
    pub fn step(&self, force_n: &mut R, measured: &Measurement<R>) -> Command<R> {
        R::section("ramp: F = F + r T_s while x < l, then 0");
        let inside = measured.position_m.lt(self.travel_m);
        let grown = self.rate_n_per_s.mul_add(measured.period_s, *force_n).named("grown_n");
        *force_n = R::select(inside, measured.range.limit(grown), R::zero()).named("ramp_n");
        Command::force(*force_n)
    }
}
