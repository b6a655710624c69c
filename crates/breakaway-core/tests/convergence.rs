//! How fast the error of an integrator falls with its step, on a part that slides smoothly.

mod laws;
mod support;

use breakaway_core::Maybe;
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
    let law = Lugre { viscous_n_s_per_m: Maybe::some(60.0), ..paper_joint() };
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

/// Every option in use.
fn options() -> Lugre<f64> {
    Lugre {
        viscous_n_s_per_m: Maybe::some(60.0),
        damping_velocity_m_per_s: Maybe::some(0.2),
        backward_ratio: Maybe::some(0.8),
        ..paper_joint()
    }
}

/// x, v and z after a force that grows to `force_n` within `time_s`, from rest.
fn pull(
    joint: Joint<f64>,
    integrator: Integrator,
    [force_n, time_s]: [f64; 2],
    n: u32,
) -> [f64; 3] {
    let mut rig = Rig { integrator, ..Rig::at(joint, 0.0) };
    let h = time_s / f64::from(n);
    (0..n).for_each(|i| _ = rig.push(force_n * (f64::from(i) + 0.5) / f64::from(n), h));
    [rig.state.position_m, rig.state.velocity_m_per_s, rig.state.bristle_m]
}

/// Relative errors of x, v and z at 200, 400 and 800 steps; z is left out where there is none.
fn errors(joint: Joint<f64>, pulled: [f64; 2], exact: [f64; 3]) -> Vec<[f64; 3]> {
    let error = |n| {
        let ours = pull(joint, Integrator::LinearlyImplicitMidpoint, pulled, n);
        std::array::from_fn(
            |i| if exact[i] == 0.0 { 0.0 } else { (ours[i] / exact[i] - 1.0).abs() },
        )
    };
    [200, 400, 800].map(error).to_vec()
}

fn assert_order_two(name: &str, errors: &[[f64; 3]]) {
    for pair in errors.windows(2) {
        for (coarse, fine) in pair[0].into_iter().zip(pair[1]) {
            let order = (coarse / fine).log2();
            assert!(coarse == 0.0 || (1.8..2.4).contains(&order), "{name}: {errors:?}");
        }
    }
}

/// Neither the options nor an onset of slip that depends on the deflection cost an order, stuck or
/// while the joint breaks loose. With the onset of the deflection before the step, the elasto-plastic law
/// would be of order one.
#[test]
fn one_bristle_is_of_order_two_from_rest() {
    for pulled in [[400.0, 2e-3], [750.0, 3e-3]] {
        let joints = [Joint::Lugre(options()), laws::elasto_plastic(options())];
        for (joint, name) in joints.into_iter().zip(["lugre", "elasto_plastic"]) {
            let exact = pull(joint, Integrator::Rk4, pulled, 200_000);
            assert_order_two(name, &errors(joint, pulled, exact));
        }
    }
}

/// Breaking loose is an event that costs nothing: the level of the first step is that of rest.
#[test]
fn rigid_friction_is_of_order_two_from_rest() {
    let (joint, pulled) = (laws::coulomb_stiction(options()), [750.0, 3e-3]);
    let exact = pull(joint, Integrator::LinearlyImplicitMidpoint, pulled, 1_000_000);
    assert_order_two("coulomb_stiction", &errors(joint, pulled, exact));
}

/// Elements let go at the level of the middle of a step, not of the event: an error of order one, and
/// small. Found at steps of 10 us: 3e-6 of x and 6e-6 of v while stuck, 1.1e-5 and 2.6e-5 breaking loose.
#[test]
fn elements_are_close_from_rest() {
    let joint = Joint::Gms(laws::gms(options(), 5));
    for (pulled, bound) in [([400.0, 2e-3], 1e-5), ([750.0, 3e-3], 4e-5)] {
        let midpoint = Integrator::LinearlyImplicitMidpoint;
        let exact = pull(joint, midpoint, pulled, 400_000);
        let errors = errors(joint, pulled, exact);
        assert!(errors.iter().flatten().all(|error| *error < bound), "{errors:?}");
    }
}

/// Between events the elements are of order two.
#[test]
fn sliding_elements_are_of_order_two() {
    let law = laws::gms(options(), 5);
    let slide = |steps: u32| {
        let mut rig = Rig::at(Joint::Gms(law), 0.01);
        rig.state.velocity_m_per_s = 0.2;
        for i in 0..5 {
            let limit = law.level_shares[i] * 324.0 / (law.stiffness_shares[i] * 3.6e7);
            (rig.state.elements.deflection_m[i], rig.state.elements.slip[i]) = (limit, 1.0);
        }
        rig.state.joint_force_n = 324.0;
        let h = TIME_S / f64::from(steps);
        for n in 0..steps {
            let t = (f64::from(n) + 0.5) * h;
            rig.push_disturbed(400.0 + 60.0 * (4000.0 * t).sin(), h, FACTORS);
            assert!(rig.state.elements.slip[..5] == [1.0; 5]);
        }
        [rig.state.position_m, rig.state.velocity_m_per_s, rig.state.bristle_m]
    };
    let exact = slide(160_000);
    let error = |n| std::array::from_fn(|i| (slide(n)[i] / exact[i] - 1.0).abs());
    assert_order_two("gms", &[400, 800, 1600].map(error));
}
