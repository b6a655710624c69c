//! Sensors: what they do to a value, in which order, and that an ideal one does nothing.

use breakaway_core::control::{Controller, VelocityFrom};
use breakaway_core::sensor::{DELAY_MAX, Noise, Sensor, SensorState, Sensors};
use breakaway_core::test_models::paper_as_computed;
use breakaway_core::{Draws, Extraction, ExtractionState, Maybe};
use std::f64::consts::PI;

fn ideal() -> Sensor<f64> {
    Sensor { noise_rms: 0.0, quantum: Maybe::none(), bandwidth_hz: Maybe::none(), delay_samples: 0 }
}
const PERIOD_S: f64 = 1e-5;

fn reads(sensor: &Sensor<f64>, values: impl IntoIterator<Item = (f64, f64)>) -> Vec<f64> {
    let mut state = SensorState::at_rest();
    values.into_iter().map(|(value, w)| sensor.read(&mut state, value, w, PERIOD_S)).collect()
}

#[test]
fn an_ideal_sensor_shows_what_is() {
    for value in [0.0, -0.0, 1e-12, 0.1, -7.5e300, f64::INFINITY] {
        let shown = reads(&ideal(), [(value, 0.7)])[0];
        assert_eq!(shown.to_bits(), (value + 0.0).to_bits(), "{value}");
    }
    assert!(reads(&ideal(), [(f64::NAN, 0.0)])[0].is_nan());
}

/// Whatever the draws: with ideal sensors the loop has the bits that it has without any.
#[test]
fn a_loop_with_ideal_sensors_is_the_loop_without() {
    let mut without = paper_as_computed();
    let Controller::Pid(pid) = &mut without.controller else { unreachable!() };
    pid.velocity_from = VelocityFrom::PositionDifference;
    let with =
        Extraction { sensors: Some(Sensors { position: ideal(), force: ideal() }), ..without };
    let (mut a, mut b) = (ExtractionState::at_rest(), ExtractionState::at_rest());
    for n in 0..50_000 {
        let w = f64::from(n % 7) - 3.0;
        let draws = Draws { disturbance: 0.0, noise: Noise { position: w, force: -w } };
        assert_eq!(without.step(&mut a, draws), with.step(&mut b, draws), "sample {n}");
    }
    assert!(a.plant.position_m > 0.09 && a.plant == b.plant && a.controller == b.controller);
}

#[test]
fn noise_is_the_draw_times_its_deviation() {
    let noisy = Sensor { noise_rms: 2e-6, ..ideal() };
    let shown = reads(&noisy, [(1e-3, 1.5), (1e-3, -0.25), (1e-3, 0.0)]);
    for (ours, expected) in shown.iter().zip([1e-3 + 3e-6, 1e-3 - 5e-7, 1e-3]) {
        assert!((ours - expected).abs() < 1e-18, "{ours}");
    }
}

#[test]
fn steps_are_whole_and_nearest() {
    let stepped = Sensor { quantum: Maybe::some(0.5), ..ideal() };
    let shown = reads(&stepped, [(0.2, 0.0), (0.26, 0.0), (-0.8, 0.0), (1e6 + 0.3, 0.0)]);
    assert_eq!(shown, [0.0, 0.5, -1.0, 1e6 + 0.5]);
    // Noise comes before the steps: half a step of it moves the reading by one.
    let both = Sensor { noise_rms: 0.5, ..stepped };
    assert_eq!(reads(&both, [(0.2, 0.2), (0.2, -1.0)]), [0.5, -0.5]);
    // A uniform input errs by q/√12 rms.
    let fine = Sensor { quantum: Maybe::some(1e-6), ..ideal() };
    let values: Vec<f64> = (0..100_000).map(|n| f64::from(n) * 3.7e-9).collect();
    let shown = reads(&fine, values.iter().map(|&x| (x, 0.0)));
    let square: f64 = shown.iter().zip(&values).map(|(s, x)| (s - x).powi(2)).sum();
    let rms = (square / 1e5).sqrt();
    assert!((rms / (1e-6 / 12.0_f64.sqrt()) - 1.0).abs() < 5e-3, "{rms:e}");
}

/// A step: 1 − e^(−2π f t), the newest sample counted; a sine at the corner: 3 dB down.
#[test]
fn a_slow_sensor_is_a_first_order_low_pass() {
    let slow = Sensor { bandwidth_hz: Maybe::some(300.0), ..ideal() };
    let shown = reads(&slow, (0..2000).map(|_| (1.0, 0.0)));
    for (n, ours) in shown.iter().enumerate() {
        let t = (n + 1) as f64 * PERIOD_S;
        assert!((ours - (1.0 - (-2.0 * PI * 300.0 * t).exp())).abs() < 1e-12, "{n}");
    }
    let phase = |n: u32| 2.0 * PI * 300.0 * f64::from(n) * PERIOD_S;
    let shown = reads(&slow, (0..100_000).map(|n| (phase(n).sin(), 0.0)));
    let (mut sine, mut cosine) = (0.0, 0.0);
    for n in 50_000..100_000_u32 {
        sine += shown[n as usize] * phase(n).sin() / 25_000.0;
        cosine += shown[n as usize] * phase(n).cos() / 25_000.0;
    }
    let gain_db = 10.0 * (sine * sine + cosine * cosine).log10();
    // Found: off by 1.3e-4 dB, the price of sampling.
    assert!((gain_db + 10.0 * 2.0_f64.log10()).abs() < 3e-4, "{gain_db} dB");
    // Noise is behind the low-pass: it stays white.
    let noisy = Sensor { noise_rms: 1.0, ..slow };
    let shown = reads(&noisy, [(0.0, 1.0), (0.0, -1.0), (0.0, 1.0)]);
    assert_eq!(shown, [1.0, -1.0, 1.0]);
}

#[test]
fn a_late_sensor_shows_what_was() {
    for delay in 0..=DELAY_MAX as u32 {
        let late = Sensor { delay_samples: delay, ..ideal() };
        let shown = reads(&late, (1..=50).map(|n| (f64::from(n), 0.0)));
        for (n, ours) in (1..=50_u32).zip(shown) {
            assert_eq!(ours, f64::from(n.saturating_sub(delay)), "{delay} late at {n}");
        }
    }
}
