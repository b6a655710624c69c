//! A part on a rig, under each drive: known answers, and derivatives by three ways.

mod complex_step;

use std::f64::consts::PI;

use breakaway_core::control::{AntiWindup, Cascade, DerivativeOf, Gains, Pid, VelocityFrom};
use breakaway_core::rig::{Drive, LimitedPid, Predicted, RIG_NUMBERS, Rig, Row};
use breakaway_core::{Dual, Maybe, Real};
use complex_step::Complex;

/// In the order of [`RIG_NUMBERS`].
const NUMBERS: [f64; 16] =
    [5.0, 50.0, 20.0, 30.0, 40.0, 60.0, 1.3, 0.01, 1e6, 300.0, 100.0, 0.6, 0.0, 0.0, 0.0, 4.0];

/// A rig with some of its numbers changed; LuGre.
fn rig(changes: &[(&str, f64)]) -> Rig<f64> {
    Rig::from_numbers(&numbers(changes), false)
}

fn numbers(changes: &[(&str, f64)]) -> [f64; 16] {
    let mut numbers = NUMBERS;
    for (name, value) in changes {
        let place = RIG_NUMBERS.iter().position(|known| known == name);
        numbers[place.expect("a number of a rig")] = *value;
    }
    numbers
}

/// A row of a rig at rest.
const STILL: Row<f64> = Row {
    position_m: 0.0,
    velocity_m_per_s: 0.0,
    acceleration_m_per_s2: 0.0,
    force_n: 0.0,
    reference_m: 0.0,
    reference_rate_m_per_s: 0.0,
    period_s: 1e-3,
    mean_velocity_m_per_s: 0.0,
    held_force_n: 0.0,
    outside_force_n: 0.0,
    time_s: 0.0,
};

fn run<R: Real>(
    rig: &Rig<R>,
    drive: &Drive<f64>,
    rows: &[Row<f64>],
    steps: u32,
) -> Vec<Predicted<R>> {
    let drive = drive.constant();
    let mut state = rig.start(&drive, &rows[0].constant());
    rows.iter().map(|row| rig.step(&drive, &mut state, &row.constant(), steps)).collect()
}

fn last(predicted: &[Predicted<f64>]) -> Predicted<f64> {
    *predicted.last().expect("rows")
}

/// The orders in which the last position converges to `exact` as steps are halved.
fn orders(rig: &Rig<f64>, rows: &[Row<f64>], exact: f64) -> [f64; 2] {
    let error = |steps| last(&run(rig, &Drive::Force, rows, steps)).position_m - exact;
    [(error(1) / error(2)).abs().log2(), (error(2) / error(4)).abs().log2()]
}

/// m dv/dt = F − F_0 ∓ F_c − σ± v:  v falls to v_∞ = (F − F_0 ∓ F_c) / σ± with m / σ±.
#[test]
fn a_sliding_part_under_a_constant_force_settles_exponentially() {
    for elasto_plastic in [false, true] {
        for (sign, coulomb, viscous) in [(1.0, 20.0, 40.0), (-1.0, 30.0, 60.0)] {
            let numbers = numbers(&[
                ("spring_n_per_m", 0.0),
                ("stiction_ratio", 1.0),
                ("coulomb_slope_n_per_m", 0.0),
            ]);
            let rig = Rig::from_numbers(&numbers, elasto_plastic);
            let (force, v, x, mass) = (sign * 60.0, sign * 0.2, 0.03, 5.0);
            let acceleration = (force - 4.0 - sign * coulomb - viscous * v) / mass;
            let row = Row {
                position_m: x,
                velocity_m_per_s: v,
                acceleration_m_per_s2: acceleration,
                force_n: force,
                period_s: 2e-3,
                held_force_n: force,
                ..STILL
            };
            let (t, tau) = (0.2, mass / viscous);
            let end = (force - 4.0 - sign * coulomb) / viscous;
            let exact = x + end * t + (v - end) * tau * (1.0 - (-t / tau).exp());
            let orders = orders(&rig, &[row; 101], exact);
            assert!(orders.iter().all(|p| (1.95..2.05).contains(p)), "{orders:?}");
            let predicted = last(&run(&rig, &Drive::Force, &[row; 101], 32));
            let error = (predicted.position_m - exact) / (exact - x);
            assert!(error.abs() < 1e-6, "off by {error:e}");
            assert_eq!(predicted.force_n, force);
        }
    }
}

