//! Rigid friction: exactly stuck, or sliding at its level.

mod laws;
mod support;

use breakaway_core::Maybe;
use breakaway_core::imposed::impose_motion;
use breakaway_core::joint::Lugre;
use breakaway_core::plant::PlantState;
use breakaway_core::test_models::paper_joint;
use support::Rig;

#[test]
fn below_stiction_nothing_moves_at_all() {
    let mut rig = Rig::at(laws::coulomb_stiction(paper_joint()), 0.02);
    let stiction_n = 450.0 + (9.81 - 450.0) * 0.2;
    let mut seed = 4;
    for _ in 0..10_000 {
        let force = 0.999_999 * stiction_n * support::random(&mut seed);
        let held = rig.push(force, 1e-5);
        assert!((held - force).abs() < 1e-10, "{held} {force}");
    }
    let at_start = PlantState { position_m: 0.02, ..PlantState::at_rest() };
    assert_eq!(PlantState { joint_force_n: 0.0, ..rig.state }, at_start);
    rig.push(1.000_001 * stiction_n, 1e-5);
    assert!(rig.state.velocity_m_per_s > 0.0 && rig.state.sliding == 1.0);
}

/// Without a Stribeck curve a part that slides freely stops after v² m / (2 F_c), exactly at rest.
#[test]
fn it_stops_where_its_energy_is_spent() {
    let law = Lugre { stiction_n: 360.0, ..laws::endless() };
    for v in [0.3_f64, -0.3] {
        let mut rig = Rig::at(laws::coulomb_stiction(law), 0.0);
        (rig.state.velocity_m_per_s, rig.state.sliding) = (v, 1.0);
        let mut steps = 0;
        while rig.state.velocity_m_per_s != 0.0 {
            rig.push(0.0, 1e-5);
            steps += 1;
        }
        let travel = v.abs() * v / (2.0 * 360.0);
        // The last step is the one with the stop within it.
        let least = v.abs() / 360.0 / 1e-5;
        assert!((least..least + 1.0).contains(&f64::from(steps)), "{steps}");
        assert!((rig.state.position_m - travel).abs() < 0.5 * 360.0 * 1e-10, "{:?}", rig.state);
        rig.hold(359.0, 1e-3);
        assert_eq!((rig.state.velocity_m_per_s, rig.state.sliding), (0.0, 0.0));
    }
}

/// Stuck it needs F_s, once loose g(v): between the two it slides on, and does not start.
#[test]
fn between_the_levels_it_slides_on_but_does_not_start() {
    let joint = laws::coulomb_stiction(laws::endless());
    let mut rig = Rig::at(joint, 0.0);
    rig.hold(400.0, 0.01);
    assert_eq!(rig.state.position_m, 0.0);
    (rig.state.velocity_m_per_s, rig.state.sliding) = (0.2, 1.0);
    rig.hold(400.0, 0.01);
    assert!(rig.state.velocity_m_per_s > 0.5, "{:?}", rig.state);
}

/// A steady force of either sign beyond the level turns a sliding part round.
#[test]
fn it_turns_under_a_force_beyond_its_level() {
    let law = Lugre { stiction_n: 360.0, ..laws::endless() };
    let mut errors = [0.0; 2];
    for (error, h) in errors.iter_mut().zip([1e-5, 5e-6]) {
        let mut rig = Rig::at(laws::coulomb_stiction(law), 0.0);
        (rig.state.velocity_m_per_s, rig.state.sliding) = (0.301, 1.0);
        let steps = (1e-3 / h) as u32;
        (0..steps).for_each(|_| _ = rig.push(-800.0, h));
        let turned_s = 0.301 / 1160.0;
        let expected = -(800.0 - 360.0) * (1e-3 - turned_s);
        *error = (rig.state.velocity_m_per_s - expected).abs();
        assert!(*error < 720.0 * h, "{:?} {expected}", rig.state);
    }
}

/// Moved as on a rig it shows ± g(v) + σ v; at a halt it holds what it held.
#[test]
fn imposed_motion_shows_its_level() {
    let law = Lugre { viscous_n_s_per_m: Maybe::some(60.0), ..laws::endless() };
    let (joint, mut state) = (laws::coulomb_stiction(law), PlantState::at_rest());
    assert_eq!(impose_motion(&joint, &mut state, 0.0, 1e-3), 0.0);
    for v in [0.01, -0.2, 0.05] {
        impose_motion(&joint, &mut state, v, 1e-3);
        let force = impose_motion(&joint, &mut state, v, 1e-3);
        let g = 360.0 + 90.0 * (-(v / 0.09_f64).powi(2)).exp();
        assert!((force - g * v.signum() - 60.0 * v).abs() < 1e-6, "{force}");
    }
    let before = state.joint_force_n;
    assert_eq!(impose_motion(&joint, &mut state, 0.0, 1e-3), before);
}
