//! Random draws as a function of seed, run and number of the draw.
//!
//! Philox4x32-10 (Salmon, Moraes, Dror and Shaw, *Parallel random numbers: as easy as 1, 2, 3*,
//! SC 2011) turns a key and a counter into four random words. A draw therefore depends on nothing
//! that was drawn before it: not on threads, lanes or the order of runs.

// Indexed loops over fixed arrays are what compilers vectorize.
#![allow(clippy::needless_range_loop)]

use breakaway_core::Real;
use breakaway_core::disturbance::{Disturbance, DrawLaw};
use breakaway_core::variation::FieldKeys;

use crate::normal::quantile;

/// What a draw is for; each purpose has draws of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// The disturbance of the joint.
    Disturbance,
    /// The noise of the sensors.
    Noise,
    /// What makes the field of a run its own.
    Field,
    /// A number of the scenario that differs from run to run, counted from zero.
    Part(u32),
}

impl Stream {
    const fn word(self) -> u32 {
        match self {
            Self::Disturbance => 0,
            Self::Part(number) => 1 + number,
            Self::Noise => u32::MAX,
            Self::Field => u32::MAX - 1,
        }
    }
}

/// Four random words of 32 bits for each of `N` counters, side by side, and a key.
///
/// The words are held in 64 bits each, because their products are that long.
#[must_use]
#[inline(always)]
pub fn philox4x32<const N: usize>(mut counter: [[u64; N]; 4], mut key: [u32; 2]) -> [[u64; N]; 4] {
    for round in 0..10 {
        if round > 0 {
            key[0] = key[0].wrapping_add(0x9E37_79B9);
            key[1] = key[1].wrapping_add(0xBB67_AE85);
        }
        for i in 0..N {
            let product0 = (counter[0][i] & LOW) * 0xD251_1F53;
            let product1 = (counter[2][i] & LOW) * 0xCD9E_8D57;
            counter[0][i] = (product1 >> 32) ^ counter[1][i] ^ u64::from(key[0]);
            counter[1][i] = product1 & LOW;
            counter[2][i] = (product0 >> 32) ^ counter[3][i] ^ u64::from(key[1]);
            counter[3][i] = product0 & LOW;
        }
    }
    counter
}

/// The lower 32 bits.
const LOW: u64 = 0xFFFF_FFFF;

/// Draw number `index[i]` of run `run[i]`: 53 random bits each.
///
/// The key is the seed; the counter is (index, stream, run), the run in two words.
#[inline(always)]
fn bits<const N: usize>(seed: u64, run: &[u64; N], stream: Stream, index: &[u32; N]) -> [u64; N] {
    let mut counter = [[u64::from(stream.word()); N]; 4];
    for i in 0..N {
        counter[0][i] = u64::from(index[i]);
        counter[2][i] = run[i] & LOW;
        counter[3][i] = run[i] >> 32;
    }
    let words = philox4x32(counter, [seed as u32, (seed >> 32) as u32]);
    let mut bits = [0; N];
    for i in 0..N {
        bits[i] = (words[1][i] << 32 | words[0][i]) >> 11;
    }
    bits
}

/// Noise of the sensors of `N` runs, each at a sample of its own: of the position, and of the force.
///
/// Each is the sum of eight random bytes, shifted and scaled to mean 0 and variance 1: nearly normal,
/// |w| < 4.88, excess kurtosis -0.15, in steps of 0.005. One call of the generator gives both.
#[must_use]
#[inline(always)]
pub fn noise<const N: usize>(seed: u64, run: &[u64; N], sample: &[u64; N]) -> [[f64; N]; 2] {
    let mut counter = [[u64::from(Stream::Noise.word()); N]; 4];
    for i in 0..N {
        counter[0][i] = sample[i] & LOW;
        counter[2][i] = run[i] & LOW;
        counter[3][i] = run[i] >> 32;
    }
    let words = philox4x32(counter, [seed as u32, (seed >> 32) as u32]);
    let mut draws = [[0.0; N]; 2];
    for i in 0..N {
        draws[0][i] = nearly_normal(words[1][i] << 32 | words[0][i]);
        draws[1][i] = nearly_normal(words[3][i] << 32 | words[2][i]);
    }
    draws
}

/// The sum of the bytes of a word, at mean 0 and variance 1.
#[inline(always)]
fn nearly_normal(word: u64) -> f64 {
    const EVERY_OTHER: u64 = 0x00FF_00FF_00FF_00FF;
    const MEAN: f64 = 8.0 * 255.0 / 2.0;
    const PER_DEVIATION: f64 = 1.0 / 209.021_529_035_956_37; // sqrt(8 (256² − 1) / 12)
    let pairs = (word & EVERY_OTHER) + ((word >> 8) & EVERY_OTHER);
    let sum = pairs.wrapping_mul(0x0001_0001_0001_0001) >> 48;
    (sum as f64 - MEAN) * PER_DEVIATION
}

