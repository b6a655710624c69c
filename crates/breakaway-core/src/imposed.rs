//! Motion imposed on a joint, as on a test rig.

use crate::joint::{At, Bristle, Elements, Frozen, Law, Rigid};
use crate::maybe::Maybe;
use crate::plant::PlantState;
use crate::real::Real;

/// A step of `h` seconds with the motion imposed instead of the force: velocity
/// `v` in m/s over the step. Gives the joint force in N at the middle of the step, undisturbed.
///
/// ```text
/// z_m = (z + k α v) / (1 + k A / g),   k = h / 2
/// ```
///
/// The midpoint rule again, second order and stable for any step. The velocity of `state` is set
/// to `v`. Beyond the end of the guide the force is zero. A rigid joint that does not move holds
/// what it held, at most its level.
#[inline(always)]
pub fn impose_motion<R: Real>(joint: &impl Law<R>, state: &mut PlantState<R>, v: R, h: R) -> R {
    let (zero, one) = (R::zero(), R::one());
    let settled = joint.settle(state.joint(), state.position_m, v, one);
    (state.bristle_m, state.sliding) = (settled.bristle_m, settled.sliding);
    let k = R::constant(0.5) * h;
    let x_mid = k.mul_add(v, state.position_m);
    let engaged = x_mid.lt(joint.engagement_length_m());
    let at = At {
        position_m: x_mid,
        velocity_m_per_s: v,
        level_factor: one,
        transverse_m_per_s: Maybe::none(),
        ahead_s: k,
    };
    let force = joint.frozen(&settled, &at, Imposed { state, v, k, engaged });
    let force = R::select(engaged, force, zero);
    state.bristle_m = R::select(engaged, state.bristle_m, zero);
    state.position_m = h.mul_add(v, state.position_m);
    state.velocity_m_per_s = v;
    state.joint_force_n = force;
    force
}

/// Half a step of k seconds at an imposed velocity v; gives the joint force in N.
struct Imposed<'a, R: Real> {
    state: &'a mut PlantState<R>,
    v: R,
    k: R,
    engaged: R::Mask,
}

impl<R: Real> Frozen<R> for Imposed<'_, R> {
    type Output = R;

    #[inline(always)]
    fn bristle(self, b: &Bristle<R>) -> R {
        let Self { state, v, k, .. } = self;
        let relaxed = R::one() + k * b.relaxation() / b.friction_level_n;
        let z_mid = (k * b.stretch).mul_add(v, state.bristle_m) / relaxed;
        state.bristle_m = R::constant(2.0) * z_mid - state.bristle_m;
        b.force(v, z_mid, b.rate(v, z_mid))
    }

    #[inline(always)]
    fn elements(self, elements: &Elements<'_, R>) -> R {
        let Self { state, v, k, engaged } = self;
        let mut moving = state.elements;
        let ahead = elements.ahead(&mut moving, k);
        state.bristle_m = elements.finish(&ahead, &mut moving, v, engaged);
        state.elements = moving;
        ahead.resistance_n_s_per_m.mul_add(v, ahead.force_at_rest_n)
    }

    #[inline(always)]
    fn rigid(self, rigid: &Rigid<R>) -> R {
        let Self { state, v, .. } = self;
        let zero = R::zero();
        let held = state.joint_force_n.min(rigid.level_n).max(-rigid.backward_level_n);
        let backward = R::select(v.lt(zero), -rigid.backward_level_n, held);
        let friction = R::select(zero.lt(v), rigid.level_n, backward);
        state.sliding = R::flag(v.lt(zero) | zero.lt(v));
        match rigid.viscous_n_s_per_m.get() {
            Some(&sigma) => sigma.mul_add(v, friction),
            None => friction,
        }
    }
}
