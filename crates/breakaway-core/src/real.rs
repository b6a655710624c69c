//! The number trait that every equation is generic over.

use core::fmt::Debug;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A computation that may be compiled on its own: a part of a step that would make it too large.
///
/// A type and not a closure, because closures are not inlined into the caller's instruction set.
pub trait Block {
    /// What it gives.
    type Output;

    /// Computes it. Has to be inlined.
    fn compute(self) -> Self::Output;
}

/// A function of several numbers that gives several, written for any numbers.
///
/// A type and not a closure, because lanes compute it with what they are made of.
pub trait Function<const K: usize, const N: usize> {
    /// Computes it. Has to be inlined.
    fn of<R: Real>(numbers: [R; K]) -> [R; N];
}

/// A number that the equations can be computed with.
///
/// The operations are the ones that an export to C reproduces bit for bit: plus, minus, times,
/// divide, fused multiply-add, compare, select, absolute value and the crate's own exponential.
/// A multiply-add is fused where it is written and nowhere else, so every instruction set gives
/// the same bits (see `docs/adr/0002`).
///
/// A condition is a [`Real::Mask`], not a `bool`: with lanes it differs from lane to lane, and
/// when recording it is not known. Hence [`Real::select`] in place of `if`.
///
/// # Example
/// ```
/// use breakaway_core::Real;
/// fn clip<R: Real>(x: R) -> R { x.max(R::constant(-1.0)).min(R::constant(1.0)) }
/// assert_eq!(clip(3.0_f64), 1.0);
/// assert_eq!(clip(-0.25_f32), -0.25);
/// ```
/// A branch on a number does not compile, so that whatever does can be recorded:
/// ```compile_fail,E0308
/// use breakaway_core::Real;
/// fn magnitude<R: Real>(x: R) -> R { if x.lt(R::zero()) { -x } else { x } }
/// ```
/// ```compile_fail,E0369
/// use breakaway_core::Real;
/// fn larger<R: Real>(x: R, y: R) -> R { if x < y { y } else { x } }
/// ```
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The result of a comparison.
    type Mask: Copy
        + Debug
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// 1.5·2⁵² (`f64`) or 1.5·2²³ (`f32`): added and taken away again, it rounds to a whole number.
    const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5·2⁵²

    /// The number nearest to `value`.
    fn constant(value: f64) -> Self;

    /// `self < other`; false where either is not a number.
    fn lt(self, other: Self) -> Self::Mask;

    /// `self <= other`; false where either is not a number.
    fn le(self, other: Self) -> Self::Mask;

    /// `yes` where `mask` holds, `no` elsewhere. Both are computed; the other one is dropped.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// A condition that is known beforehand, so that compilers can drop what it rules out.
    #[inline(always)]
    fn known(holds: bool) -> Self::Mask {
        Self::zero().lt(Self::constant(f64::from(u8::from(holds))))
    }

    /// Computes a block as a function of its own, where these numbers know how to call one; else in
    /// place. The same bits either way: it is for compilers, whose effort grows faster than a function.
    #[inline(always)]
    fn apart<B: Block>(block: B) -> B::Output {
        block.compute()
    }

    /// A function of `from` where `needed` holds, what was `kept` elsewhere. Numbers that know whether any
    /// needs it leave the function out where none does: for what seldom changes. The same bits either
    /// way.
    #[inline(always)]
    fn renewed<F: Function<K, N>, const K: usize, const N: usize>(
        needed: Self::Mask,
        kept: [Self; N],
        from: [Self; K],
    ) -> [Self; N] {
        let fresh = F::of(from);
        let mut out = kept;
        for i in 0..N {
            out[i] = Self::select(needed, fresh[i], kept[i]);
        }
        out
    }

    /// Says what the number is, to numbers that keep it: a recording, whose code shall be read.
    #[inline(always)]
    fn named(self, _name: &'static str) -> Self {
        self
    }

    /// Says which block's arithmetic follows, to numbers that keep it. A colon ends the block's name;
    /// what comes after is its equation.
    #[inline(always)]
    fn section(_title: &'static str) {}

    /// Absolute value.
    fn abs(self) -> Self;

    /// `self * factor + addend` with one rounding, on every machine. Fast where the processor
    /// has the instruction and the caller is compiled for it; else a library call.
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// 2 to the power of the number, as a fraction in [0.7, 1.42] and a power of two whose product
    /// it is, to a relative error below 4e-16 (`f64`) or 2e-7 (`f32`).
    ///
    /// The power is ready before the fraction: multiply it by a coefficient first where speed
    /// counts. Valid for -1022 ≤ self ≤ 1023 (`f64`) or -126 ≤ self ≤ 127 (`f32`); beyond, the
    /// power stays at the end of the range.
    fn exp2_parts(self) -> (Self, Self);

    /// 2 to the power of the number: the product of [`Real::exp2_parts`].
    #[inline(always)]
    fn exp2(self) -> Self {
        let (fraction, power) = self.exp2_parts();
        fraction * power
    }

    /// The natural exponential.
    #[inline(always)]
    fn exp(self) -> Self {
        (self * Self::constant(core::f64::consts::LOG2_E)).exp2()
    }

    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::constant(0.0)
    }

    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::constant(1.0)
    }

    /// The smaller of two numbers; `other` where `self` is not a number.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }

    /// The larger of two numbers; `other` where `self` is not a number.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }

    /// The larger of |self| and `other`, which is not below zero; `other` where `self` is not a number.
    #[inline(always)]
    fn max_abs(self, other: Self) -> Self {
        self.abs().max(other)
    }

    /// `self` limited to `[low, high]`; `low` where `self` is not a number.
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }

    /// The nearest whole number, the even one of two; valid for |self| below 2⁵¹ (`f64`) or 2²² (`f32`).
    #[inline(always)]
    fn round(self) -> Self {
        let magic = Self::constant(Self::ROUND);
        (self + magic) - magic
    }

    /// -1, 0 or 1 with the sign of the number; 0 for both zeros.
    #[inline(always)]
    fn sign(self) -> Self {
        let negative = Self::select(self.lt(Self::zero()), -Self::one(), Self::zero());
        Self::select(Self::zero().lt(self), Self::one(), negative)
    }

    /// One where `mask` holds, zero elsewhere: a condition that can be kept in a state.
    #[inline(always)]
    fn flag(mask: Self::Mask) -> Self {
        Self::select(mask, Self::one(), Self::zero())
    }

    /// The number, but zero where it is below 1e-286 in magnitude: what dies away for good, such as a
    /// filter that sees nothing, is to end at zero. It would end among numbers so small that
    /// processors compute with them many times slower. Numbers above 1e-254 stay as they are; in
    /// single precision all do.
    #[inline(always)]
    fn ebbed(self) -> Self {
        let tiny = Self::constant(1e-270);
        (self + tiny) - tiny
    }

    /// Whether a flag made by [`Real::flag`] is up.
    #[inline(always)]
    fn is_set(self) -> Self::Mask {
        Self::constant(0.5).lt(self)
    }
}
