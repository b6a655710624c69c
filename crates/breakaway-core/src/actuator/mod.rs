//! What turns a command into the push on the part, one file each.
//!
//! An actuator is stepped with the part. It first presents its push for the coming step as a force
//! that is affine in the part's velocity ([`Push`]); once the plant has solved for both, it moves its
//! own masses with the force that acted. To add one: a file here, a variant of [`Actuator`].

mod contact;
mod feed_axis;
mod force_actuator;
mod piezo;
mod push_only;

pub use contact::Contact;
pub use feed_axis::{Chain, FeedAxis, Tip};
pub use force_actuator::ForceActuator;
pub use piezo::Piezo;
pub use push_only::PushOnly;

use crate::name::Name;
use crate::parameters::parameters;
use crate::plant::Push;
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

parameters! {
    /// What a controller asks of an actuator. Each actuator heeds what it has.
    pub struct Command {
        /// Force in N: ideal, push-only and force actuators.
        pub force_n,
        /// Speed of the feed in m/s: the feed axis.
        pub feed_m_per_s,
        /// Share of the piezo's voltage, 0 to 1: a feed axis with a stack.
        pub stack_share,
    }
}

impl<R: Real> Command<R> {
    /// Nothing but a force.
    #[inline(always)]
    pub fn force(force_n: R) -> Self {
        Self { force_n, feed_m_per_s: R::zero(), stack_share: R::zero() }
    }
}

parameters! {
    /// What moves in any actuator. An actuator leaves alone what it does not have.
    pub struct ActuatorState {
        /// Force of a force actuator, N.
        pub force_n,
        /// Position of the feed, m.
        pub feed_m,
        /// Speed of the feed, m/s.
        pub feed_m_per_s,
        /// Position of the tool, the mass on the axis, m.
        pub tool_m,
        /// Its velocity, m/s.
        pub tool_m_per_s,
        /// Position of the stack's tip, m.
        pub tip_m,
        /// Its velocity, m/s.
        pub tip_m_per_s,
        /// Voltage of the stack, V.
        pub voltage_v,
        /// Free stroke of the stack, m.
        pub stroke_m,
        /// Output of the first play operator of the hysteresis, V.
        pub play_1_v,
        /// Output of the second, V.
        pub play_2_v,
        /// Output of the third, V.
        pub play_3_v,
        /// Output of the fourth, V.
        pub play_4_v,
    }
}

impl<R: Real> ActuatorState<R> {
    /// At rest, relaxed and touching nothing that it would have to push.
    pub fn at_rest() -> Self {
        let zero = R::zero();
        Self {
            force_n: zero,
            feed_m: zero,
            feed_m_per_s: zero,
            tool_m: zero,
            tool_m_per_s: zero,
            tip_m: zero,
            tip_m_per_s: zero,
            voltage_v: zero,
            stroke_m: zero,
            play_1_v: zero,
            play_2_v: zero,
            play_3_v: zero,
            play_4_v: zero,
        }
    }
}

parameters! {
    /// What an actuator did and bore over a stretch of time: sums, but for the largest tension.
    pub struct Effort {
        /// Work that its drives supplied, J.
        pub supplied_j,
        /// Energy lost in its dampers, and in its contact beyond what the contact's spring keeps, J.
        pub lost_j,
        /// ∫ |I| dt of its amplifier, C.
        pub charge_c,
        /// ∫ I² dt, A² s.
        pub current_square_a2_s,
        /// Largest tension of its stack beyond the preload's, N; below 0 where it was always pressed.
        pub stack_tension_n,
        /// Time during which it could not do as it was told, s.
        pub saturated_s,
    }
}

impl<R: Real> Effort<R> {
    /// None yet.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = R::zero();
        Self {
            supplied_j: zero,
            lost_j: zero,
            charge_c: zero,
            current_square_a2_s: zero,
            stack_tension_n: R::constant(f64::NEG_INFINITY),
            saturated_s: zero,
        }
    }

    /// Both stretches of time.
    #[inline(always)]
    pub fn and(&self, next: &Self) -> Self {
        Self {
            supplied_j: self.supplied_j + next.supplied_j,
            lost_j: self.lost_j + next.lost_j,
            charge_c: self.charge_c + next.charge_c,
            current_square_a2_s: self.current_square_a2_s + next.current_square_a2_s,
            stack_tension_n: self.stack_tension_n.max(next.stack_tension_n),
            saturated_s: self.saturated_s + next.saturated_s,
        }
    }
}

