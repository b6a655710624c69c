//! The paper's supervisor: any breakaway controller, then any vibration controller.

use super::{
    ControllerState, ForceRamp, Measurement, Pid, PidState, TimedImpacts, TimedImpactsState,
    VibratingPid, VibrationState,
};
use crate::name::{Name, within};
use crate::real::Real;
use crate::reference::Setpoint;

/// One controller until the joint breaks loose, then another that vibrates.
///
/// ```text
///              x > breakaway travel
///  ┌───────────┐                  ┌───────────────┐
///  │ breakaway │ ───────────────> │   vibration   │
///  │ PID, ramp │    taken over    │ PID × FM, or  │
///  └───────────┘  without a bump  │ timed impacts │
///                                 └───────────────┘
/// ```
///
/// The joint counts as loose once the part has traveled further than bristles can stretch;
/// choose the travel above F_s0 / k_e. There is no way back: a joint that sticks again is hit again.
///
/// What FM vibration takes over is the amplitude; the force itself falls to the start of the first
/// pulse. Its PID senses the derivative d₂ during step 1 and starts with the integral
///
/// ```text
/// after a ramp   I₂ = F_last − kp₂ e − kd₂ d₂                   F_last the last commanded force
/// after a PID    I₂ = I₁ + (kp₁ e + kd₁ d₁) − (kp₂ e + kd₂ d₂)  I₁ before this sample
/// ```
///
/// The latter goes on from what the PID would command now, before its limits: e is of now, too.
/// Timed impacts begin afresh where the part is: at their F_1, with a clock that starts then.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct TwoStep<R> {
    /// Step 1.
    pub breakaway: FirstStep<R>,
    /// Step 2.
    pub vibration: SecondStep<R>,
    /// Travel in m at which the joint counts as loose.
    pub breakaway_travel_m: R,
}

/// A controller that breaks the joint loose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum FirstStep<R> {
    /// Step 1 of the paper: a continuous force.
    Pid(Pid<R>),
    /// A force that grows until the joint is loose.
    ForceRamp(ForceRamp<R>),
}

/// A controller that vibrates a loose part out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum SecondStep<R> {
    /// Step 2 of the paper: a PID whose output is the amplitude of pulses.
    FmVibration(VibratingPid<R>),
    /// Impacts that time themselves.
    TimedImpacts(TimedImpacts<R>),
}

impl<R: Real> TwoStep<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> TwoStep<S> {
        TwoStep {
            breakaway: within!("breakaway", self.breakaway, f),
            vibration: within!("vibration", self.vibration, f),
            breakaway_travel_m: f(Name::of("breakaway_travel_m"), self.breakaway_travel_m),
        }
    }

    /// The force in N at a sample. Both steps are computed; what the other one moved is dropped.
    #[inline(always)]
    pub(super) fn step(&self, state: &mut ControllerState<R>, measured: &Measurement<R>) -> R {
        R::section("supervisor: loose once x > breakaway travel");
        let before = state.vibration;
        let was_vibrating = before.vibrating.is_set();
        let vibrating = was_vibrating | self.breakaway_travel_m.lt(measured.position_m);

        let (mut one, mut two) = (before, before);
        let push = self.breakaway.step(&mut one, measured);
        let hit = match &self.vibration {
            SecondStep::FmVibration(c) => {
                let mut pid = before.vibration_pid();
                let filtered = c.pid.sense(&mut pid, measured);
                one.set_sensed(&pid);
                let taken_over = self.breakaway.hand_over(&before, &one, &c.pid, &pid, measured);
                pid.integral_n = R::select(was_vibrating, before.integral_n, taken_over);
                let amplitude = c.pid.output(&c.pid.gains, &filtered, &mut pid, measured);
                two.integral_n = pid.integral_n;
                two.set_sensed(&pid);
                let mut pulses = before.pulses();
                let hit = c.vibration.step(&mut pulses, amplitude, measured);
                two.set_pulses(pulses);
                hit
            }
            SecondStep::TimedImpacts(c) => {
                let mut moved = state.impacts;
                let hit = c.step(&mut moved, measured).force_n;
                state.impacts = TimedImpactsState::select(vibrating, &moved, &state.impacts);
                hit
            }
        };
        R::section("supervisor: what moves is that of the step it is in");
        state.vibration = VibrationState::select(vibrating, &two, &one);
        state.vibration.vibrating = R::flag(vibrating);
        R::select(vibrating, hit, push).named("two_step_n")
    }

    /// The speed in m/s that the part is meant to have: that of the step it is in.
    #[inline(always)]
    pub(super) fn commanded_speed(&self, state: &VibrationState<R>, setpoint: &Setpoint<R>) -> R {
        let one = match self.breakaway {
            FirstStep::Pid(_) => setpoint.rate_m_per_s,
            FirstStep::ForceRamp(_) => R::zero(),
        };
        let two = match self.vibration {
            SecondStep::FmVibration(_) => setpoint.rate_m_per_s,
            SecondStep::TimedImpacts(_) => R::zero(),
        };
        R::select(state.vibrating.is_set(), two, one)
    }
}

impl<R: Real> FirstStep<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> FirstStep<S> {
        match self {
            Self::Pid(pid) => FirstStep::Pid(pid.map(f)),
            Self::ForceRamp(c) => FirstStep::ForceRamp(c.map(f)),
        }
    }

    #[inline(always)]
    fn step(&self, state: &mut VibrationState<R>, measured: &Measurement<R>) -> R {
        match self {
            Self::Pid(pid) => {
                let mut moved = state.pid();
                let force = pid.step(&mut moved, measured);
                state.set_pid(moved);
                force
            }
            Self::ForceRamp(c) => c.step(&mut state.ramp_n, measured).force_n,
        }
    }

    /// The integral in N with which `next` goes on, from what moves in this step before and after
    /// the sample. Both have sensed it.
    #[inline(always)]
    fn hand_over(
        &self,
        before: &VibrationState<R>,
        after: &VibrationState<R>,
        next: &Pid<R>,
        sensed: &PidState<R>,
        measured: &Measurement<R>,
    ) -> R {
        match self {
            Self::Pid(pid) => {
                let now = PidState { integral_n: before.integral_n, ..after.pid() };
                next.integral_after(&pid.gains, &now, sensed, measured)
            }
            Self::ForceRamp(_) => next.integral_from(before.ramp_n, sensed, measured),
        }
    }
}

impl<R: Real> SecondStep<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> SecondStep<S> {
        match self {
            Self::FmVibration(c) => SecondStep::FmVibration(c.map(f)),
            Self::TimedImpacts(c) => SecondStep::TimedImpacts(c.map(f)),
        }
    }
}
