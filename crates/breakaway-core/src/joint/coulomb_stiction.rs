//! Rigid friction: stuck, or sliding.

use super::elements::ElementState;
use super::engagement::engaged_level;
use super::frozen::{At, Frozen, JointState, Rigid};
use super::law::Law;
use super::lugre::stribeck_level;
use crate::maybe::Maybe;
use crate::name::Name;
use crate::real::Real;

/// Coulomb friction with stiction, without bristles.
///
/// ```text
/// stuck:    v = 0,  R = what it takes            as long as that is at most F_s(x)
/// sliding:  R = g(v, x) sgn v + σ v              until v reaches 0 and g can hold it there
/// g       = F_c(x) + (F_s(x) − F_c(x)) exp(−(v / v_s)²)
/// ```
///
/// The levels are those of [`super::Lugre`]. The plant takes the force that stops the part within
/// the step and limits it to the level: the implicit Euler choice of J. J. Moreau for dry friction
/// (in: Nonsmooth Mechanics and Applications, CISM 302, Springer 1988), here on the midpoint rule.
/// Stuck means v = 0 exactly: no drift, no presliding, and breakaway at F_s(x) at any loading rate.
/// A reversal through zero without a stop is taken as if it happened at the start of the step, so
/// the motion after it is of first order in the step; everything else is of second order.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct CoulombStiction<R> {
    /// F_s0 in N, stiction force at the seat.
    pub stiction_n: R,
    /// F_c0 in N, Coulomb force at the seat.
    pub coulomb_n: R,
    /// σ₂ in N s/m, if there is viscous friction.
    pub viscous_n_s_per_m: Maybe<R>,
    /// v_s in m/s.
    pub stribeck_velocity_m_per_s: R,
    /// l_f in m.
    pub engagement_length_m: R,
    /// F_end in N, friction left at x = l_f.
    pub residual_n: R,
    /// What the levels are multiplied by for backward motion, if they differ.
    pub backward_ratio: Maybe<R>,
}

impl<R: Real> CoulombStiction<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> CoulombStiction<S> {
        let v_s = self.stribeck_velocity_m_per_s;
        CoulombStiction {
            stiction_n: f(Name::of("stiction_n"), self.stiction_n),
            coulomb_n: f(Name::of("coulomb_n"), self.coulomb_n),
            viscous_n_s_per_m: self
                .viscous_n_s_per_m
                .map(|sigma| f(Name::of("viscous_n_s_per_m"), sigma)),
            stribeck_velocity_m_per_s: f(Name::of("stribeck_velocity_m_per_s"), v_s),
            engagement_length_m: f(Name::of("engagement_length_m"), self.engagement_length_m),
            residual_n: f(Name::of("residual_n"), self.residual_n),
            backward_ratio: self.backward_ratio.map(|ratio| f(Name::of("backward_ratio"), ratio)),
        }
    }

    /// g(v, x) in N against forward motion, multiplied by `factor`.
    #[inline(always)]
    fn slipping_level(&self, x: R, v: R, factor: R) -> R {
        let levels = [self.stiction_n, self.coulomb_n];
        let (end, length) = (self.residual_n, self.engagement_length_m);
        stribeck_level(levels, end, length, self.stribeck_velocity_m_per_s, x, v, factor)
    }
}

impl<R: Real> Law<R> for CoulombStiction<R> {
    #[inline(always)]
    fn engagement_length_m(&self) -> R {
        self.engagement_length_m
    }

    #[inline(always)]
    fn stiffness_n_per_m(&self) -> R {
        R::constant(f64::INFINITY)
    }

    #[inline(always)]
    fn breakaway_force(&self, x: R) -> R {
        engaged_level(self.stiction_n, self.residual_n, self.engagement_length_m, R::one(), x)
    }

    #[inline(always)]
    fn friction_level(&self, x: R, v: R, factor: R) -> R {
        let level = self.slipping_level(x, v, factor);
        match self.backward_ratio.get() {
            Some(&ratio) => level * R::select(v.lt(R::zero()), ratio, R::one()),
            None => level,
        }
    }

    /// Nothing: there are no bristles.
    #[inline(always)]
    fn stored_energy_j(&self, _bristle_m: R, _elements: &ElementState<R>) -> R {
        R::zero()
    }

    /// Nothing: there are no bristles.
    #[inline(always)]
    fn let_go(
        &self,
        state: JointState<R>,
        _elements: &mut ElementState<R>,
        _x: R,
        _level_factor: R,
    ) -> JointState<R> {
        state
    }

    /// What holds the part, stuck or sliding.
    #[inline(always)]
    fn frozen<F: Frozen<R>>(&self, state: &JointState<R>, at: &At<R>, then: F) -> F::Output {
        let (x, v, factor) = (at.position_m, at.velocity_m_per_s, at.level_factor);
        let (end, length) = (self.residual_n, self.engagement_length_m);
        let stuck = engaged_level(self.stiction_n, end, length, factor, x);
        let slips = self.slipping_level(x, v, factor);
        let level_n = R::select(state.sliding.is_set(), slips, stuck);
        let backward_level_n = match self.backward_ratio.get() {
            Some(&ratio) => level_n * ratio,
            None => level_n,
        };
        then.rigid(&Rigid { level_n, backward_level_n, viscous_n_s_per_m: self.viscous_n_s_per_m })
    }
}
