//! Friction by direction, with a choice of how slip sets in.

use std::f64::consts::PI;

use breakaway_core::Maybe;
use breakaway_core::disturbance::Factors;
use breakaway_core::imposed::impose_motion;
use breakaway_core::joint::{Bristle, DirectionalLugre, Joint, JointState, Law, Lugre};
use breakaway_core::plant::{Integrator, Plant, PlantState, Push};
use breakaway_core::variation::Variation;

const UNDISTURBED: Factors<f64> = Factors { joint_force: 1.0, friction_level: 1.0 };

/// Without damper or viscous friction: what the bristle alone carries.
fn bare(elastic_share: Maybe<f64>) -> DirectionalLugre<f64> {
    DirectionalLugre {
        coulomb_positive_n: 20.0,
        coulomb_negative_n: 30.0,
        viscous_positive_n_s_per_m: 0.0,
        viscous_negative_n_s_per_m: 0.0,
        stiction_ratio: 1.3,
        stribeck_velocity_m_per_s: 0.01,
        stiffness_n_per_m: 1e6,
        damping_n_s_per_m: 0.0,
        coulomb_slope_n_per_m: 0.0,
        elastic_share,
    }
}

fn whole(elastic_share: Maybe<f64>) -> DirectionalLugre<f64> {
    DirectionalLugre {
        viscous_positive_n_s_per_m: 40.0,
        viscous_negative_n_s_per_m: 60.0,
        damping_n_s_per_m: 300.0,
        ..bare(elastic_share)
    }
}

fn onsets() -> [Maybe<f64>; 3] {
    [Maybe::none(), Maybe::some(0.0), Maybe::some(0.7)]
}

/// Moves a relaxed joint along positions from 0 on, one every `h` seconds; gives travel and force.
fn moved(law: &DirectionalLugre<f64>, path: &[f64], h: f64) -> Vec<(f64, f64)> {
    let mut state = PlantState::at_rest();
    let step = |&x: &f64| {
        let travel = x - state.position_m;
        (travel, impose_motion(law, &mut state, travel / h, h))
    };
    path.iter().map(step).collect()
}

fn work((travel, force): &(f64, f64)) -> f64 {
    travel * force
}

/// Pushes a part of 1 kg at rest with a force of time; gives its state after each step.
fn pushed<L: Law<f64> + Copy>(
    law: &L,
    force: impl Fn(f64) -> f64,
    h: f64,
    steps: u32,
) -> Vec<PlantState<f64>> {
    let mut state = PlantState::at_rest();
    let step = |n| {
        let push = Push::rigid(force((f64::from(n) + 0.5) * h));
        let plant = Plant {
            joint: law,
            mass_kg: 1.0,
            push,
            factors: UNDISTURBED,
            variation: &Variation::none(),
        };
        plant.step(Integrator::LinearlyImplicitMidpoint, &mut state, 0.0, h);
        state
    };
    (0..steps).map(step).collect()
}

/// The same law twice: by direction with equal directions, and in a joint that is endlessly long.
fn twins() -> (DirectionalLugre<f64>, Joint<f64>) {
    let by_direction = DirectionalLugre {
        coulomb_negative_n: 20.0,
        viscous_negative_n_s_per_m: 40.0,
        ..whole(Maybe::none())
    };
    let joint = Joint::Lugre(Lugre {
        stiction_n: 26.0,
        coulomb_n: 20.0,
        stiffness_n_per_m: 1e6,
        damping_n_s_per_m: 300.0,
        viscous_n_s_per_m: Maybe::some(40.0),
        stribeck_velocity_m_per_s: 0.01,
        engagement_length_m: 1e12,
        residual_n: 0.0,
        damping_velocity_m_per_s: Maybe::none(),
        backward_ratio: Maybe::none(),
    });
    (by_direction, joint)
}

fn numbers(b: &Bristle<f64>) -> [f64; 7] {
    let viscous = b.viscous_n_s_per_m.unwrap_or(f64::NAN);
    let (speed, level) = (b.speed_m_per_s, b.friction_level_n);
    let springs = [b.relaxation_n_per_m, b.stiffness_n_per_m, b.damping_n_s_per_m];
    [b.stretch, speed, level, viscous, springs[0], springs[1], springs[2]]
}

#[test]
fn with_equal_directions_it_has_the_bristle_of_lugre() {
    let (by_direction, joint) = twins();
    let state = JointState { bristle_m: 5e-6, transverse_bristle_m: 0.0, sliding: 0.0 };
    for v in [-1.0, -0.02, -1e-6, 0.0, 1e-6, 0.005, 0.02, 1.0] {
        for (x, factor) in [(-0.1, 1.0), (0.0, 0.8), (0.3, 1.2)] {
            let ours = numbers(&by_direction.freeze(&state, x, v, factor));
            let theirs = joint.freeze(&state, x, v, factor).expect("LuGre has one");
            let theirs = numbers(&theirs);
            for (ours, theirs) in ours.into_iter().zip(theirs) {
                assert!((ours - theirs).abs() <= 1e-12 * theirs.abs(), "{ours} is {theirs} at {v}");
            }
        }
    }
}

