//! A push through something compliant: it yields to the part's motion within the step, and pulls only
//! where it grips.

mod laws;
mod support;

use breakaway_core::Maybe;
use breakaway_core::disturbance::Factors;
use breakaway_core::joint::{Joint, Lugre};
use breakaway_core::plant::{Plant, PlantState, Push};
use breakaway_core::test_models::paper_joint;
use breakaway_core::variation::Variation;
use support::{Rig, UNDISTURBED, random};

/// Whatever the law, the state, the stiffness and the play: the force agrees with the velocity that
/// comes of it, F = max(0, F_0 − S v_m) + min(0, F_b − S v_m), and the momentum with both.
#[test]
fn the_force_agrees_with_the_motion_that_it_causes() {
    let law = Lugre { viscous_n_s_per_m: Maybe::some(60.0), ..paper_joint() };
    for ((name, joint), grips) in
        laws::all(law).into_iter().flat_map(|law| [(law, false), (law, true)])
    {
        let (mut seed, mut rig) = (5, Rig::at(joint, 0.01));
        let (mut pulls, mut open, mut pushes) = (0, 0, 0);
        for n in 0..40_000 {
            let (force_n, h) = (900.0 * random(&mut seed), 1e-5);
            let s = 10.0_f64.powf(3.0 + 3.0 * random(&mut seed));
            let factors = Factors { joint_force: 1.0 + 0.2 * random(&mut seed), ..UNDISTURBED };
            let mut push = Push::yielding(force_n, s);
            if grips {
                push.pull_n = Maybe::some(force_n + 300.0 * (1.0 + random(&mut seed)));
            }
            let plant = Plant {
                joint: &rig.joint,
                mass_kg: 1.0,
                push,
                factors,
                variation: &Variation::none(),
            };
            let before = rig.state.velocity_m_per_s;
            let moved = plant.step(rig.integrator, &mut rig.state, 0.0, h);
            let (f, v_m) = (moved.push_force_n, moved.mean_velocity_m_per_s);
            let pulled = push.pull_n.get().map_or(0.0, |pull_n| (pull_n - s * v_m).min(0.0));
            let expected = (force_n - s * v_m).max(0.0) + pulled;
            let scale = force_n.abs() + 600.0 + s * v_m.abs();
            assert!((f - expected).abs() <= 1e-9 * scale, "{name} at {n}: {f}, {expected}");
            let momentum = rig.state.velocity_m_per_s - before - h * (f - moved.joint_force_n);
            assert!(momentum.abs() < 1e-13, "{name} at {n}: {f} {momentum:e}");
            open += u32::from(f == 0.0);
            (pulls, pushes) = (pulls + u32::from(f < 0.0), pushes + u32::from(f > 0.0));
            if rig.state.position_m.abs() > 0.05 {
                rig.state = PlantState::at_rest();
            }
        }
        assert!(open > 1000 && pushes > 1000, "{name}: {open} {pushes}");
        assert!(if grips { pulls > 1000 } else { pulls == 0 }, "{name}: {pulls}");
    }
}

/// Without compliance a yielding push is a rigid one, but for rounding.
#[test]
fn a_push_that_does_not_yield_is_rigid() {
    for (name, joint) in laws::all(paper_joint()) {
        let kinds = [Push::rigid, |force_n| Push::yielding(force_n, 0.0)];
        let [rigid, yielding] = kinds.map(|push: fn(f64) -> Push<f64>| {
            let mut rig = Rig::at(joint, 0.01);
            for n in 0..3000 {
                rig.moved(push(0.2 * f64::from(n)), 1e-5);
            }
            rig.state
        });
        let error = (rigid.position_m / yielding.position_m - 1.0).abs();
        assert!(error < 1e-9 && rigid.position_m > 0.011, "{name}: {error:e}");
    }
}

/// k of a contact spring in N/m, and the speed in m/s of what pushes through it.
const CONTACT_N_PER_M: f64 = 2e6;
const FEED_M_PER_S: f64 = 0.05;

/// x and v of a part in LuGre friction after 30 ms behind a feed at constant speed, by steps of `h`:
/// with the force at mid-step F = k (V t_m − x − h/2 v_m).
fn fed(law: Lugre<f64>, h: f64) -> [f64; 2] {
    let mut rig = Rig::at(Joint::Lugre(law), 0.0);
    let steps = (0.03 / h).round() as u32;
    for n in 0..steps {
        let ahead_m = FEED_M_PER_S * (f64::from(n) + 0.5) * h - rig.state.position_m;
        rig.moved(Push::yielding(CONTACT_N_PER_M * ahead_m, 0.5 * h * CONTACT_N_PER_M), h);
    }
    [rig.state.position_m, rig.state.velocity_m_per_s]
}

