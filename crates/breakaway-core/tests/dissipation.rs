//! Friction takes energy out of motion and stores some of it; it never adds any. What goes in is
//! R v, what is stored is in the bristles.

mod laws;
mod support;

use breakaway_core::Maybe;
use breakaway_core::imposed::impose_motion;
use breakaway_core::joint::{Joint, Lugre};
use breakaway_core::plant::{PlantState, Push};
use breakaway_core::test_models::paper_joint;
use support::{Rig, random};

/// The smallest dissipation in J of a step of a joint that is moved at random, and the sum of all: a
/// speed of up to `fastest` either way, newly drawn every 1 to 1000 steps, in which it moves by at most 0.2 um.
fn dissipation_j(joint: Joint<f64>, fastest: f64) -> (f64, f64) {
    let h = 2e-7 / fastest;
    let (mut seed, mut v, mut left) = (7, 0.0, 0);
    let mut state = PlantState::at_rest();
    let (mut least, mut sum) = (f64::INFINITY, 0.0);
    for _ in 0..500_000 {
        if left == 0 {
            let size = random(&mut seed);
            v = fastest * size * size * size; // often slow
            left = 1 + (500.0 * (1.0 + random(&mut seed))) as u32;
        }
        left -= 1;
        let before = state.stored_energy_j(&joint);
        let work = impose_motion(&joint, &mut state, v, h) * v * h;
        let dissipated = work - (state.stored_energy_j(&joint) - before);
        (least, sum) = (f64::min(least, dissipated), sum + dissipated);
    }
    (least, sum)
}

/// What is lost by rounding a store of half a millijoule or so.
const ROUNDING_J: f64 = 1e-17;

#[test]
fn slow_motion_creates_no_energy_under_any_law() {
    for (name, joint) in laws::all(laws::endless()) {
        let (least, sum) = dissipation_j(joint, 0.1);
        assert!(least > -ROUNDING_J && sum > 1.0, "{name}: {least:e} of {sum} J");
    }
}

/// With a constant c, LuGre gives energy back at speed: a bristle that is stretched beyond its level
/// relaxes, and its damper pushes the part. Where c falls with speed, so that c(v) |v| ≤ 4 g, it does not:
/// c v_d = 2700 N is below 4 √(2e) F_c = 3358 N.
#[test]
fn damping_that_falls_with_speed_makes_lugre_passive() {
    let constant = laws::endless();
    let falling = Lugre { damping_velocity_m_per_s: Maybe::some(0.3), ..constant };
    for (name, wrap) in [
        ("lugre", Joint::Lugre as fn(Lugre<f64>) -> Joint<f64>),
        ("elasto_plastic", laws::elasto_plastic),
        ("gms", |law| Joint::Gms(laws::gms(law, 6))),
    ] {
        let (least, _) = dissipation_j(wrap(constant), 3.0);
        let (least_falling, sum) = dissipation_j(wrap(falling), 3.0);
        assert!(least_falling > -ROUNDING_J && sum > 1.0, "{name}: {least_falling:e} of {sum} J");
        assert_eq!(least < -1e-6, name != "gms", "{name}: {least:e}");
    }
}

/// m/2 (v₁² − v₀²) = (F − R) h v_m in every step, whatever the law; and over a random push what is
/// neither in motion nor in bristles was dissipated.
#[test]
fn work_is_motion_bristles_and_loss() {
    for (name, joint) in laws::all(Lugre { viscous_n_s_per_m: Maybe::some(60.0), ..paper_joint() })
    {
        let mut rig = Rig::at(joint, 0.01);
        let (mut seed, mut force_n) = (3, 0.0);
        let (mut lost, mut least) = (0.0, f64::INFINITY);
        for n in 0..50_000 {
            if n % 40 == 0 {
                force_n = 600.0 * random(&mut seed);
            }
            let (before, h) = (rig.state, 1e-5);
            let moved = rig.moved(Push::rigid(force_n), h);
            let energy = |v: f64| 0.5 * v * v;
            let v_m = moved.mean_velocity_m_per_s;
            let gained = energy(rig.state.velocity_m_per_s) - energy(before.velocity_m_per_s);
            let work = (force_n - moved.joint_force_n) * h * v_m;
            assert!((gained - work).abs() < 1e-16, "{name}: {gained:e} {work:e}");
            let stored = rig.state.stored_energy_j(&joint) - before.stored_energy_j(&joint);
            lost += moved.joint_force_n * h * v_m - stored;
            least = f64::min(least, lost);
        }
        assert!(lost > 0.1 && least > -1e-9, "{name}: {lost} J, {least:e} J");
    }
}
