//! Friction laws of a seized joint, one file each.
//!
//! Every law is a bristle whose equation, with the velocity and the position frozen, is affine in
//! its deflection ([`Bristle`]). That common form is all the plant needs to step any law, stuck or
//! sliding, without iteration. To add a law: one file here, one variant of [`Joint`].

mod directional_lugre;
mod engagement;
mod lugre;
mod two_region;

pub use directional_lugre::DirectionalLugre;
pub use engagement::engaged_level;
pub use lugre::Lugre;
pub use two_region::TwoRegion;

use crate::real::Real;

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
    pub viscous_n_s_per_m: Option<R>,
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
        let damped = match self.viscous_n_s_per_m {
            Some(sigma) => self.damping_n_s_per_m.mul_add(rate, sigma * v),
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
    /// 1 while the two-region law slides, else 0. Laws without such an event leave it alone.
    pub sliding: R,
}

/// What the plant asks of friction. Laws of a part in its joint are in [`Joint`]; a rig's friction
/// ([`DirectionalLugre`]) goes through the same steps.
pub trait Law<R: Real> {
    /// The law's events at the start of a step: a bristle that breaks loose or catches again.
    fn settle(&self, state: JointState<R>, x: R, v: R, level_factor: R) -> JointState<R>;

    /// The law's bristle with velocity and position frozen at `v` and `x`, its friction level
    /// multiplied by `level_factor`.
    fn freeze(&self, state: &JointState<R>, x: R, v: R, level_factor: R) -> Bristle<R>;

    /// l_f in m, where contact ends.
    fn engagement_length_m(&self) -> R;
}

/// A seized joint: one of the friction laws.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "law", rename_all = "snake_case"))]
pub enum Joint<R> {
    /// Modified LuGre, equations (1) to (8).
    Lugre(Lugre<R>),
    /// The two-region law that the controller is designed with, equation (9).
    TwoRegion(TwoRegion<R>),
}

impl<R: Real> Joint<R> {
    /// Applies `f` to every number of the law.
    pub fn map<S>(&self, f: &mut impl FnMut(&'static str, R) -> S) -> Joint<S> {
        match self {
            Self::Lugre(law) => Joint::Lugre(law.map(f)),
            Self::TwoRegion(law) => Joint::TwoRegion(law.map(f)),
        }
    }

    /// k_e in N/m.
    #[inline(always)]
    pub fn stiffness_n_per_m(&self) -> R {
        match self {
            Self::Lugre(law) => law.stiffness_n_per_m,
            Self::TwoRegion(law) => law.stiffness_n_per_m,
        }
    }

    /// F_s(x) in N, the force that breaks the joint loose at position `x`: equation (5).
    #[inline(always)]
    pub fn breakaway_force(&self, x: R) -> R {
        match self {
            Self::Lugre(law) => law.stiction(x),
            Self::TwoRegion(law) => law.stiction(x),
        }
    }
}

impl<R: Real> Law<R> for Joint<R> {
    #[inline(always)]
    fn settle(&self, state: JointState<R>, x: R, v: R, level_factor: R) -> JointState<R> {
        match self {
            Self::Lugre(_) => state,
            Self::TwoRegion(law) => law.settle(state, x, v, level_factor),
        }
    }

    #[inline(always)]
    fn freeze(&self, state: &JointState<R>, x: R, v: R, level_factor: R) -> Bristle<R> {
        match self {
            Self::Lugre(law) => law.freeze(x, v, level_factor),
            Self::TwoRegion(law) => law.freeze(state),
        }
    }

    #[inline(always)]
    fn engagement_length_m(&self) -> R {
        match self {
            Self::Lugre(law) => law.engagement_length_m,
            Self::TwoRegion(law) => law.engagement_length_m,
        }
    }
}
