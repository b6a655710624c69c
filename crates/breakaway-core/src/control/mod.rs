//! Sampled controllers, one file each.
//!
//! A controller is stepped once per control period with what it measures and gives a commanded
//! force that is held until the next sample. To add one: a file here, a variant of [`Controller`].

mod cascade;
mod fm_vibration;
mod force_ramp;
mod pid;
mod steady_feed;
mod timed_impacts;
mod two_step;
mod vibrated_feed;
mod watch;

pub use cascade::{Cascade, CascadeState};
pub use fm_vibration::{FmVibration, FmVibrationState, PulseShape};
pub use force_ramp::ForceRamp;
pub use pid::{AntiWindup, DerivativeOf, Gains, Pid, PidState, VelocityFrom};
pub use steady_feed::SteadyFeed;
pub use timed_impacts::{ImpactNumbers, TimedImpacts, TimedImpactsState};
pub use two_step::{FirstStep, SecondStep, TwoStep};
pub use vibrated_feed::{StackPulses, VibratedFeed, VibratedFeedState};
pub use watch::{Watch, WatchState};

use crate::actuator::{Command, ForceRange};
use crate::name::{Name, within};
use crate::parameters::parameters;
use crate::real::Real;
use crate::reference::Setpoint;

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

parameters! {
    /// What moves in the paper's controllers. A controller leaves alone what it does not use.
    pub struct VibrationState {
        /// The integral term of the PID, N.
        pub integral_n,
        /// The filtered derivative of the PID, m/s.
        pub derivative_m_per_s,
        /// The same of the PID that sets the amplitude of step 2, sensed from the start, m/s.
        pub vibration_derivative_m_per_s,
        /// The last measured position, m.
        pub previous_position_m,
        /// The phase of the vibration in cycles, 0 to 1.
        pub phase_cycles,
        /// Time since the start of the last pulse, s.
        pub since_pulse_s,
        /// 1 once the two-step supervisor vibrates, else 0.
        pub vibrating,
        /// The force of the ramp, N.
        pub ramp_n,
    }
}

/// What moves in any controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControllerState<R> {
    /// PID, pulses, ramp.
    pub vibration: VibrationState<R>,
    /// Timed impacts.
    pub impacts: TimedImpactsState<R>,
    /// Feeds.
    pub feed: VibratedFeedState<R>,
}

impl<R: Real> ControllerState<R> {
    /// Before the first sample, with the part at `position_m`.
    pub fn at_rest(position_m: R) -> Self {
        let zero = R::zero();
        Self {
            vibration: VibrationState {
                integral_n: zero,
                derivative_m_per_s: zero,
                vibration_derivative_m_per_s: zero,
                previous_position_m: position_m,
                phase_cycles: zero,
                since_pulse_s: zero,
                vibrating: zero,
                ramp_n: zero,
            },
            impacts: TimedImpactsState::at_rest(),
            feed: VibratedFeedState::at_rest(),
        }
    }

    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> ControllerState<S> {
        ControllerState {
            vibration: within!("vibration", self.vibration, f),
            impacts: within!("impacts", self.impacts, f),
            feed: within!("feed", self.feed, f),
        }
    }
}

impl<R: Real> VibrationState<R> {
    #[inline(always)]
    pub(crate) fn pid(&self) -> PidState<R> {
        PidState {
            integral_n: self.integral_n,
            derivative_m_per_s: self.derivative_m_per_s,
            previous_position_m: self.previous_position_m,
        }
    }

    #[inline(always)]
    pub(crate) fn set_pid(&mut self, pid: PidState<R>) {
        self.integral_n = pid.integral_n;
        self.derivative_m_per_s = pid.derivative_m_per_s;
        self.previous_position_m = pid.previous_position_m;
    }

    /// The PID of step 2.
    #[inline(always)]
    fn vibration_pid(&self) -> PidState<R> {
        PidState { derivative_m_per_s: self.vibration_derivative_m_per_s, ..self.pid() }
    }

    /// What the PID of step 2 moves when it senses.
    #[inline(always)]
    fn set_sensed(&mut self, pid: &PidState<R>) {
        self.vibration_derivative_m_per_s = pid.derivative_m_per_s;
        self.previous_position_m = pid.previous_position_m;
    }

