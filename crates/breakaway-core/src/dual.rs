//! Numbers that carry exact first derivatives.

// Indexed loops are inlined and unrolled within any caller's instruction set; closures are not.
#![allow(clippy::needless_range_loop)]

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::Real;

/// A value and its derivatives with respect to `P` parameters (forward-mode differentiation).
///
/// The value goes through the very operations of `R`, so the value part of a run is bit-identical
/// to the plain run, and `R` may itself be lanes: 32 gradients at once. `num-dual` offers neither
/// (its elementary functions are the platform's, its scalars are floats); see `docs/adr/0003`.
///
/// Comparisons look at values only. At a `select` the derivative is that of the chosen side.
///
/// # Example
/// ```
/// use breakaway_core::{Dual, Real};
/// let x = Dual::<f64, 1>::variable(0.5, 0);
/// let y = (-(x * x)).exp();
/// assert!((y.derivative[0] - -(-0.25_f64).exp()).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<R, const P: usize> {
    /// The value.
    pub value: R,
    /// Its derivative with respect to each parameter.
    pub derivative: [R; P],
}

impl<R: Real, const P: usize> Dual<R, P> {
    /// The parameter number `index`, whose derivative with respect to itself is one.
    ///
    /// # Panics
    /// If `index` is not below `P`.
    #[must_use]
    pub fn variable(value: R, index: usize) -> Self {
        let mut derivative = [R::zero(); P];
        derivative[index] = R::one();
        Self { value, derivative }
    }

    #[inline(always)]
    fn chain(self, value: R, slope: R) -> Self {
        let mut out = Self { value, derivative: self.derivative };
        for i in 0..P {
            out.derivative[i] = self.derivative[i] * slope;
        }
        out
    }
}

/// An operator with its value, its preparation and its derivative at each place.
macro_rules! operator {
    ($trait:ident, $method:ident, |$a:ident, $b:ident| $value:expr, $with:expr, |$da:ident, $db:ident, $shared:ident| $slope:expr) => {
        impl<R: Real, const P: usize> $trait for Dual<R, P> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let ($a, $b) = (self.value, other.value);
                let $shared = $with;
                let mut out = Self { value: $value, derivative: self.derivative };
                for i in 0..P {
                    let ($da, $db) = (self.derivative[i], other.derivative[i]);
                    out.derivative[i] = $slope;
                }
                out
            }
        }
    };
}

operator!(Add, add, |a, b| a + b, (), |da, db, _none| da + db);
operator!(Sub, sub, |a, b| a - b, (), |da, db, _none| da - db);
operator!(Mul, mul, |a, b| a * b, (a, b), |da, db, values| da.mul_add(values.1, values.0 * db));
operator!(Div, div, |a, b| a / b, (a / b, R::one() / b), |da, db, quotient| (da - quotient.0 * db)
    * quotient.1);

impl<R: Real, const P: usize> Neg for Dual<R, P> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let mut out = Self { value: -self.value, derivative: self.derivative };
        for i in 0..P {
            out.derivative[i] = -self.derivative[i];
        }
        out
    }
}

impl<R: Real, const P: usize> Real for Dual<R, P> {
    type Mask = R::Mask;
    const ROUND: f64 = R::ROUND;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { value: R::constant(value), derivative: [R::zero(); P] }
    }
    #[inline(always)]
    fn known(holds: bool) -> R::Mask {
        R::known(holds)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> R::Mask {
        self.value.lt(other.value)
    }
    #[inline(always)]
    fn le(self, other: Self) -> R::Mask {
        self.value.le(other.value)
    }
    #[inline(always)]
    fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        let mut out = Self { value: R::select(mask, yes.value, no.value), ..no };
        for i in 0..P {
            out.derivative[i] = R::select(mask, yes.derivative[i], no.derivative[i]);
        }
        out
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let slope = R::select(self.value.lt(R::zero()), -R::one(), R::one());
        self.chain(self.value.abs(), slope)
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let mut out = Self {
            value: self.value.mul_add(factor.value, addend.value),
            derivative: addend.derivative,
        };
        for i in 0..P {
            let inner = self.value.mul_add(factor.derivative[i], addend.derivative[i]);
            out.derivative[i] = self.derivative[i].mul_add(factor.value, inner);
        }
        out
    }
    /// Its slope is zero where it has one.
    #[inline(always)]
    fn round(self) -> Self {
        Self { value: self.value.round(), derivative: [R::zero(); P] }
    }
    #[inline(always)]
    fn exp2_parts(self) -> (Self, Self) {
        let (fraction, power) = self.value.exp2_parts();
        let slope = fraction * R::constant(core::f64::consts::LN_2);
        (self.chain(fraction, slope), Self { value: power, derivative: [R::zero(); P] })
    }
}

#[cfg(test)]
mod tests {
    use super::Dual;
    use crate::real::Real;

    /// Every operation at once; the derivative is checked against a central difference.
    fn all_operations<R: Real>(x: R, y: R) -> R {
        let smooth = (x * y - x / y + (-(x * x)).exp()) * R::constant(3.0);
        smooth.abs().mul_add(y, x)
            + R::select(x.lt(y), x * x, y)
            + x.sign() * y.clamp(-x.abs(), x.abs())
    }

    #[test]
    fn derivatives_agree_with_central_differences() {
        for (x, y) in [(0.7, 1.3), (-0.4, 0.2), (1.9, -2.5), (0.3, 0.1)] {
            let d = all_operations(Dual::<f64, 2>::variable(x, 0), Dual::variable(y, 1));
            let h = 1e-6;
            let dx = (all_operations(x + h, y) - all_operations(x - h, y)) / (2.0 * h);
            let dy = (all_operations(x, y + h) - all_operations(x, y - h)) / (2.0 * h);
            assert_eq!(d.value, all_operations(x, y));
            assert!((d.derivative[0] - dx).abs() < 1e-8 * (1.0 + dx.abs()), "{x} {y}");
            assert!((d.derivative[1] - dy).abs() < 1e-8 * (1.0 + dy.abs()), "{x} {y}");
        }
    }
}