/// An actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum Actuator<R> {
    /// Delivers every commanded force, pushing or pulling.
    Ideal,
    /// A tip that can push up to a limit and cannot pull.
    PushOnly(PushOnly<R>),
    /// Push-only, behind a lag and a limit of its rate.
    Force(ForceActuator<R>),
    /// A feed axis, maybe with a piezo stack, behind a contact that pushes or grips.
    FeedAxis(FeedAxis<R>),
}

/// What an actuator presents for a step: its push, and what it needs to move once that is known.
#[derive(Clone, Copy, Debug)]
pub struct Driven<R> {
    /// The push.
    pub push: Push<R>,
    /// Masses that move with the part.
    chain: Option<Chain<R>>,
    effort: Effort<R>,
}

impl<R: Real> Driven<R> {
    #[inline(always)]
    fn rigid(force_n: R) -> Self {
        Self { push: Push::rigid(force_n), chain: None, effort: Effort::none() }
    }
}

impl<R: Real> Actuator<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Actuator<S> {
        match self {
            Self::Ideal => Actuator::Ideal,
            Self::PushOnly(actuator) => Actuator::PushOnly(actuator.map(f)),
            Self::Force(actuator) => Actuator::Force(actuator.map(f)),
            Self::FeedAxis(actuator) => Actuator::FeedAxis(actuator.map(f)),
        }
    }

    /// The forces that it can be told to deliver. A feed axis is not told a force: its range is 0.
    #[inline(always)]
    pub fn range(&self) -> ForceRange<R> {
        match self {
            Self::Ideal => ForceRange {
                min_n: R::constant(f64::NEG_INFINITY),
                max_n: R::constant(f64::INFINITY),
            },
            Self::PushOnly(actuator) => actuator.range(),
            Self::Force(actuator) => actuator.range(),
            Self::FeedAxis(_) => ForceRange { min_n: R::zero(), max_n: R::zero() },
        }
    }

    /// Begins a step of `h` seconds: moves the drive by its command, and presents the push.
    #[inline(always)]
    pub fn drive(
        &self,
        state: &mut ActuatorState<R>,
        command: &Command<R>,
        part_m: R,
        h: R,
    ) -> Driven<R> {
        match self {
            Self::Ideal => Driven::rigid(command.force_n),
            Self::PushOnly(actuator) => {
                R::section("push-only actuator: 0 <= F <= F_max");
                let force_n = actuator.range().limit(command.force_n).named("pushed_n");
                let mut driven = Driven::rigid(force_n);
                let missed = force_n.lt(command.force_n) | command.force_n.lt(force_n);
                driven.effort.saturated_s = R::select(missed, h, R::zero());
                driven
            }
            Self::Force(actuator) => actuator.drive(state, command.force_n, h),
            Self::FeedAxis(axis) => axis.drive(state, command, part_m, h),
        }
    }

    /// Ends a step: moves the masses of the actuator by the force that acted on the part while it
    /// moved at `mean_m_per_s`; gives what the step took.
    #[inline(always)]
    pub fn settle(
        &self,
        state: &mut ActuatorState<R>,
        driven: &Driven<R>,
        push_n: R,
        mean_m_per_s: R,
        h: R,
    ) -> Effort<R> {
        match (self, &driven.chain) {
            (Self::FeedAxis(axis), Some(chain)) => {
                axis.settle(state, chain, &driven.effort, push_n, mean_m_per_s, h)
            }
            _ => Effort { supplied_j: push_n * mean_m_per_s * h, ..driven.effort },
        }
    }

    /// Energy kept in springs and masses of the actuator and in its contact with the part at
    /// `part_m`, J.
    pub fn stored_energy_j(&self, state: &ActuatorState<R>, part_m: R) -> R {
        match self {
            Self::FeedAxis(axis) => axis.stored_energy_j(state, part_m),
            _ => R::zero(),
        }
    }
}
