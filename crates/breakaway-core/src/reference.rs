//! Where the part should be: references from the seat to a distance, with their rate.

use crate::name::Name;
use crate::parameters::parameters;
use crate::real::Real;

parameters! {
    /// A jump to `distance_m` at `start_s`. Its rate is taken as zero.
    pub struct Step {
        /// Distance in m.
        pub distance_m,
        /// Time of the jump in s.
        pub start_s,
    }
}

parameters! {
    /// A motion of given duration: constant speed, or minimum jerk.
    pub struct Motion {
        /// Distance in m.
        pub distance_m,
        /// Start of the motion in s.
        pub start_s,
        /// Duration of the motion in s.
        pub duration_s,
    }
}

parameters! {
    /// Trapezoidal velocity: accelerate, cruise, decelerate. Needs v² ≤ a · distance.
    pub struct Trapezoid {
        /// Distance in m.
        pub distance_m,
        /// Start of the motion in s.
        pub start_s,
        /// Cruising velocity v in m/s.
        pub velocity_m_per_s,
        /// Acceleration and deceleration a in m/s².
        pub acceleration_m_per_s2,
    }
}

parameters! {
    /// What a reference asks for at a moment.
    pub struct Setpoint {
        /// t in s.
        pub time_s,
        /// r in m.
        pub position_m,
        /// dr/dt in m/s.
        pub rate_m_per_s,
    }
}

/// A reference r(t) that starts at the seat, r = 0.
///
/// # Example
/// ```
/// use breakaway_core::reference::{Motion, Reference};
/// let r = Reference::<f64>::MinimumJerk(Motion { distance_m: 0.1, start_s: 0.0, duration_s: 0.5 });
/// let setpoint = r.sample(0.25);
/// assert!((setpoint.position_m - 0.05).abs() < 1e-15);
/// assert!((setpoint.rate_m_per_s - 1.875 * 0.1 / 0.5).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum Reference<R> {
    /// A jump.
    Step(Step<R>),
    /// Constant speed over a duration.
    Ramp(Motion<R>),
    /// r = d (10 τ³ − 15 τ⁴ + 6 τ⁵), τ = t / duration.
    MinimumJerk(Motion<R>),
    /// Trapezoidal velocity.
    TrapezoidalVelocity(Trapezoid<R>),
}

impl<R: Real> Reference<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Reference<S> {
        match self {
            Self::Step(p) => Reference::Step(p.map(f)),
            Self::Ramp(p) => Reference::Ramp(p.map(f)),
            Self::MinimumJerk(p) => Reference::MinimumJerk(p.map(f)),
            Self::TrapezoidalVelocity(p) => Reference::TrapezoidalVelocity(p.map(f)),
        }
    }

    /// What is asked for at time `t` in s.
    #[inline(always)]
    pub fn sample(&self, t: R) -> Setpoint<R> {
        let (position_m, rate_m_per_s) = match self {
            Self::Step(p) => {
                R::section("reference: a jump to the distance");
                let position_m = R::select(t.lt(p.start_s), R::zero(), p.distance_m);
                (position_m.named("reference_m"), R::zero())
            }
            Self::Ramp(p) => ramp(p, t),
            Self::MinimumJerk(p) => minimum_jerk(p, t),
            Self::TrapezoidalVelocity(p) => trapezoidal_velocity(p, t),
        };
        Setpoint { time_s: t, position_m, rate_m_per_s }
    }
}

#[inline(always)]
fn ramp<R: Real>(p: &Motion<R>, t: R) -> (R, R) {
    let speed = (p.distance_m / p.duration_s).named("reference_speed_m_per_s");
    R::section("reference: r = v t at constant speed");
    let s = (t - p.start_s).clamp(R::zero(), p.duration_s).named("elapsed_s");
    let moving = p.start_s.le(t) & (t - p.start_s).lt(p.duration_s);
    let rate = R::select(moving, speed, R::zero()).named("reference_rate_m_per_s");
    ((speed * s).named("reference_m"), rate)
}

