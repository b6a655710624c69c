//! Controllers: what each promises whatever it measures, and extractions whose answer is known.

use breakaway_core::actuator::{
    Actuator, Contact, FeedAxis, ForceActuator, ForceRange, PushOnly, Tip,
};
use breakaway_core::control::{
    AntiWindup, Control, Controller, ControllerState, DerivativeOf, FirstStep, FmVibration,
    ForceRamp, Gains, Measurement, Pid, PulseShape, SecondStep, StackPulses, SteadyFeed,
    TimedImpacts, TwoStep, VelocityFrom, VibratedFeed, VibratingPid, Watch,
};
use breakaway_core::extraction::Sample;
use breakaway_core::joint::{CoulombStiction, Joint};
use breakaway_core::metrics::{Groups, Metrics};
use breakaway_core::reference::{Reference, Step};
use breakaway_core::sensor::{Noise, Sensor, Sensors};
use breakaway_core::test_models::{paper_as_computed, paper_joint, paper_limits};
use breakaway_core::{Draws, Extraction, ExtractionState, Maybe};
use support::random;

mod laws;
mod support;

const GAINS: Gains<f64> = Gains { kp_n_per_m: 3.1e6, ki_n_per_m_s: 1.3e9, kd_n_s_per_m: 720.0 };
const PID: Pid<f64> = Pid {
    gains: GAINS,
    derivative_of: DerivativeOf::Error,
    velocity_from: VelocityFrom::PositionDifference,
    derivative_filter_s: Maybe::some(1e-4),
    anti_windup: AntiWindup::Conditional,
    tracking_time_s: 1e-3,
};
const PULSES: FmVibration<f64> = FmVibration {
    frequency_min_hz: 80.0,
    frequency_max_hz: 160.0,
    error_full_scale_m: 1e-3,
    pulse_width_s: 1e-3,
    base_fraction: 0.2,
    shape: PulseShape::HalfSine,
};
const TRAVEL_M: f64 = 0.1;
const IMPACTS: TimedImpacts<f64> = TimedImpacts {
    travel_m: TRAVEL_M,
    target_s: 8.0,
    force_start_n: 30.0,
    search_time_constant_s: 15e-3,
    rise_time_constant_s: 2e-3,
    rise_min_s: 1e-3,
    rise_per_slip: 20.0,
    slowing_m_per_s: 0.01,
    holding_m_per_s: 0.03,
    step_min_m: 30e-6,
    step_max_m: 110e-6,
    travel_min_m: 6e-6,
    restart_ratio: 0.6,
    probe_ratio: 0.06,
    breakaway_share: 0.3,
    dwell_from_ratio: 1.0,
    dwell_step_s: 2e-4,
    dwell_max_s: 1e-3,
    dwell_kept_share: 0.9,
    rough_slip_m: 150e-6,
    rough_cut_ratio: 0.1,
    patience_s: 0.2,
    patience_max_s: 2.8,
    caution_per_s: 0.17,
    low_force_ratio: 0.3,
    low_step_ratio: 0.6,
    latest_s: 9.0,
    coast_min_s: 1e-3,
    settled_m: 3e-6,
    lead_start_s: 1e-3,
    lead_min_s: 1e-4,
    lead_max_s: 1e-2,
    noise_rms_m: 1e-6,
    noise_margin: 2.0,
    free_margin_m: 3e-6,
    actuator_lag_s: 1.6e-4,
};
const FEED: SteadyFeed<f64> =
    SteadyFeed { speed_m_per_s: 0.0125, approach_m_per_s: 0.0125, approach_s: 0.0 };
const PULSED: StackPulses<f64> = StackPulses {
    frequency_hz: 100.0,
    pulse_width_s: 1e-3,
    amplitude_ratio: 0.6,
    stack_force_n: 2000.0,
    force_filter_s: 5e-3,
};
const RAMP: ForceRamp<f64> = ForceRamp { rate_n_per_s: 1e5, travel_m: TRAVEL_M };
const RANGE: ForceRange<f64> = ForceRange { min_n: 0.0, max_n: 2000.0 };

