//! How slip sets in: elastic at first, then more and more plastic.

use crate::real::Real;

/// α of the elasto-plastic laws at a deflection `z` and a velocity `v`: the share of the slip that a
/// settled bristle would have.
///
/// ```text
/// α = S((|z| k_e / g − e) / (1 − e)) while z v > 0, else 0,      S(s) = 3 s² − 2 s³ on 0 to 1
/// ```
///
/// `g` is the friction level in N, `share` e, the elastic share of the settled deflection g / k_e.
/// Source: Dupont, Hayward, Armstrong and Altpeter (IEEE TAC 47(5), 2002), whose sinusoidal step
/// differs from S by less than 0.011.
#[inline(always)]
pub(super) fn slip_onset<R: Real>(share: R, z: R, v: R, stiffness_n_per_m: R, g: R) -> R {
    let (zero, one) = (R::zero(), R::one());
    R::section("slip onset: alpha = S((|z| k_e / g - e) / (1 - e)) while z v > 0");
    let used = (z.abs() * stiffness_n_per_m / g).named("used_share");
    let s = ((used - share) / (one - share)).clamp(zero, one).named("onset_progress");
    let step = s * s * (R::constant(-2.0)).mul_add(s, R::constant(3.0));
    R::select(zero.lt(z * v), step, zero).named("onset")
}
