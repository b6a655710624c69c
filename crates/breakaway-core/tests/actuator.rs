//! Actuators against closed forms: force, stack, feed axis, contact, and the energy that they take.

mod laws;
mod support;

use breakaway_core::actuator::{
    Actuator, Command, Contact, Effort, FeedAxis, ForceActuator, Piezo, PushOnly,
};
use breakaway_core::control::{Controller, ForceRamp, SteadyFeed};
use breakaway_core::disturbance::Factors;
use breakaway_core::extraction::Sample;
use breakaway_core::joint::{Joint, Lugre};
use breakaway_core::test_models::{paper_as_computed, paper_joint};
use breakaway_core::{Draws, Extraction, ExtractionState, Maybe};
use std::f64::consts::PI;
use support::bench::{Bench, STACK, axis, feed, stack, with_stack};
use support::{UNDISTURBED, random};

const FORCE: ForceActuator<f64> =
    ForceActuator { force_max_n: 1000.0, bandwidth_hz: 500.0, force_rate_max_n_per_s: 1e9 };

/// The same with a grip, in the middle of its play.
fn gripping(axis: FeedAxis<f64>, play_m: f64) -> FeedAxis<f64> {
    let contact = Contact { gap_m: 0.5 * play_m, backlash_m: Maybe::some(play_m), ..axis.contact };
    FeedAxis { contact, ..axis }
}

fn joint() -> Joint<f64> {
    Joint::Lugre(paper_joint())
}

// Force actuator

#[test]
fn a_force_follows_a_held_command_as_a_first_order_lag_does() {
    for h in [1e-6, 1e-5, 3.7e-4] {
        let mut bench = Bench::new(Actuator::Force(FORCE), joint());
        let exact = |t: f64| 700.0 * (1.0 - (-2.0 * PI * 500.0 * t).exp());
        for n in 0..1000 {
            let (push, _) = bench.hold(&Command::force(700.0), h);
            let (t0, t1) = (f64::from(n) * h, f64::from(n + 1) * h);
            assert!((bench.state.force_n - exact(t1)).abs() < 1e-9);
            assert!((push - 0.5 * (exact(t0) + exact(t1))).abs() < 1e-9);
        }
    }
}

#[test]
fn a_force_is_3_db_down_at_its_bandwidth() {
    let (mut bench, h) = (Bench::new(Actuator::Force(FORCE), joint()), 1e-6);
    let (mut sine, mut cosine) = (0.0, 0.0);
    for n in 0..20_000 {
        let phase = 2.0 * PI * 500.0 * (f64::from(n) + 0.5) * h;
        let (push, _) = bench.hold(&Command::force(400.0 + 300.0 * phase.sin()), h);
        if n >= 10_000 {
            (sine, cosine) = (sine + push * phase.sin(), cosine + push * phase.cos());
        }
    }
    let (sine, cosine) = (sine / 5000.0 / 300.0, cosine / 5000.0 / 300.0);
    // 1 / (1 + j). Found: off by 7.1e-6 dB.
    let gain_db = 10.0 * (sine * sine + cosine * cosine).log10();
    assert!((gain_db + 10.0 * 2.0_f64.log10()).abs() < 1e-4, "{gain_db} dB");
    assert!((sine - 0.5).abs() < 1e-3 && (cosine + 0.5).abs() < 1e-3, "{sine} {cosine}");
}

#[test]
fn a_force_grows_at_its_limit_and_counts_as_saturated_meanwhile() {
    let slow = ForceActuator { force_rate_max_n_per_s: 1e5, ..FORCE };
    let (mut bench, h) = (Bench::new(Actuator::Force(slow), joint()), 1e-5);
    let mut saturated_s = 0.0;
    for n in 0..600 {
        let (_, effort) = bench.hold(&Command::force(900.0), h);
        saturated_s += effort.saturated_s;
        // The lag alone is faster than 1e5 N/s until 900 − F = r (T_s / (1 − e^(−T_s/τ))) = 32.3 N.
        if f64::from(n + 1) < 867.0 {
            let expected = 1e5 * f64::from(n + 1) * h;
            assert!((bench.state.force_n - expected).abs() < 1e-9, "{n}");
        }
    }
    assert!((saturated_s - 6e-3).abs() < 1e-12);
    for _ in 600..2000 {
        saturated_s += bench.hold(&Command::force(900.0), h).1.saturated_s;
    }
    assert!((saturated_s - 8.67e-3).abs() < 1.5e-5, "{saturated_s}");
}

