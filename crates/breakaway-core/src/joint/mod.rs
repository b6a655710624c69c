//! Friction laws of a seized joint, one file each.
//!
//! With the velocity and the position frozen, every law is one of three things ([`Frozen`]): a bristle
//! whose equation is affine in its deflection, several of them, or rigid. That is all the plant
//! needs to step any law, stuck or sliding, without iteration. To add a law: one file here, one
//! variant of [`Joint`].

mod coulomb_stiction;
mod directional_lugre;
mod elasto_plastic;
mod engagement;
mod gms;
mod lugre;
mod onset;
mod two_region;

pub use coulomb_stiction::CoulombStiction;
pub use directional_lugre::DirectionalLugre;
pub use elasto_plastic::ElastoPlastic;
pub use engagement::engaged_level;
pub use gms::{ELEMENTS_MAX, ElementState, Elements, Gms, default_shares};
pub use lugre::Lugre;
pub use two_region::TwoRegion;

use crate::maybe::Maybe;
use crate::name::Name;
use crate::plant::PlantState;
use crate::real::Real;

/// Where a law is frozen.
#[derive(Clone, Copy, Debug)]
pub struct At<R> {
    /// x in m.
    pub position_m: R,
    /// v in m/s.
    pub velocity_m_per_s: R,
    /// Factor on the friction level.
    pub level_factor: R,
    /// How far ahead of the state this is, s: half a step, or nothing.
    pub ahead_s: R,
}

/// What is done with a law whose velocity and position are frozen: it is one of three things.
///
/// A visitor and not an enum, because an enum of vectors of numbers stays in memory: measured, it
/// made batches four times slower.
pub trait Frozen<R: Real> {
    /// What comes of it.
    type Output;
    /// One bristle.
    fn bristle(self, bristle: &Bristle<R>) -> Self::Output;
    /// Several elements, each of which sticks or slips.
    fn elements(self, elements: &Elements<'_, R>) -> Self::Output;
    /// No bristle: stuck, or a friction level.
    fn rigid(self, rigid: &Rigid<R>) -> Self::Output;
}

/// Takes the bristle of a law that has one.
struct OneBristle;

impl<R: Real> Frozen<R> for OneBristle {
    type Output = Option<Bristle<R>>;
    #[inline(always)]
    fn bristle(self, bristle: &Bristle<R>) -> Option<Bristle<R>> {
        Some(*bristle)
    }
    #[inline(always)]
    fn elements(self, _: &Elements<'_, R>) -> Option<Bristle<R>> {
        None
    }
    #[inline(always)]
    fn rigid(self, _: &Rigid<R>) -> Option<Bristle<R>> {
        None
    }
}

/// Rigid friction with velocity and position frozen.
///
/// ```text
/// R = σ v + what stops the part within the step, limited to [−L_b, L]
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Rigid<R> {
    /// L in N, against forward motion.
    pub level_n: R,
    /// L_b in N, against backward motion.
    pub backward_level_n: R,
    /// σ in N s/m, if there is viscous friction.
    pub viscous_n_s_per_m: Maybe<R>,
}

/// A bristle's equation with velocity and position frozen.
///
/// ```text
/// ż = α v − (A / g) z                    stretching, and slipping at friction level g
/// R = k z + c ż + σ v                    joint force on the part, against its motion
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Bristle<R> {
    /// α, the share of the motion that stretches the bristle: 1 while it can stretch, else 0.
    pub stretch: R,
    /// |v| in m/s.
    pub speed_m_per_s: R,
    /// A / |v| in N/m: k_e for LuGre, 0 for an elastic bristle.
    pub relaxation_n_per_m: R,
    /// g in N, always above zero.
    pub friction_level_n: R,
    /// k in N/m.
    pub stiffness_n_per_m: R,
    /// c in N s/m.
    pub damping_n_s_per_m: R,
    /// σ in N s/m, if there is viscous friction.
    pub viscous_n_s_per_m: Maybe<R>,
}

impl<R: Real> Bristle<R> {
    /// A in N/s.
    #[inline(always)]
    pub fn relaxation(&self) -> R {
        self.relaxation_n_per_m * self.speed_m_per_s
    }

    /// ż at velocity `v` and deflection `z`.
    #[inline(always)]
    pub fn rate(&self, v: R, z: R) -> R {
        self.stretch * v - self.relaxation() / self.friction_level_n * z
    }

    /// R for a deflection, its rate and a velocity: equations (1) and (7).
    #[inline(always)]
    pub fn force(&self, v: R, z: R, rate: R) -> R {
        let damped = match self.viscous_n_s_per_m.get() {
            Some(&sigma) => self.damping_n_s_per_m.mul_add(rate, sigma * v),
            None => self.damping_n_s_per_m * rate,
        };
        self.stiffness_n_per_m.mul_add(z, damped)
    }
}

/// What a joint remembers between steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointState<R> {
    /// z in m.
    pub bristle_m: R,
    /// 1 while a two-region or rigid law slides, else 0. Laws without such an event leave it alone.
    pub sliding: R,
}

/// What the plant asks of friction. Laws of a part in its joint are in [`Joint`]; a rig's friction
/// ([`DirectionalLugre`]) goes through the same steps.
pub trait Law<R: Real> {
    /// The events of a bristle at the start of a step: it breaks loose or catches again.
    fn settle(&self, state: JointState<R>, x: R, v: R, level_factor: R) -> JointState<R>;

