//! Many runs at once: an array of numbers that go through the same step together.
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

/// Four numbers, or vectors of numbers, that go through the same step together.
///
/// Every operation is that of the number on each of them, so the bits of a lane equal those of the
/// scalar run. One vector alone waits for its dependency chain; four hide it. They are written out and not
/// looped over: compilers unroll such loops one by one, and a step has tens of thousands of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes<V>(pub [V; 4]);

/// A condition for each lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneMask<M>([M; 4]);

/// An array of what an expression gives for each of the four places.
macro_rules! on_each {
    (|$i:ident| $value:expr) => {
        [
            {
                const $i: usize = 0;
                $value
            },
            {
                const $i: usize = 1;
                $value
            },
            {
                const $i: usize = 2;
                $value
            },
            {
                const $i: usize = 3;
                $value
            },
        ]
    };
}

macro_rules! binary {
    ($type:ident, $trait:ident, $method:ident) => {
        impl<V: $trait<Output = V> + Copy> $trait for $type<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(on_each!(|I| self.0[I].$method(other.0[I])))
            }
        }
    };
}

binary!(Lanes, Add, add);
binary!(Lanes, Sub, sub);
binary!(Lanes, Mul, mul);
binary!(Lanes, Div, div);
binary!(LaneMask, BitAnd, bitand);
binary!(LaneMask, BitOr, bitor);

macro_rules! unary {
    ($type:ident, $trait:ident, $method:ident) => {
        impl<V: $trait<Output = V> + Copy> $trait for $type<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self) -> Self {
                Self(on_each!(|I| self.0[I].$method()))
            }
        }
    };
}

unary!(Lanes, Neg, neg);
unary!(LaneMask, Not, not);

impl<V: Real> Real for Lanes<V> {
    type Mask = LaneMask<V::Mask>;
    const ROUND: f64 = V::ROUND;

    #[inline(always)]
    fn apart<B: Block>(block: B) -> B::Output {
        V::apart(block)
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self([V::constant(value); 4])
    }
    #[inline(always)]
    fn known(holds: bool) -> Self::Mask {
        LaneMask([V::known(holds); 4])
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        LaneMask(on_each!(|I| self.0[I].lt(other.0[I])))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        LaneMask(on_each!(|I| self.0[I].le(other.0[I])))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(on_each!(|I| V::select(mask.0[I], yes.0[I], no.0[I])))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(on_each!(|I| self.0[I].abs()))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(on_each!(|I| self.0[I].min(other.0[I])))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(on_each!(|I| self.0[I].max(other.0[I])))
    }
    #[inline(always)]
    fn max_abs(self, other: Self) -> Self {
        Self(on_each!(|I| self.0[I].max_abs(other.0[I])))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(on_each!(|I| self.0[I].mul_add(factor.0[I], addend.0[I])))
    }
    #[inline(always)]
    fn exp2_parts(self) -> (Self, Self) {
        let [a, b, c, d] = on_each!(|I| self.0[I].exp2_parts());
        (Self([a.0, b.0, c.0, d.0]), Self([a.1, b.1, c.1, d.1]))
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

impl<V: Wide> Wide for Lanes<V> {
    const WIDTH: usize = 4 * V::WIDTH;
    #[inline(always)]
    fn gather(values: &[f64]) -> Self {
        Self(on_each!(|I| V::gather(&values[I * V::WIDTH..(I + 1) * V::WIDTH])))
    }
    fn extract(self, i: usize) -> f64 {
        self.0[i / V::WIDTH].extract(i % V::WIDTH)
    }
}