/// Every kind, limited to the actuator's range.
fn every_kind() -> Vec<(&'static str, Controller<f64>)> {
    let back = Pid { anti_windup: AntiWindup::BackCalculation, ..PID };
    let vibration = FmVibration { shape: PulseShape::Rectangular, ..PULSES };
    let slow = Pid { derivative_filter_s: Maybe::some(1e-3), ..back };
    let two_step = |breakaway, vibration| {
        Controller::TwoStep(TwoStep { breakaway, vibration, breakaway_travel_m: 2.5e-5 })
    };
    let (pid, ramp) = (FirstStep::Pid(PID), FirstStep::ForceRamp(RAMP));
    let pulses = SecondStep::FmVibration(VibratingPid { pid: slow, vibration: PULSES });
    let impacts = SecondStep::TimedImpacts(IMPACTS);
    vec![
        ("pid", Controller::Pid(PID)),
        ("pid, back calculation", Controller::Pid(back)),
        ("fm_vibration", Controller::FmVibration(VibratingPid { pid: PID, vibration: PULSES })),
        (
            "fm_vibration, rectangular",
            Controller::FmVibration(VibratingPid { pid: back, vibration }),
        ),
        ("two_step, pid and pulses", two_step(pid, pulses)),
        ("two_step, pid and impacts", two_step(pid, impacts)),
        ("two_step, ramp and pulses", two_step(ramp, pulses)),
        ("two_step, ramp and impacts", two_step(ramp, impacts)),
        ("force_ramp", Controller::ForceRamp(RAMP)),
        ("steady_feed", Controller::SteadyFeed(FEED)),
        ("timed_impacts", Controller::TimedImpacts(IMPACTS)),
        ("vibrated_feed", Controller::VibratedFeed(VibratedFeed { feed: FEED, pulses: PULSED })),
    ]
}

fn measured(reference_m: f64, position_m: f64) -> Measurement<f64> {
    Measurement {
        reference_m,
        reference_rate_m_per_s: 0.0,
        position_m,
        velocity_m_per_s: 0.0,
        force_n: 0.0,
        period_s: 1e-5,
        range: RANGE,
    }
}

/// Positions that wander, rest, jump and reverse, over all of the guide and beyond.
fn wander(seed: &mut u64, x: f64) -> f64 {
    let draw = random(seed);
    match (random(seed) * 1000.0) as i32 {
        999 => TRAVEL_M * 1.2 * draw,
        0..=400 => x,
        _ => x + 2e-6 * draw,
    }
}

#[test]
fn every_command_is_within_the_actuators_range() {
    for (name, controller) in every_kind() {
        for run in 0..20 {
            let (mut seed, mut x) = (run, 0.0);
            let mut state = ControllerState::at_rest();
            for n in 0..20_000 {
                x = wander(&mut seed, x);
                let command =
                    controller.step(&mut state, &measured(0.05 + 0.1 * random(&mut seed), x));
                let rounding = 1e-13 * RANGE.max_n; // a half sine is one to 1e-14
                let force = command.force_n;
                let fits = (-rounding..=RANGE.max_n + rounding).contains(&force);
                assert!(fits, "{name}, run {run}, sample {n}: {force} N");
                let feed = if name.ends_with("feed") { 0.0125 } else { 0.0 };
                assert_eq!(command.feed_m_per_s, feed, "{name}");
                assert!((0.0..=1.0).contains(&command.stack_share), "{name}");
            }
        }
    }
}

