//! LuGre friction with contact loss.

use core::f64::consts::LOG2_E;

use super::elements::ElementState;
use super::engagement::engaged_level;
use super::frozen::{At, Bristle, Frozen, JointState};
use super::law::Law;
use crate::maybe::Maybe;
use crate::name::Name;
use crate::real::Real;
use crate::variation::speed;

/// Modified LuGre friction, equations (1) to (8).
///
/// ```text
/// ż    = v − k_e |v| / g(v, x) · z                              (2)
/// R    = k_e z + c(v) ż + σ₂ v                                  (1), (7) with σ₂ = 0
/// g    = F_c(x) + (F_s(x) − F_c(x)) exp(−(v / v_s)²)            (3)
/// F(x) = F_0 + (F_end − F_0) x / l_f                            (5), (6)
/// c(v) = c,  or  c exp(−(v / v_d)²)
/// ```
///
/// Equation (2) is printed without `k_e`; the factor is that of Canudas de Wit, Olsson,
/// Åström and Lischinsky, IEEE TAC 40(3), 1995. Valid for positive levels, stiffness, velocities
/// and length. Two faults of the law flatter vibration along the motion: its breakaway force depends on
/// the loading rate, and below breakaway it drifts without end, by −g/k_e ln(1 − (F/g)²) in each slow
/// pulse of F. Slip of nanometers to less than a micrometer, which locks up, is measured (Yang, Zhang
/// and Marder, PNAS 2008).
///
/// With a constant c the law is no passive friction: at speeds where c |v| exceeds 4 g a bristle
/// stretched beyond its level can push the part. With a damping velocity (Olsson, thesis, Lund
/// 1996) it is, if c(v)² |v| ≤ 4 g(v, x) [c(v) + σ₂] at all v, for which c v_d ≤ 4 √(2e) F is enough,
/// F the smallest level. Not checked. Derivation: `docs/derivations/friction_laws.md`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Lugre<R> {
    /// F_s0 in N, stiction force at the seat.
    pub stiction_n: R,
    /// F_c0 in N, Coulomb force at the seat.
    pub coulomb_n: R,
    /// k_e in N/m.
    pub stiffness_n_per_m: R,
    /// c in N s/m.
    pub damping_n_s_per_m: R,
    /// σ₂ in N s/m, if there is viscous friction.
    pub viscous_n_s_per_m: Maybe<R>,
    /// v_s in m/s.
    pub stribeck_velocity_m_per_s: R,
    /// l_f in m.
    pub engagement_length_m: R,
    /// F_end in N, friction left at x = l_f.
    pub residual_n: R,
    /// v_d in m/s, if the damping of the bristles falls with speed.
    pub damping_velocity_m_per_s: Maybe<R>,
    /// What the levels are multiplied by while v < 0, if they differ.
    pub backward_ratio: Maybe<R>,
}