/// Draw number `index` of a stream, uniform on [-1, 1): 53 bits of it.
///
/// # Example
/// ```
/// use breakaway_batch::draws::{Stream, uniform};
/// let w = uniform(7, 3, Stream::Disturbance, 0);
/// assert!((-1.0..1.0).contains(&w));
/// assert_eq!(w, uniform(7, 3, Stream::Disturbance, 0));
/// assert_ne!(w, uniform(7, 4, Stream::Disturbance, 0));
/// ```
#[must_use]
pub fn uniform(seed: u64, run: u64, stream: Stream, index: u32) -> f64 {
    centered(bits(seed, &[run], stream, &[index])[0])
}

/// Draw number 0 of a stream, uniform on (0, 1): for a number that a run has from its start.
///
/// # Example
/// ```
/// use breakaway_batch::draws::{Stream, fraction};
/// let u = fraction(7, 3, Stream::Part(0));
/// assert!(0.0 < u && u < 1.0);
/// ```
#[must_use]
pub fn fraction(seed: u64, run: u64, stream: Stream) -> f64 {
    open(bits(seed, &[run], stream, &[0])[0])
}

/// What makes the field of a run its own.
///
/// # Example
/// ```
/// use breakaway_batch::draws::field_keys;
/// let keys = field_keys(7, 3);
/// assert!(keys.first.abs() <= 33_554_432.0 && (0.0..1.0).contains(&keys.offset));
/// assert_ne!(keys, field_keys(7, 4));
/// ```
#[must_use]
pub fn field_keys(seed: u64, run: u64) -> FieldKeys<f64> {
    let counter = [[0], [u64::from(Stream::Field.word())], [run & LOW], [run >> 32]];
    let words = philox4x32(counter, [seed as u32, (seed >> 32) as u32]);
    let whole = |word: u64| (word >> 6) as f64 - f64::from(1_u32 << 25);
    FieldKeys {
        first: whole(words[0][0]),
        second: whole(words[1][0]),
        offset: words[2][0] as f64 * 2.0_f64.powi(-32),
    }
}

/// When the first draw is due in a run that begins with `sample`: never, if it has no disturbance.
fn first_redraw(disturbance: &Disturbance<f64>, sample: u64) -> u64 {
    if disturbance.var == 0.0 { u64::MAX } else { sample }
}

/// On [-1, 1).
#[inline(always)]
fn centered(bits: u64) -> f64 {
    bits as f64 * 2.0_f64.powi(-52) - 1.0
}

/// On (0, 1); its ends cannot be drawn.
fn open(bits: u64) -> f64 {
    (bits >> 1) as f64 * 2.0_f64.powi(-52) + 2.0_f64.powi(-53)
}

/// What noise behind a low-pass keeps of itself from one draw to the next: a = exp(-2π f_b hold).
#[must_use]
pub fn kept<R: Real>(bandwidth_hz: R, hold_s: R) -> R {
    (R::constant(-std::f64::consts::TAU) * bandwidth_hz * hold_s).exp()
}

/// Largest |w| of the normal laws.
const W_MAX: f64 = 4.0;
/// P(w < -4) of a normal variable.
const BEYOND: f64 = 3.167_124_183_311_992e-5;

/// The draws of `N` runs side by side, each held for a time of its own.
///
/// Draw number j holds from the first sample at or after j · hold on (a sample within 1e-6 periods
/// of it counts as at it). A hold time need not be a whole number of control periods, but must
/// not be shorter than one.
#[derive(Clone, Copy, Debug)]
pub struct HeldDraws<const N: usize> {
    seed: u64,
    run: [u64; N],
    law: [DrawLaw<f64>; N],
    hold_s: [f64; N],
    samples_per_draw: [f64; N],
    draws: [u32; N],
    begun: [u64; N],
    next_redraw: [u64; N],
    low_passed: [f64; N],
    held: [f64; N],
}

impl<const N: usize> HeldDraws<N> {
    /// For the runs of a seed, with the disturbance of each and their sampling period in s. Draws
    /// of a run without a disturbance are never due.
    #[must_use]
    pub fn new(
        seed: u64,
        run: [u64; N],
        disturbance: impl Fn(usize) -> Disturbance<f64>,
        period_s: impl Fn(usize) -> f64,
    ) -> Self {
        let all: [Disturbance<f64>; N] = std::array::from_fn(disturbance);
        Self {
            seed,
            run,
            law: all.map(|one| one.law),
            hold_s: all.map(|one| one.hold_s),
            samples_per_draw: std::array::from_fn(|i| all[i].hold_s / period_s(i)),
            draws: [0; N],
            begun: [0; N],
            next_redraw: all.map(|one| first_redraw(&one, 0)),
            low_passed: [0.0; N],
            held: [0.0; N],
        }
    }