#[test]
fn no_command_leads_a_force_out_of_its_range_or_rate() {
    let slow = ForceActuator { force_rate_max_n_per_s: 3e7, ..FORCE };
    for actuator in [
        Actuator::Force(slow),
        Actuator::Force(ForceActuator { bandwidth_hz: 1e6, ..FORCE }),
        Actuator::PushOnly(PushOnly { force_max_n: 1000.0 }),
    ] {
        let (mut bench, mut seed, mut last) = (Bench::new(actuator, joint()), 3, 0.0_f64);
        for n in 0..50_000 {
            let wild = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300];
            let command = match wild.get(n % 40) {
                Some(&wild) => wild,
                None => 2000.0 * random(&mut seed),
            };
            let (push, effort) = bench.hold(&Command::force(command), 1e-5);
            assert!((0.0..=1000.0).contains(&push), "{push} at {n}");
            if command.is_finite() {
                let outside = !(0.0..=1000.0).contains(&command);
                assert!(!outside || effort.saturated_s > 0.0, "{command}");
            }
            if actuator == Actuator::Force(slow) {
                assert!((bench.state.force_n - last).abs() <= 300.0 * (1.0 + 1e-12), "{n}");
                last = bench.state.force_n;
            }
        }
    }
}

// Stack

#[test]
fn a_stack_without_a_load_has_its_free_stroke_at_full_voltage() {
    let free = FeedAxis { contact: Contact { gap_m: 1.0, ..axis().contact }, ..with_stack(STACK) };
    let mut bench = Bench::new(Actuator::FeedAxis(free), joint());
    let push = bench.hold_long(&stack(1.0), 1e-5, 20_000);
    let length = bench.state.tip_m - bench.state.tool_m;
    assert!(push == 0.0 && (length / STACK.stroke_m - 1.0).abs() < 1e-9, "{length}");
    assert!((bench.state.tip_m / STACK.stroke_m - 1.0).abs() < 1e-9, "the tool is back");
    // What stays at 0 V after a full cycle: h 5/27 d.
    bench.hold_long(&stack(0.0), 1e-5, 20_000);
    let left = bench.state.tip_m / (0.4 * 5.0 / 27.0 * STACK.stroke_m);
    assert!((left - 1.0).abs() < 1e-9, "{left}");
}

#[test]
fn a_held_part_feels_the_blocking_force_through_what_is_in_series() {
    for stiff in [1.0, 1e6] {
        let axis = FeedAxis {
            stiffness_n_per_m: 3e7 * stiff,
            damping_n_s_per_m: 8e3 * stiff,
            contact: Contact {
                stiffness_n_per_m: 2e8 * stiff,
                damping_n_s_per_m: 3e3 * stiff,
                gap_m: 0.0,
                backlash_m: Maybe::none(),
            },
            ..with_stack(STACK)
        };
        let mut bench = Bench::new(Actuator::FeedAxis(axis), joint());
        let push = bench.hold_long(&stack(1.0), 1e-5, 50_000);
        let series = 1.0 / (1.0 / 1e8 + 1.0 / (3e7 * stiff) + 1.0 / (2e8 * stiff));
        assert!((push / (series * STACK.stroke_m) - 1.0).abs() < 1e-9, "{push}");
        let blocking = STACK.stiffness_n_per_m * STACK.stroke_m; // 3800 N
        assert!(stiff == 1.0 || (push / blocking - 1.0).abs() < 1e-5, "{push}");
    }
}