/// Almost without friction on its spring, 10 mm away: ω = sqrt(500 / 5) = 10 rad/s.
fn swinging() -> (Rig<f64>, Row<f64>) {
    let rig = rig(&[
        ("spring_n_per_m", 500.0),
        ("coulomb_positive_n", 1e-9),
        ("coulomb_negative_n", 1e-9),
        ("viscous_positive_n_s_per_m", 0.0),
        ("viscous_negative_n_s_per_m", 0.0),
        ("damping_n_s_per_m", 0.0),
        ("coulomb_slope_n_per_m", 0.0),
        ("offset_n", 0.0),
    ]);
    (rig, Row { position_m: 0.01, acceleration_m_per_s2: -1.0, ..STILL })
}

#[test]
fn a_part_on_a_spring_swings_at_its_frequency() {
    let (rig, row) = swinging();
    let x: Vec<f64> =
        run(&rig, &Drive::Force, &vec![row; 6000], 10).iter().map(|p| p.position_m).collect();
    let crossing = |n: usize| n as f64 + x[n] / (x[n] - x[n + 1]);
    let crossings: Vec<f64> =
        (0..x.len() - 1).filter(|&n| x[n] > 0.0 && x[n + 1] <= 0.0).map(crossing).collect();
    assert_eq!(crossings.len(), 10);
    let period = (crossings[9] - crossings[0]) / 9.0 * 1e-3;
    assert!((period * 10.0 / (2.0 * PI) - 1.0).abs() < 1e-6, "{period} s");
}

#[test]
fn a_part_on_a_spring_converges_with_order_two() {
    let (rig, row) = swinging();
    let row = Row { period_s: 0.01, ..row };
    let exact = 0.01 * 20.0_f64.cos();
    let orders = orders(&rig, &[row; 201], exact);
    assert!(orders.iter().all(|p| (1.9..2.1).contains(p)), "{orders:?}");
}

/// F = m a ± F_c + σ± v + F_0 + k_r x once the bristles are stretched, ± the direction.
#[test]
fn the_force_of_an_imposed_motion_is_the_sum_of_its_parts() {
    for elasto_plastic in [false, true] {
        let numbers = numbers(&[("stiction_ratio", 1.0), ("coulomb_slope_n_per_m", 0.0)]);
        let rig = Rig::from_numbers(&numbers, elasto_plastic);
        for (sign, coulomb, viscous) in [(1.0, 20.0, 40.0), (-1.0, 30.0, 60.0)] {
            let a = sign * 0.5;
            let row = |n| {
                let t = 1e-3 * f64::from(n);
                Row {
                    position_m: 0.01 + 0.5 * a * t * t,
                    velocity_m_per_s: a * t,
                    acceleration_m_per_s2: a,
                    mean_velocity_m_per_s: a * (t + 0.5e-3),
                    ..STILL
                }
            };
            let rows: Vec<_> = (100..200).map(row).collect();
            let predicted = run(&rig, &Drive::Imposed, &rows, 4);
            for (row, predicted) in rows.iter().zip(predicted).skip(50) {
                let (x, v) = (row.position_m, row.velocity_m_per_s);
                let force = 5.0 * a + sign * coulomb + viscous * v + 4.0 + 50.0 * x;
                assert!((predicted.force_n / force - 1.0).abs() < 1e-9, "{predicted:?} {force}");
                assert_eq!(predicted.position_m, x);
            }
        }
    }
}

const CASCADE: Cascade<f64> =
    Cascade { position_gain_per_s: 20.0, velocity_gain_n_s_per_m: 500.0, force_limit_n: 100.0 };