    /// Freezes velocity and position, and hands what the law then is to `then`.
    fn frozen<F: Frozen<R>>(&self, state: &JointState<R>, at: &At<R>, then: F) -> F::Output;

    /// The law's bristle with velocity and position frozen at `v` and `x`, its friction level
    /// multiplied by `level_factor`; none for a law of several elements, or without bristles.
    #[inline(always)]
    fn freeze(&self, state: &JointState<R>, x: R, v: R, level_factor: R) -> Option<Bristle<R>> {
        let ahead_s = R::zero();
        let at = At { position_m: x, velocity_m_per_s: v, level_factor, ahead_s };
        self.frozen(state, &at, OneBristle)
    }

    /// l_f in m, where contact ends.
    fn engagement_length_m(&self) -> R;
}

/// A seized joint: one of the friction laws.
// The largest law sets the size of all. Joints are few, and no indirection is possible without an
// allocator.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "law", rename_all = "snake_case"))]
pub enum Joint<R> {
    /// Modified LuGre, equations (1) to (8).
    Lugre(Lugre<R>),
    /// The two-region law that the controller is designed with, equation (9).
    TwoRegion(TwoRegion<R>),
    /// LuGre with a bristle that is elastic at first.
    ElastoPlastic(ElastoPlastic<R>),
    /// Generalized Maxwell-slip.
    Gms(Gms<R>),
    /// Rigid Coulomb friction with stiction.
    CoulombStiction(CoulombStiction<R>),
}

impl<R: Real> Joint<R> {
    /// Applies `f` to every number of the law.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Joint<S> {
        match self {
            Self::Lugre(law) => Joint::Lugre(law.map(f)),
            Self::TwoRegion(law) => Joint::TwoRegion(law.map(f)),
            Self::ElastoPlastic(law) => Joint::ElastoPlastic(law.map(f)),
            Self::Gms(law) => Joint::Gms(law.map(f)),
            Self::CoulombStiction(law) => Joint::CoulombStiction(law.map(f)),
        }
    }

    /// k_e in N/m; infinite for a rigid joint.
    #[inline(always)]
    pub fn stiffness_n_per_m(&self) -> R {
        match self {
            Self::Lugre(law) => law.stiffness_n_per_m,
            Self::TwoRegion(law) => law.stiffness_n_per_m,
            Self::ElastoPlastic(law) => law.friction.stiffness_n_per_m,
            Self::Gms(law) => law.friction.stiffness_n_per_m,
            Self::CoulombStiction(_) => R::constant(f64::INFINITY),
        }
    }

    /// F_s(x) in N, the force that breaks the joint loose forward at position `x`: equation (5).
    #[inline(always)]
    pub fn breakaway_force(&self, x: R) -> R {
        match self {
            Self::Lugre(law) => law.stiction(x),
            Self::TwoRegion(law) => law.stiction(x),
            Self::ElastoPlastic(law) => law.friction.stiction(x),
            Self::Gms(law) => law.friction.stiction(x),
            Self::CoulombStiction(law) => law.stiction(x),
        }
    }

    /// What the bristles hold in J: ½ k_e z², the sum of ½ k_i z_i², or nothing where there are none.
    #[inline(always)]
    pub fn stored_energy_j(&self, state: &PlantState<R>) -> R {
        let half = R::constant(0.5);
        let z = state.bristle_m;
        match self {
            Self::Gms(law) => law.stored_energy_j(&state.elements.deflection_m),
            Self::CoulombStiction(_) => R::zero(),
            Self::Lugre(_) | Self::TwoRegion(_) | Self::ElastoPlastic(_) => {
                half * self.stiffness_n_per_m() * z * z
            }
        }
    }
}

impl<R: Real> Law<R> for Joint<R> {
    #[inline(always)]
    fn settle(&self, state: JointState<R>, x: R, v: R, level_factor: R) -> JointState<R> {
        match self {
            Self::TwoRegion(law) => law.settle(state, x, v, level_factor),
            Self::Lugre(_) | Self::ElastoPlastic(_) | Self::Gms(_) | Self::CoulombStiction(_) => {
                state
            }
        }
    }

    #[inline(always)]
    fn frozen<F: Frozen<R>>(&self, state: &JointState<R>, at: &At<R>, then: F) -> F::Output {
        match self {
            Self::Lugre(law) => then.bristle(&law.freeze(at)),
            Self::TwoRegion(law) => then.bristle(&law.freeze(state)),
            Self::ElastoPlastic(law) => then.bristle(&law.freeze(state.bristle_m, at)),
            Self::Gms(law) => then.elements(&law.freeze(at)),
            Self::CoulombStiction(law) => then.rigid(&law.freeze(state.sliding, at)),
        }
    }

    #[inline(always)]
    fn engagement_length_m(&self) -> R {
        match self {
            Self::Lugre(law) => law.engagement_length_m,
            Self::TwoRegion(law) => law.engagement_length_m,
            Self::ElastoPlastic(law) => law.friction.engagement_length_m,
            Self::Gms(law) => law.friction.engagement_length_m,
            Self::CoulombStiction(law) => law.engagement_length_m,
        }
    }
}
