//! Runs of any kinds side by side in lanes, in step with each other.

// Lanes are counted, because several arrays have them.
#![allow(clippy::needless_range_loop)]

use std::marker::PhantomData;
use std::ops::Range;

use breakaway_core::disturbance::{Disturbance, Factors};
use breakaway_core::metrics::Limits;
use breakaway_core::real::Block;
use breakaway_core::sensor::Noise;
use breakaway_core::{Draws, Extraction, ExtractionState, Metrics, Name};

use crate::draws::{HeldDraws, noise};
use crate::instructions::Kernel;
use crate::lanes::Wide;
use crate::run::Run;
use crate::work::{Queue, Work};

/// Runs of any kinds. A lane takes the next run as soon as its own has ended, until there are none or
/// it is told to stop.
pub(crate) struct Lockstep<'a> {
    pub(crate) work: &'a Work<'a>,
    pub(crate) queue: &'a Queue,
}

impl Kernel for Lockstep<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide, const N: usize>(self) {
        const { assert!(N == V::WIDTH) };
        while let (Some(taken), true) = (self.queue.take(N), self.work.goes_on()) {
            Pack::<V, N>::of(&self, &taken).run();
        }
    }
}

/// How many samples go by between two looks at which runs have ended.
const BLOCK: u64 = 512;

/// Runs that go through the step together.
struct Pack<'a, V, const N: usize> {
    from: &'a Lockstep<'a>,
    extraction: Extraction<V>,
    limits: Limits<V>,
    /// Whether runs end when their part is released, and not all at the same sample.
    ends_early: bool,
    /// Which run of the batch each lane has.
    run: [usize; N],
    /// Its number among the runs of the seed.
    number: [u64; N],
    /// Whether its result is wanted still.
    heeded: [bool; N],
    /// The sample of the pack with which it began.
    begun: [u64; N],
    moving: Moving<V, N>,
}

/// What moves.
#[derive(Clone, Copy)]
struct Moving<V, const N: usize> {
    state: ExtractionState<V>,
    metrics: Metrics<V>,
    draws: HeldDraws<N>,
}

impl<V: Wide, const N: usize> Moving<V, N> {
    /// Puts some lanes to the start of a run: those with a 1.
    fn restart(&mut self, lanes: &[f64; N]) {
        let restarted = V::gather(lanes).is_set();
        let (mut state, mut metrics) = (Vec::new(), Vec::new());
        ExtractionState::at_rest().map(&mut |_, value: f64| state.push(value));
        Metrics::new().map(&mut |_, value: f64| metrics.push(value));
        let (mut state, mut metrics) = (state.into_iter(), metrics.into_iter());
        let choose = |first: Option<f64>, value: V| {
            first.map_or(value, |first| V::select(restarted, V::constant(first), value))
        };
        self.state = self.state.map(&mut |_, value| choose(state.next(), value));
        self.metrics = self.metrics.map(&mut |_, value| choose(metrics.next(), value));
    }
}

/// One lane of numbers.
pub(crate) fn lane_of<V: Wide>(lane: usize) -> impl FnMut(Name<'_>, V) -> f64 {
    move |_, value| value.extract(lane)
}

impl<'a, V: Wide, const N: usize> Pack<'a, V, N> {
    /// Lanes beyond the last of the runs that were taken repeat it.
    fn of(from: &'a Lockstep<'a>, taken: &Range<usize>) -> Self {
        let run = std::array::from_fn(|lane| (taken.start + lane).min(taken.end - 1));
        let batch = from.work.batch;
        let (extraction, limits) = batch.gather::<V>(&run);
        let number = run.map(|run| batch.runs[run]);
        let period_s = batch.common.extraction.timing.control_period_s;
        let disturbance = |lane| extraction.disturbance.map(&mut lane_of(lane));
        let draws = HeldDraws::new(batch.common.seed, number, disturbance, |_| period_s);
        Self {
            from,
            ends_early: (0..N).any(|lane| limits.after_release_s.extract(lane).is_finite()),
            run,
            number,
            heeded: std::array::from_fn(|lane| lane < taken.len()),
            begun: [0; N],
            moving: Moving { state: ExtractionState::at_rest(), metrics: Metrics::new(), draws },
            extraction,
            limits,
        }
    }

    /// Samples that a lane's run still has before it at sample `n`.
    fn left(&self, lane: usize, n: u64) -> u64 {
        self.from.work.batch.common.samples - (n - self.begun[lane])
    }

    /// Takes blocks of samples until all runs have ended.
    #[inline(always)]
    fn run(mut self) {
        let mut n = 0;
        while self.heeded.contains(&true) && self.from.work.goes_on() {
            let left = (0..N).map(|lane| self.left(lane, n)).fold(BLOCK, u64::min);
            let end = n + left;
            self.advance(n..end);
            n = end;
            self.hand_over(n);
        }
    }