/// V = K_p e − F / K_v behind a reference at speed V, F what friction and offset take.
#[test]
fn a_cascade_follows_at_a_known_distance() {
    let rig = rig(&[("spring_n_per_m", 0.0), ("coulomb_slope_n_per_m", 0.0)]);
    for (v, force) in [(0.1, 20.0 + 40.0 * 0.1 + 4.0), (-0.1, -30.0 - 60.0 * 0.1 + 4.0)] {
        let rows: Vec<_> =
            (0..3000).map(|n| Row { reference_m: v * 1e-3 * f64::from(n), ..STILL }).collect();
        let predicted = last(&run(&rig, &Drive::Cascade(CASCADE), &rows, 4));
        let behind = (v + force / 500.0) / 20.0;
        assert!((predicted.force_n / force - 1.0).abs() < 1e-9, "{} {force}", predicted.force_n);
        let error = (rows[2999].reference_m - predicted.position_m) / behind - 1.0;
        assert!(error.abs() < 1e-9, "off by {error:e}");
    }
}

const PID: LimitedPid<f64> = LimitedPid {
    pid: Pid {
        gains: Gains { kp_n_per_m: 40_000.0, ki_n_per_m_s: 2e5, kd_n_s_per_m: 400.0 },
        derivative_of: DerivativeOf::Error,
        velocity_from: VelocityFrom::Sensor,
        derivative_filter_s: Maybe::some(2e-3),
        anti_windup: AntiWindup::BackCalculation,
        tracking_time_s: 0.05,
    },
    force_limit_n: 100.0,
};

#[test]
fn controllers_keep_their_limit() {
    let rig = rig(&[]);
    for drive in [Drive::Cascade(CASCADE), Drive::Pid(PID)] {
        for sign in [1.0, -1.0] {
            let row = Row { reference_m: sign * 100.0, ..STILL };
            let predicted = run(&rig, &drive, &[row; 50], 4);
            assert!(predicted.iter().all(|p| p.force_n == sign * 100.0));
            let measured = Row { held_force_n: sign * 100.0, ..STILL };
            let by_force = run(&rig, &Drive::Force, &[measured; 50], 4);
            assert_eq!(predicted, by_force, "the same motion as under that force");
        }
    }
}

/// Against a weight of 50 N, of which friction holds 1.3 · 30 N.
#[test]
fn a_pid_holds_a_weight() {
    let rig = rig(&[("offset_n", 50.0), ("spring_n_per_m", 0.0), ("coulomb_slope_n_per_m", 0.0)]);
    let row = Row { reference_m: 0.001, ..STILL };
    let predicted = run(&rig, &Drive::Pid(PID), &vec![row; 20_000], 2);
    for held in &predicted[15_000..] {
        assert!((held.position_m - 0.001).abs() < 1e-6, "{held:?}");
        assert!((held.force_n - 50.0).abs() < 1.3 * 30.0 + 1e-9, "{held:?}");
    }
    let without = run(&rig, &Drive::Force, &vec![STILL; 1000], 2);
    assert!(last(&without).position_m < -0.1, "it falls by itself");
}

/// Gains other than kd at 0: F = kd d, and a filter that has seen the motion gives d = −v.
#[test]
fn a_pid_on_the_measurement_starts_with_the_velocity_it_has_seen() {
    let gains = Gains { kp_n_per_m: 0.0, ki_n_per_m_s: 0.0, kd_n_s_per_m: 200.0 };
    let pid = Pid { gains, derivative_of: DerivativeOf::Measurement, ..PID.pid };
    let row = Row { velocity_m_per_s: 0.1, reference_rate_m_per_s: 0.1, ..STILL };
    for velocity_from in [VelocityFrom::Sensor, VelocityFrom::PositionDifference] {
        let pid = Pid { velocity_from, ..pid };
        let drive = Drive::Pid(LimitedPid { pid, ..PID });
        let force = run(&rig(&[]), &drive, &[row], 1)[0].force_n;
        assert!((force + 200.0 * 0.1).abs() < 1e-9, "{force}");
    }
}