/// The midpoint rule rings at (2/h) atan(ω h / 2): slower than ω by (ω h)² / 12.
#[test]
fn a_stack_held_at_its_foot_rings_at_its_first_resonance() {
    let undamped = Piezo { damping_n_s_per_m: 0.0, ..STACK };
    let held = FeedAxis {
        tool_mass_kg: 1e12,
        contact: Contact { gap_m: 1.0, ..axis().contact },
        ..with_stack(undamped)
    };
    let omega = (1e8_f64 / 0.01).sqrt(); // 15.9 kHz
    for h in [1e-6, 1e-7] {
        let mut bench = Bench::new(Actuator::FeedAxis(held), joint());
        bench.state.tip_m_per_s = 0.1;
        let (mut crossings, mut n, mut last) = (Vec::new(), 0, 0.0);
        while crossings.len() < 201 {
            bench.hold(&stack(0.0), h);
            n += 1;
            let x = bench.state.tip_m;
            if last < 0.0 && x >= 0.0 {
                crossings.push((f64::from(n) - x / (x - last)) * h);
            }
            last = x;
        }
        let hertz = 200.0 / (crossings[200] - crossings[0]);
        let midpoint = (omega * h / 2.0).atan() / (PI * h);
        assert!((hertz / midpoint - 1.0).abs() < 2e-5, "{hertz} Hz, midpoint {midpoint} Hz");
        let slower = (omega * h).powi(2) / 12.0;
        let error = 1.0 - hertz / (omega / 2.0 / PI);
        // Found: 8.3e-4 at 1 us, 8.3e-6 at 0.1 us.
        assert!((error - slower).abs() < 2e-5, "{error:e}, expected {slower:e}");
    }
}

/// A stack whose voltage is whatever is commanded.
fn quasi_static() -> Bench {
    let ideal = Piezo { current_max_a: 1e12, amplifier_bandwidth_hz: 1e12, ..STACK };
    Bench::new(Actuator::FeedAxis(with_stack(ideal)), joint())
}

/// Moves the voltage in steps of a 1600th of the full one; gives (V, u) on the way.
fn sweep(bench: &mut Bench, from: f64, to: f64) -> Vec<(f64, f64)> {
    let steps = ((to - from).abs() * 1600.0).round() as u32;
    let share = |i: u32| from + (to - from) * f64::from(i) / f64::from(steps);
    (1..=steps)
        .map(|i| {
            bench.hold(&stack(share(i)), 1e-5);
            (bench.state.voltage_v, bench.state.stroke_m)
        })
        .collect()
}

#[test]
fn a_hysteresis_loop_has_the_area_of_its_play_operators() {
    for (low, high) in [(0.0, 1.0), (0.0, 0.75), (0.25, 0.5), (0.5, 0.5625)] {
        let mut bench = quasi_static();
        sweep(&mut bench, 0.0, high);
        sweep(&mut bench, high, low);
        let mut round = sweep(&mut bench, low, high);
        round.extend(sweep(&mut bench, high, low));
        let area: f64 = (0..round.len())
            .map(|i| {
                let ((v0, u0), (v1, u1)) = (round[i], round[(i + 1) % round.len()]);
                0.5 * (u0 + u1) * (v1 - v0)
            })
            .sum();
        let v_pp = (high - low) * 120.0;
        let of_one = |r: f64| if v_pp > 2.0 * r { 2.0 * r * (v_pp - 2.0 * r) } else { 0.0 };
        let plays: f64 = Piezo::<f64>::PLAY.iter().map(|share| of_one(share * 120.0)).sum();
        let expected = 0.4 * (8.0 / 27.0) * plays * STACK.stroke_m / 120.0;
        // Downward the stroke is larger, so the integral is negative.
        let scale = STACK.stroke_m * 120.0;
        assert!((area + expected).abs() < 1e-12 * scale, "{area:e} {expected:e}");
        assert!(expected > 0.0 || v_pp <= 15.0);
    }
}

