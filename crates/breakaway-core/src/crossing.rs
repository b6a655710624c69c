//! When within a step a place is passed: events are split there, in closed form.

use crate::real::{Function, Real};

/// A step's motion, its acceleration constant as the midpoint rule has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<R> {
    /// x in m at its start.
    pub position_m: R,
    /// v in m/s at its start.
    pub velocity_m_per_s: R,
    /// What the velocity gains in the step, m/s.
    pub change_m_per_s: R,
    /// h in s.
    pub duration_s: R,
}

/// The share s of the step after which `d` of the way is behind it.
///
/// ```text
/// p s + q s² = d,   p = v h,   q = h Δv / 2,   0 < d ≤ p + q
/// ```
///
/// By Newton's method from the end that has the larger slope, where it cannot overshoot. Eight times is
/// exact to rounding unless v is below a hundredth of Δv; from rest it is within h/256.
struct Crossing;

impl Function<3, 1> for Crossing {
    #[inline(always)]
    fn of<R: Real>([d, p, q]: [R; 3]) -> [R; 1] {
        let mut share = R::select(R::zero().lt(q), R::one(), R::zero());
        for _ in 0..8 {
            let so_far = q.mul_add(share, p).named("per_share_m");
            let beyond = so_far.mul_add(share, -d).named("beyond_m");
            let slope = q.mul_add(share, so_far).named("slope_m");
            let too_far = (beyond / slope).named("too_far_share");
            share = (share - too_far).named("crossing_share");
        }
        [share.clamp(R::zero(), R::one())]
    }
}

impl<R: Real> Motion<R> {
    /// Where `needed` holds, the share of the step at which it passes `place_m`, which it has to; 1
    /// elsewhere.
    #[inline(always)]
    pub fn share_at(&self, place_m: R, needed: R::Mask) -> R {
        let (d, h) = ((place_m - self.position_m).named("to_place_m"), self.duration_s);
        let q = (R::constant(0.5) * h * self.change_m_per_s).named("half_gained_m");
        let from = [d, (h * self.velocity_m_per_s).named("coasted_m"), q];
        let [share] = R::renewed::<Crossing, 3, 1>(needed, [R::one()], from);
        share
    }

    /// v in m/s after a share of the step.
    #[inline(always)]
    pub fn velocity_after(&self, share: R) -> R {
        share.mul_add(self.change_m_per_s, self.velocity_m_per_s)
    }
}

#[cfg(test)]
mod tests {
    use super::Motion;

    /// x = v t + a t²/2, speeding up, slowing down, and from rest.
    #[test]
    fn finds_when_a_place_is_passed() {
        for (v, a, tolerance) in
            [(0.2, 3.0, 1e-14), (0.2, -150.0, 1e-14), (5e-3, 500.0, 1e-6), (0.0, 9.0, 0.004)]
        {
            let h = 1e-3;
            let motion = Motion {
                position_m: 0.0,
                velocity_m_per_s: v,
                change_m_per_s: a * h,
                duration_s: h,
            };
            for share in [0.02, 0.3, 0.9, 1.0_f64] {
                let t = share * h;
                let found = motion.share_at(v * t + 0.5 * a * t * t, true);
                assert!((found - share).abs() < tolerance, "{v} {a} {share} {found}");
                assert!((motion.velocity_after(share) - (v + a * t)).abs() < 1e-15);
            }
        }
    }
}