    /// Gives away runs that have ended before sample `n`. Their lanes get the next runs, where
    /// these end early too; otherwise they begin their own once more, and nobody heeds them: a part
    /// that was left alone would sink to numbers so small that processors are slow with them.
    fn hand_over(&mut self, n: u64) {
        let goes_on = V::flag(self.moving.metrics.goes_on());
        let mut ended = [0.0; N];
        for lane in 0..N {
            if self.left(lane, n) > 0 && goes_on.extract(lane) == 1.0 {
                continue;
            }
            if self.heeded[lane] {
                let _ = self.from.work.done.send((self.run[lane], self.finished(lane))); // may be stopped
            }
            let next =
                if self.ends_early && self.heeded[lane] { self.from.queue.take(1) } else { None };
            self.heeded[lane] = next.is_some();
            self.run[lane] = next.map_or(self.run[lane], |run| run.start);
            self.begun[lane] = n;
            ended[lane] = 1.0;
        }
        if ended.contains(&1.0) && self.heeded.contains(&true) {
            self.begin(&ended, n);
        }
    }

    fn finished(&self, lane: usize) -> Run {
        let Moving { state, metrics, .. } = &self.moving;
        let end_m = state.plant.position_m.extract(lane);
        let limits = self.limits.map(&mut lane_of(lane));
        Run::finished(metrics.map(&mut lane_of(lane)), end_m, &limits)
    }

    /// Begins the runs of some lanes, those with a 1, with sample `n`.
    fn begin(&mut self, lanes: &[f64; N], n: u64) {
        let batch = self.from.work.batch;
        (self.extraction, self.limits) = batch.gather::<V>(&self.run);
        self.moving.restart(lanes);
        for lane in (0..N).filter(|&lane| lanes[lane] == 1.0) {
            self.number[lane] = batch.runs[self.run[lane]];
            let disturbance: Disturbance<f64> = self.extraction.disturbance.map(&mut lane_of(lane));
            let period_s = batch.common.extraction.timing.control_period_s;
            self.moving.draws.begin(lane, self.number[lane], &disturbance, period_s, n);
        }
    }

    /// Any kinds: what moves stays in memory, where blocks compiled on their own reach it.
    #[inline(always)]
    fn advance(&mut self, samples: Range<u64>) {
        let (any, limits, groups) = (&self.extraction, &self.limits, self.from.work.groups);
        let begun = V::gather(&self.begun.map(|sample| sample as f64));
        let Moving { state, metrics, draws } = &mut self.moving;
        let mut n = samples.start;
        while n < samples.end {
            let redraw = draws.redraw_after(n);
            let factors = disturbed(any, draws.held());
            let end = samples.end.min(redraw);
            while n < end {
                let noise = match any.sensors {
                    Some(_) => {
                        let (seed, runs, begun) =
                            (self.from.work.batch.common.seed, &self.number, &self.begun);
                        V::apart(NoiseAt { seed, runs, begun, sample: n, number: PhantomData })
                    }
                    None => Noise::none(),
                };
                let time_s = (V::constant(n as f64) - begun) * any.timing.control_period_s;
                let setpoint = any.reference.sample(time_s);
                let error_m = setpoint.position_m - state.plant.position_m;
                let mut seeing = metrics.seeing(groups, limits, error_m);
                let sample = any.follow::<_, true>(state, &setpoint, &factors, &noise, &mut seeing);
                metrics.update(groups, limits, &sample);
                n += 1;
            }
        }
    }
}

/// The factors of the held draws of all lanes.
#[inline(always)]
pub(crate) fn disturbed<V: Wide>(extraction: &Extraction<V>, held: &[f64]) -> Factors<V> {
    let draws = Draws { disturbance: V::gather(held), noise: Noise::none() };
    extraction.factors(draws)
}

/// The noise of all lanes at a sample of the pack.
struct NoiseAt<'a, V, const N: usize> {
    seed: u64,
    runs: &'a [u64; N],
    begun: &'a [u64; N],
    sample: u64,
    number: PhantomData<V>,
}

impl<V: Wide, const N: usize> Block for NoiseAt<'_, V, N> {
    type Output = Noise<V>;

    #[inline(always)]
    fn compute(self) -> Noise<V> {
        let mut own = [0; N];
        for lane in 0..N {
            own[lane] = self.sample - self.begun[lane];
        }
        let [position, force] = noise(self.seed, self.runs, &own);
        Noise { position: V::gather(&position), force: V::gather(&force) }
    }
}