#[test]
fn both_branches_of_a_full_loop_are_apart_by_what_the_docs_say() {
    let mut bench = quasi_static();
    sweep(&mut bench, 0.0, 1.0);
    let down = sweep(&mut bench, 1.0, 0.0);
    let up = sweep(&mut bench, 0.0, 1.0);
    let apart = (0..1599).map(|i| down[1598 - i].1 - up[i].1).fold(0.0, f64::max);
    assert!((apart / (0.4 * 10.0 / 27.0 * STACK.stroke_m) - 1.0).abs() < 1e-9, "{apart:e}");
}

#[test]
fn minor_loops_close_and_are_forgotten() {
    let mut bench = quasi_static();
    sweep(&mut bench, 0.0, 0.9);
    sweep(&mut bench, 0.9, 0.3);
    let turned = bench.state;
    sweep(&mut bench, 0.3, 0.6);
    sweep(&mut bench, 0.6, 0.3);
    assert!((bench.state.stroke_m - turned.stroke_m).abs() < 1e-18, "return point");
    // Further down the stack goes on as if there had been no minor loop.
    let with_loop = sweep(&mut bench, 0.3, 0.1);
    let mut plain = quasi_static();
    sweep(&mut plain, 0.0, 0.9);
    sweep(&mut plain, 0.9, 0.3);
    let without = sweep(&mut plain, 0.3, 0.1);
    for (a, b) in with_loop.iter().zip(&without) {
        assert!((a.1 - b.1).abs() < 1e-18);
    }
}

#[test]
fn an_amplifier_slews_at_its_current_over_the_capacitance() {
    let fast = Piezo { amplifier_bandwidth_hz: 1e6, ..STACK };
    let (mut bench, h) = (Bench::new(Actuator::FeedAxis(with_stack(fast)), joint()), 1e-6);
    let slew = 10.0 / 13e-6; // 0.77 V/us
    for n in 0..150 {
        let (_, effort) = bench.hold(&stack(1.0), h);
        assert!((bench.state.voltage_v - slew * f64::from(n + 1) * h).abs() < 1e-9);
        assert!((effort.charge_c - 10.0 * h).abs() < 1e-18 && effort.saturated_s == h);
        assert!((effort.current_square_a2_s - 100.0 * h).abs() < 1e-15);
    }
    // 120 V after 156 us; the amplifier then needs no current.
    let after: f64 = (0..100).map(|_| bench.hold(&stack(1.0), h).1.charge_c).sum();
    assert!((after / (13e-6 * 120.0 - 1.5e-3) - 1.0).abs() < 1e-9, "{after}");
    assert!((bench.state.voltage_v - 120.0).abs() < 1e-9);
}

/// I_rms = V_pp C π f / √2, as the application notes of amplifiers say; f cycles a second.
#[test]
fn a_sine_takes_its_rms_current_and_its_cycles() {
    let fast = Piezo { amplifier_bandwidth_hz: 1e6, ..STACK };
    let (mut bench, h, hertz) =
        (Bench::new(Actuator::FeedAxis(with_stack(fast)), joint()), 1e-6, 200.0);
    let (mut square, mut charge) = (0.0, 0.0);
    for n in 0..10_000 {
        let share = 0.5 - 0.4 * (2.0 * PI * hertz * f64::from(n) * h).cos();
        let (_, effort) = bench.hold(&stack(share), h);
        if n >= 5000 {
            (square, charge) = (square + effort.current_square_a2_s, charge + effort.charge_c);
        }
    }
    let rms = (square / 5e-3_f64).sqrt();
    let expected = 0.8 * 120.0 * 13e-6 * PI * hertz / 2.0_f64.sqrt(); // 0.5545 A
    assert!((rms / expected - 1.0).abs() < 1e-6, "{rms} A, expected {expected} A");
    // One cycle of 80 % of the voltage.
    let cycles = charge / (2.0 * 13e-6 * 120.0);
    assert!((cycles - 0.8).abs() < 1e-5, "{cycles}");
}

