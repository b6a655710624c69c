//! Wall time of the paper's loop: one run, and 32 runs in lanes.

use breakaway_batch::{Job, Lanes, run};
use breakaway_core::control::Controller;
use breakaway_core::metrics::Limits;
use breakaway_core::test_models::{paper_as_computed, paper_limits};
use breakaway_core::{Draws, ExtractionState, Metrics, Real};
use std::convert::Infallible;
use std::hint::black_box;

fn main() {
    divan::main();
}

/// 0.5 simulated seconds at 100 kHz.
const SAMPLES: u64 = 50_000;

#[divan::bench]
fn single_run() -> f64 {
    let job = Job {
        extraction: black_box(paper_as_computed()),
        limits: paper_limits(),
        samples: SAMPLES,
        seed: 0,
        run: 0,
        trace_every: 0,
    };
    let Ok(result) = run::<Infallible>(&job, || Ok(()));
    result.metrics.iae_m_s
}

#[divan::bench]
fn lanes_of_32_runs() -> f64 {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        // SAFETY: the processor was just asked for both features.
        return unsafe { lanes_with_fma() };
    }
    lanes_loop()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn lanes_with_fma() -> f64 {
    lanes_loop()
}

#[inline(always)]
fn lanes_loop() -> f64 {
    let extraction = black_box(paper_as_computed()).map(&mut |_, x| Lanes([x; 32]));
    let limits: Limits<Lanes<32>> = paper_limits().map(&mut |_, x| Lanes([x; 32]));
    let mut state = ExtractionState::at_rest();
    let mut metrics = Metrics::new();
    let draws = Draws { disturbance: Lanes([0.0; 32]) };
    for _ in 0..SAMPLES {
        let sample = extraction.step(&mut state, draws);
        metrics.update(&limits, &sample);
    }
    metrics.iae_m_s.0[0]
}

/// The same loop reduced by hand to its bare equations: fixed kinds, no blocks, one index. What
/// `single_run` takes beyond this is the price of generality.
#[divan::bench]
fn bare_equations_by_hand() -> f64 {
    let Controller::Pid(pid) = paper_as_computed().controller else {
        unreachable!("the paper's loop is controlled by a PID")
    };
    bare(black_box([pid.gains.kp_n_per_m, pid.gains.ki_n_per_m_s, pid.gains.kd_n_s_per_m]))
}

fn bare(gains: [f64; 3]) -> f64 {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        // SAFETY: the processor was just asked for both features.
        return unsafe { bare_with_fma(gains) };
    }
    bare_loop(gains)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn bare_with_fma(gains: [f64; 3]) -> f64 {
    bare_loop(gains)
}

#[inline(always)]
fn bare_loop([kp, ki, kd]: [f64; 3]) -> f64 {
    let (k_e, c, v_s, l_f, h) = (3.6e7, 9000.0, 0.09, 0.1, 1e-5);
    let (f_s0, f_c0, f_end, m) = (450.0, 360.0, 9.81, 1.0);
    let k: f64 = 0.5 * h;
    let q = k / m;
    let (slope_s, slope_c) = ((f_end - f_s0) / l_f, (f_end - f_c0) / l_f);
    let per_level = 1.0 + q * (c + k * k_e);
    let (mut x, mut v, mut z, mut joint_force) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    let (mut integral, mut iae) = (0.0_f64, 0.0_f64);
    for n in 0..SAMPLES {
        let tau = (n as f64 * h * 2.0).clamp(0.0, 1.0);
        let r = 0.1 * (tau * tau * tau * tau.mul_add(6.0_f64.mul_add(tau, -15.0), 10.0));
        let rate = 6.0 * (tau * tau) * ((1.0 - tau) * (1.0 - tau));
        let e = r - x;
        iae += e.abs() * h;
        integral = (ki * h).mul_add(e, integral);
        let force = kp.mul_add(e, kd * (rate - v)) + integral;
        let x_mid = k.mul_add(v, x);
        let w = q.mul_add(force, v);
        let v_predicted = q.mul_add(force, (-q).mul_add(joint_force, v));
        let ratio = v_predicted * (core::f64::consts::LOG2_E.sqrt() / v_s);
        let f_c = slope_c.mul_add(x_mid, f_c0);
        let f_s = slope_s.mul_add(x_mid, f_s0);
        let (fraction, power) = (-(ratio * ratio)).exp2_parts();
        let g = fraction.mul_add((f_s - f_c) * power, f_c);
        let a = k_e * v_predicted.abs();
        let two_over_den = 2.0 / g.mul_add(per_level, a * k);
        let driven = g.mul_add((q * k_e).mul_add(-z, w), a * k.mul_add(w, q * c * z));
        let two_z = g * q.mul_add(c, 1.0).mul_add(z, k * w) * two_over_den;
        joint_force = (0.5 * (k_e + c / k)).mul_add(two_z, -(c / k * z));
        x = (k * driven).mul_add(two_over_den, x);
        v = driven.mul_add(two_over_den, -v);
        z = two_z - z;
    }
    iae
}
