//! The stiff way: move, whatever it takes.

use super::{Control, Measurement};
use crate::actuator::Command;
use crate::parameters::parameters;
use crate::real::Real;
use crate::states::states;

parameters! {
    /// A slow approach for a set time, then a constant speed of the feed, without any sensing.
    ///
    /// ```text
    /// w = w_a  for t < t_a,  then w_0
    /// ```
    ///
    /// Behind a stiff axis little energy is stored, so a part that breaks loose jumps by no more than
    /// about 2 (F_s − F_c) / k. This is the baseline that vibration has to beat. A tool that closes its
    /// gap at w meets the part with a force of about w sqrt(k m): hence the approach.
    pub struct SteadyFeed {
        /// w_0 in m/s.
        pub speed_m_per_s,
        /// w_a in m/s.
        pub approach_m_per_s,
        /// t_a in s.
        pub approach_s,
    }
}

states! {
    /// What moves in a steady feed.
    pub struct SteadyFeedState {
        /// t in s: time since the start.
        pub elapsed_s,
    }
}

impl<R: Real> SteadyFeed<R> {
    /// The speed in m/s at a sample.
    #[inline(always)]
    pub(super) fn speed(&self, state: &mut SteadyFeedState<R>, period_s: R) -> R {
        R::section("feed: w = w_a while t < t_a, then w_0");
        let approaching = state.elapsed_s.lt(self.approach_s);
        state.elapsed_s = state.elapsed_s + period_s;
        R::select(approaching, self.approach_m_per_s, self.speed_m_per_s).named("feed_m_per_s")
    }
}

impl<R: Real> Control<R> for SteadyFeed<R> {
    type State = SteadyFeedState<R>;

    #[inline(always)]
    fn step(&self, state: &mut SteadyFeedState<R>, measured: &Measurement<R>) -> Command<R> {
        let feed_m_per_s = self.speed(state, measured.period_s);
        Command { force_n: R::zero(), feed_m_per_s, stack_share: R::zero() }
    }
}
