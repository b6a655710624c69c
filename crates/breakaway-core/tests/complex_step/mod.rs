//! Derivatives without duals: with an imaginary part too small to disturb the real one, the
//! imaginary part of the result is the derivative times it, f(x + i h) = f(x) + i h f'(x).
//! Source: W. Squire, G. Trapp, "Using Complex Variables to Estimate Derivatives of Real Functions",
//! SIAM Review 40(1), 1998.

use std::f64::consts::LN_2;
use std::ops::{Add, Div, Mul, Neg, Sub};

use breakaway_core::Real;

/// h: its square is lost beside any number of a run.
const STEP: f64 = 1e-30;

/// A complex number whose conditions look at its real part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Complex {
    pub(crate) re: f64,
    im: f64,
}

impl Complex {
    /// The number that derivatives are taken with respect to.
    pub(crate) fn variable(value: f64) -> Self {
        Self { re: value, im: STEP }
    }

    /// The derivative.
    pub(crate) fn slope(self) -> f64 {
        self.im / STEP
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let re = self.re * other.re - self.im * other.im;
        Self { re, im: self.re * other.im + self.im * other.re }
    }
}

impl Div for Complex {
    type Output = Self;
    /// Smith's way, for divisors whose real part is the larger one.
    fn div(self, other: Self) -> Self {
        let ratio = other.im / other.re;
        let scale = other.re + other.im * ratio;
        Self { re: (self.re + self.im * ratio) / scale, im: (self.im - self.re * ratio) / scale }
    }
}

impl Neg for Complex {
    type Output = Self;
    fn neg(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }
}

impl Real for Complex {
    type Mask = bool;

    fn constant(value: f64) -> Self {
        Self { re: value, im: 0.0 }
    }
    fn lt(self, other: Self) -> bool {
        self.re < other.re
    }
    fn le(self, other: Self) -> bool {
        self.re <= other.re
    }
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    fn abs(self) -> Self {
        if self.re < 0.0 { -self } else { self }
    }
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let re = self.re.mul_add(factor.re, addend.re - self.im * factor.im);
        Self { re, im: self.re * factor.im + self.im * factor.re + addend.im }
    }
    /// 2^(a + i b) = 2^a (cos(b ln 2) + i sin(b ln 2)).
    fn exp2_parts(self) -> (Self, Self) {
        let (fraction, power) = Real::exp2_parts(self.re);
        let (sin, cos) = (self.im * LN_2).sin_cos();
        (Self { re: fraction * cos, im: fraction * sin }, Self::constant(power))
    }
}
