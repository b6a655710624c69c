//! A law with velocity and position frozen: what it asks of the plant, and what it hands to it.

use super::elements::Elements;
use crate::maybe::Maybe;
use crate::real::Real;
use crate::variation::hypotenuse;

/// Where a law is frozen.
#[derive(Clone, Copy, Debug)]
pub struct At<R> {
    /// x in m.
    pub position_m: R,
    /// v in m/s.
    pub velocity_m_per_s: R,
    /// Factor on the friction level.
    pub level_factor: R,
    /// v_y in m/s, across the motion, where something vibrates there.
    pub transverse_m_per_s: Maybe<R>,
    /// How far ahead of the state this is, s: half a step, or nothing.
    pub ahead_s: R,
}

/// What is done with a law whose velocity and position are frozen: it is one of three things.
///
/// A visitor and not an enum, because an enum of vectors of numbers stays in memory: measured, it
/// made batches four times slower.
pub trait Frozen<R: Real> {
    /// What comes of it.
    type Output;
    /// One bristle.
    fn bristle(self, bristle: &Bristle<R>) -> Self::Output;
    /// Several elements, each of which sticks or slips.
    fn elements(self, elements: &Elements<'_, R>) -> Self::Output;
    /// No bristle: stuck, or a friction level.
    fn rigid(self, rigid: &Rigid<R>) -> Self::Output;
}

/// Takes the bristle of a law that has one.
pub(super) struct OneBristle;

impl<R: Real> Frozen<R> for OneBristle {
    type Output = Option<Bristle<R>>;
    #[inline(always)]
    fn bristle(self, bristle: &Bristle<R>) -> Option<Bristle<R>> {
        Some(*bristle)
    }
    #[inline(always)]
    fn elements(self, _: &Elements<'_, R>) -> Option<Bristle<R>> {
        None
    }
    #[inline(always)]
    fn rigid(self, _: &Rigid<R>) -> Option<Bristle<R>> {
        None
    }
}

/// Rigid friction with velocity and position frozen.
///
/// ```text
/// R = σ v + what stops the part within the step, limited to [−L_b, L]
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Rigid<R> {
    /// L in N, against forward motion.
    pub level_n: R,
    /// L_b in N, against backward motion.
    pub backward_level_n: R,
    /// σ in N s/m, if there is viscous friction.
    pub viscous_n_s_per_m: Maybe<R>,
}

/// A bristle's equation with velocity and position frozen.
///
/// ```text
/// ż = α v − (A / g) z                    stretching, and slipping at friction level g
/// R = k z + c ż + σ v                    joint force on the part, against its motion
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Bristle<R> {
    /// α, the share of the motion that stretches the bristle: 1 while it can stretch, else 0.
    pub stretch: R,
    /// |v| in m/s, with what goes across the motion.
    pub speed_m_per_s: R,
    /// A / |v| in N/m: k_e for LuGre, 0 for an elastic bristle.
    pub relaxation_n_per_m: R,
    /// g in N, always above zero.
    pub friction_level_n: R,
    /// k in N/m.
    pub stiffness_n_per_m: R,
    /// c in N s/m.
    pub damping_n_s_per_m: R,
    /// σ in N s/m, if there is viscous friction.
    pub viscous_n_s_per_m: Maybe<R>,
}

impl<R: Real> Bristle<R> {
    /// A in N/s.
    #[inline(always)]
    pub fn relaxation(&self) -> R {
        self.relaxation_n_per_m * self.speed_m_per_s
    }

    /// ż at velocity `v` and deflection `z`.
    #[inline(always)]
    pub fn rate(&self, v: R, z: R) -> R {
        self.stretch * v - self.relaxation() / self.friction_level_n * z
    }

    /// R for a deflection, its rate and a velocity: equations (1) and (7).
    #[inline(always)]
    pub fn force(&self, v: R, z: R, rate: R) -> R {
        let damped = match self.viscous_n_s_per_m.get() {
            Some(&sigma) => self.damping_n_s_per_m.mul_add(rate, sigma * v),
            None => self.damping_n_s_per_m * rate,
        };
        self.stiffness_n_per_m.mul_add(z, damped)
    }
}

/// What a joint remembers between steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointState<R> {
    /// z in m.
    pub bristle_m: R,
    /// z_y in m, across the motion; zero where nothing vibrates there.
    pub transverse_bristle_m: R,
    /// 1 while a two-region or rigid law slides, else 0. Laws without such an event leave it alone.
    pub sliding: R,
}

impl<R: Real> JointState<R> {
    /// The same with bristles of k_e that carry at most a force in N: k_e |z| ≤ `most_n`, z with what lies
    /// across the motion.
    #[inline(always)]
    pub(super) fn carrying(self, most_n: R, stiffness_n_per_m: R) -> Self {
        R::section("a level that fell: |z| <= F_s(x) / k_e");
        let (along, across) = (self.bristle_m, self.transverse_bristle_m);
        let (larger, smaller) = (along.abs().max(across.abs()), along.abs().min(across.abs()));
        let carried_n = (stiffness_n_per_m * hypotenuse(larger, smaller)).named("carried_n");
        let kept = R::select(most_n.lt(carried_n), most_n / carried_n, R::one()).named("kept");
        Self { bristle_m: along * kept, transverse_bristle_m: across * kept, ..self }
    }
}