#[test]
fn a_pid_that_integrates_starts_with_the_force_it_gave() {
    let gains = Gains { kp_n_per_m: 100.0, ki_n_per_m_s: 50.0, kd_n_s_per_m: 2.0 };
    let drive = Drive::Pid(LimitedPid { pid: Pid { gains, ..PID.pid }, ..PID });
    let row = Row { force_n: 7.0, reference_m: 0.03, velocity_m_per_s: 0.1, ..STILL };
    let force = run(&rig(&[]), &drive, &[row], 1)[0].force_n;
    assert!((force - 7.0).abs() < 1e-12, "{force}");
}

/// At rest 20 mm out, where spring and offset take 50 · 0.02 + 4 = 5 N and the levels, 1.3 times those
/// of Coulomb, have risen by 1.3 · 2 N.
fn preloaded(force_n: f64) -> Row<f64> {
    Row { position_m: 0.02, force_n, held_force_n: force_n, ..STILL }
}

#[test]
fn a_rig_starts_in_balance_with_its_preload() {
    for elasto_plastic in [false, true] {
        let rig = Rig::from_numbers(&NUMBERS, elasto_plastic);
        for preload in [-20.0, 0.0, 5.0, 10.0, 30.0] {
            let row = preloaded(preload);
            let predicted = run(&rig, &Drive::Imposed, &[row], 4)[0];
            assert!((predicted.force_n - preload).abs() < 1e-13 * 30.0, "{predicted:?}");
            let held = last(&run(&rig, &Drive::Force, &[row; 1000], 4));
            assert!((held.position_m - 0.02).abs() < 1e-12, "it stays: {held:?}");
        }
    }
}

#[test]
fn a_rig_preloaded_beyond_the_level_starts_at_the_level() {
    let predicted = run(&rig(&[]), &Drive::Imposed, &[preloaded(500.0)], 4)[0];
    assert!((predicted.force_n - (1.3 * 22.0 + 5.0)).abs() < 1e-12, "{predicted:?}");
}

/// Pulled back it holds up to 1.3 · 32 N, more than it would forth.
#[test]
fn a_rig_at_rest_that_is_pulled_back_starts_within_the_level_of_that_direction() {
    for (preload, force) in [(-30.0, -30.0), (-500.0, -1.3 * 32.0 + 5.0)] {
        let predicted = run(&rig(&[]), &Drive::Imposed, &[preloaded(preload)], 4)[0];
        assert!((predicted.force_n - force).abs() < 1e-12, "{predicted:?} for {preload} N");
    }
}

/// A log in which the part sticks, slips and is driven back: motion, force and reference of a kind.
fn log() -> Vec<Row<f64>> {
    let (speed, omega, period) = (0.05, 4.0 * PI, 2e-3);
    let x = |t: f64| {
        let c = (omega * t).cos();
        speed / omega * (2.0 / 3.0 - c + c.powi(3) / 3.0) // of v = speed sin³
    };
    let row = |n| {
        let t = period * f64::from(n);
        let (s, c) = (omega * t).sin_cos();
        Row {
            position_m: x(t),
            velocity_m_per_s: speed * s.powi(3),
            acceleration_m_per_s2: 3.0 * speed * omega * s * s * c,
            force_n: 8.0,
            reference_m: 0.005 * (1.0 - c),
            reference_rate_m_per_s: 0.005 * omega * s,
            period_s: period,
            mean_velocity_m_per_s: (x(t + period) - x(t)) / period,
            held_force_n: -2.0 + 60.0 * s.powi(3),
            outside_force_n: 3.0 * c,
            time_s: t - 0.3,
        }
    };
    (0..300).map(row).collect()
}

const DRIVES: [Drive<f64>; 4] =
    [Drive::Imposed, Drive::Force, Drive::Cascade(CASCADE), Drive::Pid(PID)];

fn model<R: Real>(numbers: &[R; 16], drive: &Drive<f64>, elasto_plastic: bool) -> Vec<[R; 2]> {
    let rig = Rig::from_numbers(numbers, elasto_plastic);
    let predicted = run(&rig, drive, &log(), 3);
    predicted.iter().map(|p| [p.position_m, p.force_n]).collect()
}

