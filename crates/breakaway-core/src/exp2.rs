//! Powers of two, from plus, times, fused multiply-add and one shift, so that every target agrees on them.
//!
//! 2ʸ = 2ᶠ 2ⁿ with n = round(y) and |f| ≤ ½. Adding 1.5·2⁵² to y rounds it and leaves n in the low
//! bits, from where a shift puts it into the exponent field: no conversion to an integer, no table,
//! no branch; and f = y − n is exact. 2ᶠ and 2ⁿ are given apart and n is limited only on its way to
//! 2ⁿ, beside the polynomial, because the length of the dependency chain decides the speed.
//! The polynomials are Chebyshev fits of degree 10 (`f64`, relative error 2.2e-16) and 6 (`f32`,
//! 2e-9), summed by Estrin's scheme for the same reason.

use crate::real::Real;

/// [`Real::exp2_parts`] for a number, or several side by side, of double precision. What differs
/// between them is `shift`: the bits of the number moved left by 52.
#[inline(always)]
pub fn exp2_parts_in_double<R: Real>(y: R, shift: impl Fn(R) -> R) -> (R, R) {
    const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5·2⁵²
    let c = |i: usize| R::constant(C64[i]);
    let n = (y + R::constant(ROUND)) - R::constant(ROUND);
    let f = y - n;
    let f2 = f * f;
    let f4 = f2 * f2;
    let p01 = c(0).mul_add(f, R::one());
    let p23 = c(2).mul_add(f, c(1));
    let p45 = c(4).mul_add(f, c(3));
    let p67 = c(6).mul_add(f, c(5));
    let p89 = c(8).mul_add(f, c(7));
    let p0123 = p23.mul_add(f2, p01);
    let p4567 = p67.mul_add(f2, p45);
    let p8910 = c(9).mul_add(f2, p89);
    let p = p8910.mul_add(f4, p4567).mul_add(f4, p0123);
    let limited = n.clamp(R::constant(-1022.0), R::constant(1023.0));
    (p, shift(limited + R::constant(ROUND + 1023.0)))
}

// The first coefficient is fitted too, and is not exactly ln 2.
#[allow(clippy::approx_constant)]
const C64: [f64; 10] = [
    0.69314718055995,
    0.24022650695910097,
    0.05550410866444772,
    0.009618129107606888,
    0.0013333558230164974,
    0.0001540353044173605,
    1.5252657260200837e-05,
    1.321544258792169e-06,
    1.0208690299958306e-07,
    7.072585949269223e-09,
];

#[inline(always)]
pub(crate) fn exp2_f64(y: f64) -> (f64, f64) {
    exp2_parts_in_double(y, |n| f64::from_bits(n.to_bits() << 52))
}

/// [`Real::exp2_parts`] for a number of single precision. What differs between them is `shift`: the
/// bits of the number moved left by 23.
#[inline(always)]
pub fn exp2_parts_in_single<R: Real>(y: R, shift: impl Fn(R) -> R) -> (R, R) {
    const ROUND: f64 = 12_582_912.0; // 1.5·2²³
    let c = |i: usize| R::constant(f64::from(C32[i]));
    let n = (y + R::constant(ROUND)) - R::constant(ROUND);
    let f = y - n;
    let f2 = f * f;
    let p01 = c(0).mul_add(f, R::one());
    let p23 = c(2).mul_add(f, c(1));
    let p45 = c(4).mul_add(f, c(3));
    let p456 = c(5).mul_add(f2, p45);
    let p = p456.mul_add(f2, p23).mul_add(f2, p01);
    let limited = n.clamp(R::constant(-126.0), R::constant(127.0));
    (p, shift(limited + R::constant(ROUND + 127.0)))
}

#[inline(always)]
pub(crate) fn exp2_f32(y: f32) -> (f32, f32) {
    exp2_parts_in_single(y, |n| f32::from_bits(n.to_bits() << 23))
}

#[allow(clippy::approx_constant)]
const C32: [f32; 6] = [0.6931472, 0.2402265, 0.05550327, 0.009618057, 0.0013400428, 0.00015461445];

#[cfg(test)]
mod tests {
    extern crate std;
    fn exp2_f64(y: f64) -> f64 {
        let (fraction, power) = crate::Real::exp2_parts(y);
        fraction * power
    }

    fn exp2_f32(y: f32) -> f32 {
        let (fraction, power) = crate::Real::exp2_parts(y);
        fraction * power
    }

    #[test]
    fn f64_agrees_with_the_platform() {
        let mut worst = 0.0_f64;
        for i in -1_021_500..=1_023_400 {
            let y = f64::from(i) * 1e-3;
            worst = worst.max((exp2_f64(y) / y.exp2() - 1.0).abs());
        }
        assert!(worst < 6e-16, "relative error {worst:e}");
    }

    #[test]
    fn f32_agrees_with_the_platform() {
        let mut worst = 0.0_f64;
        for i in -125_500..=127_400 {
            let y = i as f32 * 1e-3;
            worst = worst.max((f64::from(exp2_f32(y)) / f64::from(y).exp2() - 1.0).abs());
        }
        assert!(worst < 3e-7, "relative error {worst:e}");
    }

    #[test]
    fn special_values() {
        assert_eq!((exp2_f64(0.0), exp2_f64(-3.0), exp2_f64(10.0)), (1.0, 0.125, 1024.0));
        for tiny in [-1e4, -1e15] {
            assert!(exp2_f64(tiny) > 0.0 && exp2_f64(tiny) < 1e-307);
            assert!(exp2_f64(-tiny).is_finite() && exp2_f64(-tiny) > 1e307);
        }
        assert!(exp2_f64(f64::NAN).is_nan() && exp2_f32(f32::NAN).is_nan());
    }
}
