//! Generalized Maxwell-slip friction with contact loss.

// Indexed loops over fixed arrays are inlined within any caller's instruction set; closures are not.
#![allow(clippy::needless_range_loop)]

use super::{At, Lugre};
use crate::name::Name;
use crate::real::Real;

/// The most elements that a Maxwell-slip joint can have.
pub const ELEMENTS_MAX: usize = 10;

const ELEMENT_M: [&str; ELEMENTS_MAX] = [
    "element_0_m",
    "element_1_m",
    "element_2_m",
    "element_3_m",
    "element_4_m",
    "element_5_m",
    "element_6_m",
    "element_7_m",
    "element_8_m",
    "element_9_m",
];
const SLIP: [&str; ELEMENTS_MAX] = [
    "slip_0", "slip_1", "slip_2", "slip_3", "slip_4", "slip_5", "slip_6", "slip_7", "slip_8",
    "slip_9",
];

/// What the elements of a Maxwell-slip joint remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementState<R> {
    /// z_i in m, the deflection of each element.
    pub deflection_m: [R; ELEMENTS_MAX],
    /// The direction in which each element slips, 1 or -1; 0 while it sticks.
    pub slip: [R; ELEMENTS_MAX],
}

impl<R: Real> ElementState<R> {
    /// Relaxed and stuck.
    #[inline(always)]
    pub fn at_rest() -> Self {
        Self { deflection_m: [R::zero(); ELEMENTS_MAX], slip: [R::zero(); ELEMENTS_MAX] }
    }
}

impl<R: Copy> ElementState<R> {
    /// Applies `f` to every number: all deflections, then all slips.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> ElementState<S> {
        ElementState {
            deflection_m: core::array::from_fn(|i| f(Name::of(ELEMENT_M[i]), self.deflection_m[i])),
            slip: core::array::from_fn(|i| f(Name::of(SLIP[i]), self.slip[i])),
        }
    }

    /// Applies `f` to every number and its counterpart in `other`.
    #[inline(always)]
    pub fn zip<S: Copy, T>(
        &self,
        other: &ElementState<S>,
        f: impl Fn(R, S) -> T,
    ) -> ElementState<T> {
        ElementState {
            deflection_m: core::array::from_fn(|i| f(self.deflection_m[i], other.deflection_m[i])),
            slip: core::array::from_fn(|i| f(self.slip[i], other.slip[i])),
        }
    }
}

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

/// The elements of a joint with velocity and position frozen.
#[derive(Clone, Copy, Debug)]
pub struct Elements<'a, R> {
    law: &'a Gms<R>,
    /// v in m/s, at which they are frozen.
    velocity_m_per_s: R,
    /// g in N.
    friction_level_n: R,
    /// c(v) in N s/m, of all elements.
    damping_n_s_per_m: R,
}

/// What all elements do over half a step of k seconds, for any middle velocity.
///
/// ```text
/// z_m,i = p_i + s_i v_m,      R_m = R_0 + D v_m
/// ```
#[derive(Clone, Copy, Debug)]
pub(crate) struct ElementsAhead<R> {
    offset_m: [R; ELEMENTS_MAX],
    gain_s: [R; ELEMENTS_MAX],
    /// R_0 in N.
    pub(crate) force_at_rest_n: R,
    /// D in N s/m.
    pub(crate) resistance_n_s_per_m: R,
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

    #[inline(always)]
    pub(super) fn freeze(&self, at: &At<R>) -> Elements<'_, R> {
        let (x, v) = (at.position_m, at.velocity_m_per_s);
        Elements {
            law: self,
            velocity_m_per_s: v,
            friction_level_n: self.friction.friction_level(x, v, at.level_factor),
            damping_n_s_per_m: self.friction.damping(v),
        }
    }

    /// ½ Σ k_i z_i² in J.
    #[inline(always)]
    pub(super) fn stored_energy_j(&self, deflection_m: &[R; ELEMENTS_MAX]) -> R {
        let mut sum = R::zero();
        for i in 0..self.count() {
            let z = deflection_m[i];
            sum = (self.stiffness_shares[i] * z).mul_add(z, sum);
        }
        R::constant(0.5) * self.friction.stiffness_n_per_m * sum
    }
}

