//! A force actuator that is late and slow.

use super::{ActuatorState, Driven, ForceRange};
use crate::parameters::parameters;
use crate::real::{Function, Real};

parameters! {
    /// Push-only, behind a first-order lag and a limit of its rate.
    ///
    /// ```text
    /// dF/dt = clip((u − F) / τ, −r, r),  u = clip(command, 0, F_max),  τ = 1 / (2 π f)
    /// ```
    ///
    /// Lag and limit are stepped exactly for a held command, also where the one follows the other
    /// within a step; the part feels the mean of the force at both ends of the step. A fast hydraulic,
    /// voice-coil or pneumatic drive; f is the frequency at which the force is 3 dB down.
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
        let (before, r) = (state.force_n, self.force_rate_max_n_per_s);
        let target = self.range().limit(command_n);
        let per_s = R::constant(-2.0 * core::f64::consts::PI) * self.bandwidth_hz;
        let share = (R::one() - (per_s * h).exp()).named("lag_share");
        let missing = (target - before).named("missing_n");
        let slowest = (-r / per_s).named("slowest_n"); // r τ: as far off, the lag is as fast as the limit
        let limited_s = R::zero().max((missing.abs() - slowest) / r).min(h).named("limited_s");
        let most = (r * h).named("most_n");
        let whole = R::select(h.le(limited_s), missing.clamp(-most, most), missing * share);
        let within = R::zero().lt(limited_s) & limited_s.lt(h);
        let [change] = R::renewed::<LimitThenLag, 4, 1>(
            within,
            [whole],
            [missing, r * limited_s, per_s, h - limited_s],
        );
        // Rounding may lead out of the range, by a bit.
        let force_n = self.range().limit(before + change.named("change_n"));
        state.force_n = force_n.ebbed().named("actuator_force_n");
        let beyond = target.lt(command_n) | command_n.lt(target);
        let mut driven = Driven::rigid(R::constant(0.5) * (before + state.force_n));
        driven.effort.saturated_s = R::select(beyond, h, limited_s);
        driven
    }
}

/// The change of the force in a step that begins at the limit of its rate, `limited` N, and ends in
/// the lag.
struct LimitThenLag;

impl Function<4, 1> for LimitThenLag {
    #[inline(always)]
    fn of<R: Real>([missing, limited, per_s, lagging_s]: [R; 4]) -> [R; 1] {
        let first = missing.sign() * limited;
        [(missing - first).mul_add(R::one() - (per_s * lagging_s).exp(), first)]
    }
}
