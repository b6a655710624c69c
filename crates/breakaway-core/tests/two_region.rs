//! The law that the controller is designed with: a spring that breaks at F_s and then drags at F_c.

mod support;

use breakaway_core::Maybe;
use breakaway_core::joint::{Joint, TwoRegion};
use support::Rig;

fn joint() -> Joint<f64> {
    Joint::TwoRegion(TwoRegion {
        stiction_n: 450.0,
        coulomb_n: 360.0,
        stiffness_n_per_m: 3.6e7,
        damping_n_s_per_m: 9000.0,
        engagement_length_m: 0.1,
        residual_n: 9.81,
        backward_ratio: Maybe::none(),
    })
}

#[test]
fn below_stiction_it_is_a_spring() {
    for force in [-400.0, -100.0, 100.0, 380.0] {
        let mut rig = Rig::at(joint(), 0.0);
        let joint_force = rig.hold(force, 0.05);
        assert!((joint_force - force).abs() < 1e-9, "{joint_force}");
        assert!((rig.state.position_m - force / 3.6e7).abs() < 1e-15, "{}", rig.state.position_m);
        assert_eq!(rig.state.sliding, 0.0);
        rig.hold(0.0, 0.05);
        assert!(rig.state.position_m.abs() < 1e-15, "it gives back all travel");
    }
}

#[test]
fn above_stiction_it_slides_at_the_coulomb_force() {
    for direction in [1.0, -1.0] {
        let mut rig = Rig::at(joint(), 0.02);
        rig.hold(direction * 600.0, 5e-3);
        for _ in 0..100 {
            let x = rig.state.position_m;
            let coulomb = 360.0 + (9.81 - 360.0) * x / 0.1;
            let joint_force = rig.push(direction * 600.0, 1e-5);
            assert_eq!(rig.state.sliding, 1.0);
            assert!((joint_force - direction * coulomb).abs() < 1e-9, "{joint_force} {coulomb}");
        }
    }
}

#[test]
fn it_catches_when_the_motion_turns() {
    let mut rig = Rig::at(joint(), 0.02);
    rig.hold(600.0, 5e-3);
    assert_eq!(rig.state.sliding, 1.0);
    rig.hold(0.0, 0.05);
    assert_eq!(rig.state.sliding, 0.0);
    let caught = rig.state;
    assert!(caught.velocity_m_per_s.abs() < 1e-9, "{caught:?}");
    // Stuck again: it holds what it held before, with the contact that is left.
    let left = 450.0 + (9.81 - 450.0) * caught.position_m / 0.1;
    rig.hold(0.85 * left, 0.05);
    assert_eq!(rig.state.sliding, 0.0);
    let travel = rig.state.position_m - caught.position_m;
    assert!((travel - 0.85 * left / 3.6e7).abs() < 1e-9, "{travel:e}");
    rig.hold(1.02 * left, 5e-3);
    assert_eq!(rig.state.sliding, 1.0);
}
