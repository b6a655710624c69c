//! Sampled controllers, one file each.
//!
//! A controller is stepped once per control period with what it measures and gives a commanded
//! force that is held until the next sample. To add one: a file here, a variant of [`Controller`].

mod cascade;
mod fm_vibration;
mod pid;
mod two_step;

pub use cascade::{Cascade, CascadeState};
pub use fm_vibration::{FmVibration, FmVibrationState, PulseShape};
pub use pid::{AntiWindup, DerivativeOf, Gains, Pid, PidState, VelocityFrom};
pub use two_step::TwoStep;

use crate::actuator::ForceRange;
use crate::parameters::parameters;
use crate::real::Real;

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
    /// T_s in s, the control period.
    pub period_s: R,
    /// What the actuator can deliver.
    pub range: ForceRange<R>,
}

impl<R: Real> Measurement<R> {
    /// e = r − x in m.
    #[inline(always)]
    pub fn error_m(&self) -> R {
        self.reference_m - self.position_m
    }
}

parameters! {
    /// What moves in any controller. A controller leaves alone what it does not use.
    pub struct ControllerState {
        /// The integral term of the PID, N.
        pub integral_n,
        /// The filtered derivative of the PID, m/s.
        pub derivative_m_per_s,
        /// The last measured position, m.
        pub previous_position_m,
        /// The phase of the vibration in cycles, 0 to 1.
        pub phase_cycles,
        /// Time since the start of the last pulse, s.
        pub since_pulse_s,
        /// 1 once the two-step supervisor vibrates, else 0.
        pub vibrating,
    }
}

impl<R: Real> ControllerState<R> {
    /// Before the first sample, with the part at `position_m`.
    pub fn at_rest(position_m: R) -> Self {
        let zero = R::zero();
        Self {
            integral_n: zero,
            derivative_m_per_s: zero,
            previous_position_m: position_m,
            phase_cycles: zero,
            since_pulse_s: zero,
            vibrating: zero,
        }
    }

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
}

impl<R: Real> ControllerState<R> {
    #[inline(always)]
    fn vibration(&self) -> FmVibrationState<R> {
        FmVibrationState { phase_cycles: self.phase_cycles, since_pulse_s: self.since_pulse_s }
    }

    #[inline(always)]
    fn set_vibration(&mut self, vibration: FmVibrationState<R>) {
        self.phase_cycles = vibration.phase_cycles;
        self.since_pulse_s = vibration.since_pulse_s;
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

/// A controller.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum Controller<R> {
    /// Step 1 of the paper alone: a continuous force.
    Pid(Pid<R>),
    /// Vibration from the first sample on.
    FmVibration(VibratingPid<R>),
    /// A continuous force until breakaway, then vibration.
    TwoStep(TwoStep<R>),
}

impl<R: Real> Controller<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(&'static str, R) -> S) -> Controller<S> {
        match self {
            Self::Pid(pid) => Controller::Pid(pid.map(f)),
            Self::FmVibration(c) => Controller::FmVibration(VibratingPid {
                pid: c.pid.map(f),
                vibration: c.vibration.map(f),
            }),
            Self::TwoStep(c) => Controller::TwoStep(c.map(f)),
        }
    }

    /// The commanded force in N at a sample.
    #[inline(always)]
    pub fn step(&self, state: &mut ControllerState<R>, measured: &Measurement<R>) -> R {
        match self {
            Self::Pid(pid) => {
                let mut pid_state = state.pid();
                let force = pid.step(&mut pid_state, measured);
                state.set_pid(pid_state);
                force
            }
            Self::FmVibration(c) => {
                let mut pid_state = state.pid();
                let amplitude = c.pid.step(&mut pid_state, measured);
                state.set_pid(pid_state);
                let mut vibration = state.vibration();
                let force = c.vibration.step(&mut vibration, amplitude, measured);
                state.set_vibration(vibration);
                force
            }
            Self::TwoStep(c) => c.step(state, measured),
        }
    }
}