/// Without a watch, too, and for good: what cannot be pushed with is not commanded.
#[test]
fn no_number_that_is_none_leads_out_of_the_range() {
    const WRONG: [f64; 5] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300];
    for (name, controller) in every_kind() {
        for (i, wrong) in WRONG.into_iter().enumerate() {
            let (mut seed, mut x) = (i as u64, 0.0);
            let mut state = ControllerState::at_rest();
            for n in 0..20_000 {
                x = wander(&mut seed, x);
                let mut seen = measured(0.05, x);
                match n % 3000 {
                    500 => seen.position_m = wrong,
                    1500 => seen.force_n = wrong,
                    2500 => seen.reference_m = wrong,
                    _ => {}
                }
                let command = controller.step(&mut state, &seen);
                let fits = (-1e-9..=RANGE.max_n + 1e-9).contains(&command.force_n)
                    && (0.0..=1.0).contains(&command.stack_share);
                assert!(fits, "{name}, {wrong} at sample {n}: {command:?}");
            }
        }
    }
}

#[test]
fn nothing_pushes_a_part_that_is_out() {
    let outs = [
        Controller::ForceRamp(RAMP),
        Controller::TimedImpacts(IMPACTS),
        Controller::TwoStep(TwoStep {
            breakaway: FirstStep::ForceRamp(RAMP),
            vibration: SecondStep::TimedImpacts(IMPACTS),
            breakaway_travel_m: 2.5e-5,
        }),
    ];
    for controller in outs {
        let mut state = ControllerState::at_rest();
        let mut pushed = false;
        for n in 0..5000 {
            let x = 1e-8 * f64::from(n % 3);
            pushed |= controller.step(&mut state, &measured(0.0, x)).force_n > 0.0;
        }
        assert!(pushed);
        for n in 0..20_000 {
            let x = TRAVEL_M + 4e-6 + 1e-7 * f64::from(n);
            let force = controller.step(&mut state, &measured(0.0, x)).force_n;
            assert!(force == 0.0 || n < 3, "{controller:?} at {n}"); // a mean of three positions
        }
    }
}

/// Every kind in its loop, with wrong numbers in its sensors at any time: finite, within the range,
/// and none once the watch has stopped it.
#[test]
fn a_watch_stops_every_kind() {
    let sensor = Sensor {
        noise_rms: 1.0,
        quantum: Maybe::none(),
        bandwidth_hz: Maybe::none(),
        delay_samples: 0,
    };
    let lag = ForceActuator { force_max_n: 2000.0, bandwidth_hz: 1e3, force_rate_max_n_per_s: 1e8 };
    let wrongs = [f64::NAN, f64::INFINITY, 0.02, -0.02];
    for (name, controller) in every_kind() {
        let actuator = match controller {
            Controller::SteadyFeed(_) | Controller::VibratedFeed(_) => Actuator::FeedAxis(axis()),
            _ => Actuator::Force(lag),
        };
        let extraction = Extraction {
            actuator,
            controller,
            sensors: Some(Sensors { position: sensor, force: sensor }),
            watch: Some(Watch { jump_max_m: 1e-3, frozen_max_s: 0.1 }),
            ..paper_as_computed()
        };
        for (i, wrong) in wrongs.into_iter().enumerate() {
            let stop = 3000 + 1000 * i as u32;
            let (mut state, mut seed) = (ExtractionState::at_rest(), 1);
            for n in 0..10_000 {
                let position = if n == stop { wrong } else { 1e-7 * random(&mut seed) };
                let noise = Noise { position, force: random(&mut seed) };
                let sample = extraction.step(&mut state, Draws { disturbance: 0.0, noise });
                assert!((0.0..=2000.0).contains(&sample.applied_force_n), "{name} at {n}");
                let reason = if wrong.is_finite() { 2.0 } else { 1.0 };
                assert_eq!(sample.stop_reason, if n < stop { 0.0 } else { reason }, "{name}");
                assert!(n < stop || sample.command_n == 0.0, "{name} at {n}");
                // A feed that stands still keeps what its springs hold.
                let held = n < stop + 1000 || name.ends_with("feed");
                assert!(held || sample.applied_force_n < 1.0, "{name} at {n}");
            }
            assert!(state.actuator.feed_m_per_s == 0.0, "{name}");
        }
    }
}

