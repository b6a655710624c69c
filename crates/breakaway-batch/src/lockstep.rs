//! Runs side by side in lanes, in step with each other.

// Lanes are counted, because several arrays have them.
#![allow(clippy::needless_range_loop)]

use std::marker::PhantomData;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::Sender;

use breakaway_core::disturbance::{Disturbance, Factors};
use breakaway_core::metrics::{Groups, Limits};
use breakaway_core::real::Block;
use breakaway_core::reference::{Reference, Setpoint};
use breakaway_core::sensor::Noise;
use breakaway_core::{Draws, Extraction, ExtractionState, Metrics, Name};

use crate::batch::Batch;
use crate::draws::{HeldDraws, noise};
use crate::instructions::Kernel;
use crate::lanes::Wide;
use crate::run::{Run, plain_kinds};

/// What a thread does of a batch: takes runs that nobody has taken yet, until there are none or it is
/// told to stop.
pub(crate) struct InLanes<'a> {
    pub(crate) batch: &'a Batch<'a>,
    pub(crate) groups: Groups,
    /// The first run that nobody has taken.
    pub(crate) next: &'a AtomicUsize,
    pub(crate) going: &'a AtomicBool,
    /// Where finished runs go, each with its number in the batch.
    pub(crate) done: Sender<(usize, Run)>,
}

impl Kernel for InLanes<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide, const N: usize>(self) {
        const { assert!(N == V::WIDTH) };
        while let Some(taken) = self.take(N) {
            let mut pack = Pack::<V, N>::of(&self, &taken);
            let mut n = 0;
            if let (Some(plain), false) = (plain_kinds(&pack.extraction), pack.ends_early) {
                n = pack.trust(&plain);
            }
            pack.look(n);
        }
    }
}

impl InLanes<'_> {
    /// Takes up to `count` runs.
    fn take(&self, count: usize) -> Option<Range<usize>> {
        let all = self.batch.runs.len();
        let first = self.next.fetch_add(count, Ordering::Relaxed).min(all);
        let taken = first..all.min(first.saturating_add(count));
        (self.goes_on() && !taken.is_empty()).then_some(taken)
    }

    fn goes_on(&self) -> bool {
        self.going.load(Ordering::Relaxed)
    }
}

/// How many samples go by between two looks at the bounds of runs that are trusted to keep them.
const TRUSTED_BLOCK: u64 = 4096;
/// How many samples go by between two looks at which runs have ended.
const BLOCK: u64 = 512;

/// Runs that go through the step together.
struct Pack<'a, V, const N: usize> {
    from: &'a InLanes<'a>,
    extraction: Extraction<V>,
    limits: Limits<V>,
    setpoints: Setpoints<V>,
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
    /// Whether every run is within its bounds, after samples that were counted unseen.
    fn none_left(&self, limits: &Limits<V>) -> bool {
        let within = V::flag(self.metrics.stayed_within(limits));
        let position_m = self.state.plant.position_m;
        (0..N).all(|lane| within.extract(lane) == 1.0 && position_m.extract(lane).is_finite())
    }

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
fn lane_of<V: Wide>(lane: usize) -> impl FnMut(Name<'_>, V) -> f64 {
    move |_, value| value.extract(lane)
}

