//! What nobody knows about the joint force, as a random factor on it.

use crate::name::Name;
use crate::real::Real;
use crate::sensor::Noise;

/// The random numbers of one step, drawn outside the core.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draws<R> {
    /// w, drawn by the disturbance's law and held by the caller for its hold time.
    pub disturbance: R,
    /// Of the sensors.
    pub noise: Noise<R>,
}

impl<R: Real> Draws<R> {
    /// Nothing random.
    pub fn none() -> Self {
        Self { disturbance: R::zero(), noise: Noise::none() }
    }
}

/// What the joint is multiplied by during a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors<R> {
    /// On the whole joint force R.
    pub joint_force: R,
    /// On the friction level g alone.
    pub friction_level: R,
}

/// What a disturbance multiplies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum DisturbedQuantity {
    /// The joint force R, as in the paper. Each redraw then also scales the elastic force of a
    /// stuck joint and jolts it: an artefact that helps any force to free it.
    JointForce,
    /// The friction level g only: a stuck joint is left at rest.
    FrictionLevel,
}

/// How w is drawn. The core is given w; the law is kept here, beside what w multiplies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum DrawLaw<R> {
    /// Uniform on [-1, 1], each draw independent.
    Uniform,
    /// Normal with variance 1, restricted to |w| ≤ 4, each draw independent.
    Gaussian,
    /// Normal noise with variance 1 behind a first-order low-pass, limited to |w| ≤ 4.
    BandLimited {
        /// Corner frequency of the low-pass in Hz.
        bandwidth_hz: R,
    },
}

/// R (or g) multiplied by 1 + var·w, w redrawn every hold time.
///
/// The paper states the factor 1 ± var but no distribution and no rate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Disturbance<R> {
    /// How w is drawn.
    pub law: DrawLaw<R>,
    /// Relative size: half width of a uniform law, 0 ≤ var < 1; standard deviation of the others,
    /// 0 ≤ var < 1/4.
    pub var: R,
    /// Time between redraws in s.
    pub hold_s: R,
    /// What is multiplied.
    pub acts_on: DisturbedQuantity,
}

impl<R: Real> Disturbance<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Disturbance<S> {
        Disturbance {
            law: match self.law {
                DrawLaw::Uniform => DrawLaw::Uniform,
                DrawLaw::Gaussian => DrawLaw::Gaussian,
                DrawLaw::BandLimited { bandwidth_hz } => {
                    DrawLaw::BandLimited { bandwidth_hz: f(Name::of("bandwidth_hz"), bandwidth_hz) }
                }
            },
            var: f(Name::of("var"), self.var),
            hold_s: f(Name::of("hold_s"), self.hold_s),
            acts_on: self.acts_on,
        }
    }

    /// The factors for a held draw.
    #[inline(always)]
    pub fn factors(&self, draws: Draws<R>) -> Factors<R> {
        R::section("disturbance: 1 + var w");
        let factor = (R::one() + self.var * draws.disturbance).named("factor");
        match self.acts_on {
            DisturbedQuantity::JointForce => {
                Factors { joint_force: factor, friction_level: R::one() }
            }
            DisturbedQuantity::FrictionLevel => {
                Factors { joint_force: R::one(), friction_level: factor }
            }
        }
    }
}
