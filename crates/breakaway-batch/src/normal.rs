//! The normal distribution's quantile function, with the same bits on every machine.
//!
//! What is computed with numbers is generic over them, so that exported code is recorded from it.

use breakaway_core::Real;

/// Wichura, *Algorithm AS 241*, Applied Statistics 37(3), 1988: relative error about 1e-15. The
/// middle is a quotient of polynomials; the tails need a logarithm, which is [`ln`] so that no
/// platform's own decides the bits. Valid for 0 < p < 1.
///
/// # Example
/// ```
/// use breakaway_batch::normal::quantile;
/// assert_eq!(quantile(0.5), 0.0);
/// assert!((quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-14);
/// ```
#[must_use]
pub fn quantile(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        return quantile_middle(q);
    }
    let tail = if q < 0.0 { p } else { 1.0 - p };
    let distance = quantile_tail((-ln(tail)).sqrt());
    if q < 0.0 { -distance } else { distance }
}

/// The quantile where q = p - 1/2 is at most 0.425 from 0.
#[must_use]
pub fn quantile_middle<R: Real>(q: R) -> R {
    let r = R::constant(0.180_625) - q * q;
    q * polynomial(&MIDDLE.0, r) / polynomial(&MIDDLE.1, r)
}

/// The distance of the quantile from 0 in a tail, by r = sqrt(-ln p).
#[must_use]
pub fn quantile_tail<R: Real>(r: R) -> R {
    let near = r.le(R::constant(5.0));
    let quotient = |(above, below): &Quotient, origin: f64| {
        let shifted = r - R::constant(origin);
        polynomial(above, shifted) / polynomial(below, shifted)
    };
    R::select(near, quotient(&NEAR, 1.6), quotient(&FAR, 5.0))
}

fn polynomial<R: Real>(coefficients: &[f64; 8], x: R) -> R {
    let sum = |sum: R, &c: &f64| sum * x + R::constant(c);
    coefficients.iter().rev().fold(R::zero(), sum)
}

/// The natural logarithm of a normal number above 0, to a relative error below 1e-15 below 0.9.
///
/// x = 2ᵏ m with m from √½ to √2; the bits of √½ taken from those of x leave k in the exponent field.
///
/// # Example
/// ```
/// use breakaway_batch::normal::ln;
/// assert!((ln(0.01) / 0.01_f64.ln() - 1.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn ln(x: f64) -> f64 {
    let bits = x.to_bits();
    let biased = bits.wrapping_add(BIAS_LESS_ROOT) >> 52; // k + 1023
    let mantissa = bits.wrapping_sub(biased.wrapping_sub(1023) << 52);
    ln_of_parts(f64::from_bits(mantissa), biased as f64 - 1023.0)
}

/// The bits of 1 less those of √½.
pub const BIAS_LESS_ROOT: u64 = 0x3FF0_0000_0000_0000 - 0x3FE6_A09E_667F_3BCD;

/// ln(2ᵏ m) = k ln 2 + 2 artanh s, s = (m - 1) / (m + 1), for √½ ≤ m ≤ √2. Of the series of artanh,
/// s + s³/3 + s⁵/5 + …, twelve terms leave less than 1e-19 of it.
#[must_use]
pub fn ln_of_parts<R: Real>(m: R, k: R) -> R {
    let one = R::one();
    let s = (m - one) / (m + one);
    let square = s * s;
    let mut sum = R::constant(1.0 / 23.0);
    for odd in [21.0, 19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
        sum = sum * square + R::constant(1.0 / odd);
    }
    k * R::constant(std::f64::consts::LN_2) + (s + s) * sum
}

type Quotient = ([f64; 8], [f64; 8]);

const MIDDLE: Quotient = (
    [
        3.387_132_872_796_366_6,
        133.141_667_891_784_38,
        1_971.590_950_306_551_3,
        13_731.693_765_509_46,
        45_921.953_931_549_87,
        67_265.770_927_008_7,
        33_430.575_583_588_13,
        2_509.080_928_730_122_7,
    ],
    [
        1.0,
        42.313_330_701_600_91,
        687.187_007_492_057_9,
        5_394.196_021_424_751,
        21_213.794_301_586_597,
        39_307.895_800_092_71,
        28_729.085_735_721_943,
        5_226.495_278_852_854,
    ],
);
const NEAR: Quotient = (
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        0.241_780_725_177_450_6,
        0.022_723_844_989_269_184,
        0.000_774_545_014_278_341_4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        0.689_767_334_985_1,
        0.148_103_976_427_480_08,
        0.015_198_666_563_616_457,
        0.000_547_593_808_499_534_5,
        1.050_750_071_644_416_9e-9,
    ],
);
const FAR: Quotient = (
    [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        0.296_560_571_828_504_87,
        0.026_532_189_526_576_124,
        0.001_242_660_947_388_078_4,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        0.599_832_206_555_888,
        0.136_929_880_922_735_8,
        0.014_875_361_290_850_615,
        0.000_786_869_131_145_613_3,
        1.846_318_317_510_054_7e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ],
);
