//! Generalized Maxwell-slip: known curves of springs that let go one after the other.

mod laws;
mod support;

use breakaway_core::imposed::impose_motion;
use breakaway_core::joint::{Gms, Joint, Lugre, default_shares};
use breakaway_core::plant::PlantState;
use breakaway_core::test_models::paper_joint;
use support::Rig;

/// Without damping, on a guide without end.
fn undamped(elements: u32) -> Gms<f64> {
    laws::gms(Lugre { damping_n_s_per_m: 0.0, ..laws::endless() }, elements)
}

/// F(x) of a first loading: Σ min(k_i x, ν_i F_s).
fn virgin_n(law: &Gms<f64>, x: f64) -> f64 {
    let shares = law.stiffness_shares.iter().zip(law.level_shares);
    shares.map(|(kappa, nu)| (kappa * 3.6e7 * x).min(nu * 450.0)).sum()
}

/// Moves slowly to each of the `turns` in m; gives the position and the force at each step's middle,
/// with the number of the turn.
fn path(law: Gms<f64>, turns: &[f64]) -> Vec<(usize, f64, f64)> {
    let (joint, mut state, v) = (Joint::Gms(law), PlantState::at_rest(), 1e-7_f64);
    let mut rows = Vec::new();
    for (turn, &to) in turns.iter().enumerate() {
        let from: f64 = state.position_m;
        let steps = ((to - from).abs() / 1e-8).round() as u32;
        for _ in 0..steps {
            let h = (to - from).abs() / v / f64::from(steps);
            let before = state.position_m;
            let force = impose_motion(&joint, &mut state, v.copysign(to - from), h);
            rows.push((turn, 0.5 * (before + state.position_m), force));
        }
    }
    rows
}

/// The steps in which an element lets go apart, which carry the mean of a kink.
fn off(error_n: f64, rows: &mut u32) {
    *rows += u32::from(error_n.abs() > 1e-7);
    assert!(error_n.abs() < 0.5 * 3.6e7 * 1e-8, "{error_n} N");
}

/// F(x) = Σ min(k_i x, ν_i F_s), whose initial slope is k_e and whose end is F_s.
#[test]
fn the_first_loading_is_the_sum_of_springs() {
    for elements in [4, 7, 10] {
        let law = undamped(elements);
        let mut kinks = 0;
        for (_, x, force) in path(law, &[3e-5]) {
            off(force - virgin_n(&law, x), &mut kinks);
        }
        assert!(kinks <= elements, "{kinks}");
        assert!((virgin_n(&law, 1e-6) - 36.0).abs() < 1e-9);
        // All have let go at 2 n / (n + 1) F_s/k_e.
        let n = f64::from(elements);
        let last = 2.0 * n / (n + 1.0) * 12.5e-6;
        assert!((virgin_n(&law, last) - 450.0).abs() < 1e-9);
        assert!(virgin_n(&law, 0.999 * last) < 449.99);
    }
}

/// Masing's rules: every branch is the virgin curve at twice the scale from its turn, and a loop that
/// closes is forgotten.
#[test]
fn branches_are_the_virgin_curve_doubled() {
    let law = undamped(10);
    let turns = [1.5e-5, -0.5e-5, 0.4e-5, -0.5e-5, 1.5e-5, 2.0e-5];
    let mut kinks = 0;
    for (turn, x, force) in path(law, &turns) {
        let first = |x: f64| virgin_n(&law, x);
        let down = |x: f64| first(1.5e-5) - 2.0 * first(0.5 * (1.5e-5 - x));
        let up = |x: f64| down(-0.5e-5) + 2.0 * first(0.5 * (x + 0.5e-5));
        let expected = match turn {
            0 | 5 => first(x),
            1 => down(x),
            2 | 4 => up(x),
            _ => up(0.4e-5) - 2.0 * first(0.5 * (0.4e-5 - x)),
        };
        off(force - expected, &mut kinks);
    }
    assert!(kinks <= 30, "{kinks}");
}

/// Σ k_i z_i = g sgn v once all slip, whatever the shares and the attraction.
#[test]
fn sliding_steadily_it_carries_its_level() {
    let (mut stiffness, mut level) = default_shares(4);
    (stiffness[0], stiffness[3], level[1], level[2]) = (0.4, 0.1, 0.35, 0.15);
    let own = Gms { stiffness_shares: stiffness, level_shares: level, ..undamped(4) };
    for law in [own, undamped(4), undamped(10)] {
        for attraction_n_per_s in [1e5, 1e9] {
            let joint = Joint::Gms(Gms { attraction_n_per_s, ..law });
            for v in [1e-4_f64, 0.01, 0.064, -0.01, 1.0] {
                let (mut state, h) = (PlantState::at_rest(), (1e-7 / v.abs()).clamp(1e-6, 1e-3));
                let steps = (0.06 / h) as u32 + 2000;
                let force = (0..steps).fold(0.0, |_, _| impose_motion(&joint, &mut state, v, h));
                let g = 360.0 + 90.0 * (-(v / 0.09).powi(2)).exp();
                let error = (force / (g * v.signum()) - 1.0).abs();
                assert!(error < 1e-5, "at {v}, C = {attraction_n_per_s}: off by {error:e}");
                assert!((state.bristle_m * 3.6e7 - force).abs() < 1e-6 * g);
            }
        }
    }
}

/// The force of a slipping element follows its level with the time constant g / C.
#[test]
fn slipping_elements_lag_behind_their_level() {
    let joint = Joint::Gms(undamped(6));
    let mut state = PlantState::at_rest();
    (0..40_000).for_each(|_| _ = impose_motion(&joint, &mut state, 0.01, 1e-6));
    let level = |v: f64| 360.0 + 90.0 * (-(v / 0.09_f64).powi(2)).exp();
    let (start, end) = (level(0.01), level(0.1));
    for n in 0..2000 {
        let force = impose_motion(&joint, &mut state, 0.1, 1e-6);
        let t = (f64::from(n) + 0.5) * 1e-6;
        let expected = end + (start - end) * (-t * 1e6 / end).exp();
        assert!((force - expected).abs() < 1e-4, "{force} {expected} at {t}");
    }
}

/// At rest with sliding elements, nothing moves any more: as published, their force would go on
/// growing to the level of standstill.
#[test]
fn a_part_that_has_stopped_stays() {
    let mut rig = Rig::at(Joint::Gms(laws::gms(paper_joint(), 6)), 0.0);
    rig.hold(600.0, 2e-3);
    rig.hold(300.0, 0.05);
    let stopped = rig.state;
    rig.hold(300.0, 0.5);
    assert!(stopped.velocity_m_per_s.abs() < 1e-12, "{stopped:?}");
    assert!((rig.state.position_m - stopped.position_m).abs() < 1e-15);
}

#[test]
fn past_the_end_the_elements_are_relaxed() {
    let mut rig = Rig::at(Joint::Gms(laws::gms(paper_joint(), 6)), 0.09);
    rig.hold(200.0, 0.05);
    assert!(rig.state.position_m > 0.1);
    assert_eq!(rig.state.elements, PlantState::at_rest().elements);
    assert_eq!((rig.state.bristle_m, rig.push(64.0, 1e-5)), (0.0, 0.0));
}