#[test]
fn with_equal_directions_it_moves_as_lugre() {
    let (by_direction, joint) = twins();
    let force = |t: f64| 35.0 * (40.0 * t).sin();
    let (ours, theirs) =
        (pushed(&by_direction, force, 1e-4, 5000), pushed(&joint, force, 1e-4, 5000));
    let numbers =
        |s: &PlantState<f64>| [s.position_m, s.velocity_m_per_s, s.bristle_m, s.joint_force_n];
    for i in 0..4 {
        let size = theirs.iter().fold(0.0, |size: f64, s| size.max(numbers(s)[i].abs()));
        for (ours, theirs) in ours.iter().zip(&theirs) {
            let error = (numbers(ours)[i] - numbers(theirs)[i]) / size;
            assert!(error.abs() < 1e-9, "number {i}: off by {error:e}");
        }
    }
    let fastest = ours.iter().map(|s| s.velocity_m_per_s);
    assert!(fastest.clone().fold(0.0, f64::max) > 0.05 && fastest.fold(0.0, f64::min) < -0.05);
}

/// R = ± g + σ v with the levels and the viscous friction of the direction, whatever the onset.
#[test]
fn sliding_steadily_it_carries_level_and_viscous_friction_of_its_direction() {
    for onset in onsets() {
        for speed in [1e-3, 0.01, 0.03, 0.3] {
            let stribeck = 1.0 + 0.3 * (-(speed / 0.01_f64).powi(2)).exp();
            for (v, level, viscous) in [(speed, 20.0, 40.0), (-speed, -30.0, 60.0)] {
                let mut state = PlantState::at_rest();
                let h = 1e-5 / speed; // of 10 um, about half of what the bristles yield
                let force =
                    (0..300).fold(0.0, |_, _| impose_motion(&whole(onset), &mut state, v, h));
                let expected = level * stribeck + viscous * v;
                let error = force / expected - 1.0;
                assert!(error.abs() < 1e-11, "{onset:?} at {v}: off by {error:e}");
            }
        }
    }
}

/// Pushed harder and harder it holds up to its breakaway force, which is that of the direction.
#[test]
fn it_breaks_loose_at_the_level_of_its_direction() {
    for onset in onsets() {
        for (sign, level) in [(1.0, 26.0), (-1.0, 39.0)] {
            let states = pushed(&whole(onset), |t| sign * 10.0 * t, 1e-3, 5000);
            let loose = states.iter().position(|s| s.velocity_m_per_s.abs() > 2e-3);
            let force = loose.expect("50 N break it loose") as f64 * 1e-2;
            assert!((force / level - 1.0).abs() < 0.01, "{onset:?}: {force} N of {level} N");
        }
    }
}

/// The level is a line over position; the bristles follow it within what they yield, 20 um.
#[test]
fn the_level_falls_as_the_contact_slope() {
    for onset in onsets() {
        let law =
            DirectionalLugre { stiction_ratio: 1.0, coulomb_slope_n_per_m: -100.0, ..bare(onset) };
        for (sign, level) in [(1.0, 20.0), (-1.0, 30.0)] {
            let path: Vec<f64> = (1..=10_000).map(|n| sign * 1e-5 * f64::from(n)).collect();
            for (n, (_, force)) in moved(&law, &path, 1e-3).into_iter().enumerate().skip(1000) {
                let x = path[n] - 0.5e-5 * sign;
                let error = sign * force - (level - 100.0 * x);
                assert!(error.abs() < 100.0 * 4e-5, "at {x}: {force}, off by {error}");
            }
        }
    }
}

/// u = |z| k_e / g from which the onset is computed; α = S((u − e) / (1 − e)).
fn onset(share: f64, used: f64, v: f64) -> f64 {
    let law = bare(Maybe::some(share));
    let g = law.level(0.0, v);
    let state = JointState { bristle_m: used * g / 1e6, transverse_bristle_m: 0.0, sliding: 0.0 };
    law.freeze(&state, 0.0, v, 1.0).relaxation_n_per_m / 1e6
}

#[test]
fn slip_sets_in_smoothly_from_the_elastic_share_to_the_level() {
    for share in [0.0, 0.3, 0.7, 0.99] {
        let at = |s: f64| onset(share, share + s * (1.0 - share), 1e-4);
        for (s, alpha) in [(-0.1, 0.0), (0.0, 0.0), (0.25, 0.15625), (0.5, 0.5), (1.0, 1.0)] {
            assert!((at(s) - alpha).abs() < 1e-12, "{share}, {s}: {}", at(s));
        }
        assert_eq!(at(1.5), 1.0);
        for edge in [0.0, 1.0] {
            let kink = (at(edge + 1e-4) - at(edge)) - (at(edge) - at(edge - 1e-4));
            assert!(kink.abs() < 1e-7, "neither step nor kink at {edge}: {kink:e}");
        }
        for s in (0..=1000).map(|n| f64::from(n) * 1e-3) {
            let by_dupont = 0.5 * (1.0 - (PI * s).cos());
            assert!((at(s) - by_dupont).abs() < 0.011, "{s}");
        }
    }
}

