//! Known extractions for tests, benchmarks and doc examples.

use crate::actuator::Actuator;
use crate::control::{AntiWindup, Controller, DerivativeOf, Gains, Pid, VelocityFrom};
use crate::disturbance::{Disturbance, DisturbedQuantity, DrawLaw};
use crate::extraction::{Extraction, Part, Timing};
use crate::joint::{Joint, Lugre};
use crate::maybe::Maybe;
use crate::metrics::Limits;
use crate::plant::Integrator;
use crate::reference::{Motion, Reference};
use crate::variation::Variation;

/// The joint that the paper's Table II implies: k_e = 3.6e7 N/m and c = 9000 N s/m, the rest from
/// its Table I.
#[must_use]
pub fn paper_joint() -> Lugre<f64> {
    Lugre {
        stiction_n: 450.0,
        coulomb_n: 360.0,
        stiffness_n_per_m: 3.6e7,
        damping_n_s_per_m: 9000.0,
        viscous_n_s_per_m: Maybe::none(),
        stribeck_velocity_m_per_s: 0.09,
        engagement_length_m: 0.1,
        residual_n: 9.81,
        damping_velocity_m_per_s: Maybe::none(),
        backward_ratio: Maybe::none(),
    }
}

/// The paper's loop without vibration, its gains unrounded: minimum jerk over 0.1 m in 0.5 s,
/// control at 100 kHz. Its IAE over 0.5 s is 3.0361549e-6 m s (RK4 at 0.1 us).
#[must_use]
pub fn paper_as_computed() -> Extraction<f64> {
    let second_mass = (360.0 - 9.81) / 0.1;
    let (omega, epsilon, a) = (8000.0, 1.0, 200.0);
    let (square, sum) = (omega * omega, 2.0 * epsilon * omega);
    let total = |fixed: f64, sliding: f64| 0.1 * fixed + 0.9 * sliding;
    let kp = square + a * sum;
    Extraction {
        joint: Joint::Lugre(paper_joint()),
        part: Part { mass_kg: 1.0 },
        reference: Reference::MinimumJerk(Motion {
            distance_m: 0.1,
            start_s: 0.0,
            duration_s: 0.5,
        }),
        variation: Variation::none(),
        disturbance: Disturbance {
            law: DrawLaw::Uniform,
            var: 0.0,
            hold_s: 1e-4,
            acts_on: DisturbedQuantity::JointForce,
        },
        actuator: Actuator::Ideal,
        sensors: None,
        watch: None,
        controller: Controller::Pid(Pid {
            gains: Gains {
                kp_n_per_m: total(kp - 3.6e7, kp / second_mass - 1.0),
                ki_n_per_m_s: total(a * square, a * square / second_mass),
                kd_n_s_per_m: total(sum + a - 9000.0, (sum + a) / second_mass),
            },
            derivative_of: DerivativeOf::Error,
            velocity_from: VelocityFrom::Sensor,
            derivative_filter_s: Maybe::none(),
            anti_windup: AntiWindup::Off,
            tracking_time_s: 1e-3,
        }),
        timing: Timing {
            control_period_s: 1e-5,
            one_sample_delay: false,
            integrator: Integrator::LinearlyImplicitMidpoint,
            steps_per_period: 1,
        },
    }
}

/// The limits of [`paper_as_computed`]: the bounds of divergence, and nothing forbidden.
#[must_use]
pub fn paper_limits() -> Limits<f64> {
    Limits {
        diverged_error_m: 0.05,
        diverged_force_n: 9000.0,
        release_position_m: 0.1 - 1e-6,
        after_release_s: f64::INFINITY,
        breakaway_travel_m: 2.5e-5,
        contact_force_n: 0.0,
        peak_force_max_n: f64::INFINITY,
        jump_max_m: f64::INFINITY,
        release_velocity_max_m_per_s: f64::INFINITY,
    }
}