#[test]
fn under_every_drive_the_part_sticks_slips_and_is_driven_back() {
    for drive in DRIVES {
        for elasto_plastic in [false, true] {
            let x: Vec<f64> =
                model(&NUMBERS, &drive, elasto_plastic).iter().map(|p| p[0]).collect();
            let rows = |wanted: &dyn Fn(f64) -> bool| {
                x.windows(2).filter(|pair| wanted((pair[1] - pair[0]) / 2e-3)).count()
            };
            let (stuck, forth, back) =
                (rows(&|v| v.abs() < 5e-4), rows(&|v| v > 0.01), rows(&|v| v < -0.01));
            assert!(stuck > 10 && forth > 30 && back > 30, "{drive:?}: {stuck} {forth} {back}");
        }
    }
}

/// Slopes of every row, scaled by the largest, agree within `bound`.
fn assert_agree(name: &str, ours: &[[f64; 2]], theirs: &[[f64; 2]], bound: f64) {
    for output in 0..2 {
        let size = ours.iter().fold(0.0, |size: f64, slopes| size.max(slopes[output].abs()));
        for (row, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
            let error = (ours[output] - theirs[output]).abs();
            assert!(error <= bound * size, "{name}, row {row}: {ours:?} {theirs:?} of {size}");
        }
    }
}

/// A rig whose force drifts, whose joint warms up, and with free travel.
const FAULTY: [f64; 16] =
    [5.0, 50.0, 20.0, 30.0, 40.0, 60.0, 1.3, 0.01, 1e6, 300.0, 100.0, 0.6, 2.0, -0.2, 3e-5, 4.0];

#[test]
fn duals_complex_steps_and_differences_give_the_same_slopes() {
    for drive in DRIVES {
        for elasto_plastic in [false, true] {
            let variables = std::array::from_fn(|i| Dual::<f64, 16>::variable(FAULTY[i], i));
            let dual = model(&variables, &drive, elasto_plastic);
            let plain = model(&FAULTY, &drive, elasto_plastic);
            for (dual, plain) in dual.iter().zip(&plain) {
                assert_eq!(&dual.map(|d| d.value), plain);
            }
            for (i, name) in RIG_NUMBERS.into_iter().enumerate() {
                let ours: Vec<_> = dual.iter().map(|row| row.map(|d| d.derivative[i])).collect();
                let name = format!("{name}, {elasto_plastic}, {drive:?}");

                let mut numbers = FAULTY.map(Complex::constant);
                numbers[i] = Complex::variable(FAULTY[i]);
                let complex = model(&numbers, &drive, elasto_plastic);
                assert!(complex.iter().zip(&plain).all(|(c, p)| &c.map(|c| c.re) == p));
                let theirs: Vec<_> = complex.iter().map(|row| row.map(Complex::slope)).collect();
                assert_agree(&name, &ours, &theirs, 1e-12);

                let h = 1e-5 * FAULTY[i];
                let moved = |by: f64| {
                    let mut numbers = FAULTY;
                    numbers[i] += by;
                    model(&numbers, &drive, elasto_plastic)
                };
                let (above, below) = (moved(h), moved(-h));
                let slope = |k: usize| [0, 1].map(|o| (above[k][o] - below[k][o]) / (2.0 * h));
                let theirs: Vec<_> = (0..above.len()).map(slope).collect();
                assert_agree(&name, &ours, &theirs, 1e-5);
            }
        }
    }
}

/// The elastic share is no number of LuGre, and where motion is imposed none moves the part.
#[test]
fn every_number_that_counts_has_a_slope() {
    for drive in DRIVES {
        for elasto_plastic in [false, true] {
            let variables = std::array::from_fn(|i| Dual::<f64, 16>::variable(FAULTY[i], i));
            let dual = model(&variables, &drive, elasto_plastic);
            for (i, name) in RIG_NUMBERS.into_iter().enumerate() {
                let moves = |output: usize| dual.iter().any(|row| row[output].derivative[i] != 0.0);
                let counts = elasto_plastic || name != "elastic_share";
                assert_eq!(moves(0), counts && drive != Drive::Imposed, "{name}, {drive:?}");
                assert_eq!(moves(1), counts && drive != Drive::Force, "{name}, {drive:?}");
            }
        }
    }
}
