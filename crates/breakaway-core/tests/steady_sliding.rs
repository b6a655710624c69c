//! At a constant velocity the bristles settle, and the joint force becomes a function of velocity
//! alone: the Stribeck curve, equations (4) and (8). The code never computes that curve; it has to
//! come out of the bristle's differential equation.

use breakaway_core::Maybe;
use breakaway_core::joint::{Joint, JointState, Law, Lugre};
use breakaway_core::test_models::paper_joint;

/// The joint force after the bristle has settled at velocity `v` and position `x`: the bristle
/// equation (2) integrated by a Runge-Kutta method of order four for 50 of its time constants.
fn settled_force(law: Lugre<f64>, x: f64, v: f64) -> f64 {
    let state = JointState { bristle_m: 0.0, transverse_bristle_m: 0.0, sliding: 0.0 };
    let joint = Joint::Lugre(law);
    let bristle = joint.freeze(&state, x, v, 1.0).expect("LuGre has one");
    let h = 0.1 * bristle.friction_level_n / bristle.relaxation();
    let mut z = 0.0;
    for _ in 0..500 {
        let k1 = bristle.rate(v, z);
        let k2 = bristle.rate(v, z + 0.5 * h * k1);
        let k3 = bristle.rate(v, z + 0.5 * h * k2);
        let k4 = bristle.rate(v, z + h * k3);
        z += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    bristle.force(v, z, bristle.rate(v, z))
}

const VELOCITIES: [f64; 10] = [1e-6, 1e-3, 0.01, 0.03, 0.064, 0.09, 0.15, 0.3, 1.0, 5.0];

/// R = g(v, x) sgn v + σ₂ v with g from equations (3), (5) and (6), written out again here.
#[test]
fn the_settled_force_is_the_stribeck_curve() {
    for viscous_n_s_per_m in [Maybe::none(), Maybe::some(60.0)] {
        let law = Lugre { viscous_n_s_per_m, ..paper_joint() };
        for x in [0.0, 0.03, 0.0999] {
            for v in VELOCITIES.into_iter().flat_map(|v| [v, -v]) {
                let f_s = 450.0 + (9.81 - 450.0) * x / 0.1;
                let f_c = 360.0 + (9.81 - 360.0) * x / 0.1;
                let g = f_c + (f_s - f_c) * (-(v / 0.09_f64).powi(2)).exp();
                let expected = g * v.signum() + viscous_n_s_per_m.unwrap_or(0.0) * v;
                let error = settled_force(law, x, v) / expected - 1.0;
                assert!(error.abs() < 1e-11, "at v = {v}, x = {x}: off by {error:e}");
            }
        }
    }
}

/// Between stiction and Coulomb force the curve falls, by 860 N s/m where it is steepest, at
/// v = v_s/√2. A controller with less damping than that hunts at low speed.
#[test]
fn the_curve_falls_fastest_at_the_stribeck_velocity_over_root_two() {
    let slope = |v: f64| {
        let h = 1e-4;
        let force = |v| settled_force(paper_joint(), 0.0, v);
        (force(v + h) - force(v - h)) / (2.0 * h)
    };
    let steepest = 0.09 / 2.0_f64.sqrt();
    assert!((slope(steepest) + 857.8).abs() < 0.1, "{}", slope(steepest));
    assert!(slope(0.9 * steepest) > slope(steepest) && slope(1.1 * steepest) > slope(steepest));
}
