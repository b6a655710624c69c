//! What every friction law answers, to the plant and to whoever asks for its numbers.

use super::elements::ElementState;
use super::frozen::{At, Bristle, Frozen, JointState, OneBristle};
use crate::maybe::Maybe;
use crate::real::Real;

/// A friction law. Those of a part in its joint are in [`super::Joint`]; a rig's friction
/// ([`super::DirectionalLugre`]) goes through the same steps.
pub trait Law<R: Real> {
    /// l_f in m, where contact ends; infinite where it does not end.
    fn engagement_length_m(&self) -> R;

    /// k_e in N/m; infinite for a rigid law.
    fn stiffness_n_per_m(&self) -> R;

    /// F_s(x) in N, the force that breaks the joint loose forward at position `x` in m: equation (5).
    fn breakaway_force(&self, x: R) -> R;

    /// g(v, x) in N, multiplied by `factor`: the size of the friction force while the part slides
    /// steadily at `v` in m/s, without its viscous part.
    fn friction_level(&self, x: R, v: R, factor: R) -> R;

    /// What the bristles hold in J: ½ k_e z² of one bristle.
    #[inline(always)]
    fn stored_energy_j(&self, bristle_m: R, _elements: &ElementState<R>) -> R {
        R::constant(0.5) * self.stiffness_n_per_m() * bristle_m * bristle_m
    }

    /// The events of a bristle at the start of a step: it breaks loose or catches again. A law
    /// without such events leaves the state alone.
    #[inline(always)]
    fn settle(&self, state: JointState<R>, _x: R, _v: R, _level_factor: R) -> JointState<R> {
        state
    }

    /// What bristles let go at the start of a step when their level falls with the time: none carries
    /// more than breaks it loose, |z| ≤ φ F_s(x) / k_e, whether the part moves or not. By their own
    /// equations bristles relax only as the part moves. While they let go, the motion is of first order
    /// in the step. This is for one bristle, alike in both directions.
    #[inline(always)]
    fn let_go(
        &self,
        state: JointState<R>,
        _elements: &mut ElementState<R>,
        x: R,
        level_factor: R,
    ) -> JointState<R> {
        state.carrying(self.breakaway_force(x) * level_factor, self.stiffness_n_per_m())
    }

    /// Freezes velocity and position, and hands what the law then is to `then`.
    fn frozen<F: Frozen<R>>(&self, state: &JointState<R>, at: &At<R>, then: F) -> F::Output;

    /// The law's bristle with velocity and position frozen at `v` and `x`, its friction level
    /// multiplied by `level_factor`; none for a law of several elements, or without bristles.
    #[inline(always)]
    fn freeze(&self, state: &JointState<R>, x: R, v: R, level_factor: R) -> Option<Bristle<R>> {
        let (ahead_s, transverse_m_per_s) = (R::zero(), Maybe::none());
        let at =
            At { position_m: x, velocity_m_per_s: v, level_factor, transverse_m_per_s, ahead_s };
        self.frozen(state, &at, OneBristle)
    }
}
