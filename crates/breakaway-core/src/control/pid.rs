//! Sampled PID force controller.

use super::{Control, Measurement};
use crate::actuator::Command;
use crate::maybe::Maybe;
use crate::name::{Name, within};
use crate::parameters::parameters;
use crate::real::Real;
use crate::reference::Setpoint;
use crate::states::states;

parameters! {
    /// PID gains.
    pub struct Gains {
        /// Proportional gain in N/m.
        pub kp_n_per_m,
        /// Integral gain in N/(m s).
        pub ki_n_per_m_s,
        /// Derivative gain in N s/m.
        pub kd_n_s_per_m,
    }
}

/// What the derivative term differentiates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum DerivativeOf {
    /// The error: kd (dr/dt − v). The reference's rate is known, not differenced.
    Error,
    /// The measurement: −kd v. No kick when the reference jumps.
    Measurement,
}

/// Where the controller takes the velocity from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum VelocityFrom {
    /// A velocity sensor (in simulation: the plant's velocity at the sample).
    Sensor,
    /// The backward difference of the measured position.
    PositionDifference,
}

/// What keeps the integral from winding up while the actuator is at a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum AntiWindup {
    /// Nothing; and the output is not limited by the controller either.
    Off,
    /// The integral stands still while it would drive the output further past a limit.
    Conditional,
    /// The integral is driven back by the excess over a tracking time.
    BackCalculation,
}

/// F = kp e + I + kd d, sampled every T_s.
///
/// ```text
/// I ← I + ki e T_s                            before use, held in N
/// d ← (1 − s) d + s d_raw                      s = T_s / (τ_f + T_s), d_raw = dr/dt − v or −v
/// ```
///
/// The integral is kept as a force, so a change of `ki` is bumpless by itself;
/// [`Pid::integral_after`] makes a change of all gains bumpless. `PidState` is what moves.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Pid<R> {
    /// Gains.
    pub gains: Gains<R>,
    /// What the derivative term differentiates.
    pub derivative_of: DerivativeOf,
    /// Where the velocity comes from.
    pub velocity_from: VelocityFrom,
    /// τ_f in s, time constant of the first-order filter on the derivative, if it has one.
    pub derivative_filter_s: Maybe<R>,
    /// What is done at the actuator's limits.
    pub anti_windup: AntiWindup,
    /// Tracking time in s of the back calculation, above 0.
    pub tracking_time_s: R,
}

states! {
    /// What moves in a PID.
    pub struct PidState {
        /// I in N.
        pub integral_n,
        /// d in m/s.
        pub derivative_m_per_s,
        /// The measured position at the last sample, m.
        pub previous_position_m,
    }
}

/// The filtered derivative in parts, d = kept + share · raw, so that a gain can be multiplied in
/// before the newest velocity is known. Nothing is kept without a filter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filtered<R> {
    kept: Maybe<R>,
    share: R,
    raw: R,
}

impl<R: Real> Gains<R> {
    /// kp e + kd d + I in N; the derivative last, because the velocity is the last to be known.
    #[inline(always)]
    fn force(&self, error_m: R, filtered: &Filtered<R>, integral_n: R) -> R {
        let kd = self.kd_n_s_per_m;
        let base = match filtered.kept.get() {
            Some(&kept) => kd.mul_add(kept, integral_n).named("kept_derivative_n"),
            None => integral_n,
        };
        let steady = self.kp_n_per_m.mul_add(error_m, base).named("proportional_n");
        (kd * filtered.share).mul_add(filtered.raw, steady)
    }
}

impl<R: Real> Pid<R> {
    /// Without options: on the error and a velocity sensor, unfiltered, without anti-windup.
    pub fn plain(gains: Gains<R>) -> Self {
        Self {
            gains,
            derivative_of: DerivativeOf::Error,
            velocity_from: VelocityFrom::Sensor,
            derivative_filter_s: Maybe::none(),
            anti_windup: AntiWindup::Off,
            tracking_time_s: R::one(),
        }
    }

    /// Whether this is [`Pid::plain`].
    pub fn is_plain(&self) -> bool {
        self.derivative_of == DerivativeOf::Error
            && self.velocity_from == VelocityFrom::Sensor
            && self.derivative_filter_s.is_none()
            && self.anti_windup == AntiWindup::Off
    }

    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Pid<S> {
        Pid {
            gains: within!("gains", self.gains, f),
            derivative_of: self.derivative_of,
            velocity_from: self.velocity_from,
            derivative_filter_s: self
                .derivative_filter_s
                .map(|tau| f(Name::of("derivative_filter_s"), tau)),
            anti_windup: self.anti_windup,
            tracking_time_s: f(Name::of("tracking_time_s"), self.tracking_time_s),
        }
    }

    /// The force in N at a sample.
    #[inline(always)]
    pub fn force(&self, state: &mut PidState<R>, measured: &Measurement<R>) -> R {
        let filtered = self.sense(state, measured);
        self.output(&self.gains, &filtered, state, measured)
    }