#[test]
fn unloaded_bristles_do_not_slip() {
    for used in [0.1, 0.8, 1.0, 2.0] {
        assert_eq!(onset(0.5, used, -1e-4), 0.0);
        assert_eq!(onset(0.5, -used, 1e-4), 0.0);
        assert_eq!(onset(0.5, -used, -1e-4), onset(0.5, used, 1e-4));
    }
}

/// From 20 N on: down to −e times the level of the way back nothing but the spring.
#[test]
fn turned_back_an_elastoplastic_bristle_is_a_spring() {
    let law = DirectionalLugre { stiction_ratio: 1.0, ..bare(Maybe::some(0.7)) };
    let forth = (1..=3000).map(|n| 1e-6 * f64::from(n));
    let back = (1..=1000).map(|n| 3e-3 - 1e-7 * f64::from(n));
    let path: Vec<f64> = forth.chain(back).collect();
    let moved = moved(&law, &path, 1e-3);
    assert!((moved[2999].1 - 20.0).abs() < 1e-9, "it slides: {}", moved[2999].1);
    for (n, (_, force)) in moved.iter().enumerate().skip(3000).take(409) {
        let elastic = 20.0 - 1e6 * (3e-3 - path[n] - 0.5e-7);
        assert!((force - elastic).abs() < 1e-8, "{force} is {elastic}");
    }
    let (_, slipping) = moved[3999];
    assert!(slipping > -30.0 && slipping - (20.0 - 99.95) > 40.0, "{slipping}");
}

/// Positions of `cycles` cycles to and fro.
fn cycles(amplitude_m: f64, cycles: u32) -> Vec<f64> {
    let angle = |n| 2.0 * PI * f64::from(n) / 1000.0;
    (1..=1000 * cycles).map(|n| amplitude_m * angle(n).sin()).collect()
}

#[test]
fn below_the_elastic_share_a_loop_encloses_nothing() {
    let amplitude = 18e-6; // of 0.7 times the 26 um at which the bristles carry the lower level
    let loss = |onset| {
        let moved = moved(&bare(onset), &cycles(amplitude, 10), 1e-5);
        moved.iter().map(work).sum::<f64>() / (0.5 * 1e6 * amplitude.powi(2))
    };
    assert!(loss(Maybe::some(0.7)).abs() < 1e-12, "{:e}", loss(Maybe::some(0.7)));
    assert!(
        loss(Maybe::some(0.6)) > 0.01 && loss(Maybe::none()) > 1.0,
        "{} {}",
        loss(Maybe::some(0.6)),
        loss(Maybe::none())
    );
}

#[test]
fn no_loop_gives_work() {
    for onset in onsets() {
        for slope in [0.0, -2000.0, 2000.0] {
            let law = DirectionalLugre { coulomb_slope_n_per_m: slope, ..whole(onset) };
            let bristles = DirectionalLugre { coulomb_slope_n_per_m: slope, ..bare(onset) };
            for amplitude in [1e-6, 1e-5, 3e-5, 1e-4, 1e-3] {
                for h in [1e-6, 1e-4, 1e-2] {
                    let path = cycles(amplitude, 20);
                    let last = |law| moved(law, &path, h)[19_000..].iter().map(work).sum::<f64>();
                    let (damped, bare) = (last(&law), last(&bristles));
                    let rounding = 1e-12 * 1e6 * amplitude * amplitude;
                    assert!(damped > 0.0 && bare > -rounding, "{onset:?} {amplitude}: {bare:e}");
                }
            }
        }
    }
}

/// While the force rises to F the bristles of LuGre yield by dz = (1 − k_e z/g₊) dx, while it falls by
/// dz = (1 + k_e z/g₋) dx; of each pulse remains −[g₊ ln(1 − F/g₊) + g₋ ln(1 + F/g₋)] / k_e.
#[test]
fn pulses_below_breakaway_make_lugre_drift_but_not_an_elastoplastic_bristle() {
    let end = |onset: Maybe<f64>| {
        let force = |t: f64| if t < 100.0 { 5.0 * (1.0 - (20.0 * PI * t).cos()) } else { 0.0 };
        let states = pushed(&whole(onset), force, 1e-4, 1_001_000);
        states[1_000_999].position_m
    };
    assert!(end(Maybe::some(0.7)).abs() < 1e-15, "{:e} m", end(Maybe::some(0.7)));
    let remains = |g: f64, force: f64| -g / 1e6 * (1.0 - force / g).ln();
    let pulse = remains(26.0, 10.0) + remains(39.0, -10.0);
    let error = end(Maybe::none()) / (1000.0 * pulse) - 1.0;
    assert!(error.abs() < 0.02, "{pulse:e} m with every pulse, off by {error}");
}
