//! Generalized Maxwell-slip friction with contact loss.

// Indexed loops over fixed arrays are inlined within any caller's instruction set; closures are not.
#![allow(clippy::needless_range_loop)]

use super::elements::{ELEMENTS_MAX, ElementState, Elements};
use super::frozen::{At, Frozen, JointState};
use super::law::Law;
use super::lugre::Lugre;
use crate::name::Name;
use crate::real::Real;

/// Springs side by side, each of which holds until its share of the friction level, then slips:
/// Al-Bender, Lampaert and Swevers, IEEE TAC 50(11), 2005.
///
/// ```text
/// sticks:  ż_i = v                                      until |k_i z_i| reaches ν_i g(v, x)
/// slips:   d(k_i z_i)/dt = C (ν_i d − k_i z_i / g)      d = sgn v, until v turns against d
/// R      = Σ (k_i z_i + c_i ż_i) + σ₂ v,   k_i = κ_i k_e,  c_i = κ_i c(v),  Σ κ_i = Σ ν_i = 1
/// ```
///
/// g(v, x), c(v) and the options are those of [`Lugre`]. At stiction all elements have broken loose;
/// below it, those still stuck spring back, so the part does not drift, and slow motion shows a
/// hysteresis that depends on the path alone. The default shares ([`default_shares`]) are equal
/// springs whose yield deflections rise linearly, to 2 n / (n + 1) · F_s/k_e at the last of n.
///
/// One departure from the source: a slipping element loads no faster than the part moves,
/// d ż_i ≤ |v|. As published, the force of a sliding element grows with the level while the part comes
/// to rest, and even after, which creates energy and pushes a part at rest back.
///
/// Elements are passive at a fixed level if C c(v) ≤ k_e g; with a larger product their dampers can
/// give back more than slip dissipates. An attraction faster than a step (C > 2 g / h) is taken as
/// one that arrives within the step. Not checked: that the shares add up to one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Gms<R> {
    /// Levels, bristles and guide.
    pub friction: Lugre<R>,
    /// C in N/s: how fast the force of a slipping element follows its level.
    pub attraction_n_per_s: R,
    /// n, at most [`ELEMENTS_MAX`].
    pub elements: u32,
    /// κ_i, the share of each element in stiffness and damping, above 0 for the first n.
    pub stiffness_shares: [R; ELEMENTS_MAX],
    /// ν_i, the share of each element in the friction level.
    pub level_shares: [R; ELEMENTS_MAX],
}

/// (κ_i, ν_i) of `elements` equal springs whose yield deflections rise linearly:
///
/// ```text
/// κ_i = 1 / n,   ν_i = 2 i / (n (n + 1)),   i = 1 … n;   0 for the elements that are not there
/// ```
///
/// The corners of their virgin curve lie on a parabola: element j yields at x = 2 j / (n + 1) F_s/k_e,
/// where all of them carry F_s j (2 n + 1 − j) / (n (n + 1)).
///
/// # Example
/// ```
/// use breakaway_core::joint::default_shares;
/// let (stiffness, level) = default_shares::<f64>(4);
/// assert_eq!(stiffness[..5], [0.25, 0.25, 0.25, 0.25, 0.0]);
/// assert_eq!(level[..5], [0.1, 0.2, 0.3, 0.4, 0.0]);
/// ```
pub fn default_shares<R: Real>(elements: u32) -> ([R; ELEMENTS_MAX], [R; ELEMENTS_MAX]) {
    let n = f64::from(elements);
    let (mut stiffness, mut level) = ([R::zero(); ELEMENTS_MAX], [R::zero(); ELEMENTS_MAX]);
    for i in 0..ELEMENTS_MAX.min(elements as usize) {
        stiffness[i] = R::constant(1.0 / n);
        level[i] = R::constant(2.0 * (i + 1) as f64 / (n * (n + 1.0)));
    }
    (stiffness, level)
}

impl<R: Real> Gms<R> {
    /// Applies `f` to every number: those of [`Lugre`], the attraction, all stiffness shares, all
    /// level shares.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Gms<S> {
        Gms {
            friction: self.friction.map(f),
            attraction_n_per_s: f(Name::of("attraction_n_per_s"), self.attraction_n_per_s),
            elements: self.elements,
            stiffness_shares: self
                .stiffness_shares
                .map(|share| f(Name::of("stiffness_shares"), share)),
            level_shares: self.level_shares.map(|share| f(Name::of("level_shares"), share)),
        }
    }

    #[inline(always)]
    fn count(&self) -> usize {
        (self.elements as usize).min(ELEMENTS_MAX)
    }
}

impl<R: Real> Law<R> for Gms<R> {
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

    /// ½ Σ k_i z_i².
    #[inline(always)]
    fn stored_energy_j(&self, _bristle_m: R, elements: &ElementState<R>) -> R {
        let mut sum = R::zero();
        for i in 0..self.count() {
            let z = elements.deflection_m[i];
            sum = (self.stiffness_shares[i] * z).mul_add(z, sum);
        }
        R::constant(0.5) * self.friction.stiffness_n_per_m * sum
    }

    /// k_i |z_i| ≤ ν_i φ F_s(x).
    #[inline(always)]
    fn let_go(
        &self,
        state: JointState<R>,
        elements: &mut ElementState<R>,
        x: R,
        level_factor: R,
    ) -> JointState<R> {
        R::section("a level that fell: k_i |z_i| <= nu_i F_s(x)");
        let k_e = self.friction.stiffness_n_per_m;
        let [forward_m, backward_m] = self.friction.loose_n(x, level_factor).map(|n| n / k_e);
        for i in 0..self.count() {
            let share = (self.level_shares[i] / self.stiffness_shares[i]).named("yield_share");
            let z = elements.deflection_m[i].clamp(-(share * backward_m), share * forward_m);
            elements.deflection_m[i] = z.named("deflection_m");
        }
        state
    }

    #[inline(always)]
    fn frozen<F: Frozen<R>>(&self, _state: &JointState<R>, at: &At<R>, then: F) -> F::Output {
        let (x, v) = (at.position_m, at.velocity_m_per_s);
        then.elements(&Elements {
            count: self.count(),
            velocity_m_per_s: v,
            friction_level_n: self.friction_level(x, v, at.level_factor),
            stiffness_n_per_m: self.friction.stiffness_n_per_m,
            damping_n_s_per_m: self.friction.damping(v),
            viscous_n_s_per_m: self.friction.viscous_n_s_per_m,
            attraction_n_per_s: self.attraction_n_per_s,
            stiffness_shares: &self.stiffness_shares,
            level_shares: &self.level_shares,
        })
    }
}
