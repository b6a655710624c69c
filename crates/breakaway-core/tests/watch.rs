//! The watch: each of its reasons, that it never lets go, and that nothing wrong reaches the part.

use breakaway_core::actuator::{Actuator, ForceActuator, ForceRange};
use breakaway_core::control::{Controller, ForceRamp, Measurement, SteadyFeed, Watch, WatchState};
use breakaway_core::sensor::{Noise, Sensor, Sensors};
use breakaway_core::test_models::paper_as_computed;
use breakaway_core::{Draws, Extraction, ExtractionState, Maybe};

const WATCH: Watch<f64> = Watch { jump_max_m: 1e-4, frozen_max_s: 1e-3 };

fn at(position_m: f64) -> Measurement<f64> {
    Measurement {
        reference_m: 0.01,
        reference_rate_m_per_s: 0.0,
        position_m,
        velocity_m_per_s: 0.0,
        force_n: 100.0,
        period_s: 1e-4,
        range: ForceRange { min_n: 0.0, max_n: 1e3 },
    }
}

/// Samples of a sensor that is alive: it moves by a bit each time.
fn after_ten() -> WatchState<f64> {
    let mut state = WatchState::at_rest();
    for n in 0..10 {
        assert!(WATCH.trusts(&mut state, &at(1e-6 * f64::from(n)), true));
    }
    state
}

fn reason(measured: &Measurement<f64>) -> f64 {
    let mut state = after_ten();
    let trusted = WATCH.trusts(&mut state, measured, true);
    assert_eq!(trusted, state.reason == 0.0);
    state.reason
}

#[test]
fn what_can_be_true_is_trusted() {
    assert_eq!(reason(&at(1e-5)), 0.0);
    assert_eq!(reason(&at(9e-6 + 9.9e-5)), 0.0);
    assert_eq!(reason(&at(9e-6 - 9.9e-5)), 0.0);
    // The first sample can be anywhere.
    assert!(WATCH.trusts(&mut WatchState::at_rest(), &at(0.5), true));
}

#[test]
fn reason_1_is_a_number_that_is_none() {
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let good = at(1e-5);
        assert_eq!(reason(&at(wrong)), 1.0);
        assert_eq!(reason(&Measurement { force_n: wrong, ..good }), 1.0);
        assert_eq!(reason(&Measurement { reference_m: wrong, ..good }), 1.0);
        assert_eq!(reason(&Measurement { reference_rate_m_per_s: wrong, ..good }), 1.0);
        assert_eq!(reason(&Measurement { velocity_m_per_s: wrong, ..good }), 1.0);
        let mut state = WatchState::at_rest();
        assert!(!WATCH.trusts(&mut state, &at(wrong), false), "the first sample counts, too");
    }
}

#[test]
fn reason_2_is_a_jump() {
    assert_eq!(reason(&at(9e-6 + 1.01e-4)), 2.0);
    assert_eq!(reason(&at(9e-6 - 1.01e-4)), 2.0);
}

#[test]
fn reason_3_is_a_sensor_that_freezes_while_it_is_pushed() {
    let (mut state, mut trusted) = (after_ten(), 0);
    while WATCH.trusts(&mut state, &at(9e-6), true) {
        trusted += 1;
    }
    // 1 ms is ten samples, and one more is too long; rounding may take one away.
    assert!((9..=10).contains(&trusted) && state.reason == 3.0, "{trusted} {state:?}");
    // Nothing is pushed, so nothing need move.
    let mut state = after_ten();
    assert!((0..1000).all(|_| WATCH.trusts(&mut state, &at(9e-6), false)));
    // Between pulses the count goes on where it was.
    let (mut state, mut samples) = (after_ten(), 0);
    while WATCH.trusts(&mut state, &at(9e-6), samples % 10 == 0) {
        samples += 1;
    }
    assert!((90..=101).contains(&samples) && state.reason == 3.0, "{samples}");
    // A sensor of which it is not known how long it may stand still.
    let patient = Watch { frozen_max_s: f64::INFINITY, ..WATCH };
    let mut state = after_ten();
    assert!((0..10_000).all(|_| patient.trusts(&mut state, &at(9e-6), true)));
}

#[test]
fn reason_4_is_a_clock_that_does_not_go_on() {
    for period_s in [0.0, -1e-4, f64::NAN, f64::NEG_INFINITY] {
        assert_eq!(reason(&Measurement { period_s, ..at(1e-5) }), 4.0);
    }
}

#[test]
fn the_first_reason_stays_whatever_comes() {
    for (first, wrong) in
        [(1.0, at(f64::NAN)), (2.0, at(0.1)), (4.0, Measurement { period_s: 0.0, ..at(1e-5) })]
    {
        let mut state = after_ten();
        assert!(!WATCH.trusts(&mut state, &wrong, true));
        for n in 0..1000 {
            let later = match n % 4 {
                0 => at(f64::NAN),
                1 => at(f64::from(n)),
                _ => at(1e-5 + 1e-7 * f64::from(n)),
            };
            assert!(!WATCH.trusts(&mut state, &later, n % 3 == 0));
            assert_eq!(state.reason, first);
        }
    }
}