// Known answers

fn axis() -> FeedAxis<f64> {
    FeedAxis {
        speed_max_m_per_s: 0.05,
        acceleration_max_m_per_s2: 1.0,
        stiffness_n_per_m: 3e7,
        damping_n_s_per_m: 1e3,
        tool_mass_kg: 0.1,
        tip: Tip::Rigid,
        contact: Contact {
            stiffness_n_per_m: 3e8,
            damping_n_s_per_m: 5e3,
            gap_m: 1e-4,
            backlash_m: Maybe::none(),
        },
    }
}

/// Rigid friction: F_s 450 N, F_c 360 N at the seat, 10 N at the end after 5 mm.
fn rigid() -> CoulombStiction<f64> {
    CoulombStiction {
        stiction_n: 450.0,
        coulomb_n: 360.0,
        viscous_n_s_per_m: Maybe::none(),
        stribeck_velocity_m_per_s: 0.09,
        engagement_length_m: 5e-3,
        residual_n: 10.0,
        backward_ratio: Maybe::none(),
    }
}

const PUSH_ONLY: Actuator<f64> = Actuator::PushOnly(PushOnly { force_max_n: 2000.0 });

fn calm(
    joint: CoulombStiction<f64>,
    actuator: Actuator<f64>,
    controller: Controller<f64>,
) -> Extraction<f64> {
    let joint = Joint::CoulombStiction(joint);
    Extraction { joint, actuator, controller, ..paper_as_computed() }
}

/// Samples until `done`; panics where that takes more than a second.
fn until(extraction: &Extraction<f64>, done: impl Fn(&Sample<f64>) -> bool) -> Vec<Sample<f64>> {
    let (mut state, mut samples) = (ExtractionState::at_rest(), Vec::new());
    loop {
        let sample = extraction.step(&mut state, Draws::none());
        samples.push(sample);
        if done(&sample) {
            return samples;
        }
        assert!(sample.time_s < 1.0, "never: {sample:?}");
    }
}

/// F = r t passes 450 N after 0.09 s: a rigid part stands still until then, to the bit, and moves in
/// the sample after.
#[test]
fn a_force_ramp_breaks_a_rigid_joint_loose_at_its_stiction() {
    let ramp = Controller::ForceRamp(ForceRamp { rate_n_per_s: 5e3, travel_m: 5e-3 });
    let samples = until(&calm(rigid(), PUSH_ONLY, ramp), |s| s.next_position_m > 0.0);
    let last = samples.last().expect("there is one");
    // 0.05 N in each sample: 9000 of them are 450 N, and rounding decides whether that holds.
    let force = last.applied_force_n;
    assert!(force > 450.0 && force < 450.05 + 1e-6, "{force}");
    assert!((last.time_s - 0.09).abs() < 1.5e-5, "{}", last.time_s);
    // It goes on growing until the part is out, then ends.
    let out = until(&calm(rigid(), PUSH_ONLY, ramp), |s| s.position_m >= 5e-3);
    let last = out.last().expect("there is one");
    assert_eq!(last.applied_force_n, 0.0);
    assert!(out[out.len() - 2].applied_force_n > 450.0);
    // Thrown: the mean friction is (360 + 10) / 2 N and more, so v² / 2 · 1 kg is at most
    // (F_end − 185 N) · 5 mm, and at least (450 N − 230 N) · 5 mm.
    let energy = 0.5 * last.velocity_m_per_s * last.velocity_m_per_s;
    let force = out[out.len() - 2].applied_force_n;
    assert!((220.0 * 5e-3..(force - 185.0) * 5e-3).contains(&energy), "{energy} J, {force} N");
}

