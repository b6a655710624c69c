//! Frequency-modulated vibration.

use super::Measurement;
use crate::name::Name;
use crate::real::Real;
use crate::sine::half_sine;
use crate::states::states;

/// The course of the force during a pulse, from 0 to 1 and back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum PulseShape {
    /// Full force from start to end.
    Rectangular,
    /// sin(π u).
    HalfSine,
    /// sin²(π u).
    RaisedCosine,
}

/// Pulses whose amplitude is given and whose frequency follows the error (paper, section 4.2).
///
/// ```text
/// f = f_min + (f_max − f_min) min(|e| / e_full, 1)       pulse frequency
/// u = time since the pulse's start / t_p                  progress of the pulse of width t_p
/// F = A (b + (1 − b) shape(u))  for u < 1,  A b after     b the share held between pulses
/// ```
///
/// A pulse starts when the phase, the integral of f, completes a cycle. Its width is that of a clock,
/// whatever f does meanwhile. The paper gives 80 to 160 Hz; `e_full`, the width and the shape are not printed. Not checked
/// here: f_max below half the sampling rate, pulses that do not overlap (t_p f_max ≤ 1).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct FmVibration<R> {
    /// f_min in Hz, at no error.
    pub frequency_min_hz: R,
    /// f_max in Hz, at full error.
    pub frequency_max_hz: R,
    /// e_full in m.
    pub error_full_scale_m: R,
    /// t_p in s.
    pub pulse_width_s: R,
    /// b, 0 to 1: the share of the amplitude that is held between pulses.
    pub base_fraction: R,
    /// The pulse's shape.
    pub shape: PulseShape,
}

states! {
    /// What moves in pulses.
    pub struct FmVibrationState {
        /// Phase in cycles, 0 to 1.
        pub phase_cycles,
        /// Time in s since the pulse's start.
        pub since_pulse_s,
    }
}

impl<R: Real> FmVibration<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> FmVibration<S> {
        FmVibration {
            frequency_min_hz: f(Name::of("frequency_min_hz"), self.frequency_min_hz),
            frequency_max_hz: f(Name::of("frequency_max_hz"), self.frequency_max_hz),
            error_full_scale_m: f(Name::of("error_full_scale_m"), self.error_full_scale_m),
            pulse_width_s: f(Name::of("pulse_width_s"), self.pulse_width_s),
            base_fraction: f(Name::of("base_fraction"), self.base_fraction),
            shape: self.shape,
        }
    }

    /// The pulse frequency in Hz for an error in m.
    #[inline(always)]
    pub fn frequency(&self, error_m: R) -> R {
        let share = (error_m.abs() / self.error_full_scale_m).min(R::one()).named("error_share");
        let span_hz = (self.frequency_max_hz - self.frequency_min_hz).named("span_hz");
        (self.frequency_min_hz + span_hz * share).named("frequency_hz")
    }

    /// The force in N at a sample for an amplitude in N; moves phase and clock by one period.
    #[inline(always)]
    pub fn force(
        &self,
        state: &mut FmVibrationState<R>,
        amplitude_n: R,
        measured: &Measurement<R>,
    ) -> R {
        // Half a period less, so that rounding does not decide whether a pulse has a sample more.
        R::section("pulses: F = A (b + (1 - b) shape(u)), u = time since the pulse's start / t_p");
        let last_s = (self.pulse_width_s - R::constant(0.5) * measured.period_s).named("last_s");
        let progress = (state.since_pulse_s / self.pulse_width_s).named("progress");
        let on = state.since_pulse_s.lt(last_s);
        let pulse = R::select(on, self.shape(progress), R::zero()).named("pulse");
        R::section("pulses, phase: f = f_min + (f_max - f_min) min(|e| / e_full, 1)");
        let frequency_hz = self.frequency(measured.error_m());
        let next = frequency_hz.mul_add(measured.period_s, state.phase_cycles).named("next_cycles");
        let starts = R::one().le(next);
        state.phase_cycles = next - R::flag(starts);
        state.since_pulse_s = R::select(starts, R::zero(), state.since_pulse_s + measured.period_s);
        let base = self.base_fraction;
        (amplitude_n * (base + (R::one() - base).named("pulse_share") * pulse)).named("pulsed_n")
    }

    #[inline(always)]
    fn shape(&self, u: R) -> R {
        match self.shape {
            PulseShape::Rectangular => R::one(),
            PulseShape::HalfSine => half_sine(u),
            PulseShape::RaisedCosine => half_sine(u) * half_sine(u),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::actuator::ForceRange;

    fn vibration(shape: PulseShape) -> FmVibration<f64> {
        FmVibration {
            frequency_min_hz: 80.0,
            frequency_max_hz: 160.0,
            error_full_scale_m: 1e-3,
            pulse_width_s: 1e-3,
            base_fraction: 0.0,
            shape,
        }
    }

    fn measured(error_m: f64) -> Measurement<f64> {
        Measurement {
            reference_m: error_m,
            reference_rate_m_per_s: 0.0,
            position_m: 0.0,
            velocity_m_per_s: 0.0,
            force_n: 0.0,
            period_s: 1e-5,
            range: ForceRange { min_n: 0.0, max_n: 1e3 },
        }
    }

    #[test]
    fn a_pulse_keeps_its_width_while_the_error_moves() {
        let (mut state, mut on, mut widths) =
            (FmVibrationState::at_rest(), 0, std::vec::Vec::new());
        for n in 0..100_000 {
            let error = 1e-3 * f64::from(n % 370) / 370.0;
            let force = vibration(PulseShape::Rectangular).force(&mut state, 5.0, &measured(error));
            if force > 0.0 {
                on += 1;
            } else if on > 0 {
                widths.push(on);
                on = 0;
            }
        }
        assert!(widths.len() > 80);
        assert!(widths.iter().all(|&width| width == 100), "{widths:?}");
    }

    #[test]
    fn pulses_per_second_and_their_width_follow_the_error() {
        for (error, hertz) in [(0.0, 80), (0.5e-3, 120), (-1e-3, 160), (1.0, 160)] {
            let (mut state, mut starts, mut samples, mut last) =
                (FmVibrationState::at_rest(), 0, 0, 0.0);
            for _ in 0..100_000 {
                let force =
                    vibration(PulseShape::Rectangular).force(&mut state, 5.0, &measured(error));
                starts += i32::from(force > 0.0 && last == 0.0);
                samples += i32::from(force > 0.0);
                last = force;
            }
            assert_eq!(starts, hertz, "at error {error}");
            assert!((samples - 100 * hertz).abs() <= hertz, "{samples} samples of force");
        }
    }

    #[test]
    fn shapes_have_their_mean() {
        for (shape, mean) in [
            (PulseShape::Rectangular, 1.0),
            (PulseShape::HalfSine, 2.0 / core::f64::consts::PI),
            (PulseShape::RaisedCosine, 0.5),
        ] {
            let (mut state, mut sum) = (FmVibrationState::at_rest(), 0.0);
            for _ in 0..1250 {
                sum += vibration(shape).force(&mut state, 1.0, &measured(0.0));
            }
            assert!((sum / 100.0 - mean).abs() < 0.02, "{shape:?}: {}", sum / 100.0);
        }
    }

    #[test]
    fn the_base_is_held_between_pulses() {
        let mut held = vibration(PulseShape::Rectangular);
        held.base_fraction = 0.4;
        let mut state = FmVibrationState { phase_cycles: 0.5, since_pulse_s: 5e-3 };
        assert_eq!(held.force(&mut state, 10.0, &measured(0.0)), 4.0);
    }
}
