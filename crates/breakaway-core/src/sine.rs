//! The sine.

use crate::real::Real;

/// sin(π u) for 0 ≤ u ≤ 1, as the cosine's series in π (u − ½); error below 1e-14.
#[inline(always)]
pub(crate) fn half_sine<R: Real>(u: R) -> R {
    const COSINE: [f64; 10] = [
        1.0,
        -1.0 / 2.0,
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40_320.0,
        -1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
        -1.0 / 87_178_291_200.0,
        1.0 / 20_922_789_888_000.0,
        -1.0 / 6_402_373_705_728_000.0,
    ];
    let y = R::constant(core::f64::consts::PI) * (u - R::constant(0.5));
    let square = (y * y).named("angle_squared");
    let mut sum = R::constant(COSINE[9]);
    for &coefficient in COSINE[..9].iter().rev() {
        sum = sum * square + R::constant(coefficient);
    }
    sum.named("half_sine")
}

/// sin(2π t) for |t| below 2⁵¹ turns; error below 1e-14 of the rest beyond whole turns.
#[inline(always)]
pub(crate) fn sine_of_turns<R: Real>(turns: R) -> R {
    let rest = (turns - turns.round()).named("turn");
    let size = half_sine(rest.abs() + rest.abs());
    R::select(rest.lt(R::zero()), -size, size).named("sine")
}

#[cfg(test)]
mod tests {
    use super::{half_sine, sine_of_turns};
    use core::f64::consts::{PI, TAU};

    #[test]
    fn half_sine_is_the_sine() {
        for i in 0..=1000 {
            let u = f64::from(i) * 1e-3;
            assert!((half_sine(u) - (PI * u).sin()).abs() < 1e-14);
        }
    }

    #[test]
    fn sine_of_turns_is_the_sine() {
        for i in -3000..3000 {
            let turns = f64::from(i) * 1.37e-3;
            assert!((sine_of_turns(turns) - (TAU * turns).sin()).abs() < 3e-14);
        }
    }
}