/// Friction of one level, so that nothing sticks and slips: the axis needs 12.5 ms for its speed and
/// falls back by w²/2a = 78.125 um, crosses a gap of 100 um, is compressed by 10 N / k at the end,
/// and has by then moved 5 mm at 12.5 mm/s: 0.4 s + 6.25 ms + 8 ms + 0.03 ms. The tool is light, so that
/// its blow, v sqrt(m k_c) = 68 N, does not break the joint loose before the axis presses.
#[test]
fn a_steady_feed_is_out_when_its_travel_says() {
    let even = CoulombStiction { coulomb_n: 450.0, ..rigid() };
    let steady = Controller::SteadyFeed(FEED);
    let extraction = calm(even, Actuator::FeedAxis(axis()), steady);
    let samples = until(&extraction, |s| s.next_position_m >= 5e-3);
    let last = samples.last().expect("there is one");
    let per_n = 1.0 / 3e7 + 1.0 / 3e8;
    let expected = (5e-3 + 78.125e-6 + 1e-4 + 10.0 * per_n) / 0.0125;
    assert!((last.time_s + 1e-5 - expected).abs() < 2e-5, "{} {expected}", last.time_s);
    assert!((last.next_velocity_m_per_s - 0.0125).abs() < 2e-4, "{}", last.next_velocity_m_per_s);
    // It breaks loose once the compression is 450 N · per_n, 16.5 um.
    let moved = samples.iter().find(|s| s.next_position_m > 0.0).expect("it moves");
    let expected = (78.125e-6 + 1e-4 + 450.0 * per_n) / 0.0125;
    assert!((moved.time_s - expected).abs() < 5e-5, "{} {expected}", moved.time_s);
    let peak = samples.iter().map(|s| s.applied_force_n).fold(0.0, f64::max);
    // Part and tool of 1.1 kg then catch up with the feed: v sqrt(m k) = 68 N more.
    assert!(peak > 450.0 && peak < 518.0, "{peak}");
}

/// A rigid part gives nothing away before it moves, so the force grows by 1 + T_s/τ_s each sample:
/// from 30 N beyond 450 N in ceil(ln 15 / ln(1 + 10 us / 15 ms)) = 4064 samples, to at most that
/// factor above 450 N.
#[test]
fn timed_impacts_break_a_rigid_joint_loose_within_a_step_of_their_exponential() {
    let extraction = calm(rigid(), PUSH_ONLY, Controller::TimedImpacts(IMPACTS));
    let samples = until(&extraction, |s| s.next_position_m > 0.0);
    let factor: f64 = 1.0 + 1e-5 / 15e-3;
    let expected = (15.0_f64.ln() / factor.ln()).ceil();
    assert_eq!(expected, 4064.0);
    assert_eq!(samples.len() as f64, expected);
    let force = samples[samples.len() - 1].applied_force_n;
    assert!(force > 450.0 && force <= 450.0 * factor, "{force}");
    // The whole extraction: one slip after the other. Found: out after 0.41 s of 0.5 s, 617 N.
    let mut limits = paper_limits();
    (limits.release_position_m, limits.diverged_error_m) = (5e-3, 1.0);
    let mut travel = extraction;
    travel.controller =
        Controller::TimedImpacts(TimedImpacts { travel_m: 5e-3, target_s: 0.5, ..IMPACTS });
    let (mut state, mut metrics) = (ExtractionState::at_rest(), Metrics::new());
    for _ in 0..200_000 {
        metrics.step(Groups::ALL, &limits, &travel, &mut state, Draws::none());
    }
    assert!(metrics.time_to_release_s < 1.0, "{}", metrics.time_to_release_s);
    assert!(metrics.peak_force_n < 2.0 * 450.0, "{}", metrics.peak_force_n);
    assert!(metrics.largest_jump_m < 1e-3 && metrics.impacts > 40.0, "{metrics:?}");
}