    #[inline(always)]
    fn pulses(&self) -> FmVibrationState<R> {
        FmVibrationState { phase_cycles: self.phase_cycles, since_pulse_s: self.since_pulse_s }
    }

    #[inline(always)]
    fn set_pulses(&mut self, pulses: FmVibrationState<R>) {
        self.phase_cycles = pulses.phase_cycles;
        self.since_pulse_s = pulses.since_pulse_s;
    }
}

/// The vibration controller of the paper: a PID whose output is the amplitude of pulses.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct VibratingPid<R> {
    /// Sets the amplitude.
    pub pid: Pid<R>,
    /// Sets frequency, width and shape of the pulses.
    pub vibration: FmVibration<R>,
}

impl<R: Real> VibratingPid<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> VibratingPid<S> {
        VibratingPid {
            pid: within!("pid", self.pid, f),
            vibration: within!("vibration", self.vibration, f),
        }
    }
}

/// A controller.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum Controller<R> {
    /// Step 1 of the paper alone: a continuous force.
    Pid(Pid<R>),
    /// Vibration from the first sample on.
    FmVibration(VibratingPid<R>),
    /// One controller until breakaway, then another that vibrates.
    TwoStep(TwoStep<R>),
    /// A force that grows until the part is out.
    ForceRamp(ForceRamp<R>),
    /// A constant speed of the feed.
    SteadyFeed(SteadyFeed<R>),
    /// Impacts that time themselves.
    TimedImpacts(TimedImpacts<R>),
    /// A constant speed of the feed, and pulses of a stack.
    VibratedFeed(VibratedFeed<R>),
}

impl<R: Real> Controller<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Controller<S> {
        match self {
            Self::Pid(pid) => Controller::Pid(pid.map(f)),
            Self::FmVibration(c) => Controller::FmVibration(c.map(f)),
            Self::TwoStep(c) => Controller::TwoStep(c.map(f)),
            Self::ForceRamp(c) => Controller::ForceRamp(c.map(f)),
            Self::SteadyFeed(c) => Controller::SteadyFeed(c.map(f)),
            Self::TimedImpacts(c) => Controller::TimedImpacts(c.map(f)),
            Self::VibratedFeed(c) => Controller::VibratedFeed(c.map(f)),
        }
    }

    /// The command at a sample.
    #[inline(always)]
    pub fn step(&self, state: &mut ControllerState<R>, measured: &Measurement<R>) -> Command<R> {
        match self {
            Self::Pid(pid) => {
                let mut pid_state = state.vibration.pid();
                let force = pid.step(&mut pid_state, measured);
                state.vibration.set_pid(pid_state);
                Command::force(force)
            }
            Self::FmVibration(c) => {
                let mut pid_state = state.vibration.pid();
                let amplitude = c.pid.step(&mut pid_state, measured);
                state.vibration.set_pid(pid_state);
                let mut pulses = state.vibration.pulses();
                let force = c.vibration.step(&mut pulses, amplitude, measured);
                state.vibration.set_pulses(pulses);
                Command::force(force)
            }
            Self::TwoStep(c) => Command::force(c.step(state, measured)),
            Self::ForceRamp(c) => c.step(&mut state.vibration.ramp_n, measured),
            Self::SteadyFeed(c) => c.step(&mut state.feed.elapsed_s, measured.period_s),
            Self::TimedImpacts(c) => c.step(&mut state.impacts, measured),
            Self::VibratedFeed(c) => c.step(&mut state.feed, measured),
        }
    }

    /// The speed in m/s that the part is meant to have after a step: what is faster is a jump.
    #[inline(always)]
    pub fn commanded_speed(
        &self,
        state: &ControllerState<R>,
        setpoint: &Setpoint<R>,
        command: &Command<R>,
    ) -> R {
        match self {
            Self::Pid(_) | Self::FmVibration(_) => setpoint.rate_m_per_s,
            Self::TwoStep(c) => c.commanded_speed(&state.vibration, setpoint),
            Self::SteadyFeed(_) | Self::VibratedFeed(_) => command.feed_m_per_s,
            Self::ForceRamp(_) | Self::TimedImpacts(_) => R::zero(),
        }
    }
}
