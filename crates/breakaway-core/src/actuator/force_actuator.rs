//! A force actuator that is late and slow.

use super::{ActuatorState, Driven, ForceRange};
use crate::parameters::parameters;
use crate::real::Real;

parameters! {
    /// Push-only, behind a first-order lag and a limit of its rate.
    ///
    /// ```text
    /// dF/dt = clip((u − F) / τ, −r, r),  u = clip(command, 0, F_max),  τ = 1 / (2 π f)
    /// ```
    ///
    /// The lag is stepped exactly for a held command, the limit holds for the mean rate of a step;
    /// the part feels the mean of the force at both ends of the step. A fast hydraulic, voice-coil or
    /// pneumatic drive; f is the frequency at which the force is 3 dB down.
    pub struct ForceActuator {
        /// F_max in N.
        pub force_max_n,
        /// f in Hz.
        pub bandwidth_hz,
        /// r in N/s.
        pub force_rate_max_n_per_s,
    }
}

impl<R: Real> ForceActuator<R> {
    /// What it can deliver.
    #[inline(always)]
    pub fn range(&self) -> ForceRange<R> {
        ForceRange { min_n: R::zero(), max_n: self.force_max_n }
    }

    #[inline(always)]
    pub(super) fn drive(&self, state: &mut ActuatorState<R>, command_n: R, h: R) -> Driven<R> {
        R::section("force actuator: dF/dt = clip((u - F) / tau, -r, r)");
        let before = state.force_n;
        let target = self.range().limit(command_n);
        let per_s = R::constant(-2.0 * core::f64::consts::PI) * self.bandwidth_hz;
        let share = (R::one() - (per_s * h).exp()).named("lag_share");
        let wanted = ((target - before) * share).named("wanted_change_n");
        let most = (self.force_rate_max_n_per_s * h).named("most_n");
        // Rounding may lead out of the range, by a bit.
        let force_n = self.range().limit(before + wanted.clamp(-most, most));
        state.force_n = force_n.ebbed().named("actuator_force_n");
        let limited = target.lt(command_n) | command_n.lt(target) | most.lt(wanted.abs());
        let mut driven = Driven::rigid(R::constant(0.5) * (before + state.force_n));
        driven.effort.saturated_s = R::select(limited, h, R::zero());
        driven
    }
}
