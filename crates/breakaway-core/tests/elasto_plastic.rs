//! Elasto-plastic friction: a spring at first, LuGre in the end.

mod laws;
mod support;

use breakaway_core::Maybe;
use breakaway_core::imposed::impose_motion;
use breakaway_core::joint::{Joint, Lugre};
use breakaway_core::plant::PlantState;
use breakaway_core::test_models::paper_joint;
use support::Rig;

/// Moved to and fro within its elastic share it is a spring, whatever the path: R = k_e x + c v.
#[test]
fn below_the_elastic_share_it_is_a_spring() {
    let joint = laws::elasto_plastic(paper_joint());
    let reach_m = 0.99 * laws::ELASTIC_SHARE * 450.0 / 3.6e7;
    let mut state = PlantState::at_rest();
    let mut seed = 9;
    for _ in 0..20_000 {
        let target = reach_m * support::random(&mut seed);
        let (h, x) = (1e-3, state.position_m);
        let v = (target - x) / h;
        let force = impose_motion(&joint, &mut state, v, h);
        let expected = 3.6e7 * 0.5 * (x + target) + 9000.0 * v;
        assert!((force - expected).abs() < 1e-6, "{force} {expected}");
    }
    assert!((state.bristle_m - state.position_m).abs() < 1e-16);
}

/// Sliding steadily its onset is one and its force the Stribeck curve of LuGre.
#[test]
fn sliding_steadily_it_is_lugre() {
    let law = Lugre { viscous_n_s_per_m: Maybe::some(60.0), ..laws::endless() };
    for joint in [Joint::Lugre(law), laws::elasto_plastic(law)] {
        for v in [1e-3_f64, 0.03, 0.3, -0.03] {
            let mut state = PlantState::at_rest();
            let h = 1e-7 / v.abs();
            let force = (0..5000).fold(0.0, |_, _| impose_motion(&joint, &mut state, v, h));
            let g = 360.0 + 90.0 * (-(v / 0.09).powi(2)).exp();
            assert!((force / (g * v.signum() + 60.0 * v) - 1.0).abs() < 1e-10, "at {v}: {force}");
        }
    }
}

/// A slow loop up to 0.9 g: all of it comes from dz/dx = 1 − α(z) k_e z/g on the way out, and the way
/// back is elastic until the bristle is loaded the other way.
#[test]
fn a_loop_yields_out_and_returns_elastically() {
    let law = Lugre { damping_n_s_per_m: 0.0, ..laws::endless() };
    let joint = laws::elasto_plastic(law);
    let (mut state, h, v) = (PlantState::at_rest(), 1e-3, 1e-7);
    let mut z = 0.0;
    let slope = |z: f64| {
        let used: f64 = z * 3.6e7 / 450.0;
        let s = ((used - laws::ELASTIC_SHARE) / (1.0 - laws::ELASTIC_SHARE)).clamp(0.0, 1.0);
        1.0 - s * s * (3.0 - 2.0 * s) * used
    };
    let dx = v * h;
    while z < 0.9 * 450.0 / 3.6e7 {
        impose_motion(&joint, &mut state, v, h);
        let k1 = slope(z);
        let k2 = slope(z + 0.5 * dx * k1);
        let k3 = slope(z + 0.5 * dx * k2);
        let k4 = slope(z + dx * k3);
        z += dx / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        assert!((state.bristle_m - z).abs() < 1e-11, "{:e} {z:e}", state.bristle_m);
    }
    let slipped = state.position_m - state.bristle_m;
    assert!(slipped > 2e-7, "{slipped:e}");
    while state.bristle_m > -0.6 * 450.0 / 3.6e7 {
        impose_motion(&joint, &mut state, -v, h);
        assert!((state.position_m - state.bristle_m - slipped).abs() < 1e-16);
    }
}

/// Pushed by three fifths of breakaway and let go, it is back where it was; LuGre is not.
#[test]
fn it_gives_back_what_it_yielded() {
    let left_m = |joint| {
        let mut rig = Rig::at(joint, 0.0);
        rig.hold(270.0, 0.05);
        rig.hold(0.0, 0.05);
        rig.state.position_m
    };
    assert!(left_m(laws::elasto_plastic(paper_joint())).abs() < 1e-15);
    assert!(left_m(Joint::Lugre(paper_joint())) > 1e-6);
}
