//! The paper's supervisor: any breakaway controller, then any vibration controller.

use super::controller::controllers;
use super::{
    Control, FmVibrationState, ForceRamp, ForceRampState, Measurement, Pid, PidState, TimedImpacts,
    TimedImpactsState, VibratingPid, VibratingPidState,
};
use crate::actuator::Command;
use crate::name::{Name, within};
use crate::real::Real;
use crate::reference::Setpoint;
use crate::states::states;

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

controllers! {
    /// A controller that breaks the joint loose.
    pub enum FirstStep;
    /// What moves in step 1.
    pub struct FirstStepState;

    /// Step 1 of the paper: a continuous force.
    Pid(Pid) with pid: PidState,
    /// A force that grows until the joint is loose.
    ForceRamp(ForceRamp) with force_ramp: ForceRampState,
}

controllers! {
    /// A controller that vibrates a loose part out.
    pub enum SecondStep;
    /// What moves in step 2.
    pub struct SecondStepState;

    /// Step 2 of the paper: a PID whose output is the amplitude of pulses.
    FmVibration(VibratingPid) with fm_vibration: VibratingPidState,
    /// Impacts that time themselves.
    TimedImpacts(TimedImpacts) with timed_impacts: TimedImpactsState,
}

states! {
    /// What moves in two steps. Step 1 stands still once step 2 moves; before, step 2 only senses.
    pub struct TwoStepState {
        /// 1 once it vibrates, else 0.
        pub vibrating,
    } with {
        /// Step 1.
        pub breakaway: FirstStepState,
        /// Step 2.
        pub vibration: SecondStepState,
    }
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
}

impl<R: Real> Control<R> for TwoStep<R> {
    type State = TwoStepState<R>;

    /// Both steps are computed; what the other one moved is dropped.
    #[inline(always)]
    fn step(&self, state: &mut TwoStepState<R>, measured: &Measurement<R>) -> Command<R> {
        R::section("supervisor: loose once x > breakaway travel");
        let was_vibrating = state.vibrating.is_set();
        let vibrating = was_vibrating | self.breakaway_travel_m.lt(measured.position_m);
        let mut breakaway = state.breakaway;
        let push_n = self.breakaway.step(&mut breakaway, measured).force_n;
        let hit_n = match &self.vibration {
            SecondStep::FmVibration(second) => {
                let moving = &mut state.vibration.fm_vibration;
                let filtered = second.pid.sense(&mut moving.pid, measured);
                let steps = [&state.breakaway, &breakaway];
                let taken_over_n =
                    self.breakaway.hand_over(steps, &second.pid, &moving.pid, measured);
                let integral_n = R::select(was_vibrating, moving.pid.integral_n, taken_over_n);
                moving.pid.integral_n = integral_n;
                let amplitude_n =
                    second.pid.output(&second.pid.gains, &filtered, &mut moving.pid, measured);
                let mut pulses = moving.vibration;
                let hit_n = second.vibration.force(&mut pulses, amplitude_n, measured);
                moving.vibration = FmVibrationState::select(vibrating, &pulses, &moving.vibration);
                hit_n
            }
            SecondStep::TimedImpacts(second) => {
                let moving = &mut state.vibration.timed_impacts;
                let mut moved = *moving;
                let hit_n = second.step(&mut moved, measured).force_n;
                *moving = TimedImpactsState::select(vibrating, &moved, moving);
                hit_n
            }
        };
        R::section("supervisor: what moves is that of the step it is in");
        state.breakaway = FirstStepState::select(vibrating, &state.breakaway, &breakaway);
        state.vibrating = R::flag(vibrating);
        Command::force(R::select(vibrating, hit_n, push_n).named("two_step_n"))
    }

    /// That of the step it is in.
    #[inline(always)]
    fn commanded_speed(
        &self,
        state: &TwoStepState<R>,
        setpoint: &Setpoint<R>,
        command: &Command<R>,
    ) -> R {
        let one = self.breakaway.commanded_speed(&state.breakaway, setpoint, command);
        let two = self.vibration.commanded_speed(&state.vibration, setpoint, command);
        R::select(state.vibrating.is_set(), two, one)
    }
}

impl<R: Real> FirstStep<R> {
    /// The integral in N with which `next` goes on, from what moves in this step before and after
    /// the sample. Both have sensed it.
    #[inline(always)]
    fn hand_over(
        &self,
        [before, after]: [&FirstStepState<R>; 2],
        next: &Pid<R>,
        sensed: &PidState<R>,
        measured: &Measurement<R>,
    ) -> R {
        match self {
            Self::Pid(pid) => {
                let now = PidState { integral_n: before.pid.integral_n, ..after.pid };
                next.integral_after(&pid.gains, &now, sensed, measured)
            }
            Self::ForceRamp(_) => next.integral_from(before.force_ramp.force_n, sensed, measured),
        }
    }
}
