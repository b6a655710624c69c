//! LuGre friction with contact loss.

use core::f64::consts::LOG2_E;

use super::{Bristle, engaged_level};
use crate::real::Real;

/// Modified LuGre friction, equations (1) to (8).
///
/// ```text
/// ż    = v − k_e |v| / g(v, x) · z                              (2)
/// R    = k_e z + c ż + σ₂ v                                     (1), (7) with σ₂ = 0
/// g    = F_c(x) + (F_s(x) − F_c(x)) exp(−(v / v_s)²)            (3)
/// F(x) = F_0 + (F_end − F_0) x / l_f                            (5), (6)
/// ```
///
/// Equation (2) is printed without `k_e`; the factor is that of Canudas de Wit, Olsson,
/// Åström and Lischinsky, IEEE TAC 40(3), 1995. Valid for positive levels, stiffness, Stribeck
/// velocity and length. Two faults of the law flatter vibration: it drifts below breakaway
/// under vibration, and its breakaway force depends on the loading rate.
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
    pub viscous_n_s_per_m: Option<R>,
    /// v_s in m/s.
    pub stribeck_velocity_m_per_s: R,
    /// l_f in m.
    pub engagement_length_m: R,
    /// F_end in N, friction left at x = l_f.
    pub residual_n: R,
}

impl<R: Real> Lugre<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(&'static str, R) -> S) -> Lugre<S> {
        Lugre {
            stiction_n: f("stiction_n", self.stiction_n),
            coulomb_n: f("coulomb_n", self.coulomb_n),
            stiffness_n_per_m: f("stiffness_n_per_m", self.stiffness_n_per_m),
            damping_n_s_per_m: f("damping_n_s_per_m", self.damping_n_s_per_m),
            viscous_n_s_per_m: self.viscous_n_s_per_m.map(|sigma| f("viscous_n_s_per_m", sigma)),
            stribeck_velocity_m_per_s: f(
                "stribeck_velocity_m_per_s",
                self.stribeck_velocity_m_per_s,
            ),
            engagement_length_m: f("engagement_length_m", self.engagement_length_m),
            residual_n: f("residual_n", self.residual_n),
        }
    }

    /// F_s(x) in N: equation (5).
    #[inline(always)]
    pub fn stiction(&self, x: R) -> R {
        engaged_level(self.stiction_n, self.residual_n, self.engagement_length_m, R::one(), x)
    }

    /// F_c(x) in N: equation (6).
    #[inline(always)]
    pub fn coulomb(&self, x: R) -> R {
        engaged_level(self.coulomb_n, self.residual_n, self.engagement_length_m, R::one(), x)
    }

    /// g(v, x) in N, multiplied by `factor`: equation (3).
    ///
    /// exp(−(v/v_s)²) is computed as 2^(v² s) with s = −log₂ e / v_s², and both levels as straight
    /// lines whose coefficients do not change during a run.
    #[inline(always)]
    pub fn friction_level(&self, x: R, v: R, factor: R) -> R {
        let (end, length) = (self.residual_n, self.engagement_length_m);
        let coulomb = engaged_level(self.coulomb_n, end, length, factor, x);
        let seated_peak = self.stiction_n - self.coulomb_n;
        let peak = engaged_level(seated_peak, R::zero(), length, factor, x);
        let v_s = self.stribeck_velocity_m_per_s;
        let (fraction, power) = (v * v * (-R::constant(LOG2_E) / (v_s * v_s))).exp2_parts();
        fraction.mul_add(peak * power, coulomb)
    }

    #[inline(always)]
    pub(super) fn freeze(&self, x: R, v: R, level_factor: R) -> Bristle<R> {
        Bristle {
            stretch: R::one(),
            speed_m_per_s: v.abs(),
            relaxation_n_per_m: self.stiffness_n_per_m,
            friction_level_n: self.friction_level(x, v, level_factor),
            stiffness_n_per_m: self.stiffness_n_per_m,
            damping_n_s_per_m: self.damping_n_s_per_m,
            viscous_n_s_per_m: self.viscous_n_s_per_m,
        }
    }
}
