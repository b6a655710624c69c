//! Friction of a rig, by direction.

use super::frozen::{At, Bristle, Frozen, JointState};
use super::law::Law;
use super::onset::slip_onset;
use crate::maybe::Maybe;
use crate::real::Real;
use core::f64::consts::LOG2_E;

/// Friction as a rig measures it: LuGre whose levels may differ between the directions, with a
/// choice of how slip sets in.
///
/// ```text
/// dz/dt = v − α k_e |v| / g · z
/// R     = k_e z + c dz/dt + σ± v                              ± follows the sign of v
/// g     = (F_c± + s x) (1 + (ρ − 1) exp(−(v / v_s)²))          ρ = F_s / F_c
/// α     = 1 (LuGre), or S((|z| k_e / g − e) / (1 − e)) while the bristle is loaded, else 0
/// ```
///
/// S is the smooth step 3 s² − 2 s³ on 0 to 1, and e the share of the deflection that is elastic:
/// the elasto-plastic law of Dupont, Hayward, Armstrong and Altpeter (IEEE TAC 47(5), 2002), whose
/// sinusoidal step differs from S by less than 0.011. α is taken at the deflection before the step.
///
/// With equal levels, no slope and α = 1 it is [`super::Lugre`] with an engagement that does not
/// change. Numbers are not checked: `F_c± + s x` has to stay above 0.
///
/// # Example
/// ```
/// use breakaway_core::Maybe;
/// use breakaway_core::joint::DirectionalLugre;
/// let friction = DirectionalLugre {
///     coulomb_positive_n: 20.0,
///     coulomb_negative_n: 30.0,
///     viscous_positive_n_s_per_m: 0.0,
///     viscous_negative_n_s_per_m: 0.0,
///     stiction_ratio: 1.0,
///     stribeck_velocity_m_per_s: 0.01,
///     stiffness_n_per_m: 1e6,
///     damping_n_s_per_m: 100.0,
///     coulomb_slope_n_per_m: 0.0,
///     elastic_share: Maybe::none(),
/// };
/// assert_eq!(friction.level(0.0, 0.1), 20.0);
/// assert_eq!(friction.level(0.0, -0.1), 30.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLugre<R> {
    /// F_c while v ≥ 0, N.
    pub coulomb_positive_n: R,
    /// F_c while v < 0, N.
    pub coulomb_negative_n: R,
    /// σ while v ≥ 0, N s/m.
    pub viscous_positive_n_s_per_m: R,
    /// σ while v < 0, N s/m.
    pub viscous_negative_n_s_per_m: R,
    /// ρ = F_s / F_c, above 0; below 1 friction rises with speed.
    pub stiction_ratio: R,
    /// v_s in m/s.
    pub stribeck_velocity_m_per_s: R,
    /// k_e in N/m.
    pub stiffness_n_per_m: R,
    /// c in N s/m.
    pub damping_n_s_per_m: R,
    /// s in N/m: how the level changes with position; below 0 where a joint disengages.
    pub coulomb_slope_n_per_m: R,
    /// e, from 0 to below 1, of the elasto-plastic law; none for LuGre.
    pub elastic_share: Maybe<R>,
}

impl<R: Real> DirectionalLugre<R> {
    /// g in N at position `x` in m and velocity `v` in m/s.
    #[inline(always)]
    pub fn level(&self, x: R, v: R) -> R {
        let coulomb = self.of_direction(v, self.coulomb_positive_n, self.coulomb_negative_n);
        self.level_of(coulomb, x, v)
    }

    #[inline(always)]
    fn level_of(&self, coulomb: R, x: R, v: R) -> R {
        let level = self.coulomb_slope_n_per_m.mul_add(x, coulomb);
        let v_s = self.stribeck_velocity_m_per_s;
        let decay = (v * v * (-R::constant(LOG2_E) / (v_s * v_s))).exp2();
        level * (self.stiction_ratio - R::one()).mul_add(decay, R::one())
    }

    #[inline(always)]
    fn of_direction(&self, v: R, positive: R, negative: R) -> R {
        R::select(v.lt(R::zero()), negative, positive)
    }

    /// The deflection in m at which a rig starts whose friction force is `friction_n` at position
    /// `x` and velocity `v`: that of the elastic force, at most at the level of its direction.
    #[inline(always)]
    pub fn deflection_under(&self, friction_n: R, x: R, v: R) -> R {
        let viscous = self.viscous(v) * v;
        let forward = self.level_of(self.coulomb_positive_n, x, v);
        let backward = self.level_of(self.coulomb_negative_n, x, v);
        (friction_n - viscous).clamp(-backward, forward) / self.stiffness_n_per_m
    }

    #[inline(always)]
    fn viscous(&self, v: R) -> R {
        self.of_direction(v, self.viscous_positive_n_s_per_m, self.viscous_negative_n_s_per_m)
    }

    /// The bristle with velocity and position frozen, its level multiplied by `level_factor`.
    #[inline(always)]
    pub fn freeze(&self, state: &JointState<R>, x: R, v: R, level_factor: R) -> Bristle<R> {
        let g = self.level(x, v) * level_factor;
        let relaxation = match self.elastic_share.get() {
            Some(&share) => {
                slip_onset(share, state.bristle_m, v, self.stiffness_n_per_m, g)
                    * self.stiffness_n_per_m
            }
            None => self.stiffness_n_per_m,
        };
        Bristle {
            stretch: R::one(),
            speed_m_per_s: v.abs(),
            relaxation_n_per_m: relaxation,
            friction_level_n: g,
            stiffness_n_per_m: self.stiffness_n_per_m,
            damping_n_s_per_m: self.damping_n_s_per_m,
            viscous_n_s_per_m: Maybe::some(self.viscous(v)),
        }
    }
}

impl<R: Real> Law<R> for DirectionalLugre<R> {
    /// It does not end.
    #[inline(always)]
    fn engagement_length_m(&self) -> R {
        R::constant(f64::INFINITY)
    }

    #[inline(always)]
    fn stiffness_n_per_m(&self) -> R {
        self.stiffness_n_per_m
    }

    #[inline(always)]
    fn breakaway_force(&self, x: R) -> R {
        self.level(x, R::zero())
    }

    #[inline(always)]
    fn friction_level(&self, x: R, v: R, factor: R) -> R {
        self.level(x, v) * factor
    }

    #[inline(always)]
    fn frozen<F: Frozen<R>>(&self, state: &JointState<R>, at: &At<R>, then: F) -> F::Output {
        let (x, v) = (at.position_m, at.velocity_m_per_s);
        then.bristle(&self.freeze(state, x, v, at.level_factor))
    }
}
