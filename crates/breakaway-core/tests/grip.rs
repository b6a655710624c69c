//! A feed that grips its part: force both ways, play, and the energy of rattling in it.

mod laws;
mod support;

use std::f64::consts::PI;

use breakaway_core::Maybe;
use breakaway_core::actuator::{Actuator, Command, Contact, FeedAxis};
use breakaway_core::joint::{CoulombStiction, Joint, Lugre};
use breakaway_core::test_models::paper_joint;
use support::bench::{Bench, STACK, axis, feed, with_stack};
use support::{UNDISTURBED, random};

/// m: from the tip to the part at the start, and between the faces.
const GAP_M: f64 = 1e-5;
const PLAY_M: f64 = 3e-5;

fn gripping(axis: FeedAxis<f64>, gap_m: f64, play_m: f64) -> Actuator<f64> {
    let contact = Contact { gap_m, backlash_m: Maybe::some(play_m), ..axis.contact };
    Actuator::FeedAxis(FeedAxis { contact, ..axis })
}

/// Rigid friction that holds against 450 N, so that a part below it does not move at all.
fn rigid() -> Joint<f64> {
    Joint::CoulombStiction(CoulombStiction {
        stiction_n: 450.0,
        coulomb_n: 360.0,
        viscous_n_s_per_m: Maybe::none(),
        stribeck_velocity_m_per_s: 0.09,
        engagement_length_m: 0.1,
        residual_n: 10.0,
        backward_ratio: Maybe::none(),
    })
}

/// Moves the feed to a place at 0.2 mm/s and waits; gives the force on the part.
fn feed_to(bench: &mut Bench, target_m: f64) -> f64 {
    let (speed, h) = (2e-4, 1e-5);
    let way_m = target_m - bench.state.feed_m;
    let steps = (way_m.abs() / (speed * h)).round() as u32;
    let waiting = 20_000;
    (0..steps + waiting).fold(0.0, |_, n| {
        let command = feed(if n < steps { speed * way_m.signum() } else { 0.0 });
        bench.step(&command, UNDISTURBED, h).0.push_force_n
    })
}

/// F = k (p − gap) in front of the part, k (p − gap + b) behind it, 0 in the play between, and k that
/// of axis, stack and contact in series.
#[test]
fn a_stuck_part_feels_the_feed_both_ways() {
    let plain = 1.0 / (1.0 / 3e7 + 1.0 / 2e8);
    let stacked = 1.0 / (1.0 / plain + 1.0 / 1e8);
    for (axis, k) in [(axis(), plain), (with_stack(STACK), stacked)] {
        for (gap_m, play_m) in [(0.0, 0.0), (GAP_M, PLAY_M)] {
            let mut bench = Bench::new(gripping(axis, gap_m, play_m), rigid());
            for way_m in [8e-6, -9e-6, 4e-6, -2e-6, -1e-5] {
                let place_m = gap_m + way_m - if way_m < 0.0 { play_m } else { 0.0 };
                let force_n = feed_to(&mut bench, place_m);
                let expected = k * (bench.state.feed_m - place_m + way_m);
                assert!((force_n / expected - 1.0).abs() < 1e-9, "{way_m}: {force_n} {expected}");
                assert_eq!(bench.part.position_m, 0.0, "it is stuck");
            }
        }
    }
}

