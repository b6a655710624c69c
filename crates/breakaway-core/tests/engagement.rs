//! The further out the part, the less contact is left to hold it: equations (5) and (6).

mod support;

use breakaway_core::Maybe;
use breakaway_core::joint::{Joint, Law, TwoRegion};
use breakaway_core::plant::Integrator::{LinearlyImplicitMidpoint, Rk4};
use breakaway_core::test_models::paper_joint;
use support::Rig;

fn two_region() -> TwoRegion<f64> {
    TwoRegion {
        stiction_n: 450.0,
        coulomb_n: 360.0,
        stiffness_n_per_m: 3.6e7,
        damping_n_s_per_m: 9000.0,
        engagement_length_m: 0.1,
        residual_n: 9.81,
        backward_ratio: Maybe::none(),
    }
}

/// The force at which a part at position `x` runs away when the force grows by `rate` in N/s.
fn breakaway_force(joint: Joint<f64>, x: f64, rate: f64) -> f64 {
    let mut rig = Rig::at(joint, x);
    let mut force = 0.0;
    while rig.state.velocity_m_per_s < 0.02 {
        force += rate * 1e-5;
        rig.push(force, 1e-5);
    }
    force
}

#[test]
fn the_force_that_breaks_the_joint_falls_with_the_distance() {
    for joint in [Joint::Lugre(paper_joint()), Joint::TwoRegion(two_region())] {
        for x in [0.0, 0.025, 0.05, 0.075] {
            let by_equation_5 = 450.0 + (9.81 - 450.0) * x / 0.1;
            assert!((joint.breakaway_force(x) / by_equation_5 - 1.0).abs() < 1e-15);
            let error = breakaway_force(joint, x, 100.0) / by_equation_5 - 1.0;
            assert!(error.abs() < 0.015, "at {x}: off by {error}");
        }
    }
}

#[test]
fn before_the_seat_the_joint_is_fully_engaged() {
    let law = paper_joint();
    for x in [-1e-9, -0.01, -1.0] {
        assert_eq!((law.breakaway_force(x), law.coulomb(x)), (450.0, 360.0));
    }
    let error = breakaway_force(Joint::Lugre(law), -0.02, 100.0) / 450.0 - 1.0;
    assert!(error.abs() < 0.01, "{error}");
}

#[test]
fn past_the_end_the_joint_is_gone() {
    for joint in [Joint::Lugre(paper_joint()), Joint::TwoRegion(two_region())] {
        for integrator in [LinearlyImplicitMidpoint, Rk4] {
            let mut rig = Rig { integrator, ..Rig::at(joint, 0.1) };
            rig.state.bristle_m = 1e-5;
            rig.state.velocity_m_per_s = 0.25;
            for n in 1..=100 {
                let joint_force = rig.push(64.0, 1e-5);
                assert_eq!(joint_force, 0.0);
                let v = 0.25 + 64.0 * 1e-5 * f64::from(n);
                assert!((rig.state.velocity_m_per_s - v).abs() < 1e-14, "{rig:?}", rig = rig.state);
            }
            assert_eq!(rig.state.bristle_m, 0.0);
        }
    }
}
