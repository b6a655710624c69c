//! `f64` and `f32` as numbers of the equations.

use crate::real::{Function, Real};
use crate::{exp2, fused};

/// A function of its own: in place it would be many times as long as what surrounds it.
#[cold]
#[inline(never)]
fn fresh<R: Real, F: Function<K, N>, const K: usize, const N: usize>(from: [R; K]) -> [R; N] {
    F::of(from)
}

macro_rules! impl_real {
    ($float:ty, $round:expr, $exp2:expr, $fma:path) => {
        impl Real for $float {
            type Mask = bool;
            const ROUND: f64 = $round;

            #[inline(always)]
            fn constant(value: f64) -> Self {
                value as $float
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
            #[inline(always)]
            fn renewed<F: Function<K, N>, const K: usize, const N: usize>(
                needed: bool,
                kept: [Self; N],
                from: [Self; K],
            ) -> [Self; N] {
                if needed { fresh::<Self, F, K, N>(from) } else { kept }
            }
            #[inline(always)]
            fn known(holds: bool) -> bool {
                holds
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                $fma(self, factor, addend)
            }
            #[inline(always)]
            fn exp2_parts(self) -> (Self, Self) {
                $exp2(self)
            }
        }
    };
}

impl_real!(f64, 6_755_399_441_055_744.0, exp2::exp2_f64, fused::fma_f64);
impl_real!(f32, 12_582_912.0, exp2::exp2_f32, fused::fma_f32);

#[cfg(test)]
mod tests {
    use crate::real::Real;

    #[test]
    fn sign_of_zeros_and_signs() {
        assert_eq!(Real::sign(-0.0_f64), 0.0);
        assert_eq!(Real::sign(-2.0_f64), -1.0);
        assert_eq!(Real::sign(1e-300_f64), 1.0);
    }

    #[test]
    fn rounding_goes_to_the_nearest() {
        for (value, whole) in [(0.49, 0.0), (-2.6, -3.0), (7.5, 8.0), (8.5, 8.0), (1e6, 1e6)] {
            assert_eq!(Real::round(value), whole);
            assert_eq!(Real::round(value as f32), whole as f32);
        }
    }

    #[test]
    fn comparisons_with_nan_are_false() {
        assert!(!Real::lt(f64::NAN, 1.0) && !Real::le(1.0, f64::NAN));
        assert_eq!(Real::clamp(f64::NAN, -1.0, 1.0), -1.0);
    }
}
