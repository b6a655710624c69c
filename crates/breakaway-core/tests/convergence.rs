//! How fast the error of an integrator falls with its step, on a part that slides smoothly.

mod support;

use breakaway_core::disturbance::Factors;
use breakaway_core::joint::{Joint, Lugre};
use breakaway_core::plant::Integrator;
use breakaway_core::test_models::paper_joint;
use support::Rig;

/// Simulated time in s.
const TIME_S: f64 = 1.6e-3;

/// A disturbance that holds.
const FACTORS: Factors<f64> = Factors { joint_force: 1.1, friction_level: 0.9 };

/// x, v and z after sliding under a force that is taken at the middle of each step. No term of the
/// equations is zero, so that one missing in the closed form would spoil the order.
fn slide(integrator: Integrator, force: impl Fn(f64) -> f64, steps: u32) -> [f64; 3] {
    let law = Lugre { viscous_n_s_per_m: Some(60.0), ..paper_joint() };
    let mut rig = Rig { integrator, ..Rig::at(Joint::Lugre(law), 0.01) };
    let h = TIME_S / f64::from(steps);
    rig.state.velocity_m_per_s = 0.2;
    rig.state.bristle_m = 9e-6;
    rig.state.joint_force_n = 324.0;
    for n in 0..steps {
        rig.push_disturbed(force((f64::from(n) + 0.5) * h), h, FACTORS);
        assert!(rig.state.velocity_m_per_s > 0.05, "it must not stick");
    }
    [rig.state.position_m, rig.state.velocity_m_per_s, rig.state.bristle_m]
}

/// The order in which x, v and z converge to `exact` when `steps` is doubled.
fn orders(
    integrator: Integrator,
    force: impl Fn(f64) -> f64 + Copy,
    steps: u32,
    exact: [f64; 3],
) -> [f64; 3] {
    let coarse = slide(integrator, force, steps);
    let fine = slide(integrator, force, 2 * steps);
    std::array::from_fn(|i| ((coarse[i] - exact[i]) / (fine[i] - exact[i])).abs().log2())
}

#[test]
fn the_linearly_implicit_midpoint_rule_is_of_order_two() {
    let force = |t: f64| 400.0 + 60.0 * (4000.0 * t).sin();
    let exact = slide(Integrator::Rk4, force, 160_000);
    for steps in [400, 800, 1600] {
        let orders = orders(Integrator::LinearlyImplicitMidpoint, force, steps, exact);
        assert!(orders.iter().all(|p| (1.9..2.2).contains(p)), "{steps} steps: {orders:?}");
    }
}

#[test]
fn runge_kutta_is_of_order_four() {
    let force = |_: f64| 400.0;
    let exact = slide(Integrator::Rk4, force, 25_600);
    // Coarser steps are not yet in the range of the leading error term, finer ones meet rounding.
    for steps in [80, 120] {
        let orders = orders(Integrator::Rk4, force, steps, exact);
        assert!(orders.iter().all(|p| (3.9..4.4).contains(p)), "{steps} steps: {orders:?}");
    }
}