/// A part that is pulled back into its guide follows at the speed of the feed, less what axis and
/// contact stretch by as the friction level grows: found 1.7e-4 of it, as (dg/dx) / k says.
#[test]
fn a_grip_pulls_a_part_along() {
    let mut bench = Bench::new(gripping(axis(), GAP_M, PLAY_M), rigid());
    (bench.part.position_m, bench.state.feed_m, bench.state.tool_m) = (0.05, 0.05, 0.05);
    let mut force_n = 0.0;
    for _ in 0..100_000 {
        force_n = bench.step(&feed(-0.02), UNDISTURBED, 1e-5).0.push_force_n;
    }
    let v = bench.part.velocity_m_per_s;
    let bell = (-(v / 0.09).powi(2)).exp();
    let per_way = (350.0 + 90.0 * bell) / 0.1;
    let level = 360.0 + 90.0 * bell - per_way * bench.part.position_m;
    let stretched = per_way * (1.0 / 3e7 + 1.0 / 2e8);
    assert!((v / -0.02 - 1.0 + stretched).abs() < 1e-6, "{v} {stretched}");
    assert!((force_n / -level - 1.0).abs() < 2e-6, "{force_n} {level}");
}

/// p = −9 um (1 − cos ω t), with the faces 1 um ahead of the start and 19 um behind it.
#[test]
fn a_feed_that_moves_within_the_play_moves_nothing() {
    for (law, joint) in laws::all(paper_joint()) {
        let mut bench = Bench::new(gripping(with_stack(STACK), 1e-6, 2e-5), joint);
        let (omega, h, mut lowest_m) = (2.0 * PI * 50.0, 1e-5, 0.0_f64);
        for n in 0..20_000 {
            let command = feed(-9e-6 * omega * (omega * h * f64::from(n)).sin());
            let force_n = bench.step(&command, UNDISTURBED, h).0.push_force_n;
            assert!(force_n == 0.0, "{law} at {n}: {force_n}");
            lowest_m = lowest_m.min(bench.state.tip_m);
        }
        assert_eq!((bench.part.position_m, bench.part.velocity_m_per_s), (0.0, 0.0), "{law}");
        assert!(lowest_m < -1.8e-5, "{law}: all of the play but 1 um {lowest_m}");
    }
}

/// A feed to and fro and a stack at 100 Hz rattle the part in its play: at every one of 10⁵ steps the
/// work is motion, springs and losses. Found: 2e-14 of what went to and fro.
#[test]
fn the_energy_of_rattling_in_the_play_is_accounted_for() {
    let law = Lugre { stiction_n: 45.0, coulomb_n: 36.0, ..paper_joint() };
    for (law, joint) in laws::all(law) {
        let mut bench = Bench::new(gripping(with_stack(STACK), GAP_M, PLAY_M), joint);
        let (mut seed, mut speed, mut counts, h) = (7, 0.0, [0_u32; 3], 1e-5);
        let (mut supplied, mut moved_j, mut lost, mut friction) = (0.0, 0.0, 0.0, 0.0);
        let mut worst = 0.0_f64;
        for n in 0..100_000_u32 {
            if n % 500 == 0 {
                speed =
                    0.01 * random(&mut seed) + if bench.state.feed_m > 0.0 { -2e-3 } else { 2e-3 };
            }
            let share = if n % 1000 < 300 { 1.0 } else { 0.0 };
            let command = Command { stack_share: share, ..feed(speed) };
            let (moved, effort) = bench.step(&command, UNDISTURBED, h);
            supplied += effort.supplied_j;
            moved_j += effort.supplied_j.abs();
            lost += effort.lost_j;
            friction += moved.joint_force_n * moved.mean_velocity_m_per_s * h;
            let v = bench.part.velocity_m_per_s;
            let stored = bench.actuator.stored_energy_j(&bench.state, bench.part.position_m);
            let error = supplied - lost - friction - 0.5 * v * v - stored;
            worst = worst.max(error.abs() / moved_j);
            let f = moved.push_force_n;
            counts[if f < 0.0 { 0 } else { usize::from(f > 0.0) + 1 }] += 1;
        }
        println!("{law}: {worst:e}, lost {lost:e} of {supplied:e} and {moved_j:e} J, {counts:?}");
        assert!(worst < 1e-12, "{law}: {worst:e}");
        assert!(lost > 0.0 && counts.into_iter().min() > Some(1000), "{law}: {lost} {counts:?}");
    }
}
