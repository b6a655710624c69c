//! The fused multiply-add a·b + c with one rounding: the platform's, or the same in software.

#[cfg(feature = "std")]
#[inline(always)]
pub(crate) fn fma_f64(a: f64, b: f64, c: f64) -> f64 {
    f64::mul_add(a, b, c)
}

#[cfg(feature = "std")]
#[inline(always)]
pub(crate) fn fma_f32(a: f32, b: f32, c: f32) -> f32 {
    f32::mul_add(a, b, c)
}

#[cfg(not(feature = "std"))]
pub(crate) use libm::{fma as fma_f64, fmaf as fma_f32};