/// A proportional PID on elastic bristles of k_e stands still where k_p (r − x) = k_e x.
#[test]
fn a_proportional_controller_stretches_the_bristles_to_its_balance() {
    let gains = Gains { kp_n_per_m: 4e6, ki_n_per_m_s: 0.0, kd_n_s_per_m: 500.0 };
    let extraction = Extraction {
        joint: laws::two_region(paper_joint()),
        reference: Reference::Step(Step { distance_m: 5e-5, start_s: 0.0 }),
        controller: Controller::Pid(Pid::plain(gains)),
        ..paper_as_computed()
    };
    let mut state = ExtractionState::at_rest();
    let mut force = 0.0;
    for _ in 0..5000 {
        force = extraction.step(&mut state, Draws::none()).applied_force_n;
    }
    let k_e = paper_joint().stiffness_n_per_m;
    let balance = 4e6 * 5e-5 / (4e6 + k_e); // 5 um, 180 N
    assert!((state.plant.position_m / balance - 1.0).abs() < 1e-9, "{}", state.plant.position_m);
    assert!((force - 180.0).abs() < 1e-6, "{force}");
}

/// A constant error e of a part that does not move: I = k_i e t, and the joint breaks loose when that
/// is 450 N. Then the two-step controller vibrates.
#[test]
fn an_integral_breaks_a_rigid_joint_loose_on_time_and_two_steps_then_vibrate() {
    let gains = Gains { kp_n_per_m: 0.0, ki_n_per_m_s: 1e7, kd_n_s_per_m: 0.0 };
    let pid = Pid { gains, anti_windup: AntiWindup::Conditional, ..PID };
    let vibration = FmVibration { base_fraction: 0.0, shape: PulseShape::Rectangular, ..PULSES };
    let two_step = TwoStep {
        breakaway: FirstStep::Pid(pid),
        vibration: SecondStep::FmVibration(VibratingPid { pid, vibration }),
        breakaway_travel_m: 1e-5,
    };
    for controller in [Controller::Pid(pid), Controller::TwoStep(two_step)] {
        let extraction = Extraction {
            reference: Reference::Step(Step { distance_m: 1e-3, start_s: 0.0 }),
            ..calm(rigid(), PUSH_ONLY, controller)
        };
        let samples = until(&extraction, |s| s.position_m > 1e-4);
        let moved = samples.iter().position(|s| s.next_position_m > 0.0).expect("it moves");
        // 0.1 N in each sample: 450 N in the 4500th, and rounding decides whether that holds.
        assert!((4499..=4500).contains(&moved), "{moved}");
        assert!((samples[moved].applied_force_n - 450.0).abs() < 0.101);
    }
    let extraction = Extraction {
        reference: Reference::Step(Step { distance_m: 1e-3, start_s: 0.0 }),
        ..calm(rigid(), PUSH_ONLY, Controller::TwoStep(two_step))
    };
    let samples = until(&extraction, |s| s.time_s > 0.2);
    let loose = samples.iter().position(|s| s.position_m > 1e-5).expect("it slips");
    assert!(samples[..loose].iter().skip(1).all(|s| s.applied_force_n > 0.0));
    let pushed = samples[loose + 200..].iter().filter(|s| s.applied_force_n > 0.0).count();
    let share = pushed as f64 / (samples.len() - loose - 200) as f64;
    // Pulses of 1 ms at 80 to 160 Hz: 8 to 16 % of the time.
    assert!((0.07..0.17).contains(&share), "{share}");
}