/// The same by explicit Runge-Kutta of order four on the equations as they are written, with the
/// number of times that the contact opened.
fn fed_explicitly(law: Lugre<f64>, h: f64) -> ([f64; 2], u32) {
    let rates = |t: f64, [x, v, z]: [f64; 3]| {
        let f_s = law.stiction_n + (law.residual_n - law.stiction_n) * x / law.engagement_length_m;
        let f_c = law.coulomb_n + (law.residual_n - law.coulomb_n) * x / law.engagement_length_m;
        let g = f_c + (f_s - f_c) * (-(v / law.stribeck_velocity_m_per_s).powi(2)).exp();
        let z_rate = v - law.stiffness_n_per_m * v.abs() / g * z;
        let push = (CONTACT_N_PER_M * (FEED_M_PER_S * t - x)).max(0.0);
        [v, push - law.stiffness_n_per_m * z - law.damping_n_s_per_m * z_rate, z_rate]
    };
    let (mut y, mut opened, mut was_open) = ([0.0; 3], 0, true);
    for n in 0..(0.03 / h).round() as u32 {
        let t = f64::from(n) * h;
        let at = |k: [f64; 3], s: f64| std::array::from_fn(|i| y[i] + s * k[i]);
        let k1 = rates(t, y);
        let k2 = rates(t + 0.5 * h, at(k1, 0.5 * h));
        let k3 = rates(t + 0.5 * h, at(k2, 0.5 * h));
        let k4 = rates(t + h, at(k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        let open = FEED_M_PER_S * (t + h) < y[0];
        opened += u32::from(open && !was_open);
        was_open = open;
    }
    ([y[0], y[1]], opened)
}

/// Stick-slip behind a soft contact: the part breaks loose, jumps ahead of the feed, out of contact,
/// stops, and is caught up with.
#[test]
fn a_fed_part_jumps_as_explicit_integration_says() {
    let law = Lugre { stiction_n: 900.0, ..paper_joint() };
    let (exact, opened) = fed_explicitly(law, 1e-7);
    assert!(opened > 0, "the contact opens");
    let error = |h: f64| {
        let ours = fed(law, h);
        [(ours[0] / exact[0] - 1.0).abs(), (ours[1] - exact[1]).abs()]
    };
    let (coarse, fine) = (error(1e-5), error(2.5e-6));
    // Found: 1.1e-4 of x and 3.3e-6 m/s, of second order.
    assert!(coarse[0] < 1.5e-4 && coarse[1] < 5e-6, "{coarse:?}");
    assert!(coarse[0] > 10.0 * fine[0] && coarse[1] > 10.0 * fine[1], "{coarse:?} {fine:?}");
}

/// A part of 1 kg that nothing holds, between two faces of k = 1e6 N/m that are 1 mm apart: it needs
/// b/v from one to the other, and π/ω, ω² = k/m, to turn.
#[test]
fn a_free_part_bounces_between_the_faces_of_a_grip() {
    let (k, play_m, v, h) = (1e6_f64, 1e-3, 0.1, 1e-5);
    let mut rig = Rig::at(Joint::Lugre(paper_joint()), 1.0);
    rig.state.velocity_m_per_s = v;
    let bounce_s = play_m / v + std::f64::consts::PI / 1e3;
    let (mut turns, mut last, mut n) = (Vec::new(), v, 0);
    while turns.len() < 200 {
        let ahead_n = k * (1.0 - rig.state.position_m);
        let push = Push::yielding(ahead_n, 0.5 * h * k);
        rig.moved(Push { pull_n: Maybe::some(ahead_n + k * play_m), ..push }, h);
        n += 1;
        let now = rig.state.velocity_m_per_s;
        if now * last < 0.0 {
            turns.push(f64::from(n) * h - h * now / (now - last));
        }
        last = now;
    }
    let turning_s = (turns[199] - turns[0]) / 199.0;
    // Found: 4e-6 of the time, 4e-6 of the energy after 200 turns.
    assert!((turning_s / bounce_s - 1.0).abs() < 1e-5, "{turning_s} {bounce_s}");
    let x = rig.state.position_m;
    let depth = (1.0 - x).max(0.0) + (1.0 + play_m - x).min(0.0);
    let energy = 0.5 * last * last + 0.5 * k * depth * depth;
    assert!((energy / (0.5 * v * v) - 1.0).abs() < 1e-5, "{energy}");
}
