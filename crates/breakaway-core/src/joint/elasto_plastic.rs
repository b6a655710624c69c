//! Elasto-plastic friction with contact loss.

use super::elements::ElementState;
use super::frozen::{At, Bristle, Frozen, JointState};
use super::law::Law;
use super::lugre::Lugre;
use super::onset::slip_onset;
use crate::name::Name;
use crate::real::Real;
use crate::variation::hypotenuse;

/// LuGre friction whose bristle gives back all of its first stretch.
///
/// ```text
/// ż = v − α k_e |v| / g(v, x) · z
/// α = 0                                                 while |z| ≤ e g/k_e, or z v ≤ 0 (unloading)
/// α = 3 s² − 2 s³,   s = (|z| k_e/g − e) / (1 − e)       up to
/// α = 1                                                 from |z| = g/k_e
/// ```
///
/// R and g are those of [`Lugre`]. Source: Dupont, Hayward, Armstrong and Altpeter, IEEE TAC 47(5),
/// 2002; their step between 0 and 1 is sinusoidal and differs by less than 0.011. Below e F_s(x)
/// vibration moves nothing for good, where LuGre drifts. Between e F_s(x) and F_s(x) this law
/// drifts too: less, the closer to e. Breakaway still depends on the loading rate as in LuGre.
///
/// Valid for 0 ≤ e < 1; with e → 1 the bristle is elastic until it breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct ElastoPlastic<R> {
    /// Levels, bristle and guide.
    pub friction: Lugre<R>,
    /// e, the share of the settled deflection g/k_e that is elastic.
    pub elastic_share: R,
}

impl<R: Real> ElastoPlastic<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> ElastoPlastic<S> {
        ElastoPlastic {
            friction: self.friction.map(f),
            elastic_share: f(Name::of("elastic_share"), self.elastic_share),
        }
    }

    /// The bristle with α at the deflection that it will have at the time at which it is frozen: that
    /// of its linear equation with the α of now, solved implicitly. With the α of now alone a step
    /// would be of first order.
    #[inline(always)]
    fn bristle(&self, state: &JointState<R>, at: &At<R>) -> Bristle<R> {
        let (z, v, k) = (state.bristle_m, at.velocity_m_per_s, at.ahead_s);
        let friction = self.friction.bristle(at);
        let g = friction.friction_level_n;
        let Some(&across) = at.transverse_m_per_s.get() else {
            let bristle = self.yielding(friction, z, v);
            let z_ahead =
                (g * k.mul_add(v, z) / k.mul_add(bristle.relaxation(), g)).named("ahead_m");
            return self.yielding(bristle, z_ahead, v);
        };
        let (z, v) = ([z, state.transverse_bristle_m], [v, across]);
        let bristle = self.yielding_in_plane(friction, z, v);
        let kept = g / k.mul_add(bristle.relaxation(), g);
        let ahead = [k.mul_add(v[0], z[0]) * kept, k.mul_add(v[1], z[1]) * kept];
        self.yielding_in_plane(bristle, ahead, v)
    }

    /// As along the motion, but |z| and z v are those of vectors.
    #[inline(always)]
    fn yielding_in_plane(&self, bristle: Bristle<R>, z: [R; 2], v: [R; 2]) -> Bristle<R> {
        let (larger, smaller) = (z[0].abs().max(z[1].abs()), z[0].abs().min(z[1].abs()));
        let along = z[0].mul_add(v[0], z[1] * v[1]);
        self.yielding(bristle, hypotenuse(larger, smaller), along)
    }

    #[inline(always)]
    fn yielding(&self, bristle: Bristle<R>, z: R, v: R) -> Bristle<R> {
        let (k_e, g) = (bristle.stiffness_n_per_m, bristle.friction_level_n);
        let onset = slip_onset(self.elastic_share, z, v, k_e, g);
        Bristle { relaxation_n_per_m: onset * k_e, ..bristle }
    }
}

impl<R: Real> Law<R> for ElastoPlastic<R> {
    #[inline(always)]
    fn engagement_length_m(&self) -> R {
        self.friction.engagement_length_m
    }

    #[inline(always)]
    fn stiffness_n_per_m(&self) -> R {
        self.friction.stiffness_n_per_m
    }

    #[inline(always)]
    fn breakaway_force(&self, x: R) -> R {
        self.friction.breakaway_force(x)
    }

    #[inline(always)]
    fn friction_level(&self, x: R, v: R, factor: R) -> R {
        self.friction.friction_level(x, v, factor)
    }

    #[inline(always)]
    fn let_go(
        &self,
        state: JointState<R>,
        elements: &mut ElementState<R>,
        x: R,
        level_factor: R,
    ) -> JointState<R> {
        self.friction.let_go(state, elements, x, level_factor)
    }

    #[inline(always)]
    fn frozen<F: Frozen<R>>(&self, state: &JointState<R>, at: &At<R>, then: F) -> F::Output {
        then.bristle(&self.bristle(state, at))
    }
}
