//! The contact between a tip and the part: it pushes, or it holds both ways with play.

use crate::maybe::Maybe;
use crate::name::Name;
use crate::plant::Push;
use crate::real::Real;

/// A face that pushes, and where there is a grip another one that pulls.
///
/// ```text
/// F = max(0, k_c d + c_c d') + min(0, k_c (d + b) + c_c d'),   d = x_p − gap − x
/// ```
///
/// d is how far the tip reaches into the part. At most one face acts, since b ≥ 0: with damping, too,
/// the first never pulls and the second never pushes. A damper acts c_c/k_c |d'| before its face
/// touches. Without a grip, F is the first term.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Contact<R> {
    /// k_c in N/m, of each face.
    pub stiffness_n_per_m: R,
    /// c_c in N s/m, of each face.
    pub damping_n_s_per_m: R,
    /// Distance of the tip from the part at the start, m.
    pub gap_m: R,
    /// b in m: play between the faces of a grip; none for a tip that only pushes.
    pub backlash_m: Maybe<R>,
}

impl<R: Real> Contact<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Contact<S> {
        Contact {
            stiffness_n_per_m: f(Name::of("stiffness_n_per_m"), self.stiffness_n_per_m),
            damping_n_s_per_m: f(Name::of("damping_n_s_per_m"), self.damping_n_s_per_m),
            gap_m: f(Name::of("gap_m"), self.gap_m),
            backlash_m: self.backlash_m.map(|play| f(Name::of("backlash_m"), play)),
        }
    }

    /// The push of a tip that reaches d = `pressed_m` into the part before the step, and moves at
    /// `tip_free` − `tip_yield` F at its middle, after `k` seconds.
    #[inline(always)]
    pub(super) fn push(&self, pressed_m: R, tip_free: R, tip_yield: R, k: R) -> Push<R> {
        let contact = self.stiffness_n_per_m.mul_add(k, self.damping_n_s_per_m);
        let contact = contact.named("contact_n_s_per_m");
        let spring_n = (self.stiffness_n_per_m * pressed_m).named("spring_n");
        let free_n = contact.mul_add(tip_free, spring_n).named("free_n");
        let shared = (R::one() / contact.mul_add(tip_yield, R::one())).named("shared");
        let pushing = Push::yielding(free_n * shared, contact * shared);
        match self.backlash_m.get() {
            Some(&play) => {
                R::section("grip: F + min(0, k_c (x_p - gap - x + b) + c_c (v_p - v))");
                let pull_n =
                    (self.stiffness_n_per_m.mul_add(play, free_n) * shared).named("pull_n");
                Push { pull_n: Maybe::some(pull_n), ..pushing }
            }
            None => pushing,
        }
    }

    /// Energy in the springs of the faces with the tip at d = `pressed_m`, J.
    #[inline(always)]
    pub(super) fn energy_j(&self, pressed_m: R) -> R {
        let zero = R::zero();
        let depth = match self.backlash_m.get() {
            Some(&play) => pressed_m.max(zero) + (pressed_m + play).min(zero),
            None => pressed_m.max(zero),
        };
        R::constant(0.5) * self.stiffness_n_per_m * depth * depth
    }
}
