//! What goes through the part in a control period.

use crate::actuator::Effort;
use crate::crossing::Motion;
use crate::name::{Name, within};
use crate::real::Real;

/// What went through the part in a control period, or in an integration step of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period<R> {
    /// F in N: the mean.
    pub force_n: R,
    /// Largest F of an integration step, N.
    pub largest_force_n: R,
    /// R in N: the mean, disturbance included.
    pub joint_force_n: R,
    /// ∫ F dx in J.
    pub work_j: R,
    /// ∫ R dx in J.
    pub joint_work_j: R,
    /// What the actuator took.
    pub effort: Effort<R>,
}

impl<R: Real> Period<R> {
    /// None yet: what the steps of a period are added to.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = R::zero();
        Self {
            force_n: zero,
            largest_force_n: zero,
            joint_force_n: zero,
            work_j: zero,
            joint_work_j: zero,
            effort: Effort::none(),
        }
    }

    /// With one more step. The forces are sums until [`Period::mean`].
    #[inline(always)]
    pub fn and(&self, step: &Self) -> Self {
        Self {
            force_n: self.force_n + step.force_n,
            largest_force_n: step.largest_force_n.max(self.largest_force_n),
            joint_force_n: self.joint_force_n + step.joint_force_n,
            work_j: self.work_j + step.work_j,
            joint_work_j: self.joint_work_j + step.joint_work_j,
            effort: self.effort.and(&step.effort),
        }
    }

    /// The forces of all steps as means; `share` is 1 over their number.
    #[inline(always)]
    pub fn mean(&self, share: R) -> Self {
        Self { force_n: self.force_n * share, joint_force_n: self.joint_force_n * share, ..*self }
    }

    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Period<S> {
        Period {
            force_n: f(Name::of("force_n"), self.force_n),
            largest_force_n: f(Name::of("largest_force_n"), self.largest_force_n),
            joint_force_n: f(Name::of("joint_force_n"), self.joint_force_n),
            work_j: f(Name::of("work_j"), self.work_j),
            joint_work_j: f(Name::of("joint_work_j"), self.joint_work_j),
            effort: within!("effort", self.effort, f),
        }
    }
}

/// An integration step, as whoever counts sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch<R> {
    /// Time at its start, s.
    pub time_s: R,
    /// How the part moves; as if the joint held to the end, where it lets go within.
    pub motion: Motion<R>,
    /// x at its end, m.
    pub next_position_m: R,
    /// Speed that was asked of the part, m/s: that of the reference, or of the feed.
    pub commanded_m_per_s: R,
    /// F in N.
    pub force_n: R,
}

/// Who sees every integration step.
pub trait Witness<R> {
    /// Sees one. Has to be inlined.
    fn see(&mut self, step: &Stretch<R>);
}

/// Nobody does.
#[derive(Clone, Copy, Debug)]
pub struct Nobody;

impl<R> Witness<R> for Nobody {
    #[inline(always)]
    fn see(&mut self, _: &Stretch<R>) {}
}
