//! The force across the joint, which friction is proportional to.

use super::course::{Course, Over};
use crate::maybe::Maybe;
use crate::name::{Name, within};
use crate::parameters::parameters;
use crate::real::{Block, Real};
use crate::sine::sine_of_turns;

parameters! {
    /// Vibration normal to the joint: the bodies approach and part on the contact's stiffness.
    pub struct NormalVibration {
        /// a in m.
        pub amplitude_m,
        /// k_n in N/m, stiffness of the contact normal to the joint.
        pub stiffness_n_per_m,
        /// f in Hz.
        pub frequency_hz,
        /// Phase at the start in turns.
        pub phase_turns,
    }
}

parameters! {
    /// Vibration within the joint's plane, across the motion: y = a sin(2π (f t + φ)).
    pub struct TransverseVibration {
        /// a in m.
        pub amplitude_m,
        /// f in Hz.
        pub frequency_hz,
        /// Phase at the start in turns.
        pub phase_turns,
    }
}

impl<R: Real> TransverseVibration<R> {
    /// dy/dt in m/s at time `t` in s.
    #[inline(always)]
    pub fn velocity_m_per_s(&self, t: R) -> R {
        R::section("vibration across the motion: v_y = 2 pi f a cos(2 pi (f t + phase))");
        let turns = self.frequency_hz.mul_add(t, self.phase_turns + R::constant(0.25));
        let largest = R::constant(core::f64::consts::TAU) * self.frequency_hz * self.amplitude_m;
        largest.named("transverse_amplitude_m_per_s") * sine_of_turns(turns)
    }
}

/// The normal force, as a share of the one at which the joint's levels hold.
///
/// ```text
/// N / N_0,   N = max(0, N_c + γ c(x, t) + k_n a sin(2π (f t + φ)))
/// ```
///
/// All levels are μ N. Where the bodies part, the levels are 1e-9 of those at N_0, because a law
/// divides by them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct NormalForce<R> {
    /// N_0 in N.
    pub nominal_n: R,
    /// N_c in N.
    pub constant_n: R,
    /// γ, in N over the unit of the course.
    pub course_gain: R,
    /// c.
    pub course: Option<Course<R>>,
    /// Normal to the joint.
    pub vibration: Option<NormalVibration<R>>,
    /// Across the motion: it turns the friction away from the motion, and does not change N.
    pub transverse: Option<TransverseVibration<R>>,
}

impl<R: Real> NormalForce<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> NormalForce<S> {
        NormalForce {
            nominal_n: f(Name::of("nominal_n"), self.nominal_n),
            constant_n: f(Name::of("constant_n"), self.constant_n),
            course_gain: f(Name::of("course_gain"), self.course_gain),
            course: self.course.as_ref().map(|course| within!("course", course, f)),
            vibration: self.vibration.as_ref().map(|one| within!("vibration", one, f)),
            transverse: self.transverse.as_ref().map(|one| within!("transverse", one, f)),
        }
    }

    /// Whether N depends on the time.
    #[inline(always)]
    pub fn reads_time(&self) -> bool {
        self.vibration.is_some() || self.course.is_some_and(|course| course.over == Over::Time)
    }

    /// N / N_0 at travel `x` in m and time `t` in s.
    #[inline(always)]
    pub fn share(&self, x: R, t: R) -> R {
        R::section("normal force: N / N_0");
        let mut normal_n = self.constant_n;
        if let Some(course) = &self.course {
            normal_n = self.course_gain.mul_add(course.at(x, t), normal_n);
        }
        if let Some(vibration) = &self.vibration {
            let turns = vibration.frequency_hz.mul_add(t, vibration.phase_turns);
            let amplitude_n = vibration.stiffness_n_per_m * vibration.amplitude_m;
            normal_n = amplitude_n.named("vibration_n").mul_add(sine_of_turns(turns), normal_n);
        }
        let share = normal_n.named("normal_n") / self.nominal_n;
        share.max(R::constant(1e-9)).named("normal_share")
    }
}

/// The speed of a motion along v that also goes across at `transverse`, √(v² + v_y²), in m/s. From a
/// first guess within 1.2 %, Heron's rule three times: the relative error is below 1e-15.
#[inline(always)]
pub(crate) fn speed<R: Real>(v: R, transverse: Maybe<R>) -> R {
    let Some(&across) = transverse.get() else { return v.abs() };
    R::section("speed: |v| = (v^2 + v_y^2)^(1/2)");
    let (larger, smaller) = (v.abs().max(across.abs()), v.abs().min(across.abs()));
    hypotenuse(larger, smaller).named("speed_m_per_s")
}

/// √(a² + b²) for a ≥ b ≥ 0.
#[inline(always)]
pub(crate) fn hypotenuse<R: Real>(larger: R, smaller: R) -> R {
    R::apart(Hypotenuse { larger, smaller })
}

struct Hypotenuse<R> {
    larger: R,
    smaller: R,
}

impl<R: Real> Block for Hypotenuse<R> {
    type Output = R;

    #[inline(always)]
    fn compute(self) -> R {
        let Self { larger, smaller } = self;
        let (half, tiny) = (R::constant(0.5), R::constant(1e-150));
        let scale = larger.max(tiny);
        let ratio = smaller / scale;
        let square = ratio.mul_add(ratio, R::one());
        let mut root = (R::constant(0.425) * ratio).mul_add(ratio, R::one());
        for _ in 0..3 {
            root = half * (root + square / root);
        }
        larger * root
    }
}