// In the loop

fn sensor() -> Sensor<f64> {
    Sensor { noise_rms: 1.0, quantum: Maybe::none(), bandwidth_hz: Maybe::none(), delay_samples: 0 }
}

/// A loop whose sensors show whatever a test adds to them.
fn watched(actuator: Actuator<f64>, controller: Controller<f64>) -> Extraction<f64> {
    Extraction {
        actuator,
        controller,
        sensors: Some(Sensors { position: sensor(), force: sensor() }),
        watch: Some(WATCH),
        ..paper_as_computed()
    }
}

fn seen(position: f64, force: f64) -> Draws<f64> {
    Draws { disturbance: 0.0, noise: Noise { position, force } }
}

#[test]
fn nothing_wrong_in_a_sensor_reaches_the_force() {
    let pid = paper_as_computed().controller;
    let ramp = Controller::ForceRamp(ForceRamp { rate_n_per_s: 1e4, travel_m: 0.1 });
    let lag = ForceActuator { force_max_n: 1e3, bandwidth_hz: 1e3, force_rate_max_n_per_s: 1e7 };
    let wrongs = [(f64::NAN, 0.0), (0.0, f64::NAN), (f64::INFINITY, 0.0), (2e-4, 0.0)];
    for controller in [pid, ramp] {
        for actuator in [Actuator::Ideal, Actuator::Force(lag)] {
            for (position, force) in wrongs {
                for delay in [false, true] {
                    let mut extraction = watched(actuator, controller);
                    extraction.timing.one_sample_delay = delay;
                    let mut state = ExtractionState::at_rest();
                    for n in 0..2000 {
                        let alive = 1e-9 * f64::from(n % 2);
                        let draws = if n == 1000 { (position, force) } else { (alive, 0.0) };
                        let sample = extraction.step(&mut state, seen(draws.0, draws.1));
                        let applied = sample.applied_force_n;
                        assert!(applied.is_finite(), "{applied} at {n}");
                        assert_eq!(sample.stop_reason > 0.0, n >= 1000, "at {n}");
                        if n >= 1000 + i32::from(delay) {
                            assert_eq!(sample.command_n, 0.0, "at {n}");
                            assert!(applied == 0.0 || actuator != Actuator::Ideal);
                        }
                        assert!(n < 1500 || applied < 1e-9, "{applied} at {n}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_stop_ends_the_feed() {
    use breakaway_core::actuator::{Contact, FeedAxis, Tip};
    let contact = Contact {
        stiffness_n_per_m: 2e8,
        damping_n_s_per_m: 3e3,
        gap_m: 1.0,
        backlash_m: Maybe::none(),
    };
    let axis = FeedAxis {
        speed_max_m_per_s: 0.05,
        acceleration_max_m_per_s2: 10.0,
        stiffness_n_per_m: 3e7,
        damping_n_s_per_m: 8e3,
        tool_mass_kg: 3.0,
        tip: Tip::Rigid,
        contact,
    };
    let steady = Controller::SteadyFeed(SteadyFeed {
        speed_m_per_s: 0.02,
        approach_m_per_s: 0.02,
        approach_s: 0.0,
    });
    let extraction = watched(Actuator::FeedAxis(axis), steady);
    let mut state = ExtractionState::at_rest();
    for n in 0..1000 {
        let wrong = if n == 500 { f64::NAN } else { 1e-9 * f64::from(n % 2) };
        extraction.step(&mut state, seen(wrong, 0.0));
        assert!(n != 499 || (state.actuator.feed_m_per_s - 0.02).abs() < 1e-12);
    }
    // 0.02 m/s at 10 m/s² are 2 ms of the 5 ms that are left.
    assert_eq!((state.actuator.feed_m_per_s, state.watch.reason), (0.0, 1.0));
}

/// A frozen position, the part stuck or not: what a PID would make of it is 9 kN.
#[test]
fn a_frozen_sensor_stops_a_pid() {
    let extraction = watched(Actuator::Ideal, paper_as_computed().controller);
    let mut state = ExtractionState::at_rest();
    let mut largest = 0.0_f64;
    for n in 0..20_000 {
        let x = state.plant.position_m;
        let position = if n < 5000 { 1e-9 * f64::from(n % 2) } else { 1e-3 - x };
        let sample = extraction.step(&mut state, seen(position, 0.0));
        largest = largest.max(sample.applied_force_n.abs());
    }
    // It either jumps to where it froze, or its bits stop moving.
    assert!(state.watch.reason == 2.0 || state.watch.reason == 3.0, "{:?}", state.watch);
    assert!(largest < 1e3, "{largest}");
}
