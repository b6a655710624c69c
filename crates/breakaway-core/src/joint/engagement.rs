//! Loss of contact while the part leaves its seat.

use crate::real::Real;

/// A friction level at position `x`, multiplied by `factor`: it falls with the contact area,
/// equations (5) and (6).
///
/// ```text
/// F(x) = φ [F_0 + (F_end − F_0) x / l_f],   0 ≤ x ≤ l_f,   φ the factor
/// ```
///
/// `x` in m is 0 at the seat; before the seat the joint is fully engaged. `F_end` is what is left
/// at the end of the guide: m g in the paper. Not valid beyond `l_f`, where the joint is gone.
#[inline(always)]
pub fn engaged_level<R: Real>(seated_n: R, end_n: R, length_m: R, factor: R, x: R) -> R {
    let slope = ((end_n - seated_n) / length_m).named("slope_n_per_m");
    (slope * factor).mul_add(x.max(R::zero()).named("engaged_m"), seated_n * factor)
}
