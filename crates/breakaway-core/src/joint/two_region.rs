//! The two-region law that the paper designs its controller with.

use super::elements::ElementState;
use super::engagement::engaged_level;
use super::frozen::{At, Bristle, Frozen, JointState};
use super::law::Law;
use crate::maybe::Maybe;
use crate::name::Name;
use crate::real::Real;

/// Bristle spring and damper while stuck, Coulomb force while sliding: equation (9).
///
/// ```text
/// stuck:    R = k_e z + c ż,  ż = v        until |k_e z| > F_s(x)
/// sliding:  R = F_c(x) sgn z               until v turns against the slip
/// ```
///
/// The paper switches on the applied force and gives no way back. Here the joint switches on
/// what it can feel, its own elastic force, and catches again when the slip stops. A switch
/// takes effect at the start of a step, so the time of an event is exact to one step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct TwoRegion<R> {
    /// F_s0 in N, stiction force at the seat.
    pub stiction_n: R,
    /// F_c0 in N, Coulomb force at the seat.
    pub coulomb_n: R,
    /// k_e in N/m.
    pub stiffness_n_per_m: R,
    /// c in N s/m.
    pub damping_n_s_per_m: R,
    /// l_f in m.
    pub engagement_length_m: R,
    /// F_end in N, friction left at x = l_f.
    pub residual_n: R,
    /// What the levels are multiplied by while z < 0, if they differ.
    pub backward_ratio: Maybe<R>,
}

impl<R: Real> TwoRegion<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> TwoRegion<S> {
        TwoRegion {
            stiction_n: f(Name::of("stiction_n"), self.stiction_n),
            coulomb_n: f(Name::of("coulomb_n"), self.coulomb_n),
            stiffness_n_per_m: f(Name::of("stiffness_n_per_m"), self.stiffness_n_per_m),
            damping_n_s_per_m: f(Name::of("damping_n_s_per_m"), self.damping_n_s_per_m),
            engagement_length_m: f(Name::of("engagement_length_m"), self.engagement_length_m),
            residual_n: f(Name::of("residual_n"), self.residual_n),
            backward_ratio: self.backward_ratio.map(|ratio| f(Name::of("backward_ratio"), ratio)),
        }
    }

    /// F_c(x) in N against forward motion: equation (6).
    #[inline(always)]
    pub fn coulomb(&self, x: R) -> R {
        engaged_level(self.coulomb_n, self.residual_n, self.engagement_length_m, R::one(), x)
    }

    /// A factor on the level, for a force in this direction.
    #[inline(always)]
    fn directed(&self, level_factor: R, direction: R) -> R {
        match self.backward_ratio.get() {
            Some(&ratio) => level_factor * R::select(direction.lt(R::zero()), ratio, R::one()),
            None => level_factor,
        }
    }
}

impl<R: Real> Law<R> for TwoRegion<R> {
    #[inline(always)]
    fn engagement_length_m(&self) -> R {
        self.engagement_length_m
    }

    #[inline(always)]
    fn stiffness_n_per_m(&self) -> R {
        self.stiffness_n_per_m
    }

    #[inline(always)]
    fn breakaway_force(&self, x: R) -> R {
        engaged_level(self.stiction_n, self.residual_n, self.engagement_length_m, R::one(), x)
    }

    /// F_c(x), at any speed.
    #[inline(always)]
    fn friction_level(&self, x: R, v: R, factor: R) -> R {
        self.coulomb(x) * self.directed(factor, v)
    }

    /// Breaks loose, catches, and while sliding holds the deflection that carries F_c(x).
    #[inline(always)]
    fn settle(&self, state: JointState<R>, x: R, v: R, level_factor: R) -> JointState<R> {
        R::section("two regions: breaks loose at k_e |z| > F_s(x), catches when v turns");
        let direction = state.bristle_m.sign().named("direction");
        let level_factor = self.directed(level_factor, direction);
        let elastic = (self.stiffness_n_per_m * state.bristle_m).abs().named("elastic_n");
        let slips_on = state.sliding.is_set() & R::zero().lt(v * direction);
        let breaks = !state.sliding.is_set() & (self.breakaway_force(x) * level_factor).lt(elastic);
        let engaged = x.lt(self.engagement_length_m);
        let sliding = engaged & (slips_on | breaks);
        let slip_deflection = direction * self.coulomb(x) * level_factor / self.stiffness_n_per_m;
        let slip_deflection = slip_deflection.named("slip_deflection_m");
        JointState {
            transverse_bristle_m: state.transverse_bristle_m,
            bristle_m: R::select(
                engaged,
                R::select(sliding, slip_deflection, state.bristle_m),
                R::zero(),
            ),
            sliding: R::flag(sliding),
        }
    }

    /// Nothing more: it settles on its level at each step.
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

    #[inline(always)]
    fn frozen<F: Frozen<R>>(&self, state: &JointState<R>, _at: &At<R>, then: F) -> F::Output {
        then.bristle(&Bristle {
            stretch: R::one() - state.sliding,
            speed_m_per_s: R::zero(),
            relaxation_n_per_m: R::zero(),
            friction_level_n: R::one(),
            stiffness_n_per_m: self.stiffness_n_per_m,
            damping_n_s_per_m: self.damping_n_s_per_m,
            viscous_n_s_per_m: Maybe::none(),
        })
    }
}
