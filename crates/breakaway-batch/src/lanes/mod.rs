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
use breakaway_core::real::{Block, Function};

/// Defines several numbers, or vectors of numbers, that go through the same step together.
///
/// Every operation is that of the number on each of them, so the bits of a lane equal those of the
/// scalar run. They are written out and not looped over: compilers unroll such loops one by one, and a
/// step has tens of thousands of them.
macro_rules! lanes {
    ($(#[$meta:meta])* $lanes:ident, $mask:ident, $count:literal, [$($i:literal),+]) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $lanes<V>(pub [V; $count]);

        /// A condition for each lane.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct $mask<M>([M; $count]);

        lanes!(binary $lanes, [$($i),+], Add add, Sub sub, Mul mul, Div div);
        lanes!(binary $mask, [$($i),+], BitAnd bitand, BitOr bitor);
        lanes!(unary $lanes, [$($i),+], Neg neg);
        lanes!(unary $mask, [$($i),+], Not not);

        impl<V: Real> Real for $lanes<V> {
            type Mask = $mask<V::Mask>;
            const ROUND: f64 = V::ROUND;

            #[inline(always)]
            fn apart<B: Block>(block: B) -> B::Output {
                V::apart(block)
            }
            #[inline(always)]
            fn constant(value: f64) -> Self {
                Self([V::constant(value); $count])
            }
            #[inline(always)]
            fn known(holds: bool) -> Self::Mask {
                $mask([V::known(holds); $count])
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                $mask([$(self.0[$i].lt(other.0[$i])),+])
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                $mask([$(self.0[$i].le(other.0[$i])),+])
            }
            #[inline(always)]
            fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
                Self([$(V::select(mask.0[$i], yes.0[$i], no.0[$i])),+])
            }
            #[inline(always)]
            fn renewed<F: Function<K, N>, const K: usize, const N: usize>(
                needed: Self::Mask,
                kept: [Self; N],
                from: [Self; K],
            ) -> [Self; N] {
                let mut out = kept;
                $(
                    let (mut held, mut given) = ([V::zero(); N], [V::zero(); K]);
                    for n in 0..N {
                        held[n] = kept[n].0[$i];
                    }
                    for k in 0..K {
                        given[k] = from[k].0[$i];
                    }
                    let one = V::renewed::<F, K, N>(needed.0[$i], held, given);
                    for n in 0..N {
                        out[n].0[$i] = one[n];
                    }
                )+
                out
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self([$(self.0[$i].abs()),+])
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self([$(self.0[$i].min(other.0[$i])),+])
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self([$(self.0[$i].max(other.0[$i])),+])
            }
            #[inline(always)]
            fn max_abs(self, other: Self) -> Self {
                Self([$(self.0[$i].max_abs(other.0[$i])),+])
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                Self([$(self.0[$i].mul_add(factor.0[$i], addend.0[$i])),+])
            }
            #[inline(always)]
            fn exp2_parts(self) -> (Self, Self) {
                let parts = [$(self.0[$i].exp2_parts()),+];
                (Self([$(parts[$i].0),+]), Self([$(parts[$i].1),+]))
            }
        }

        impl<V: Wide> Wide for $lanes<V> {
            const WIDTH: usize = $count * V::WIDTH;
            #[inline(always)]
            fn gather(values: &[f64]) -> Self {
                Self([$(V::gather(&values[$i * V::WIDTH..($i + 1) * V::WIDTH])),+])
            }
            fn extract(self, i: usize) -> f64 {
                self.0[i / V::WIDTH].extract(i % V::WIDTH)
            }
        }
    };
    (binary $type:ident, $places:tt, $($trait:ident $method:ident),+) => {
        $( lanes!(one binary $type, $trait $method, $places); )+
    };
    (one binary $type:ident, $trait:ident $method:ident, [$($i:literal),+]) => {
        impl<V: $trait<Output = V> + Copy> $trait for $type<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self([$(self.0[$i].$method(other.0[$i])),+])
            }
        }
    };
    (unary $type:ident, [$($i:literal),+], $trait:ident $method:ident) => {
        impl<V: $trait<Output = V> + Copy> $trait for $type<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self) -> Self {
                Self([$(self.0[$i].$method()),+])
            }
        }
    };
}

lanes! {
    /// Two, for steps of very many numbers.
    Two, TwoMask, 2, [0, 1]
}

lanes! {
    /// Four, which hide the latency of a dependency chain: one vector alone waits for it.
    Four, FourMask, 4, [0, 1, 2, 3]
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
