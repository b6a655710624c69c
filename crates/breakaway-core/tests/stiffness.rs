//! Why the plant is stepped implicitly.

use breakaway_core::metrics::Groups;
use breakaway_core::plant::Integrator;
use breakaway_core::reference::Reference;
use breakaway_core::test_models::{paper_as_computed, paper_limits};
use breakaway_core::{Draws, Extraction, ExtractionState, Metrics};

/// The paper's loop with another stiffness of the bristles and another speed of the motion.
fn extraction(stiffness: f64, speed: f64) -> Extraction<f64> {
    paper_as_computed().map(&mut |name, value| match name.field() {
        "stiffness_n_per_m" => value * stiffness,
        "duration_s" => value / speed,
        _ => value,
    })
}

/// Runs it for the duration of its motion, or until it diverges.
fn run(mut extraction: Extraction<f64>, integrator: Integrator, steps: u32) -> Metrics<f64> {
    let Reference::MinimumJerk(motion) = extraction.reference else {
        unreachable!("the paper's loop follows a minimum jerk")
    };
    extraction.timing.integrator = integrator;
    extraction.timing.steps_per_period = steps;
    let (mut state, mut metrics) = (ExtractionState::at_rest(), Metrics::new());
    for _ in 0..(motion.duration_s * 1e5).round() as u32 {
        metrics.step(Groups::ALL, &paper_limits(), &extraction, &mut state, Draws::none());
        if metrics.bounded == 0.0 {
            break;
        }
    }
    metrics
}

/// (Stiffness, speed, bound on the relative error of the IAE): found 7.2e-6, 2.3e-4, 7.0e-5.
const CASES: [(f64, f64, f64); 3] = [(1.0, 1.0, 1e-5), (4.0, 1.0, 3e-4), (1.0, 2.0, 1e-4)];

/// One implicit step of 10 us against one hundred explicit ones, which are the oracle.
#[test]
fn one_implicit_step_per_period_stays_close_to_the_oracle() {
    for (stiffness, speed, bound) in CASES {
        let extraction = extraction(stiffness, speed);
        let oracle = run(extraction, Integrator::Rk4, 100);
        let ours = run(extraction, Integrator::LinearlyImplicitMidpoint, 1);
        assert!(ours.time_to_release_s.is_finite() && oracle.time_to_release_s.is_finite());
        let iae = ours.iae_m_s / oracle.iae_m_s - 1.0;
        let peak = ours.peak_force_n / oracle.peak_force_n - 1.0;
        assert!(iae.abs() < bound && peak.abs() < 1e-4, "{stiffness}, {speed}: {iae:e} {peak:e}");
    }
}

/// One explicit step of 10 us: on the nominal case it is the better of the two, and on a joint four
/// times as stiff, or a motion twice as fast, it blows up. Nothing in the nominal run warns of it.
#[test]
fn one_explicit_step_per_period_looks_perfect_until_it_blows_up() {
    let nominal = run(extraction(1.0, 1.0), Integrator::Rk4, 1);
    assert!((nominal.iae_m_s / 3.036_154_9e-6 - 1.0).abs() < 1e-6, "{}", nominal.iae_m_s);
    for (stiffness, speed) in [(4.0, 1.0), (1.0, 2.0)] {
        let diverged = run(extraction(stiffness, speed), Integrator::Rk4, 1);
        assert_eq!(diverged.bounded, 0.0, "{stiffness}, {speed}: {diverged:?}");
    }
}