impl<R: Real> Lugre<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Lugre<S> {
        let v_s = self.stribeck_velocity_m_per_s;
        Lugre {
            stiction_n: f(Name::of("stiction_n"), self.stiction_n),
            coulomb_n: f(Name::of("coulomb_n"), self.coulomb_n),
            stiffness_n_per_m: f(Name::of("stiffness_n_per_m"), self.stiffness_n_per_m),
            damping_n_s_per_m: f(Name::of("damping_n_s_per_m"), self.damping_n_s_per_m),
            viscous_n_s_per_m: self
                .viscous_n_s_per_m
                .map(|sigma| f(Name::of("viscous_n_s_per_m"), sigma)),
            stribeck_velocity_m_per_s: f(Name::of("stribeck_velocity_m_per_s"), v_s),
            engagement_length_m: f(Name::of("engagement_length_m"), self.engagement_length_m),
            residual_n: f(Name::of("residual_n"), self.residual_n),
            damping_velocity_m_per_s: self
                .damping_velocity_m_per_s
                .map(|v_d| f(Name::of("damping_velocity_m_per_s"), v_d)),
            backward_ratio: self.backward_ratio.map(|ratio| f(Name::of("backward_ratio"), ratio)),
        }
    }

    /// Whether none of the options is used.
    pub fn is_plain(&self) -> bool {
        self.viscous_n_s_per_m.is_none()
            && self.damping_velocity_m_per_s.is_none()
            && self.backward_ratio.is_none()
    }

    /// The same levels, bristle and guide without options, written so that compilers see it.
    #[inline(always)]
    pub fn plain(&self) -> Self {
        Self {
            viscous_n_s_per_m: Maybe::none(),
            damping_velocity_m_per_s: Maybe::none(),
            backward_ratio: Maybe::none(),
            ..*self
        }
    }

    /// F_c(x) in N against forward motion: equation (6).
    #[inline(always)]
    pub fn coulomb(&self, x: R) -> R {
        engaged_level(self.coulomb_n, self.residual_n, self.engagement_length_m, R::one(), x)
    }

    /// c(v) in N s/m.
    #[inline(always)]
    pub fn damping(&self, v: R) -> R {
        match self.damping_velocity_m_per_s.get() {
            Some(&v_d) => (self.damping_n_s_per_m * bell(v, v_d)).named("damping_n_s_per_m"),
            None => self.damping_n_s_per_m,
        }
    }

    /// φ F_s(x) in N against forward and against backward motion.
    #[inline(always)]
    pub(super) fn loose_n(&self, x: R, level_factor: R) -> [R; 2] {
        let forward = (self.breakaway_force(x) * level_factor).named("loose_n");
        let backward = match self.backward_ratio.get() {
            Some(&ratio) => forward * ratio,
            None => forward,
        };
        [forward, backward]
    }

    /// The bristle with velocity and position frozen. Where something vibrates across the motion, slip and
    /// level go with the speed of both: in the plane ż = v − k_e |v| / g(|v|) z, a vector equation.
    #[inline(always)]
    pub(super) fn bristle(&self, at: &At<R>) -> Bristle<R> {
        let speed = speed(at.velocity_m_per_s, at.transverse_m_per_s);
        let v = match at.transverse_m_per_s.get() {
            Some(_) => R::select(at.velocity_m_per_s.lt(R::zero()), -speed, speed),
            None => at.velocity_m_per_s,
        };
        Bristle {
            stretch: R::one(),
            speed_m_per_s: speed,
            relaxation_n_per_m: self.stiffness_n_per_m,
            friction_level_n: self.friction_level(at.position_m, v, at.level_factor),
            stiffness_n_per_m: self.stiffness_n_per_m,
            damping_n_s_per_m: self.damping(v),
            viscous_n_s_per_m: self.viscous_n_s_per_m,
        }
    }
}

impl<R: Real> Law<R> for Lugre<R> {
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

    /// Equation (3).
    #[inline(always)]
    fn friction_level(&self, x: R, v: R, factor: R) -> R {
        let factor = match self.backward_ratio.get() {
            Some(&ratio) => factor * R::select(v.lt(R::zero()), ratio, R::one()),
            None => factor,
        };
        let (end, length) = (self.residual_n, self.engagement_length_m);
        let levels = [self.stiction_n, self.coulomb_n];
        stribeck_level(levels, end, length, self.stribeck_velocity_m_per_s, x, v, factor)
    }

    #[inline(always)]
    fn let_go(
        &self,
        state: JointState<R>,
        _elements: &mut ElementState<R>,
        x: R,
        level_factor: R,
    ) -> JointState<R> {
        let [forward_n, backward_n] = self.loose_n(x, level_factor);
        let most_n = R::select(state.bristle_m.lt(R::zero()), backward_n, forward_n);
        state.carrying(most_n, self.stiffness_n_per_m)
    }

    #[inline(always)]
    fn frozen<F: Frozen<R>>(&self, _state: &JointState<R>, at: &At<R>, then: F) -> F::Output {
        then.bristle(&self.bristle(at))
    }
}

/// exp(−(v / scale)²) as 2^(v² s) with s = −log₂ e / scale², which does not change during a run.
#[inline(always)]
fn bell<R: Real>(v: R, scale: R) -> R {
    let per_square = (-R::constant(LOG2_E) / (scale * scale)).named("bell_s2_per_m2");
    (v * v * per_square).named("bell_exponent").exp2()
}

/// The Stribeck curve g(v, x) in N of the levels [F_s0, F_c0] and F_end, multiplied by `factor`:
/// equation (3). Both levels are straight lines whose coefficients do not change during a run.
#[inline(always)]
pub(super) fn stribeck_level<R: Real>(
    [stiction_n, coulomb_n]: [R; 2],
    end_n: R,
    length_m: R,
    v_s: R,
    x: R,
    v: R,
    factor: R,
) -> R {
    R::section("friction level: g = F_c(x) + (F_s(x) - F_c(x)) exp(-(v / v_s)^2), equation (3)");
    let coulomb = engaged_level(coulomb_n, end_n, length_m, factor, x).named("coulomb_n");
    let seated_peak = (stiction_n - coulomb_n).named("seated_peak_n");
    let peak = engaged_level(seated_peak, R::zero(), length_m, factor, x).named("peak_n");
    let per_square = (-R::constant(LOG2_E) / (v_s * v_s)).named("stribeck_s2_per_m2");
    let (fraction, power) = (v * v * per_square).named("stribeck_exponent").exp2_parts();
    fraction.mul_add(peak * power, coulomb).named("level_n")
}
