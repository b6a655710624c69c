//! Several elements side by side, each of which sticks or slips, over a step.

// Indexed loops over fixed arrays are inlined within any caller's instruction set; closures are not.
#![allow(clippy::needless_range_loop)]

use crate::maybe::Maybe;
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

/// The elements of a joint with velocity and position frozen.
#[derive(Clone, Copy, Debug)]
pub struct Elements<'a, R> {
    /// n, at most [`ELEMENTS_MAX`].
    pub(super) count: usize,
    /// v in m/s, at which they are frozen.
    pub(super) velocity_m_per_s: R,
    /// g in N.
    pub(super) friction_level_n: R,
    /// k_e in N/m, of all elements.
    pub(super) stiffness_n_per_m: R,
    /// c(v) in N s/m, of all elements.
    pub(super) damping_n_s_per_m: R,
    /// σ₂ in N s/m, if there is viscous friction.
    pub(super) viscous_n_s_per_m: Maybe<R>,
    /// C in N/s: how fast the force of a slipping element follows its level.
    pub(super) attraction_n_per_s: R,
    /// κ_i, the share of each element in stiffness and damping.
    pub(super) stiffness_shares: &'a [R; ELEMENTS_MAX],
    /// ν_i, the share of each element in the friction level.
    pub(super) level_shares: &'a [R; ELEMENTS_MAX],
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
        let (k_e, g) = (self.stiffness_n_per_m, self.friction_level_n);
        let direction = self.velocity_m_per_s.sign().named("direction");
        let travel = ((k + k) * self.velocity_m_per_s.abs()).named("travel_m");
        let per_travel = (one / travel).named("per_travel_per_m");
        let y = (k * self.attraction_n_per_s / g).min(one).named("attraction");
        let kept = (one / (one + y)).named("attraction_kept");
        let mut out = ElementsAhead {
            offset_m: *deflection_m,
            gain_s: [zero; ELEMENTS_MAX],
            force_at_rest_n: zero,
            resistance_n_s_per_m: zero,
        };
        let (mut offset, mut gain, mut mean) = (zero, zero, zero);
        for i in 0..self.count {
            let (z, share) = (deflection_m[i], self.stiffness_shares[i]);
            let limit = (self.level_shares[i] * g / (share * k_e)).named("limit_m");
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
        let viscous = self.viscous_n_s_per_m.unwrap_or(zero);
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
        let zero = R::zero();
        let mut mean = zero;
        for i in 0..self.count {
            let z_mid = ahead.gain_s[i].mul_add(v, ahead.offset_m[i]);
            let z = R::select(engaged, (z_mid + z_mid) - state.deflection_m[i], zero);
            let z = z.named("deflection_m");
            mean = self.stiffness_shares[i].mul_add(z, mean);
            state.deflection_m[i] = z;
            state.slip[i] = R::select(engaged, state.slip[i], zero);
        }
        mean
    }
}
