//! Many runs at once: an array of numbers that go through the same step together.
//!
//! A lane may be one number or, where the processor has them, a vector of several. Which one a
//! batch uses is chosen at run time ([`crate::instructions`]); all give the same bits.

// Indexed loops over fixed arrays are inlined and unrolled within any caller's instruction set;
// closures are not.
#![allow(clippy::needless_range_loop)]

#[cfg(target_arch = "x86_64")]
pub(crate) mod avx2;
#[cfg(avx512)]
pub(crate) mod avx512;

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use breakaway_core::Real;

/// `K` numbers, or vectors of numbers, that go through the same step together.
///
/// Every operation is that of the number on each of them, so the bits of a lane equal those of the
/// scalar run. One vector alone waits for its dependency chain; four hide it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes<V, const K: usize>(pub [V; K]);

/// A condition for each lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneMask<M, const K: usize>([M; K]);

macro_rules! lanewise {
    ($type:ident, $bound:ident, $trait:ident, $method:ident) => {
        impl<V: $bound<Output = V> + Copy, const K: usize> $trait for $type<V, K> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let mut out = self;
                for i in 0..K {
                    out.0[i] = self.0[i].$method(other.0[i]);
                }
                out
            }
        }
    };
}

lanewise!(Lanes, Add, Add, add);
lanewise!(Lanes, Sub, Sub, sub);
lanewise!(Lanes, Mul, Mul, mul);
lanewise!(Lanes, Div, Div, div);
lanewise!(LaneMask, BitAnd, BitAnd, bitand);
lanewise!(LaneMask, BitOr, BitOr, bitor);

macro_rules! on_each {
    ($type:ident, $trait:ident, $method:ident) => {
        impl<V: $trait<Output = V> + Copy, const K: usize> $trait for $type<V, K> {
            type Output = Self;
            #[inline(always)]
            fn $method(self) -> Self {
                let mut out = self;
                for i in 0..K {
                    out.0[i] = self.0[i].$method();
                }
                out
            }
        }
    };
}

on_each!(Lanes, Neg, neg);
on_each!(LaneMask, Not, not);

impl<V: Real, const K: usize> Lanes<V, K> {
    #[inline(always)]
    fn compare(self, other: Self, holds: impl Fn(V, V) -> V::Mask) -> LaneMask<V::Mask, K> {
        let mut mask = LaneMask([holds(self.0[0], other.0[0]); K]);
        for i in 1..K {
            mask.0[i] = holds(self.0[i], other.0[i]);
        }
        mask
    }
}

impl<V: Real, const K: usize> Real for Lanes<V, K> {
    type Mask = LaneMask<V::Mask, K>;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self([V::constant(value); K])
    }
    #[inline(always)]
    fn known(holds: bool) -> Self::Mask {
        LaneMask([V::known(holds); K])
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        self.compare(other, V::lt)
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        self.compare(other, V::le)
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        let mut out = no;
        for i in 0..K {
            out.0[i] = V::select(mask.0[i], yes.0[i], no.0[i]);
        }
        out
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let mut out = self;
        for i in 0..K {
            out.0[i] = self.0[i].abs();
        }
        out
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let mut out = self;
        for i in 0..K {
            out.0[i] = self.0[i].min(other.0[i]);
        }
        out
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let mut out = self;
        for i in 0..K {
            out.0[i] = self.0[i].max(other.0[i]);
        }
        out
    }
    #[inline(always)]
    fn max_abs(self, other: Self) -> Self {
        let mut out = self;
        for i in 0..K {
            out.0[i] = self.0[i].max_abs(other.0[i]);
        }
        out
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let mut out = self;
        for i in 0..K {
            out.0[i] = self.0[i].mul_add(factor.0[i], addend.0[i]);
        }
        out
    }
    #[inline(always)]
    fn exp2_parts(self) -> (Self, Self) {
        let (mut fraction, mut power) = (self, self);
        for i in 0..K {
            (fraction.0[i], power.0[i]) = self.0[i].exp2_parts();
        }
        (fraction, power)
    }
}

/// A number that holds one or more `f64`, side by side.
pub trait Wide: Real {
    /// How many.
    const WIDTH: usize;

    /// From as many values.
    fn gather(values: &[f64]) -> Self;

    /// Number `i` of them.
    fn extract(self, i: usize) -> f64;
}

impl Wide for f64 {
    const WIDTH: usize = 1;
    #[inline(always)]
    fn gather(values: &[f64]) -> Self {
        values[0]
    }
    fn extract(self, _: usize) -> f64 {
        self
    }
}

impl<V: Wide, const K: usize> Wide for Lanes<V, K> {
    const WIDTH: usize = K * V::WIDTH;
    #[inline(always)]
    fn gather(values: &[f64]) -> Self {
        let mut out = Self::constant(0.0);
        for k in 0..K {
            out.0[k] = V::gather(&values[k * V::WIDTH..(k + 1) * V::WIDTH]);
        }
        out
    }
    fn extract(self, i: usize) -> f64 {
        self.0[i / V::WIDTH].extract(i % V::WIDTH)
    }
}