/// A stack that is pulled back at once drags its tip: −k u beyond the preload.
#[test]
fn the_tension_of_a_stack_is_what_its_preload_does_not_bear() {
    let axis = FeedAxis { contact: Contact { gap_m: 1.0, ..axis().contact }, ..with_stack(STACK) };
    let mut bench = Bench::new(Actuator::FeedAxis(axis), joint());
    let (_, rest) = bench.hold(&stack(0.0), 1e-6);
    assert!((rest.stack_tension_n + 800.0).abs() < 1e-9, "pressed by the preload alone");
    bench.hold_long(&stack(1.0), 1e-6, 200_000);
    bench.state.tip_m -= 38e-6; // held back, then let go: pressed by k d more
    let (_, pressed) = bench.hold(&stack(1.0), 1e-9);
    assert!((pressed.stack_tension_n + 800.0 + 3800.0).abs() < 2.0, "{pressed:?}");
    bench.state.tip_m += 2.0 * 38e-6; // drawn out by as much
    let (_, drawn) = bench.hold(&stack(1.0), 1e-9);
    assert!((drawn.stack_tension_n - 3000.0).abs() < 40.0, "{drawn:?}");
}

// Feed axis

#[test]
fn a_feed_keeps_its_limits_of_speed_and_acceleration() {
    let (mut bench, h) = (Bench::new(Actuator::FeedAxis(axis()), joint()), 1e-5);
    bench.part.position_m = 1.0;
    for n in 0..1000 {
        let (_, effort) = bench.hold(&feed(1.0), h);
        let t = f64::from(n + 1) * h;
        let (w, p) = if t <= 5e-3 { (10.0 * t, 5.0 * t * t) } else { (0.05, 0.05 * t - 1.25e-4) };
        assert!((bench.state.feed_m_per_s - w).abs() < 1e-12, "{n}");
        assert!((bench.state.feed_m - p).abs() < 1e-12, "{n}");
        assert_eq!(effort.saturated_s, h, "asked for more than it can");
    }
    assert_eq!(bench.hold(&feed(0.05), h).1.saturated_s, 0.0);
    for told in [-1.0, f64::NAN, f64::NEG_INFINITY] {
        bench.hold_long(&feed(0.05), h, 2000);
        bench.hold_long(&feed(told), h, 2000);
        let w = if told.is_nan() { 0.0 } else { -0.05 };
        assert!(
            (bench.state.feed_m_per_s - w).abs() < 1e-15,
            "{told}: {}",
            bench.state.feed_m_per_s
        );
    }
}

#[test]
fn a_held_part_feels_the_feed_through_what_is_in_series() {
    let compliances =
        [(axis(), 1.0 / 3e7 + 1.0 / 2e8), (with_stack(STACK), 1.0 / 3e7 + 1.0 / 2e8 + 1e-8)];
    for (axis, compliance) in compliances {
        let mut bench = Bench::new(Actuator::FeedAxis(axis), joint());
        bench.hold_long(&feed(0.01), 1e-5, 1000);
        let push = bench.hold_long(&feed(0.0), 1e-5, 50_000);
        let expected = (bench.state.feed_m - 1e-5) / compliance;
        assert!((push / expected - 1.0).abs() < 1e-9 && push > 1000.0, "{push} {expected}");
    }
}