    /// Updates the filtered derivative from a sample; gives its parts.
    #[inline(always)]
    pub(super) fn sense(&self, state: &mut PidState<R>, measured: &Measurement<R>) -> Filtered<R> {
        R::section("PID, derivative: d = (1 - s) d + s d_raw, s = T_s / (tau_f + T_s)");
        let velocity = match self.velocity_from {
            VelocityFrom::Sensor => measured.velocity_m_per_s,
            VelocityFrom::PositionDifference => {
                let travel_m = measured.position_m - state.previous_position_m;
                (travel_m / measured.period_s).named("differenced_m_per_s")
            }
        };
        let raw = match self.derivative_of {
            DerivativeOf::Error => measured.reference_rate_m_per_s - velocity,
            DerivativeOf::Measurement => -velocity,
        }
        .named("raw_derivative_m_per_s");
        state.previous_position_m = measured.position_m;
        let Some(&filter_s) = self.derivative_filter_s.get() else {
            state.derivative_m_per_s = raw;
            return Filtered { kept: Maybe::none(), share: R::one(), raw };
        };
        let share = (measured.period_s / (filter_s + measured.period_s)).named("filter_share");
        let kept = ((R::one() - share) * state.derivative_m_per_s).named("kept_m_per_s");
        state.derivative_m_per_s = share.mul_add(raw, kept).ebbed().named("derivative_m_per_s");
        Filtered { kept: Maybe::some(kept), share, raw }
    }

    /// The force in N for `gains` after [`Pid::sense`]; moves the integral.
    #[inline(always)]
    pub(super) fn output(
        &self,
        gains: &Gains<R>,
        filtered: &Filtered<R>,
        state: &mut PidState<R>,
        measured: &Measurement<R>,
    ) -> R {
        R::section("PID: F = kp e + I + kd d, I = I + ki T_s e before use");
        let error = measured.error_m();
        let ki_n_per_m = (gains.ki_n_per_m_s * measured.period_s).named("ki_n_per_m");
        let advanced = ki_n_per_m.mul_add(error, state.integral_n).named("integral_n");
        let wanted = gains.force(error, filtered, advanced).named("wanted_n");
        let limited = measured.range.limit(wanted).named("limited_n");
        match self.anti_windup {
            AntiWindup::Off => {
                state.integral_n = advanced;
                wanted
            }
            AntiWindup::Conditional => {
                let winds_up = (limited.lt(wanted) & state.integral_n.lt(advanced))
                    | (wanted.lt(limited) & advanced.lt(state.integral_n));
                state.integral_n =
                    R::select(winds_up, state.integral_n, advanced).named("kept_integral_n");
                let force_n = gains.force(error, filtered, state.integral_n).named("unlimited_n");
                measured.range.limit(force_n).named("pid_n")
            }
            AntiWindup::BackCalculation => {
                let share = (measured.period_s / self.tracking_time_s).named("tracking_share");
                state.integral_n =
                    share.mul_add(limited - wanted, advanced).named("tracked_integral_n");
                limited
            }
        }
    }

    /// The integral in N with which this PID goes on from another with the gains `from` and the
    /// state `last`. Both have sensed the sample; neither has moved its integral.
    ///
    /// ```text
    /// I = I_from + (kp_from − kp) e + (kd_from − kd) d_from + kd (d_from − d)
    /// ```
    ///
    /// In this form the last term is zero to the bit where both derivatives are the same.
    #[inline(always)]
    pub fn integral_after(
        &self,
        from: &Gains<R>,
        last: &PidState<R>,
        sensed: &PidState<R>,
        measured: &Measurement<R>,
    ) -> R {
        R::section(
            "hand-over: I = I_from + (kp_from - kp) e + (kd_from - kd) d_from + kd (d_from - d)",
        );
        let (to, d) = (&self.gains, last.derivative_m_per_s);
        let bump = (from.kp_n_per_m - to.kp_n_per_m) * measured.error_m()
            + (from.kd_n_s_per_m - to.kd_n_s_per_m) * d
            + to.kd_n_s_per_m * (d - sensed.derivative_m_per_s);
        (last.integral_n + bump.named("bump_n")).named("taken_over_n")
    }

    /// The integral in N with which this PID goes on from a force: F − kp e − kd d, with the
    /// derivative as sensed.
    #[inline(always)]
    pub fn integral_from(&self, force_n: R, sensed: &PidState<R>, measured: &Measurement<R>) -> R {
        R::section("hand-over: I = F - kp e - kd d");
        let integral_n = force_n
            - self.gains.kp_n_per_m * measured.error_m()
            - self.gains.kd_n_s_per_m * sensed.derivative_m_per_s;
        integral_n.named("taken_over_n")
    }
}

impl<R: Real> Control<R> for Pid<R> {
    type State = PidState<R>;

