//! What nobody knows about the joint force, as a random factor on it.

use crate::real::Real;

/// The random numbers of one step, drawn outside the core.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draws<R> {
    /// w, uniform on [-1, 1], held by the caller for the disturbance's hold time.
    pub disturbance: R,
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

/// R (or g) multiplied by 1 + var·w, w uniform on [-1, 1] and redrawn every hold time.
///
/// The paper states the factor 1 ± var but no distribution and no rate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct UniformDisturbance<R> {
    /// Relative half width, 0 ≤ var < 1.
    pub var: R,
    /// Time between redraws in s.
    pub hold_s: R,
    /// What is multiplied.
    pub acts_on: DisturbedQuantity,
}

impl<R: Real> UniformDisturbance<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(&'static str, R) -> S) -> UniformDisturbance<S> {
        UniformDisturbance {
            var: f("var", self.var),
            hold_s: f("hold_s", self.hold_s),
            acts_on: self.acts_on,
        }
    }

    /// The factors for a held draw.
    #[inline(always)]
    pub fn factors(&self, draws: Draws<R>) -> Factors<R> {
        let factor = R::one() + self.var * draws.disturbance;
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
