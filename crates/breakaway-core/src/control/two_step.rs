//! The paper's control in two steps.

use super::{FmVibration, FmVibrationState, Gains, Measurement, Pid, VibrationState};
use crate::real::Real;

/// A PID until the joint breaks loose, then vibration with gains of its own.
///
/// ```text
///              x > breakaway travel
///  ┌───────────┐                  ┌───────────┐
///  │ breakaway │ ───────────────> │ vibration │
///  │    PID    │  gains taken     │ PID × FM  │
///  └───────────┘  over bumplessly └───────────┘
/// ```
///
/// The joint counts as loose once the part has traveled further than bristles can stretch;
/// choose the travel above F_s0 / k_e. What is taken over is the amplitude: the force itself falls to
/// the start of the first pulse. There is no way back: a joint that sticks again is hit again.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct TwoStep<R> {
    /// The PID of step 1, whose settings but for the gains also hold in step 2.
    pub pid: Pid<R>,
    /// The gains of step 2.
    pub vibration_gains: Gains<R>,
    /// The pulses of step 2.
    pub vibration: FmVibration<R>,
    /// Travel in m at which the joint counts as loose.
    pub breakaway_travel_m: R,
}

impl<R: Real> TwoStep<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(&'static str, R) -> S) -> TwoStep<S> {
        TwoStep {
            pid: self.pid.map(f),
            vibration_gains: self.vibration_gains.map(f),
            vibration: self.vibration.map(f),
            breakaway_travel_m: f("breakaway_travel_m", self.breakaway_travel_m),
        }
    }

    #[inline(always)]
    pub(super) fn step(&self, state: &mut VibrationState<R>, measured: &Measurement<R>) -> R {
        let mut pid = state.pid();
        let filtered = self.pid.sense(&mut pid, measured);

        let loose = self.breakaway_travel_m.lt(measured.position_m);
        let was_vibrating = state.vibrating.is_set();
        let vibrating = was_vibrating | loose;
        let mut taken_over = pid;
        self.pid.take_over(&self.pid.gains, &self.vibration_gains, &mut taken_over, measured);
        pid.integral_n =
            R::select(vibrating & !was_vibrating, taken_over.integral_n, pid.integral_n);
        state.vibrating = R::flag(vibrating);

        let gains = self.gains(vibrating);
        let force = self.pid.output(&gains, &filtered, &mut pid, measured);
        state.set_pid(pid);
        let waiting = state.pulses();
        let mut moved = waiting;
        let pulsed = self.vibration.step(&mut moved, force, measured);
        let kept = |moved: R, waiting: R| R::select(vibrating, moved, waiting);
        state.set_pulses(FmVibrationState {
            phase_cycles: kept(moved.phase_cycles, waiting.phase_cycles),
            since_pulse_s: kept(moved.since_pulse_s, waiting.since_pulse_s),
        });
        R::select(vibrating, pulsed, force)
    }

    #[inline(always)]
    fn gains(&self, vibrating: R::Mask) -> Gains<R> {
        let (one, two) = (&self.pid.gains, &self.vibration_gains);
        Gains {
            kp_n_per_m: R::select(vibrating, two.kp_n_per_m, one.kp_n_per_m),
            ki_n_per_m_s: R::select(vibrating, two.ki_n_per_m_s, one.ki_n_per_m_s),
            kd_n_s_per_m: R::select(vibrating, two.kd_n_s_per_m, one.kd_n_s_per_m),
        }
    }
}