/// Tool and tip between a feed and a held part, by Runge-Kutta of order four on the equations as they
/// are written; the voltage, the stroke and the feed are known functions of time.
fn chain_explicitly(piezo: &Piezo<f64>, end_s: f64, h: f64) -> [f64; 4] {
    let tau = 1.0 / (2.0 * PI * piezo.amplifier_bandwidth_hz);
    let rates = |t: f64, [x_t, v_t, x_p, v_p]: [f64; 4]| {
        let decayed = (-t / tau).exp();
        let u = piezo.stroke_m * (1.0 - decayed);
        let (p, w) = (5.0 * t * t, 10.0 * t);
        let axis = 3e7 * (p - x_t) + 8e3 * (w - v_t);
        let stack = 1e8 * (u - x_p + x_t) - piezo.damping_n_s_per_m * (v_p - v_t);
        let push = (2e8 * x_p + 3e3 * v_p).max(0.0);
        [v_t, (axis - stack) / 3.0, v_p, (stack - push) / 0.01]
    };
    let mut y = [0.0; 4];
    for n in 0..(end_s / h).round() as u32 {
        let t = f64::from(n) * h;
        let at = |k: [f64; 4], s: f64| std::array::from_fn(|i| y[i] + s * k[i]);
        let k1 = rates(t, y);
        let k2 = rates(t + 0.5 * h, at(k1, 0.5 * h));
        let k3 = rates(t + 0.5 * h, at(k2, 0.5 * h));
        let k4 = rates(t + h, at(k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    y
}

#[test]
fn a_chain_moves_as_explicit_integration_says() {
    let piezo = Piezo { hysteresis_share: 0.0, current_max_a: 1e6, ..STACK };
    let axis = FeedAxis { contact: Contact { gap_m: 0.0, ..axis().contact }, ..with_stack(piezo) };
    let end_s = 1e-3;
    let exact = chain_explicitly(&piezo, end_s, 2e-8);
    let error = |h: f64| {
        let mut bench = Bench::new(Actuator::FeedAxis(axis), joint());
        let command = Command { force_n: 0.0, feed_m_per_s: 0.05, stack_share: 1.0 };
        bench.hold_long(&command, h, (end_s / h).round() as u32);
        let s = bench.state;
        let ours = [s.tool_m, s.tool_m_per_s, s.tip_m, s.tip_m_per_s];
        let scale = [1e-5, 1e-2, 1e-5, 1e-2];
        (0..4).map(|i| ((ours[i] - exact[i]) / scale[i]).abs()).fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(1e-6), error(2.5e-7));
    println!("chain: {coarse:e} {fine:e}");
    assert!(coarse < 1e-3 && coarse > 12.0 * fine, "{coarse:e} {fine:e}");
}

/// Whatever is commanded and whatever the joint does: the contact force is that of its springs and
/// dampers at mid-step, where a face pulls only in a grip, and the momentum of each mass agrees with
/// its forces.
#[test]
fn a_contact_pushes_or_grips_and_momentum_is_kept() {
    let law = Lugre { viscous_n_s_per_m: Maybe::some(60.0), ..paper_joint() };
    for (name, joint) in laws::all(law) {
        let [pulled, open, pushed] = chained(name, joint, Maybe::none());
        assert!(pulled == 0 && open > 1000 && pushed > 1000, "{name}: {pulled} {open} {pushed}");
        let [pulled, open, pushed] = chained(name, joint, Maybe::some(2e-5));
        assert!(pulled.min(open).min(pushed) > 1000, "{name}: {pulled} {open} {pushed}");
        let [pulled, open, pushed] = chained(name, joint, Maybe::some(0.0));
        assert!(pulled.min(pushed) > 1000 && open < 10, "{name}: {pulled} {open} {pushed}");
    }
}

/// Checks every step of a stack and a tool that are driven at random; counts those in which the
/// contact pulls, is open and pushes.
fn chained(name: &str, joint: Joint<f64>, backlash_m: Maybe<f64>) -> [u32; 3] {
    let axis = match backlash_m.get() {
        Some(&play) => gripping(with_stack(STACK), play),
        None => with_stack(STACK),
    };
    let gap_m = axis.contact.gap_m;
    let mut bench = Bench::new(Actuator::FeedAxis(axis), joint);
    bench.part.position_m = 0.01;
    bench.state.feed_m = 0.01;
    (bench.state.tool_m, bench.state.tip_m) = (0.01, 0.01);
    let (mut seed, mut counts) = (11, [0; 3]);
    let (mut command, h) = (feed(0.0), 1e-5);
    for n in 0..30_000 {
        if n % 50 == 0 {
            command.feed_m_per_s = 0.05 * random(&mut seed) + 0.01;
            command.stack_share = random(&mut seed);
        }
        let factors = Factors { joint_force: 1.0 + 0.2 * random(&mut seed), ..UNDISTURBED };
        let (before, part) = (bench.state, bench.part);
        let (moved, _) = bench.step(&command, factors, h);
        let (after, f) = (bench.state, moved.push_force_n);
        let mid = |a: f64, b: f64| 0.5 * (a + b);
        let x = mid(part.position_m, bench.part.position_m);
        let (tip, tool) = (mid(before.tip_m, after.tip_m), mid(before.tool_m, after.tool_m));
        let tip_v = mid(before.tip_m_per_s, after.tip_m_per_s);
        let tool_v = mid(before.tool_m_per_s, after.tool_m_per_s);
        let damper = 3e3 * (tip_v - moved.mean_velocity_m_per_s);
        let pushing = (2e8 * (tip - gap_m - x) + damper).max(0.0);
        let pulling = |play: &f64| (2e8 * (tip - gap_m + play - x) + damper).min(0.0);
        let expected = pushing + backlash_m.get().map_or(0.0, pulling);
        assert!((f - expected).abs() < 1e-5, "{name} {n}: {f} {expected}");
        let u = mid(before.stroke_m, after.stroke_m);
        let stack = 1e8 * (u - tip + tool) - 200.0 * (tip_v - tool_v);
        let w = (after.feed_m - before.feed_m) / h;
        let axis = 3e7 * (mid(before.feed_m, after.feed_m) - tool) + 8e3 * (w - tool_v);
        let pushed_tip = 0.01 * (after.tip_m_per_s - before.tip_m_per_s) / h - (stack - f);
        let pushed_tool = 3.0 * (after.tool_m_per_s - before.tool_m_per_s) / h - (axis - stack);
        assert!(pushed_tip.abs() < 1e-5 && pushed_tool.abs() < 1e-4, "{name} {n}");
        counts[if f < 0.0 { 0 } else { usize::from(f > 0.0) + 1 }] += 1;
    }
    counts
}

// Energy

/// Sums over a run, and what is kept at its end.
#[derive(Default)]
struct Balance {
    supplied_j: f64,
    lost_j: f64,
    joint_work_j: f64,
    kept_j: f64,
}

impl Balance {
    fn add(&mut self, effort: &Effort<f64>, joint_work_j: f64) {
        self.supplied_j += effort.supplied_j;
        self.lost_j += effort.lost_j;
        self.joint_work_j += joint_work_j;
    }

    /// What is missing, as a share of what was supplied.
    fn error(&self) -> f64 {
        let spent = self.lost_j + self.joint_work_j + self.kept_j;
        (self.supplied_j - spent).abs() / self.supplied_j
    }
}

/// A short guide and no disturbance.
fn short(joint: Joint<f64>) -> Extraction<f64> {
    let mut extraction = Extraction { joint, ..paper_as_computed() };
    extraction.disturbance.var = 0.0;
    extraction
}

fn short_law() -> Lugre<f64> {
    Lugre { engagement_length_m: 5e-3, ..paper_joint() }
}

fn extract(extraction: &Extraction<f64>, limit_s: f64) -> Balance {
    let (mut state, mut balance) = (ExtractionState::at_rest(), Balance::default());
    let mut after = 0;
    while after < 100 {
        let sample: Sample<f64> = extraction.step(&mut state, Draws::none());
        balance.add(&sample.effort, sample.joint_work_j);
        assert!(sample.time_s < limit_s, "not out: {:?}", state.plant);
        after += u32::from(sample.position_m > 5e-3);
    }
    let v = state.plant.velocity_m_per_s;
    let kinetic_j = 0.5 * extraction.part.mass_kg * v * v;
    let actuator_j = extraction.actuator.stored_energy_j(&state.actuator, state.plant.position_m);
    let friction_j = balance.joint_work_j - state.plant.stored_energy_j(&extraction.joint);
    assert!(friction_j > 0.0 && balance.lost_j > -1e-12, "{friction_j}");
    balance.kept_j = kinetic_j + actuator_j;
    balance
}

#[test]
fn energy_is_accounted_for_over_whole_extractions() {
    let ramp = Controller::ForceRamp(ForceRamp { rate_n_per_s: 5e3, travel_m: 5e-3 });
    let steady = Controller::SteadyFeed(SteadyFeed {
        speed_m_per_s: 0.02,
        approach_m_per_s: 0.02,
        approach_s: 0.0,
    });
    let kinds = [
        ("ideal", Actuator::Ideal, ramp),
        ("push_only", Actuator::PushOnly(PushOnly { force_max_n: 2000.0 }), ramp),
        ("force", Actuator::Force(FORCE), ramp),
        ("feed_axis", Actuator::FeedAxis(axis()), steady),
        ("feed_axis with a stack", Actuator::FeedAxis(with_stack(STACK)), steady),
        ("gripping feed_axis", Actuator::FeedAxis(gripping(axis(), 0.0)), steady),
        ("gripping stack", Actuator::FeedAxis(gripping(with_stack(STACK), 2e-5)), steady),
    ];
    let mut worst = 0.0_f64;
    for (name, actuator, controller) in kinds {
        for (law, joint) in laws::all(short_law()) {
            for steps in [1, 3] {
                let mut extraction = Extraction { actuator, controller, ..short(joint) };
                extraction.timing.steps_per_period = steps;
                let balance = extract(&extraction, 1.0);
                worst = worst.max(balance.error());
                assert!(balance.error() < 1e-9, "{name} on {law}: {:e}", balance.error());
            }
        }
    }
    println!("energy: {worst:e}");
}

/// The same with a stack that hammers at 100 Hz, and not only at the end but at every step.
#[test]
fn energy_is_accounted_for_while_a_stack_hammers() {
    for (law, joint) in laws::all(short_law()) {
        let [pulled, open, _] = hammered(law, joint, with_stack(STACK));
        assert!(pulled == 0 && open > 100, "{law}: the contact opens {pulled} {open}");
        let counts = hammered(law, joint, gripping(with_stack(STACK), 2e-5));
        assert!(counts.into_iter().min() > Some(100), "{law}: {counts:?}");
    }
}

/// Hammers a part out of its joint; counts the steps in which the contact pulls, is open and pushes.
fn hammered(law: &str, joint: Joint<f64>, axis: FeedAxis<f64>) -> [u32; 3] {
    let mut bench = Bench::new(Actuator::FeedAxis(axis), joint);
    let (mut balance, mut charge, mut counts, h) = (Balance::default(), 0.0, [0; 3], 1e-5);
    let mut n = 0;
    while bench.part.position_m < 5e-3 {
        let on = (f64::from(n) * h * 100.0).fract() < 0.2;
        let share = if on { 1.0 } else { 0.0 };
        let command = Command { force_n: 0.0, feed_m_per_s: 0.01, stack_share: share };
        let (moved, effort) = bench.step(&command, UNDISTURBED, h);
        balance.add(&effort, moved.joint_work_j);
        charge += effort.charge_c;
        let f = moved.push_force_n;
        counts[if f < 0.0 { 0 } else { usize::from(f > 0.0) + 1 }] += 1;
        let v = bench.part.velocity_m_per_s;
        let stored = bench.actuator.stored_energy_j(&bench.state, bench.part.position_m);
        balance.kept_j = 0.5 * v * v + stored;
        assert!(n < 1000 || balance.error() < 1e-9, "{law} at {n}: {:e}", balance.error());
        n += 1;
        assert!(n < 200_000, "{law}: not out");
    }
    let cycles = charge / (2.0 * 13e-6 * 120.0);
    let expected = f64::from(n) * h * 100.0;
    assert!((cycles - expected).abs() < 1.5, "{law}: {cycles} cycles, {expected}");
    counts
}
