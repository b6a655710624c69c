//! The vibration controller of the paper.

use super::{Control, FmVibration, FmVibrationState, Measurement, Pid, PidState};
use crate::actuator::Command;
use crate::name::{Name, within};
use crate::real::Real;
use crate::reference::Setpoint;
use crate::states::states;

/// A PID whose output is the amplitude of pulses.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct VibratingPid<R> {
    /// Sets the amplitude.
    pub pid: Pid<R>,
    /// Sets frequency, width and shape of the pulses.
    pub vibration: FmVibration<R>,
}

states! {
    /// What moves in a PID that sets the amplitude of pulses.
    pub struct VibratingPidState with {
        /// The PID.
        pub pid: PidState,
        /// The pulses.
        pub vibration: FmVibrationState,
    }
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

impl<R: Real> Control<R> for VibratingPid<R> {
    type State = VibratingPidState<R>;

    #[inline(always)]
    fn step(&self, state: &mut VibratingPidState<R>, measured: &Measurement<R>) -> Command<R> {
        let amplitude_n = self.pid.force(&mut state.pid, measured);
        Command::force(self.vibration.force(&mut state.vibration, amplitude_n, measured))
    }

    #[inline(always)]
    fn commanded_speed(
        &self,
        _state: &VibratingPidState<R>,
        setpoint: &Setpoint<R>,
        _command: &Command<R>,
    ) -> R {
        setpoint.rate_m_per_s
    }
}