impl<R: Real> Elements<'_, R> {
    /// Looks half a step of `k` seconds ahead; the slips become those of the step.
    ///
    /// An element that is to reach its level within the step stretches by the share θ of the part's
    /// motion that takes it there, so that an event is no jump of the force: with room r_i left to
    /// its level in the direction of motion, θ = min(1, r_i / (2 k |v|)). A slipping one follows
    /// L_i = d ν_i g / k_i with y = min(k C/g, 1), unless that were faster than the part:
    ///
    /// ```text
    /// sticks:  z_m = z + θ k v_m          slips:  z_m = (z + y L) / (1 + y)
    /// ```
    #[inline(always)]
    pub(crate) fn ahead(&self, state: &mut ElementState<R>, k: R) -> ElementsAhead<R> {
        R::section("elements: each sticks or slips, z_m = p + s v_m over half a step");
        let ElementState { deflection_m, slip } = state;
        let (zero, one) = (R::zero(), R::one());
        let (law, g) = (self.law, self.friction_level_n);
        let k_e = law.friction.stiffness_n_per_m;
        let direction = self.velocity_m_per_s.sign().named("direction");
        let travel = ((k + k) * self.velocity_m_per_s.abs()).named("travel_m");
        let per_travel = (one / travel).named("per_travel_per_m");
        let y = (k * law.attraction_n_per_s / g).min(one).named("attraction");
        let kept = (one / (one + y)).named("attraction_kept");
        let mut out = ElementsAhead {
            offset_m: *deflection_m,
            gain_s: [zero; ELEMENTS_MAX],
            force_at_rest_n: zero,
            resistance_n_s_per_m: zero,
        };
        let (mut offset, mut gain, mut mean) = (zero, zero, zero);
        for i in 0..law.count() {
            let (z, share) = (deflection_m[i], law.stiffness_shares[i]);
            let limit = (law.level_shares[i] * g / (share * k_e)).named("limit_m");
            // How far it is to the limit, and how far the attraction takes it, along the motion.
            let room = (-direction).mul_add(z, limit).named("room_m");
            let pulled = (room * ((y + y) * kept)).named("pulled_m");
            let slipping = zero.lt(slip[i] * direction) | room.lt(zero);
            let slips_on = slipping & pulled.lt(travel);
            let reaches = room.lt(travel);
            let stretch = R::select(reaches, (room * per_travel).max(zero), one).named("stretch");
            let follows = (direction * y * kept).mul_add(room, z).named("follows_m");
            out.offset_m[i] = R::select(slips_on, follows, z).named("offset_m");
            out.gain_s[i] = R::select(slips_on, zero, stretch * k).named("gain_s");
            slip[i] = R::select(slipping | reaches, direction, zero).named("slip");
            offset = share.mul_add(out.offset_m[i], offset).named("offset_sum_m");
            gain = share.mul_add(out.gain_s[i], gain).named("gain_sum_s");
            mean = share.mul_add(z, mean).named("mean_m");
        }
        let c_over_k = (self.damping_n_s_per_m / k).named("damping_n_per_m");
        let per_stretch = (k_e + c_over_k).named("per_stretch_n_per_m");
        let viscous = law.friction.viscous_n_s_per_m.unwrap_or(zero);
        out.force_at_rest_n =
            per_stretch.mul_add(offset, -(c_over_k * mean)).named("force_at_rest_n");
        out.resistance_n_s_per_m = per_stretch.mul_add(gain, viscous).named("resistance_n_s_per_m");
        out
    }

    /// Ends a step with middle velocity `v`; elements are relaxed and stuck where not `engaged`.
    /// Gives their mean deflection Σ κ_i z_i in m.
    #[inline(always)]
    pub(crate) fn finish(
        &self,
        ahead: &ElementsAhead<R>,
        state: &mut ElementState<R>,
        v: R,
        engaged: R::Mask,
    ) -> R {
        R::section("elements, end of the step");
        let (zero, law) = (R::zero(), self.law);
        let mut mean = zero;
        for i in 0..law.count() {
            let z_mid = ahead.gain_s[i].mul_add(v, ahead.offset_m[i]);
            let z = R::select(engaged, (z_mid + z_mid) - state.deflection_m[i], zero);
            let z = z.named("deflection_m");
            mean = law.stiffness_shares[i].mul_add(z, mean);
            state.deflection_m[i] = z;
            state.slip[i] = R::select(engaged, state.slip[i], zero);
        }
        mean
    }
}