    #[inline(always)]
    fn step(&self, state: &mut PidState<R>, measured: &Measurement<R>) -> Command<R> {
        Command::force(self.force(state, measured))
    }

    #[inline(always)]
    fn commanded_speed(
        &self,
        _state: &PidState<R>,
        setpoint: &Setpoint<R>,
        _command: &Command<R>,
    ) -> R {
        setpoint.rate_m_per_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::ForceRange;

    fn pid(anti_windup: AntiWindup) -> Pid<f64> {
        Pid {
            gains: Gains { kp_n_per_m: 1e4, ki_n_per_m_s: 2e5, kd_n_s_per_m: 50.0 },
            derivative_of: DerivativeOf::Error,
            velocity_from: VelocityFrom::Sensor,
            derivative_filter_s: Maybe::none(),
            anti_windup,
            tracking_time_s: 0.01,
        }
    }

    fn sample(reference_m: f64, position_m: f64) -> Measurement<f64> {
        Measurement {
            reference_m,
            reference_rate_m_per_s: 0.2,
            position_m,
            velocity_m_per_s: 0.05,
            force_n: 0.0,
            period_s: 1e-3,
            range: ForceRange { min_n: 0.0, max_n: 100.0 },
        }
    }

    #[test]
    fn one_sample_by_hand() {
        // kp e = 20, ki e T_s = 0.4, kd (dr/dt - v) = 7.5
        let force = pid(AntiWindup::Off).force(&mut PidState::at_rest(), &sample(0.002, 0.0));
        assert!((force - 27.9).abs() < 1e-12, "{force}");
    }

    #[test]
    fn derivative_of_the_measurement_ignores_the_reference() {
        let controller = Pid { derivative_of: DerivativeOf::Measurement, ..pid(AntiWindup::Off) };
        let force = controller.force(&mut PidState::at_rest(), &sample(0.002, 0.0));
        assert!((force - (20.4 - 2.5)).abs() < 1e-12, "{force}");
    }

    #[test]
    fn differenced_and_filtered_velocity_settles_on_the_true_one() {
        let controller = Pid {
            derivative_of: DerivativeOf::Measurement,
            velocity_from: VelocityFrom::PositionDifference,
            derivative_filter_s: Maybe::some(5e-3),
            ..pid(AntiWindup::Off)
        };
        let mut state = PidState::at_rest();
        for n in 1..100 {
            controller.force(&mut state, &sample(0.0, 0.3 * 1e-3 * f64::from(n)));
            if n == 1 {
                assert!((state.derivative_m_per_s + 0.3 / 6.0).abs() < 1e-12); // T_s/(tau+T_s)
            }
        }
        assert!((state.derivative_m_per_s + 0.3).abs() < 1e-6);
    }

    #[test]
    fn without_anti_windup_the_integral_grows_and_with_it_it_does_not() {
        let wound = |anti_windup| {
            let (controller, mut state) = (pid(anti_windup), PidState::at_rest());
            for _ in 0..1000 {
                controller.force(&mut state, &sample(0.05, 0.0));
            }
            state.integral_n
        };
        assert!((wound(AntiWindup::Off) - 10_000.0).abs() < 1e-6);
        assert_eq!(wound(AntiWindup::Conditional), 0.0);
        // In balance: 10 N in per sample, (wanted - 100) / 10 out.
        assert!((wound(AntiWindup::BackCalculation) + 317.5).abs() < 10.0);
    }

    #[test]
    fn leaving_a_limit_is_prompt_with_anti_windup() {
        let controller = pid(AntiWindup::Conditional);
        let mut state = PidState::at_rest();
        for _ in 0..1000 {
            assert_eq!(controller.force(&mut state, &sample(0.05, 0.0)), 100.0);
        }
        assert!(controller.force(&mut state, &sample(0.0, 0.001)) < 1.0);
    }

    #[test]
    fn taking_over_new_gains_does_not_bump() {
        let controller = pid(AntiWindup::Off);
        let new = Gains { kp_n_per_m: 3e3, ki_n_per_m_s: 0.0, kd_n_s_per_m: 400.0 };
        let (mut state, measured) = (PidState::at_rest(), sample(0.002, 0.0));
        let before = controller.force(&mut state, &measured);
        let next = Pid { gains: new, derivative_filter_s: Maybe::some(5e-3), ..controller };
        let mut sensed = PidState::at_rest();
        let filtered = next.sense(&mut sensed, &measured);
        assert!(sensed.derivative_m_per_s < 0.5 * state.derivative_m_per_s);
        for integral_n in [
            next.integral_after(&controller.gains, &state, &sensed, &measured),
            next.integral_from(before, &sensed, &measured),
        ] {
            let mut taken_over = PidState { integral_n, ..sensed };
            let after = next.output(&new, &filtered, &mut taken_over, &measured);
            assert!((after - before).abs() < 1e-12);
        }
    }
}