#[inline(always)]
fn minimum_jerk<R: Real>(p: &Motion<R>, t: R) -> (R, R) {
    let c = R::constant;
    R::section("reference: r = d (10 tau^3 - 15 tau^4 + 6 tau^5), tau = (t - start) / duration");
    let per_duration = (R::one() / p.duration_s).named("per_duration_per_s");
    let tau = ((t - p.start_s) * per_duration).clamp(R::zero(), R::one()).named("tau");
    let (tau2, rest) = ((tau * tau).named("tau_squared"), (R::one() - tau).named("tau_left"));
    let position = tau2 * tau * tau.mul_add(c(6.0).mul_add(tau, c(-15.0)), c(10.0));
    let rate = c(30.0) * tau2 * (rest * rest);
    let mean_m_per_s = (p.distance_m / p.duration_s).named("mean_speed_m_per_s");
    let reference_m = (p.distance_m * position.named("reference_share")).named("reference_m");
    (reference_m, (mean_m_per_s * rate).named("reference_rate_m_per_s"))
}

#[inline(always)]
fn trapezoidal_velocity<R: Real>(p: &Trapezoid<R>, t: R) -> (R, R) {
    let half = R::constant(0.5);
    let (v, a) = (p.velocity_m_per_s, p.acceleration_m_per_s2);
    R::section("reference: accelerate, cruise, brake");
    let ramp_s = (v / a).named("ramp_s");
    let duration_s = (p.distance_m / v + ramp_s).named("duration_s");
    let s = (t - p.start_s).clamp(R::zero(), duration_s).named("elapsed_s");
    let left = (duration_s - s).named("left_s");
    let (rising, falling) = (s.lt(ramp_s), left.lt(ramp_s));
    let cruise = (v * (s - half * ramp_s)).named("cruise_m");
    let braking = (p.distance_m - half * a * left * left).named("braking_m");
    let position = R::select(falling, braking, cruise);
    let rate = R::select(falling, a * left, v);
    let reference_m = R::select(rising, half * a * s * s, position).named("reference_m");
    (reference_m, R::select(rising, a * s, rate).named("reference_rate_m_per_s"))
}

#[cfg(test)]
mod tests {
    use super::{Motion, Reference, Step, Trapezoid};

    fn all() -> [Reference<f64>; 3] {
        let motion = Motion { distance_m: 0.08, start_s: 0.1, duration_s: 0.4 };
        let trapezoid = Trapezoid {
            distance_m: 0.08,
            start_s: 0.1,
            velocity_m_per_s: 0.25,
            acceleration_m_per_s2: 2.0,
        };
        [
            Reference::Ramp(motion),
            Reference::MinimumJerk(motion),
            Reference::TrapezoidalVelocity(trapezoid),
        ]
    }

    #[test]
    fn motions_start_at_the_seat_and_end_at_the_distance() {
        for reference in all() {
            let before = reference.sample(0.05);
            assert_eq!((before.position_m, before.rate_m_per_s), (0.0, 0.0));
            let after = reference.sample(0.6);
            let gap = (after.position_m - 0.08).abs();
            assert!(gap < 1e-15 && after.rate_m_per_s == 0.0, "{reference:?}");
        }
        let step = Reference::Step(Step { distance_m: 0.08, start_s: 0.1 });
        assert_eq!((step.sample(0.099_f64).position_m, step.sample(0.1).position_m), (0.0, 0.08));
    }

    #[test]
    fn rate_is_the_derivative_of_position() {
        for reference in all() {
            for i in 1..60 {
                let (t, h) = (f64::from(i) * 0.01 + 0.003, 1e-6);
                let at = |t| reference.sample(t).position_m;
                let slope = (at(t + h) - at(t - h)) / (2.0 * h);
                assert!(
                    (reference.sample(t).rate_m_per_s - slope).abs() < 1e-8,
                    "{reference:?} at {t}"
                );
            }
        }
    }

    #[test]
    fn the_trapezoid_keeps_its_velocity_and_acceleration() {
        let reference = all()[2];
        let rates = |t: f64| reference.sample(t).rate_m_per_s;
        assert!((rates(0.1 + 0.0625) - 0.125).abs() < 1e-15); // halfway up: a t
        assert!((rates(0.3) - 0.25).abs() < 1e-15); // cruise
    }
}
