//! Friction of a part that slides steadily: what a law settles on, and how fast.

use super::elements::Elements;
use super::frozen::{At, Bristle, Frozen, JointState, Rigid};
use super::law::Law;
use crate::maybe::Maybe;
use crate::real::Real;

/// Friction at a steady velocity, and how it follows when the velocity changes a little.
///
/// ```text
/// R   = g sgn v + σ v
/// dR  = y + (λ/ω) ẏ + σ dv,   ẏ = ω (g' sgn v · dv − y)
/// ```
///
/// One bristle has ω = k_e |v| / g and λ = c ω / k_e, elements that slip have ω = C / g and λ = 0. A
/// law without bristles, and a bristle that slips without yielding, follow at once: ω is infinite
/// and λ is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steady<R> {
    /// g in N.
    pub level_n: R,
    /// σ in N s/m.
    pub viscous_n_s_per_m: R,
    /// c in N s/m, of the bristles at this velocity; zero for a rigid law.
    pub damping_n_s_per_m: R,
    /// ω in 1/s, not below zero.
    pub rate_per_s: R,
    /// λ, the share of a change of the level that shows at once.
    pub lead: R,
}

impl<R: Real> Steady<R> {
    /// R in N at the velocity `v` in m/s that this is the friction at; zero at rest.
    #[inline(always)]
    pub fn force_n(&self, v: R) -> R {
        self.viscous_n_s_per_m.mul_add(v, self.level_n * v.sign())
    }
}

/// Friction of a law that slides steadily through position `x` in m at velocity `v` in m/s.
///
/// # Example
/// ```
/// use breakaway_core::{Dual, Real, joint::steady, test_models::paper_joint};
/// // The curve falls from 450 N to 360 N over 0.09 m/s: by 857.8 N s/m at 0.09/√2 m/s.
/// let joint = paper_joint().map(&mut |_, value| Dual::<f64, 1>::constant(value));
/// let v = Dual::variable(0.09 / 2.0_f64.sqrt(), 0);
/// let force_n = steady(&joint, Dual::zero(), v).force_n(v);
/// assert!((force_n.value - (360.0 + 90.0 * (-0.5_f64).exp())).abs() < 1e-12);
/// assert!((force_n.derivative[0] + 857.8).abs() < 0.1);
/// ```
#[inline(always)]
pub fn steady<R: Real>(joint: &impl Law<R>, x: R, v: R) -> Steady<R> {
    let one = R::one();
    let level_n = joint.friction_level(x, v, one);
    let bristle_m = v.sign() * level_n / joint.stiffness_n_per_m();
    let state = JointState { bristle_m, transverse_bristle_m: R::zero(), sliding: one };
    let at = At {
        position_m: x,
        velocity_m_per_s: v,
        level_factor: one,
        transverse_m_per_s: Maybe::none(),
        ahead_s: R::zero(),
    };
    joint.frozen(&state, &at, Settled { level_n })
}

/// A law whose bristles carry what they do at a steady velocity.
struct Settled<R> {
    level_n: R,
}

impl<R: Real> Frozen<R> for Settled<R> {
    type Output = Steady<R>;

    #[inline(always)]
    fn bristle(self, b: &Bristle<R>) -> Steady<R> {
        let yields = R::zero().lt(b.stretch);
        let rate = b.relaxation() / b.friction_level_n;
        let lead = b.damping_n_s_per_m * rate / b.stiffness_n_per_m;
        Steady {
            level_n: self.level_n,
            viscous_n_s_per_m: b.viscous_n_s_per_m.unwrap_or(R::zero()),
            damping_n_s_per_m: b.damping_n_s_per_m,
            rate_per_s: R::select(yields, rate, R::constant(f64::INFINITY)),
            lead: R::select(yields, lead, R::one()),
        }
    }

    #[inline(always)]
    fn elements(self, elements: &Elements<'_, R>) -> Steady<R> {
        Steady {
            level_n: self.level_n,
            viscous_n_s_per_m: elements.viscous_n_s_per_m.unwrap_or(R::zero()),
            damping_n_s_per_m: elements.damping_n_s_per_m,
            rate_per_s: elements.attraction_n_per_s / self.level_n,
            lead: R::zero(),
        }
    }

    #[inline(always)]
    fn rigid(self, rigid: &Rigid<R>) -> Steady<R> {
        Steady {
            level_n: self.level_n,
            viscous_n_s_per_m: rigid.viscous_n_s_per_m.unwrap_or(R::zero()),
            damping_n_s_per_m: R::zero(),
            rate_per_s: R::constant(f64::INFINITY),
            lead: R::one(),
        }
    }
}

/// Which of three things a law is to the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// One bristle.
    Bristle,
    /// Several elements.
    Elements,
    /// Rigid.
    Rigid,
}

/// The form of a law.
///
/// # Example
/// ```
/// use breakaway_core::joint::{Form, form};
/// use breakaway_core::test_models::paper_joint;
/// assert_eq!(form(&paper_joint()), Form::Bristle);
/// ```
pub fn form<R: Real>(joint: &impl Law<R>) -> Form {
    let (zero, one) = (R::zero(), R::one());
    let state = JointState { bristle_m: zero, transverse_bristle_m: zero, sliding: zero };
    let at = At {
        position_m: zero,
        velocity_m_per_s: zero,
        level_factor: one,
        transverse_m_per_s: Maybe::none(),
        ahead_s: zero,
    };
    joint.frozen(&state, &at, Asked)
}

struct Asked;

impl<R: Real> Frozen<R> for Asked {
    type Output = Form;
    fn bristle(self, _: &Bristle<R>) -> Form {
        Form::Bristle
    }
    fn elements(self, _: &Elements<'_, R>) -> Form {
        Form::Elements
    }
    fn rigid(self, _: &Rigid<R>) -> Form {
        Form::Rigid
    }
}