/// What is held is the amplitude, so that it shows: at the take-over it is what step 1 would
/// command then, or, after a ramp, what was commanded last, and the one step of its own integral.
#[test]
fn a_vibration_takes_the_amplitude_over_without_a_bump() {
    let gains = Gains { kp_n_per_m: 4e5, ki_n_per_m_s: 2e8, kd_n_s_per_m: 90.0 };
    let first = Pid { anti_windup: AntiWindup::Off, ..PID };
    let second = Pid {
        gains,
        derivative_of: DerivativeOf::Measurement,
        derivative_filter_s: Maybe::some(3e-4),
        ..first
    };
    let pulses = FmVibration { base_fraction: 1.0, ..PULSES };
    let vibration = SecondStep::FmVibration(VibratingPid { pid: second, vibration: pulses });
    let error = 2e-4;
    let seen = |n: u32| {
        let x = 1e-7 * f64::from(n) + 1e-5 * f64::from(n / 100);
        Measurement { reference_rate_m_per_s: 0.02, ..measured(x + error, x) }
    };
    for (breakaway, alone) in [
        (FirstStep::Pid(first), Controller::Pid(first)),
        (FirstStep::ForceRamp(RAMP), Controller::ForceRamp(RAMP)),
    ] {
        let supervisor =
            Controller::TwoStep(TwoStep { breakaway, vibration, breakaway_travel_m: 1.8e-5 });
        let mut states = [ControllerState::at_rest(); 2];
        let mut last = 0.0;
        for n in 0..100 {
            last = supervisor.step(&mut states[0], &seen(n)).force_n;
            assert_eq!(last, alone.step(&mut states[1], &seen(n)).force_n, "{n}");
        }
        let taken = supervisor.step(&mut states[0], &seen(100)).force_n; // and 10 um further
        let step = |gains: &Gains<f64>| gains.ki_n_per_m_s * 1e-5 * error;
        let expected = match breakaway {
            FirstStep::ForceRamp(_) => last + step(&gains),
            FirstStep::Pid(_) => {
                let now = alone.step(&mut states[1], &seen(100)).force_n;
                now - step(&GAINS) + step(&gains)
            }
        };
        assert!((taken - expected).abs() < 1e-9 * expected.abs(), "{taken} {expected}");
        // Neither goes back.
        let sitting = Measurement { reference_m: 0.0, ..measured(0.0, 0.0) };
        supervisor.step(&mut states[0], &sitting);
        assert_eq!(states[0].two_step.vibrating, 1.0);
    }
}

/// Impacts of step 2 are those of a controller that begins where the joint broke loose.
#[test]
fn timed_impacts_begin_afresh_at_the_take_over() {
    let supervisor = Controller::TwoStep(TwoStep {
        breakaway: FirstStep::ForceRamp(RAMP),
        vibration: SecondStep::TimedImpacts(IMPACTS),
        breakaway_travel_m: 1e-5,
    });
    let alone = Controller::TimedImpacts(IMPACTS);
    let mut states = [ControllerState::at_rest(); 2];
    let seen = |n: u32| measured(0.0, 1e-6 * f64::from(n % 37) + 4e-8 * f64::from(n));
    for n in 0..100 {
        supervisor.step(&mut states[0], &measured(0.0, 1e-7 * f64::from(n)));
    }
    for n in 0..50_000 {
        let seen = if n == 0 { measured(0.0, 1.1e-5) } else { seen(n) };
        let expected = alone.step(&mut states[1], &seen);
        assert_eq!(supervisor.step(&mut states[0], &seen), expected, "{n}");
    }
    assert_eq!(states[0].two_step.vibration.timed_impacts, states[1].timed_impacts);
}