impl<'a, V: Wide, const N: usize> Pack<'a, V, N> {
    /// Lanes beyond the last of the runs that were taken repeat it.
    fn of(from: &'a InLanes<'a>, taken: &Range<usize>) -> Self {
        let run = std::array::from_fn(|lane| (taken.start + lane).min(taken.end - 1));
        let batch = from.batch;
        let (extraction, limits) = batch.gather::<V>(&run);
        let number = run.map(|run| batch.runs[run]);
        let period_s = batch.common.extraction.timing.control_period_s;
        let disturbance = |lane| extraction.disturbance.map(&mut lane_of(lane));
        let draws = HeldDraws::new(batch.common.seed, number, disturbance, |_| period_s);
        Self {
            from,
            setpoints: Setpoints::of(&extraction),
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

    fn samples(&self) -> u64 {
        self.from.batch.common.samples
    }

    /// Takes blocks of samples without looking at the bounds, until a block has left them; undoes that
    /// one, and gives the number of its first sample. Extractions of the commonest kinds only: for
    /// each way to step, everything is compiled once for each kind of instructions.
    #[inline(always)]
    fn trust(&mut self, plain: &Extraction<V>) -> u64 {
        let mut n = 0;
        while n < self.samples() && self.from.goes_on() {
            let start = self.moving;
            let end = self.samples().min(n + TRUSTED_BLOCK);
            self.advance_plain(plain, n..end);
            if !self.moving.none_left(&self.limits) {
                self.moving = start;
                break;
            }
            n = end;
        }
        n
    }

    /// Takes blocks of samples, looking at the bounds at each of them, until all runs have ended.
    #[inline(always)]
    fn look(&mut self, first: u64) {
        let mut n = first;
        while self.heeded.contains(&true) && self.from.goes_on() {
            let first_end = (0..N).map(|lane| self.begun[lane] + self.samples()).min();
            let end = first_end.map_or(n, |end| end.min(n + BLOCK));
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
            if n < self.begun[lane] + self.samples() && goes_on.extract(lane) == 1.0 {
                continue;
            }
            if self.heeded[lane] {
                let _ = self.from.done.send((self.run[lane], self.finished(lane))); // may be stopped
            }
            let next = if self.ends_early && self.heeded[lane] { self.from.take(1) } else { None };
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
        let batch = self.from.batch;
        (self.extraction, self.limits) = batch.gather::<V>(&self.run);
        self.moving.restart(lanes);
        for lane in (0..N).filter(|&lane| lanes[lane] == 1.0) {
            self.number[lane] = batch.runs[self.run[lane]];
            let disturbance: Disturbance<f64> = self.extraction.disturbance.map(&mut lane_of(lane));
            let period_s = batch.common.extraction.timing.control_period_s;
            self.moving.draws.begin(lane, self.number[lane], &disturbance, period_s, n);
        }
    }

    /// What is read and what moves at every sample is copied first, so that it is known to be this
    /// function's own, and what does not change is computed once.
    #[inline(always)]
    fn advance_plain(&mut self, plain: &Extraction<V>, samples: Range<u64>) {
        let (extraction, limits, groups) = (*plain, self.limits, self.from.groups);
        let Moving { mut state, mut metrics, .. } = self.moving;
        let draws = &mut self.moving.draws;
        let mut n = samples.start;
        while n < samples.end {
            let redraw = draws.redraw_after(n);
            let factors = disturbed(&extraction, draws.held());
            let end = samples.end.min(redraw);
            while n < end {
                let setpoint = self.setpoints.at(n);
                let none = Noise::none();
                let sample = extraction.follow::<false>(&mut state, &setpoint, &factors, &none);
                metrics.update_unseen(groups, &limits, &sample);
                n += 1;
            }
        }
        (self.moving.state, self.moving.metrics) = (state, metrics);
    }

    /// Any kinds: what moves stays in memory, where blocks compiled on their own reach it.
    #[inline(always)]
    fn advance(&mut self, samples: Range<u64>) {
        let (any, limits, groups) = (&self.extraction, &self.limits, self.from.groups);
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
                            (self.from.batch.common.seed, &self.number, &self.begun);
                        V::apart(NoiseAt { seed, runs, begun, sample: n, number: PhantomData })
                    }
                    None => Noise::none(),
                };
                let time_s = (V::constant(n as f64) - begun) * any.timing.control_period_s;
                let setpoint = any.reference.sample(time_s);
                let sample = any.follow::<true>(state, &setpoint, &factors, &noise);
                metrics.update(groups, limits, &sample);
                n += 1;
            }
        }
    }
}

/// The factors of the held draws of all lanes.
#[inline(always)]
fn disturbed<V: Wide>(extraction: &Extraction<V>, held: &[f64]) -> Factors<V> {
    let draws = Draws { disturbance: V::gather(held), noise: Noise::none() };
    extraction.disturbance.factors(draws)
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

/// Where runs should be that began together: for all of them at once, if they share their reference.
enum Setpoints<V> {
    Shared(Reference<f64>, f64),
    Own(Reference<V>, V),
}

impl<V: Wide> Setpoints<V> {
    fn of(extraction: &Extraction<V>) -> Self {
        let (reference, period_s) = (extraction.reference, extraction.timing.control_period_s);
        let mut shared = true;
        let first = reference.map(&mut |_, value| {
            let first = value.extract(0);
            shared &= (1..V::WIDTH).all(|lane| value.extract(lane).to_bits() == first.to_bits());
            first
        });
        if shared {
            Self::Shared(first, period_s.extract(0))
        } else {
            Self::Own(reference, period_s)
        }
    }

    #[inline(always)]
    fn at(&self, sample: u64) -> Setpoint<V> {
        match self {
            Self::Shared(reference, period_s) => {
                let shared = reference.sample(sample as f64 * period_s);
                Setpoint {
                    time_s: V::constant(shared.time_s),
                    position_m: V::constant(shared.position_m),
                    rate_m_per_s: V::constant(shared.rate_m_per_s),
                }
            }
            Self::Own(reference, period_s) => {
                reference.sample(V::constant(sample as f64) * *period_s)
            }
        }
    }
}
