//! Many runs at once: numbers that go through the same step together.
//!
//! A lane may be one number or, where the processor has them, a vector of several. Which one a
//! batch uses is chosen at run time ([`crate::instructions`]); all give the same bits.

#[cfg(target_arch = "x86_64")]
pub(crate) mod avx2;
#[cfg(avx512)]
pub(crate) mod avx512;

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use breakaway_core::Real;
use breakaway_core::real::Block;

/// Two numbers, vectors of numbers or pairs of them, that go through the same step together.
///
/// Every operation is that of the number on both, so the bits of a lane equal those of the scalar run.
/// One vector alone waits for its dependency chain; a pair, or a pair of pairs, hides it. They are
/// written out and not looped over: compilers unroll such loops one by one, and a step has tens of
/// thousands of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair<V>(pub V, pub V);

/// A condition for each lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PairMask<M>(M, M);

macro_rules! binary {
    ($type:ident, $trait:ident, $method:ident) => {
        impl<V: $trait<Output = V>> $trait for $type<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    };
}

binary!(Pair, Add, add);
binary!(Pair, Sub, sub);
binary!(Pair, Mul, mul);
binary!(Pair, Div, div);
binary!(PairMask, BitAnd, bitand);
binary!(PairMask, BitOr, bitor);

macro_rules! unary {
    ($type:ident, $trait:ident, $method:ident) => {
        impl<V: $trait<Output = V>> $trait for $type<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self) -> Self {
                Self(self.0.$method(), self.1.$method())
            }
        }
    };
}

unary!(Pair, Neg, neg);
unary!(PairMask, Not, not);

impl<V: Real> Real for Pair<V> {
    type Mask = PairMask<V::Mask>;
    const ROUND: f64 = V::ROUND;

    #[inline(always)]
    fn apart<B: Block>(block: B) -> B::Output {
        V::apart(block)
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self(V::constant(value), V::constant(value))
    }
    #[inline(always)]
    fn known(holds: bool) -> Self::Mask {
        PairMask(V::known(holds), V::known(holds))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        PairMask(self.0.lt(other.0), self.1.lt(other.1))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        PairMask(self.0.le(other.0), self.1.le(other.1))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(V::select(mask.0, yes.0, no.0), V::select(mask.1, yes.1, no.1))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn max_abs(self, other: Self) -> Self {
        Self(self.0.max_abs(other.0), self.1.max_abs(other.1))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(self.0.mul_add(factor.0, addend.0), self.1.mul_add(factor.1, addend.1))
    }
    #[inline(always)]
    fn exp2_parts(self) -> (Self, Self) {
        let (first, second) = (self.0.exp2_parts(), self.1.exp2_parts());
        (Self(first.0, second.0), Self(first.1, second.1))
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

impl<V: Wide> Wide for Pair<V> {
    const WIDTH: usize = 2 * V::WIDTH;
    #[inline(always)]
    fn gather(values: &[f64]) -> Self {
        Self(V::gather(&values[..V::WIDTH]), V::gather(&values[V::WIDTH..Self::WIDTH]))
    }
    fn extract(self, i: usize) -> f64 {
        if i < V::WIDTH { self.0.extract(i) } else { self.1.extract(i - V::WIDTH) }
    }
}
