//! A steady feed helped by a vibrating stack.

use super::{Control, Measurement, SteadyFeed, SteadyFeedState};
use crate::actuator::Command;
use crate::name::{Name, within};
use crate::parameters::parameters;
use crate::real::Real;
use crate::sine::half_sine;
use crate::states::states;

/// A constant feed, on which a piezo stack superimposes pulses in proportion to the measured force.
///
/// ```text
/// w     = w_0                                       feed, that of [`SteadyFeed`]
/// share = min(α F̄ / F_stack, 1) sin²(π u)            u = t / t_p in the pulse, 0 after it
/// dF̄/dt = (F − F̄) / τ                               F as measured
/// ```
///
/// The pulses push against the inertia of the tool and break the part loose while the mean force is only
/// F_s / (1 + α). Where that is below the sliding friction, a slip ends with its pulse whatever the axis
/// has stored: this is what vibration is good for, and on a stiff axis there is no need of it. In proportion
/// to F̄, it is as gentle to a weak part as to a strong one. It is told nothing of the part.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct VibratedFeed<R> {
    /// The feed.
    pub feed: SteadyFeed<R>,
    /// The pulses of the stack.
    pub pulses: StackPulses<R>,
}

parameters! {
    /// Pulses of a piezo stack.
    pub struct StackPulses {
        /// Pulses in a second, Hz.
        pub frequency_hz,
        /// t_p in s.
        pub pulse_width_s,
        /// α.
        pub amplitude_ratio,
        /// F_stack in N: the force of the full stroke against a part that does not move, as known.
        pub stack_force_n,
        /// τ in s.
        pub force_filter_s,
    }
}

states! {
    /// What moves in a vibrated feed.
    pub struct VibratedFeedState with {
        /// The feed.
        pub feed: SteadyFeedState,
        /// The pulses of the stack.
        pub pulses: StackPulsesState,
    }
}

states! {
    /// What moves in the pulses of a stack.
    pub struct StackPulsesState {
        /// F̄ in N.
        pub mean_n,
        /// Share of the stroke of this pulse.
        pub amplitude,
        /// Phase in cycles, 0 to 1.
        pub phase_cycles,
    }
}

impl<R: Real> VibratedFeed<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> VibratedFeed<S> {
        VibratedFeed {
            feed: within!("feed", self.feed, f),
            pulses: within!("pulses", self.pulses, f),
        }
    }
}

impl<R: Real> StackPulses<R> {
    /// The share of the stroke at a sample.
    #[inline(always)]
    fn share(&self, state: &mut StackPulsesState<R>, measured: &Measurement<R>) -> R {
        let (zero, one, period) = (R::zero(), R::one(), measured.period_s);
        R::section("stack pulses: share = min(alpha F_mean / F_stack, 1) sin^2(pi u)");
        let new = (period / (self.force_filter_s + period)).named("new_share");
        let changed_n = measured.force_n - state.mean_n;
        state.mean_n = new.mul_add(changed_n, state.mean_n).named("mean_n");
        let duty = (self.frequency_hz * self.pulse_width_s).named("duty");
        let u = (state.phase_cycles / duty).named("progress");
        let shape = half_sine(u.min(one));
        let share = (state.amplitude * shape * shape).named("stack_share");
        let next = self.frequency_hz.mul_add(period, state.phase_cycles).named("next_cycles");
        let starts = one.le(next);
        let wanted =
            (self.amplitude_ratio * state.mean_n / self.stack_force_n).named("wanted_share");
        state.amplitude = R::select(starts, wanted.clamp(zero, one), state.amplitude);
        state.phase_cycles = next - R::flag(starts);
        share
    }
}

impl<R: Real> Control<R> for VibratedFeed<R> {
    type State = VibratedFeedState<R>;

    #[inline(always)]
    fn step(&self, state: &mut VibratedFeedState<R>, measured: &Measurement<R>) -> Command<R> {
        let stack_share = self.pulses.share(&mut state.pulses, measured);
        let feed_m_per_s = self.feed.speed(&mut state.feed, measured.period_s);
        Command { force_n: R::zero(), feed_m_per_s, stack_share }
    }
}
