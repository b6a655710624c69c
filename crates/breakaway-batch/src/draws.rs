//! Random draws as a function of seed, run and number of the draw.
//!
//! Philox4x32-10 (Salmon, Moraes, Dror and Shaw, *Parallel random numbers: as easy as 1, 2, 3*,
//! SC 2011) turns a key and a counter into four random words. A draw therefore depends on nothing
//! that was drawn before it: not on threads, lanes or the order of runs.

/// What a draw is for; each purpose has draws of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Stream {
    /// The disturbance of the joint force.
    Disturbance = 0,
}

/// Four random words for a counter and a key.
#[must_use]
pub fn philox4x32(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for round in 0..10 {
        if round > 0 {
            key[0] = key[0].wrapping_add(0x9E37_79B9);
            key[1] = key[1].wrapping_add(0xBB67_AE85);
        }
        let product0 = u64::from(counter[0]) * 0xD251_1F53;
        let product1 = u64::from(counter[2]) * 0xCD9E_8D57;
        counter = [
            (product1 >> 32) as u32 ^ counter[1] ^ key[0],
            product1 as u32,
            (product0 >> 32) as u32 ^ counter[3] ^ key[1],
            product0 as u32,
        ];
    }
    counter
}

/// Draw number `index` of a stream, uniform on [-1, 1): 53 bits of it.
///
/// The key is the seed; the counter is (index, stream, run), the run in two words.
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
    let counter = [index, stream as u32, run as u32, (run >> 32) as u32];
    let words = philox4x32(counter, [seed as u32, (seed >> 32) as u32]);
    let bits = (u64::from(words[1]) << 32 | u64::from(words[0])) >> 11;
    bits as f64 * 2.0_f64.powi(-52) - 1.0
}

/// The draws of one run, each held for a time.
///
/// Draw number j holds from the first sample at or after j · hold on (a sample within 1e-6 periods
/// of it counts as at it). A hold time need not be a whole number of control periods, but must
/// not be shorter than one.
#[derive(Clone, Copy, Debug)]
pub struct HeldDraws {
    seed: u64,
    run: u64,
    samples_per_draw: f64,
    draws: u32,
    next_redraw: u64,
    held: f64,
}

impl HeldDraws {
    /// For a hold time and a sampling period, both in s and above zero.
    #[must_use]
    pub fn new(seed: u64, run: u64, hold_s: f64, period_s: f64) -> Self {
        let samples_per_draw = hold_s / period_s;
        Self { seed, run, samples_per_draw, draws: 0, next_redraw: 0, held: 0.0 }
    }

    /// Draws for sample number `sample` where one is due; gives the sample of the next draw.
    /// Samples must be asked for in order.
    pub fn redraw_after(&mut self, sample: u64) -> u64 {
        if sample >= self.next_redraw {
            self.held = uniform(self.seed, self.run, Stream::Disturbance, self.draws);
            self.draws += 1;
            self.next_redraw = (f64::from(self.draws) * self.samples_per_draw - 1e-6).ceil() as u64;
        }
        self.next_redraw
    }

    /// The draw that holds; zero before the first.
    #[must_use]
    pub fn held(&self) -> f64 {
        self.held
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            assert_eq!(philox4x32(counter, key), words);
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
        let mut draws = HeldDraws::new(5, 0, 1e-4, 1e-5);
        let held: Vec<f64> = (0..100_000)
            .map(|n| {
                draws.redraw_after(n);
                draws.held()
            })
            .collect();
        for (j, block) in held.chunks(10).enumerate() {
            let expected = uniform(5, 0, Stream::Disturbance, j as u32);
            assert!(block.iter().all(|&w| w == expected), "hold {j}");
        }
    }
}
