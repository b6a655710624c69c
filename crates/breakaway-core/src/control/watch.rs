//! A watch over the sensor: what cannot be true stops the extraction.

use super::Measurement;
use crate::parameters::parameters;
use crate::real::Real;
use crate::states::states;

parameters! {
    /// Stops for good at a measurement that cannot be true: no force, no feed, stack relaxed.
    ///
    /// ```text
    /// 1  not a number     position, velocity, force or reference is none, or infinite
    /// 2  jump             |x − x_last| > jump_max
    /// 3  frozen           x has not changed by a bit while a command was given for frozen_max
    /// 4  clock            the time since the last sample is not above 0
    /// ```
    ///
    /// The first that holds is the reason. Time without a command is not counted, nor does it end the
    /// count: between pulses a frozen sensor stays suspect.
    /// A sensor with noise never shows the same bits for long; for an ideal one let frozen_max be
    /// infinite.
    pub struct Watch {
        /// Most that a part can move in one sample, m.
        pub jump_max_m,
        /// Longest time that a sensor shows the same, s.
        pub frozen_max_s,
    }
}

states! {
    /// What the watch remembers.
    pub struct WatchState {
        /// Why it stopped: the number of the reason, 0 while it has none.
        pub reason,
        /// The last position, m.
        pub last_m,
        /// How long a command was given since it changed, s.
        pub unchanged_s,
        /// 1 once there was a sample.
        pub began,
    }
}

impl<R: Real> Watch<R> {
    /// Whether to go on after this sample; `pushing` says whether the last command was more than none.
    #[inline(always)]
    pub fn trusts(
        &self,
        state: &mut WatchState<R>,
        measured: &Measurement<R>,
        pushing: R::Mask,
    ) -> R::Mask {
        R::section("watch: stops for good at a measurement that cannot be true");
        let (zero, x) = (R::zero(), measured.position_m);
        let finite = R::constant(f64::INFINITY);
        let numbers = x.abs().lt(finite)
            & measured.force_n.abs().lt(finite)
            & measured.velocity_m_per_s.abs().lt(finite)
            & measured.reference_m.abs().lt(finite)
            & measured.reference_rate_m_per_s.abs().lt(finite);
        let began = state.began.is_set();
        let jumped = began & self.jump_max_m.lt((x - state.last_m).abs());
        let same = began & x.le(state.last_m) & state.last_m.le(x);
        let pushed_s = R::select(pushing, measured.period_s, zero);
        state.unchanged_s =
            R::select(same, state.unchanged_s + pushed_s, zero).named("unchanged_s");
        let frozen = self.frozen_max_s.lt(state.unchanged_s);
        let clock = !zero.lt(measured.period_s);
        let number = |value: f64| R::constant(value);
        let mut reason = R::select(clock, number(4.0), zero);
        reason = R::select(frozen, number(3.0), reason);
        reason = R::select(jumped, number(2.0), reason);
        reason = R::select(!numbers, number(1.0), reason);
        let stopped = zero.lt(state.reason);
        state.reason = R::select(stopped, state.reason, reason).named("reason");
        state.last_m = R::select(numbers, x, state.last_m);
        state.began = R::one();
        !zero.lt(state.reason)
    }
}