    /// Begins place `i` anew with another run, whose sample 0 is `sample` here.
    pub(crate) fn begin(
        &mut self,
        i: usize,
        run: u64,
        disturbance: &Disturbance<f64>,
        period_s: f64,
        sample: u64,
    ) {
        (self.run[i], self.law[i], self.hold_s[i]) = (run, disturbance.law, disturbance.hold_s);
        self.samples_per_draw[i] = disturbance.hold_s / period_s;
        (self.draws[i], self.begun[i]) = (0, sample);
        self.next_redraw[i] = first_redraw(disturbance, sample);
        (self.low_passed[i], self.held[i]) = (0.0, 0.0);
    }

    /// Draws for sample number `sample` where one is due; gives the sample of the next draw.
    /// Samples must be asked for in order.
    #[inline(always)]
    pub fn redraw_after(&mut self, sample: u64) -> u64 {
        let mut next = u64::MAX;
        for i in 0..N {
            next = next.min(self.next_redraw[i]);
        }
        if sample < next {
            return next;
        }
        let bits = bits(self.seed, &self.run, Stream::Disturbance, &self.draws);
        next = u64::MAX;
        for i in 0..N {
            if sample >= self.next_redraw[i] {
                self.held[i] = self.draw(i, bits[i]);
                self.draws[i] += 1;
                let due = f64::from(self.draws[i]) * self.samples_per_draw[i] - 1e-6;
                self.next_redraw[i] = self.begun[i].saturating_add(due.ceil() as u64);
            }
            next = next.min(self.next_redraw[i]);
        }
        next
    }

    #[inline(always)]
    fn draw(&mut self, i: usize, bits: u64) -> f64 {
        match self.law[i] {
            DrawLaw::Uniform => centered(bits),
            DrawLaw::Gaussian => quantile(BEYOND + open(bits) * (1.0 - 2.0 * BEYOND)),
            DrawLaw::BandLimited { bandwidth_hz } => self.low_pass(i, bandwidth_hz, bits),
        }
    }

    /// w ← a w + √(1 − a²) ξ with a = exp(−2π f_b hold) and ξ normal: noise of variance 1 behind a
    /// first-order low-pass, from its first draw on.
    fn low_pass(&mut self, i: usize, bandwidth_hz: f64, bits: u64) -> f64 {
        let a = kept(bandwidth_hz, self.hold_s[i]);
        let fresh = quantile(open(bits));
        self.low_passed[i] = match self.draws[i] {
            0 => fresh,
            _ => a * self.low_passed[i] + (1.0 - a * a).sqrt() * fresh,
        };
        self.low_passed[i].clamp(-W_MAX, W_MAX)
    }

    /// The draw of each run that holds; zero before the first.
    #[must_use]
    pub fn held(&self) -> &[f64; N] {
        &self.held
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use breakaway_core::disturbance::DisturbedQuantity;

    #[test]
    fn philox_known_answers() {
        // The vectors published with the authors' Random123 library.
        let known = [
            ([0; 4], [0; 2], [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]),
            ([u32::MAX; 4], [u32::MAX; 2], [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, words) in known {
            let wide = |words: [u32; 4]| words.map(|word| [u64::from(word)]);
            assert_eq!(philox4x32(wide(counter), key), wide(words));
        }
    }

    #[test]
    fn draws_are_uniform_and_independent_between_runs() {
        let n = 100_000_u32;
        let (mut sum, mut square, mut product) = (0.0, 0.0, 0.0);
        for i in 0..n {
            let a = uniform(1, 0, Stream::Disturbance, i);
            let b = uniform(1, 1, Stream::Disturbance, i);
            (sum, square, product) = (sum + a, square + a * a, product + a * b);
        }
        let n = f64::from(n);
        // Five standard errors of each mean.
        assert!((sum / n).abs() < 5.0 * (1.0 / 3.0 / n).sqrt());
        assert!((square / n - 1.0 / 3.0).abs() < 5.0 * (4.0 / 45.0 / n).sqrt());
        assert!((product / n).abs() < 5.0 * (1.0 / 9.0 / n).sqrt());
    }

    #[test]
    fn a_draw_is_held_for_its_time() {
        let law = DrawLaw::Uniform;
        let acts_on = DisturbedQuantity::JointForce;
        let disturbance = Disturbance { law, var: 0.1, hold_s: 1e-4, acts_on };
        let mut draws = HeldDraws::new(5, [0], |_| disturbance, |_| 1e-5);
        let held: Vec<f64> = (0..100_000)
            .map(|n| {
                draws.redraw_after(n);
                draws.held()[0]
            })
            .collect();
        for (j, block) in held.chunks(10).enumerate() {
            let expected = uniform(5, 0, Stream::Disturbance, j as u32);
            assert!(block.iter().all(|&w| w == expected), "hold {j}");
        }
    }
}
