//! What turns a commanded force into the force on the part, one file each.

mod push_only;

pub use push_only::PushOnly;

use crate::real::Real;

/// The forces in N that an actuator can deliver. Controllers are given it to keep their integral
/// from winding up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceRange<R> {
    /// Smallest force.
    pub min_n: R,
    /// Largest force.
    pub max_n: R,
}

impl<R: Real> ForceRange<R> {
    /// `force_n` limited to the range.
    #[inline(always)]
    pub fn limit(&self, force_n: R) -> R {
        force_n.clamp(self.min_n, self.max_n)
    }
}

/// An actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum Actuator<R> {
    /// Delivers every commanded force, pushing or pulling.
    Ideal,
    /// A tip that can push up to a limit and can not pull.
    PushOnly(PushOnly<R>),
}

impl<R: Real> Actuator<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(&'static str, R) -> S) -> Actuator<S> {
        match self {
            Self::Ideal => Actuator::Ideal,
            Self::PushOnly(actuator) => Actuator::PushOnly(actuator.map(f)),
        }
    }

    /// What it can deliver.
    #[inline(always)]
    pub fn range(&self) -> ForceRange<R> {
        match self {
            Self::Ideal => ForceRange {
                min_n: R::constant(f64::NEG_INFINITY),
                max_n: R::constant(f64::INFINITY),
            },
            Self::PushOnly(actuator) => actuator.range(),
        }
    }

    /// The force in N on the part for a commanded force in N.
    #[inline(always)]
    pub fn force(&self, command_n: R) -> R {
        match self {
            Self::Ideal => command_n,
            Self::PushOnly(actuator) => actuator.range().limit(command_n),
        }
    }
}
