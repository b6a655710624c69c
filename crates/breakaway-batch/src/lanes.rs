//! Many runs at once: a plain array that compilers turn into vector instructions.

// Indexed loops over fixed arrays are what compilers vectorize, within any caller's instruction set.
#![allow(clippy::needless_range_loop)]

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use breakaway_core::Real;

/// `N` numbers that go through the same step together, each its own run.
///
/// Every operation is the scalar operation on each lane, so a lane's bits equal those of the
/// scalar run. 32 lanes hide the latency of the dependency chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes<const N: usize>(pub [f64; N]);

/// A condition for each lane: all bits set, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneMask<const N: usize>([u64; N]);

impl<const N: usize> LaneMask<N> {
    #[inline(always)]
    fn of(a: Lanes<N>, b: Lanes<N>, holds: impl Fn(f64, f64) -> bool) -> Self {
        let mut mask = [0; N];
        for i in 0..N {
            mask[i] = if holds(a.0[i], b.0[i]) { u64::MAX } else { 0 };
        }
        Self(mask)
    }
}

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl<const N: usize> $trait for Lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let mut out = self;
                for i in 0..N {
                    out.0[i] = self.0[i] $op other.0[i];
                }
                out
            }
        }
    };
}

macro_rules! maskwise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl<const N: usize> $trait for LaneMask<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let mut out = self;
                for i in 0..N {
                    out.0[i] = self.0[i] $op other.0[i];
                }
                out
            }
        }
    };
}

lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);
lanewise!(Div, div, /);
maskwise!(BitAnd, bitand, &);
maskwise!(BitOr, bitor, |);

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let mut out = self;
        for lane in &mut out.0 {
            *lane = -*lane;
        }
        out
    }
}

impl<const N: usize> Not for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        let mut out = self;
        for lane in &mut out.0 {
            *lane = !*lane;
        }
        out
    }
}

impl<const N: usize> Real for Lanes<N> {
    type Mask = LaneMask<N>;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self([value; N])
    }
    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask<N> {
        LaneMask::of(self, other, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, other: Self) -> LaneMask<N> {
        LaneMask::of(self, other, |a, b| a <= b)
    }
    #[inline(always)]
    fn select(mask: LaneMask<N>, yes: Self, no: Self) -> Self {
        let mut out = no;
        for i in 0..N {
            let bits = (mask.0[i] & yes.0[i].to_bits()) | (!mask.0[i] & no.0[i].to_bits());
            out.0[i] = f64::from_bits(bits);
        }
        out
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let mut out = self;
        for lane in &mut out.0 {
            *lane = lane.abs();
        }
        out
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let mut out = self;
        for i in 0..N {
            out.0[i] = self.0[i].mul_add(factor.0[i], addend.0[i]);
        }
        out
    }
    #[inline(always)]
    fn exp2_parts(self) -> (Self, Self) {
        let (mut fraction, mut power) = (self, self);
        for i in 0..N {
            (fraction.0[i], power.0[i]) = self.0[i].exp2_parts();
        }
        (fraction, power)
    }
}