/// The ramp alone throws the part out; impacts that follow it let it slip by less than 1 mm.
#[test]
fn a_force_ramp_and_then_timed_impacts_free_a_rigid_joint() {
    let ramp = ForceRamp { rate_n_per_s: 5e3, travel_m: 5e-3 };
    let impacts = TimedImpacts { travel_m: 5e-3, target_s: 0.5, ..IMPACTS };
    let supervisor = TwoStep {
        breakaway: FirstStep::ForceRamp(ramp),
        vibration: SecondStep::TimedImpacts(impacts),
        breakaway_travel_m: 1e-5,
    };
    let mut limits = paper_limits();
    (limits.release_position_m, limits.diverged_error_m) = (5e-3, 1.0);
    let freed = |controller| {
        let extraction = calm(rigid(), PUSH_ONLY, controller);
        let (mut state, mut metrics) = (ExtractionState::at_rest(), Metrics::new());
        for _ in 0..200_000 {
            metrics.step(Groups::ALL, &limits, &extraction, &mut state, Draws::none());
        }
        metrics
    };
    let (two, one) = (freed(Controller::TwoStep(supervisor)), freed(Controller::ForceRamp(ramp)));
    assert!(two.time_to_release_s < 1.0 && two.impacts > 40.0, "{two:?}");
    assert!(two.largest_jump_m < 1e-3 && one.largest_jump_m > 4e-3, "{two:?} {one:?}");
}

/// A part that does not give way: the error stays, so there are f = f_min + (f_max − f_min) e / e_full
/// pulses a second, each as high as the PID says.
#[test]
fn frequency_modulation_has_its_pulses_and_their_height() {
    let gains = Gains { kp_n_per_m: 4e5, ki_n_per_m_s: 0.0, kd_n_s_per_m: 0.0 };
    let pid = Pid { gains, ..PID };
    for (error_m, hertz) in [(2.5e-4, 100.0), (5e-4, 120.0), (1e-3, 160.0)] {
        let vibration = FmVibration { base_fraction: 0.0, ..PULSES };
        let controller = Controller::FmVibration(VibratingPid { pid, vibration });
        let extraction = Extraction {
            reference: Reference::Step(Step { distance_m: error_m, start_s: 0.0 }),
            ..calm(rigid(), PUSH_ONLY, controller)
        };
        let (mut state, mut metrics) = (ExtractionState::at_rest(), Metrics::new());
        let mut limits = paper_limits();
        limits.diverged_error_m = 1.0;
        for _ in 0..100_000 {
            metrics.step(Groups::ALL, &limits, &extraction, &mut state, Draws::none());
        }
        // The first pulse begins at once, with the phase at zero.
        assert!((metrics.impacts - hertz).abs() <= 1.0, "{} of {hertz}", metrics.impacts);
        let amplitude = 4e5 * error_m;
        assert!((metrics.peak_force_n / amplitude - 1.0).abs() < 1e-12, "{}", metrics.peak_force_n);
        // ∫ F dt = A · 2/π · t_p a pulse.
        let impulse = metrics.impacts * amplitude * 1e-3 * 2.0 / std::f64::consts::PI;
        assert!((metrics.impulse_n_s / impulse - 1.0).abs() < 0.02, "{}", metrics.impulse_n_s);
        assert_eq!(state.plant.position_m, 0.0);
    }
}

/// The mean force stays at F̄, so each pulse is α F̄ / F_stack of the stroke high, 100 in a second, and
/// 10 % of the time; the first cycle only listens.
#[test]
fn a_vibrated_feed_pulses_in_proportion_to_the_force() {
    let controller = Controller::VibratedFeed(VibratedFeed { feed: FEED, pulses: PULSED });
    let mut state = ControllerState::at_rest();
    let seen = Measurement { force_n: 1000.0, ..measured(0.0, 0.0) };
    let (mut largest, mut pulsing, mut starts, mut last) = (0.0_f64, 0, 0, 0.0);
    for n in 0..100_000 {
        let share = controller.step(&mut state, &seen).stack_share;
        assert!(n >= 999 || share == 0.0, "{share} at {n}");
        if n >= 50_000 {
            largest = largest.max(share);
            pulsing += u32::from(share > 1e-12);
            starts += u32::from(share > 1e-12 && last <= 1e-12);
        }
        last = share;
    }
    assert!((largest - 0.6 * 1000.0 / 2000.0).abs() < 1e-4, "{largest}");
    assert_eq!(starts, 50);
    assert!((4900..=5000).contains(&pulsing), "{pulsing}");
}
