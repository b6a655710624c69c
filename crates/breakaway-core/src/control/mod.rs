//! Sampled controllers, one file each.
//!
//! A controller is stepped once per control period with what it measures and gives a command that is
//! held until the next sample. To add one: a file here, and a line in the list of [`Controller`].

mod cascade;
mod controller;
mod fm_vibration;
mod force_ramp;
mod pid;
mod steady_feed;
mod timed_impacts;
mod two_step;
mod vibrated_feed;
mod vibrating_pid;
mod watch;

pub use cascade::{Cascade, CascadeState};
pub use controller::Control;
pub use fm_vibration::{FmVibration, FmVibrationState, PulseShape};
pub use force_ramp::{ForceRamp, ForceRampState};
pub use pid::{AntiWindup, DerivativeOf, Gains, Pid, PidState, VelocityFrom};
pub use steady_feed::{SteadyFeed, SteadyFeedState};
pub use timed_impacts::{ImpactNumbers, TimedImpacts, TimedImpactsState};
pub use two_step::{FirstStep, FirstStepState, SecondStep, SecondStepState, TwoStep, TwoStepState};
pub use vibrated_feed::{StackPulses, StackPulsesState, VibratedFeed, VibratedFeedState};
pub use vibrating_pid::{VibratingPid, VibratingPidState};
pub use watch::{Watch, WatchState};

use crate::actuator::ForceRange;
use crate::real::Real;
use controller::controllers;

/// What a controller knows at a sample.
#[derive(Clone, Copy, Debug)]
pub struct Measurement<R> {
    /// r in m.
    pub reference_m: R,
    /// dr/dt in m/s.
    pub reference_rate_m_per_s: R,
    /// x in m.
    pub position_m: R,
    /// v in m/s; used only by controllers that are told to trust it.
    pub velocity_m_per_s: R,
    /// F in N, the force on the part as measured.
    pub force_n: R,
    /// T_s in s, the control period.
    pub period_s: R,
    /// What the actuator can deliver.
    pub range: ForceRange<R>,
}

impl<R: Real> Measurement<R> {
    /// e = r − x in m.
    #[inline(always)]
    pub fn error_m(&self) -> R {
        (self.reference_m - self.position_m).named("error_m")
    }
}

controllers! {
    /// A controller.
    pub enum Controller;
    /// What moves in any controller: each moves its own.
    pub struct ControllerState;

    /// Step 1 of the paper alone: a continuous force.
    Pid(Pid) with pid: PidState,
    /// Vibration from the first sample on.
    FmVibration(VibratingPid) with fm_vibration: VibratingPidState,
    /// One controller until breakaway, then another that vibrates.
    TwoStep(TwoStep) with two_step: TwoStepState,
    /// A force that grows until the part is out.
    ForceRamp(ForceRamp) with force_ramp: ForceRampState,
    /// A constant speed of the feed.
    SteadyFeed(SteadyFeed) with steady_feed: SteadyFeedState,
    /// Impacts that time themselves.
    TimedImpacts(TimedImpacts) with timed_impacts: TimedImpactsState,
    /// A constant speed of the feed, and pulses of a stack.
    VibratedFeed(VibratedFeed) with vibrated_feed: VibratedFeedState,
}
