//! What a controller gets to see of position and force.

use crate::maybe::Maybe;
use crate::name::{Name, within};
use crate::real::Real;

/// Most samples that a sensor can be late.
pub const DELAY_MAX: usize = 8;

/// A sensor: low-pass, noise, quantization, and whole samples of delay, in this order.
///
/// ```text
/// y ← y + (1 − exp(−2π f T_s)) (x − y)          without a bandwidth: y = x
/// s = q round((y + σ w) / q)                     without a step: s = y + σ w
/// ```
///
/// w is drawn outside, with variance 1. Without noise, bandwidth, step and delay it is ideal.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Sensor<R> {
    /// σ, in the unit of what is measured.
    pub noise_rms: R,
    /// q, in that unit, if it is quantized.
    pub quantum: Maybe<R>,
    /// f in Hz, if it is slower than the sampling.
    pub bandwidth_hz: Maybe<R>,
    /// How many samples late it is, at most [`DELAY_MAX`].
    pub delay_samples: u32,
}

/// What a sensor remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorState<R> {
    /// y.
    pub filtered: R,
    /// The last values, newest first.
    pub late: [R; DELAY_MAX],
}

impl<R: Real> SensorState<R> {
    /// Having seen nothing but zero.
    pub fn at_rest() -> Self {
        Self { filtered: R::zero(), late: [R::zero(); DELAY_MAX] }
    }

    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> SensorState<S> {
        SensorState {
            filtered: f(Name::of("filtered"), self.filtered),
            late: self.late.map(|value| f(Name::of("late"), value)),
        }
    }
}

impl<R: Real> Sensor<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Sensor<S> {
        Sensor {
            noise_rms: f(Name::of("noise_rms"), self.noise_rms),
            quantum: self.quantum.map(|q| f(Name::of("quantum"), q)),
            bandwidth_hz: self.bandwidth_hz.map(|hertz| f(Name::of("bandwidth_hz"), hertz)),
            delay_samples: self.delay_samples,
        }
    }

    /// What it shows of `value` at a sample, with the draw `w`.
    #[inline(always)]
    pub fn read(&self, state: &mut SensorState<R>, value: R, w: R, period_s: R) -> R {
        R::section("sensor: s = q round((y + sigma w) / q), y low-passed");
        let seen = match self.bandwidth_hz.get() {
            Some(&hertz) => {
                let per_s = R::constant(-2.0 * core::f64::consts::PI) * hertz;
                let share = (R::one() - (per_s * period_s).exp()).named("bandwidth_share");
                let filtered = share.mul_add(value - state.filtered, state.filtered);
                state.filtered = filtered.ebbed().named("filtered");
                state.filtered
            }
            None => value,
        };
        let noisy = self.noise_rms.mul_add(w, seen).named("noisy");
        let shown = match self.quantum.get() {
            Some(&q) => q * (noisy / q).round(),
            None => noisy,
        };
        self.delayed(state, shown)
    }

    #[inline(always)]
    fn delayed(&self, state: &mut SensorState<R>, shown: R) -> R {
        let delay = self.delay_samples as usize;
        if delay == 0 || delay > DELAY_MAX {
            return shown;
        }
        let oldest = state.late[delay - 1];
        for i in (1..delay).rev() {
            state.late[i] = state.late[i - 1];
        }
        state.late[0] = shown;
        oldest
    }
}

/// The sensors of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Sensors<R> {
    /// Of the part's position, m.
    pub position: Sensor<R>,
    /// Of the force on the part, N.
    pub force: Sensor<R>,
}

impl<R: Real> Sensors<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Sensors<S> {
        Sensors {
            position: within!("position", self.position, f),
            force: within!("force", self.force, f),
        }
    }
}

/// What the sensors remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorsState<R> {
    /// Of the position.
    pub position: SensorState<R>,
    /// Of the force.
    pub force: SensorState<R>,
}

impl<R: Real> SensorsState<R> {
    /// Having seen nothing but zero.
    pub fn at_rest() -> Self {
        Self { position: SensorState::at_rest(), force: SensorState::at_rest() }
    }

    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> SensorsState<S> {
        SensorsState {
            position: within!("position", self.position, f),
            force: within!("force", self.force, f),
        }
    }
}

/// Draws of variance 1 for a sample of each sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise<R> {
    /// Of the position.
    pub position: R,
    /// Of the force.
    pub force: R,
}

impl<R: Real> Noise<R> {
    /// None.
    #[inline(always)]
    pub fn none() -> Self {
        Self { position: R::zero(), force: R::zero() }
    }
}
