//! Loss of contact while the part leaves its seat.

use crate::real::Real;

/// A friction level at position `x`: it falls with the contact area, equations (5) and (6).
///
/// ```text
/// F(x) = F_0 + (F_end − F_0) x / l_f,   0 ≤ x ≤ l_f
/// ```
///
/// `x` in m is 0 at the seat; before the seat the joint is fully engaged. `F_end` is what is left
/// at the end of the guide: m g in the paper. Beyond `l_f` the caller removes the joint.
#[inline(always)]
pub fn engaged_level<R: Real>(seated_n: R, end_n: R, length_m: R, x: R) -> R {
    let x = x.clamp(R::zero(), length_m);
    ((end_n - seated_n) / length_m).mul_add(x, seated_n)
}
