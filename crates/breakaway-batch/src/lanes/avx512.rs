//! Eight numbers in one register of 512 bits.
//!
//! # Safety
//! Every function here needs a processor with [`available`] instructions, and a caller that is
//! compiled for them, into which it is inlined. Only `crate::instructions` makes these numbers, behind that
//! question.

#![allow(unsafe_code)]
#![allow(clippy::incompatible_msrv)] // built only by compilers that know these vectors

use core::arch::x86_64::{
    __m512d, __mmask8, _CMP_LE_OQ, _CMP_LT_OQ, _mm512_abs_pd, _mm512_add_pd, _mm512_castpd_si512,
    _mm512_castsi512_pd, _mm512_cmp_pd_mask, _mm512_div_pd, _mm512_fmadd_pd, _mm512_loadu_pd,
    _mm512_mask_blend_pd, _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd, _mm512_range_pd,
    _mm512_set1_pd, _mm512_slli_epi64, _mm512_storeu_pd, _mm512_sub_pd, _mm512_xor_pd,
};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use breakaway_core::Real;
use breakaway_core::exp2::exp2_parts_in_double;
use breakaway_core::real::{Block, Function};

use super::Wide;

/// Whether this processor has the instructions.
pub(crate) fn available() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("fma")
}

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eight(__m512d);

/// Eight conditions, one bit each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EightMask(__mmask8);

macro_rules! operator {
    ($trait:ident, $method:ident, $instruction:ident) => {
        impl $trait for Eight {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}

operator!(Add, add, _mm512_add_pd);
operator!(Sub, sub, _mm512_sub_pd);
operator!(Mul, mul, _mm512_mul_pd);
operator!(Div, div, _mm512_div_pd);

impl Neg for Eight {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

impl BitAnd for EightMask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for EightMask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for EightMask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

/// A block as a function that may use the instructions.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
#[inline(never)]
unsafe fn apart<B: Block>(block: B) -> B::Output {
    block.compute()
}

/// A function where some lane needs it.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
#[cold]
#[inline(never)]
unsafe fn fresh<F: Function<K, N>, const K: usize, const N: usize>(from: [Eight; K]) -> [Eight; N] {
    F::of(from)
}

impl Real for Eight {
    type Mask = EightMask;

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
        if needed.0 != 0 {
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
        Self(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    fn known(holds: bool) -> EightMask {
        EightMask(if holds { 0xff } else { 0 })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> EightMask {
        EightMask(unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn le(self, other: Self) -> EightMask {
        EightMask(unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn select(mask: EightMask, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm512_mask_blend_pd(mask.0, no.0, yes.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm512_abs_pd(self.0) })
    }
    /// The instruction gives its second operand where either is not a number, as [`Real::min`] does.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(unsafe { _mm512_min_pd(self.0, other.0) })
    }
    /// As for the minimum.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    /// One instruction: the larger magnitude of two, its sign cleared; the number of the two where
    /// one is none.
    #[inline(always)]
    fn max_abs(self, other: Self) -> Self {
        const LARGER_MAGNITUDE: i32 = 0b11;
        const SIGN_CLEARED: i32 = 0b10 << 2;
        Self(unsafe { _mm512_range_pd::<{ SIGN_CLEARED | LARGER_MAGNITUDE }>(self.0, other.0) })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(unsafe { _mm512_fmadd_pd(self.0, factor.0, addend.0) })
    }
    #[inline(always)]
    fn exp2_parts(self) -> (Self, Self) {
        exp2_parts_in_double(self, |n: Self| unsafe {
            Self(_mm512_castsi512_pd(_mm512_slli_epi64::<52>(_mm512_castpd_si512(n.0))))
        })
    }
}

impl Wide for Eight {
    const WIDTH: usize = 8;
    #[inline(always)]
    fn gather(values: &[f64]) -> Self {
        assert!(values.len() == Self::WIDTH);
        Self(unsafe { _mm512_loadu_pd(values.as_ptr()) })
    }
    fn extract(self, i: usize) -> f64 {
        let mut values = [0.0; 8];
        unsafe { _mm512_storeu_pd(values.as_mut_ptr(), self.0) };
        values[i]
    }
}
