//! Four numbers in one register of 256 bits.
//!
//! # Safety
//! Every function here needs a processor with [`available`] instructions, and a caller that is
//! compiled for them, into which it is inlined. Only `crate::instructions` makes these numbers, behind that
//! question.

#![allow(unsafe_code)]

use core::arch::x86_64::{
    __m256d, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_add_pd, _mm256_and_pd, _mm256_andnot_pd,
    _mm256_blendv_pd, _mm256_castpd_si256, _mm256_castsi256_pd, _mm256_cmp_pd, _mm256_div_pd,
    _mm256_fmadd_pd, _mm256_loadu_pd, _mm256_max_pd, _mm256_min_pd, _mm256_movemask_pd,
    _mm256_mul_pd, _mm256_or_pd, _mm256_set1_epi64x, _mm256_set1_pd, _mm256_slli_epi64,
    _mm256_storeu_pd, _mm256_sub_pd, _mm256_xor_pd,
};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use breakaway_core::Real;
use breakaway_core::exp2::exp2_parts_in_double;
use breakaway_core::real::{Block, Function};

use super::Wide;

/// Whether this processor has the instructions.
pub(crate) fn available() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

/// Four numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Four(__m256d);

/// Four conditions, each all bits or none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FourMask(__m256d);

macro_rules! operator {
    ($type:ident, $trait:ident, $method:ident, $instruction:ident) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}

operator!(Four, Add, add, _mm256_add_pd);
operator!(Four, Sub, sub, _mm256_sub_pd);
operator!(Four, Mul, mul, _mm256_mul_pd);
operator!(Four, Div, div, _mm256_div_pd);
operator!(FourMask, BitAnd, bitand, _mm256_and_pd);
operator!(FourMask, BitOr, bitor, _mm256_or_pd);

impl Neg for Four {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

impl Not for FourMask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        let all = unsafe { _mm256_castsi256_pd(_mm256_set1_epi64x(-1)) };
        Self(unsafe { _mm256_xor_pd(self.0, all) })
    }
}

/// A block as a function that may use the instructions.
#[target_feature(enable = "avx2,fma")]
#[inline(never)]
unsafe fn apart<B: Block>(block: B) -> B::Output {
    block.compute()
}

/// A function where some lane needs it.
#[target_feature(enable = "avx2,fma")]
#[cold]
#[inline(never)]
unsafe fn fresh<F: Function<K, N>, const K: usize, const N: usize>(from: [Four; K]) -> [Four; N] {
    F::of(from)
}

impl Real for Four {
    type Mask = FourMask;

    #[inline(always)]
    fn apart<B: Block>(block: B) -> B::Output {
        // SAFETY: these numbers are only computed with where the processor has the instructions.
        unsafe { apart(block) }
    }

    #[inline(always)]
    fn renewed<F: Function<K, N>, const K: usize, const N: usize>(
        needed: Self::Mask,
        kept: [Self; N],
        from: [Self; K],
    ) -> [Self; N] {
        let mut out = kept;
        if unsafe { _mm256_movemask_pd(needed.0) } != 0 {
            // SAFETY: these numbers are only computed with where the processor has the instructions.
            let fresh = unsafe { fresh::<F, K, N>(from) };
            for i in 0..N {
                out[i] = Self::select(needed, fresh[i], kept[i]);
            }
        }
        out
    }

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self(unsafe { _mm256_set1_pd(value) })
    }
    #[inline(always)]
    fn known(holds: bool) -> FourMask {
        let bits = if holds { -1 } else { 0 };
        FourMask(unsafe { _mm256_castsi256_pd(_mm256_set1_epi64x(bits)) })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> FourMask {
        FourMask(unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn le(self, other: Self) -> FourMask {
        FourMask(unsafe { _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn select(mask: FourMask, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm256_blendv_pd(no.0, yes.0, mask.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    /// The instruction gives its second operand where either is not a number, as [`Real::min`] does.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(unsafe { _mm256_min_pd(self.0, other.0) })
    }
    /// As for the minimum.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(unsafe { _mm256_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(unsafe { _mm256_fmadd_pd(self.0, factor.0, addend.0) })
    }
    #[inline(always)]
    fn exp2_parts(self) -> (Self, Self) {
        exp2_parts_in_double(self, |n: Self| unsafe {
            Self(_mm256_castsi256_pd(_mm256_slli_epi64::<52>(_mm256_castpd_si256(n.0))))
        })
    }
}

impl Wide for Four {
    const WIDTH: usize = 4;
    #[inline(always)]
    fn gather(values: &[f64]) -> Self {
        assert!(values.len() == Self::WIDTH);
        Self(unsafe { _mm256_loadu_pd(values.as_ptr()) })
    }
    fn extract(self, i: usize) -> f64 {
        let mut values = [0.0; 4];
        unsafe { _mm256_storeu_pd(values.as_mut_ptr(), self.0) };
        values[i]
    }
}
