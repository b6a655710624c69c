//! The paper's loop stripped by hand to its bare equations: the yardstick of `make bench`.
//!
//! No blocks, no kinds, no options: LuGre friction without viscosity, a PID, an ideal actuator, one
//! shared reference, no disturbance, no bounds, no release, one index. Every coefficient that does
//! not change is computed beforehand. What the batch takes beyond this is the price of generality.

use std::f64::consts::LOG2_E;

use breakaway_core::Extraction;
use breakaway_core::control::Controller;
use breakaway_core::joint::Joint;
use breakaway_core::test_models::paper_as_computed;

use crate::instructions::{Instructions, Kernel};
use crate::lanes::Wide;

/// The mean IAE in m s of the paper's loop over `samples` control periods, in all lanes at once.
#[must_use]
pub fn iae_by_hand(instructions: Instructions, samples: u64) -> f64 {
    instructions.run(Yardstick { samples })
}

/// The same for one run, in m s.
#[must_use]
pub fn iae_of_one_by_hand(samples: u64) -> f64 {
    #[cfg(target_arch = "x86_64")]
    if crate::lanes::avx2::available() {
        // SAFETY: the processor was just asked for both features.
        #[allow(unsafe_code)]
        return unsafe { one_with_fma(samples) };
    }
    bare(&std::hint::black_box(paper_as_computed()), samples)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
#[allow(unsafe_code)]
unsafe fn one_with_fma(samples: u64) -> f64 {
    bare(&std::hint::black_box(paper_as_computed()), samples)
}

struct Yardstick {
    samples: u64,
}

impl Kernel for Yardstick {
    type Output = f64;

    #[inline(always)]
    fn run<V: Wide, const N: usize>(self) -> f64 {
        // The optimizer may know neither the numbers nor that lanes share them.
        let e: Extraction<V> =
            std::hint::black_box(paper_as_computed().map(&mut |_, value| V::constant(value)));
        let iae = bare(&e, self.samples);
        (0..N).map(|lane| iae.extract(lane)).sum::<f64>() / N as f64
    }
}

#[inline(always)]
fn bare<V: Wide>(e: &Extraction<V>, samples: u64) -> V {
    let (Joint::Lugre(joint), Controller::Pid(pid)) = (e.joint, e.controller) else {
        unreachable!("the paper's loop is LuGre friction under a PID")
    };
    let (one, two, zero) = (V::one(), V::constant(2.0), V::zero());
    let (k_e, c, v_s) =
        (joint.stiffness_n_per_m, joint.damping_n_s_per_m, joint.stribeck_velocity_m_per_s);
    let (f_s, f_c, f_end) = (joint.stiction_n, joint.coulomb_n, joint.residual_n);
    let l_f = joint.engagement_length_m;
    let h = e.timing.control_period_s;
    let k = V::constant(0.5) * h;
    let q = k / e.part.mass_kg;
    let (slope, peak, peak_slope) = ((f_end - f_c) / l_f, f_s - f_c, (f_c - f_s) / l_f);
    let c_k = c / k;
    let per_level = one + q * k * (k_e + c_k);
    let sharpness = -V::constant(LOG2_E) / (v_s * v_s);
    let (q_k_e, q_c_k, k_k_e, half_q) = (q * k_e, q * c_k, k * k_e, V::constant(0.5) / q);
    let per_force = one / (k_e + c_k);
    let (z_kept, z_lost) = (two * per_force * c_k - one, per_force / q);
    let (kp, ki_h, kd) = (pid.gains.kp_n_per_m, pid.gains.ki_n_per_m_s * h, pid.gains.kd_n_s_per_m);
    let h_shared = h.extract(0);
    let (mut x, mut v, mut z, mut r, mut integral, mut iae) = (zero, zero, zero, zero, zero, zero);
    for n in 0..samples {
        let tau = (n as f64 * h_shared * 2.0).clamp(0.0, 1.0);
        let (tau2, rest) = (tau * tau, 1.0 - tau);
        let reference = 0.1 * (tau2 * tau * tau.mul_add(6.0_f64.mul_add(tau, -15.0), 10.0));
        let rate = V::constant(6.0 * tau2 * (rest * rest));
        let error = V::constant(reference) - x;
        iae = error.abs().mul_add(h, iae);
        integral = ki_h.mul_add(error, integral);
        let force = kd.mul_add(rate - v, kp.mul_add(error, integral));
        let x_mid = k.mul_add(v, x);
        let w = q.mul_add(force, v);
        let ahead = (-q).mul_add(r, w);
        let (fraction, power) = (ahead * ahead * sharpness).exp2_parts();
        let level = slope.mul_add(x_mid, f_c);
        let g = fraction.mul_add(peak_slope.mul_add(x_mid, peak) * power, level);
        let a = k_k_e * ahead.abs();
        let inverse = two / g.mul_add(per_level, a);
        let two_v = g.mul_add((-q_k_e).mul_add(z, w), a * q_c_k.mul_add(z, w)) * inverse;
        let lost = w + w - two_v;
        r = lost * half_q;
        x = k.mul_add(two_v, x);
        v = two_v - v;
        z = z_lost.mul_add(lost, z_kept * z);
    }
    iae
}

#[cfg(test)]
mod tests {
    use super::{iae_by_hand, iae_of_one_by_hand};
    use crate::{Instructions, Job, run};
    use breakaway_core::test_models::{paper_as_computed, paper_limits};
    use std::convert::Infallible;

    /// Other roundings, and no limits: the loop by hand differs in the last digits only.
    #[test]
    fn the_loop_by_hand_does_the_same_work() {
        let (extraction, limits, samples) = (paper_as_computed(), paper_limits(), 50_000);
        let job = Job { extraction, limits, samples, seed: 0, run: 0, trace_every: 0 };
        let Ok(ours) = run::<Infallible>(&job, || Ok(()));
        let same = |by_hand: f64| (by_hand / ours.metrics.iae_m_s - 1.0).abs() < 1e-9;
        assert!(same(iae_of_one_by_hand(samples)), "{}", iae_of_one_by_hand(samples));
        for with in Instructions::available() {
            assert!(same(iae_by_hand(with, samples)), "{}", iae_by_hand(with, samples));
        }
    }
}
