//! Many runs of one extraction: in lanes, on threads, each with numbers and draws of its own.

use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant};

use breakaway_core::disturbance::Factors;
use breakaway_core::metrics::{Groups, Limits};
use breakaway_core::real::Block;
use breakaway_core::reference::{Reference, Setpoint};
use breakaway_core::sensor::Noise;
use breakaway_core::{Draws, Extraction, ExtractionState, Metrics, Name, Outcome};

use crate::draws::{HeldDraws, noise};
use crate::figures::Figure;
use crate::instructions::{Instructions, Kernel};
use crate::lanes::Wide;
use crate::run::{Job, Run, plain_kinds};

/// Runs that differ in their draws and in some of their numbers.
#[derive(Clone, Debug)]
pub struct Batch<'a> {
    /// What the runs have in common. Its run number and trace are not used.
    pub common: Job,
    /// The number of each run among the runs of the seed.
    pub runs: &'a [u64],
    /// The numbers that differ.
    pub varied: Vec<Varied<'a>>,
}

/// A number that differs from run to run.
#[derive(Clone, Copy, Debug)]
pub struct Varied<'a> {
    /// Which one: its place among [`Job::numbers`].
    pub place: usize,
    /// Its value in each run.
    pub values: &'a [f64],
}

/// What is wanted of each run.
#[derive(Clone)]
pub struct Wanted {
    /// Its figures.
    pub figures: Vec<Figure>,
    /// Whether its outcome is judged in full; else only whether it diverged.
    pub outcome: bool,
}

/// What the runs gave, in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct Results {
    /// One column for each figure.
    pub figures: Vec<Vec<f64>>,
    /// How each run ended; where outcomes are not wanted, [`Outcome::Diverged`] or
    /// [`Outcome::NotReleased`].
    pub outcomes: Vec<Outcome>,
}

/// How often progress is told, and asked whether to go on.
const TELL_EVERY: Duration = Duration::from_millis(50);

/// Runs a batch on `threads` threads. Which threads, lanes or instructions compute a run
/// changes no bit of it: each has the bits of [`crate::run()`].
///
/// `tell` is told now and then how many runs are done; once it answers `Err`, so does the batch.
///
/// # Errors
/// What `tell` gave.
pub fn run_batch<E>(
    batch: &Batch,
    wanted: &Wanted,
    threads: usize,
    instructions: Instructions,
    mut tell: impl FnMut(usize) -> Result<(), E>,
) -> Result<Results, E> {
    let mut results = Results::of(batch.runs.len(), wanted.figures.len());
    let groups = wanted.groups(batch);
    let lanes = instructions.lanes();
    let packs = Mutex::new(results.packs(lanes).enumerate());
    let going = AtomicBool::new(true);
    let work = |done: Sender<usize>| {
        while let Some((i, mut pack)) = packs.lock().ok().and_then(|mut left| left.next()) {
            let (first, count) = (i * lanes, pack.outcomes.len());
            let range = first..first + count;
            let Some(runs) = instructions.run(InLanes { batch, range, groups, going: &going })
            else {
                break; // told to stop
            };
            for (lane, run) in runs.iter().enumerate() {
                pack.keep(lane, &batch.job(first + lane), run, wanted);
            }
            let _ = done.send(count); // nobody listens once the batch was stopped
        }
    };
    thread::scope(|scope| {
        let (sender, done) = mpsc::channel();
        for _ in 0..threads.max(1) {
            let sender = sender.clone();
            scope.spawn(|| work(sender));
        }
        drop(sender);
        let told = tell_until_done(&done, &mut tell);
        going.store(told.is_ok(), Ordering::Relaxed);
        told
    })?;
    drop(packs);
    Ok(results)
}

/// Tells how many runs are done, until all threads are or `tell` has had enough.
fn tell_until_done<E>(
    done: &Receiver<usize>,
    tell: &mut impl FnMut(usize) -> Result<(), E>,
) -> Result<(), E> {
    let (mut total, mut told) = (0, Instant::now());
    loop {
        match done.recv_timeout(TELL_EVERY) {
            Ok(count) => total += count,
            Err(RecvTimeoutError::Timeout) => (),
            Err(RecvTimeoutError::Disconnected) => return tell(total),
        }
        if told.elapsed() >= TELL_EVERY {
            tell(total)?;
            told = Instant::now();
        }
    }
}

impl Batch<'_> {
    /// Run number `i` of the batch on its own.
    #[must_use]
    pub fn job(&self, i: usize) -> Job {
        let mut numbers = self.common.numbers();
        for varied in &self.varied {
            numbers[varied.place] = varied.values[i];
        }
        Job { run: self.runs[i], ..self.common.with_numbers(|place| numbers[place]) }
    }

    /// The numbers of several runs side by side; lanes beyond the last run repeat it.
    fn gather<V: Wide>(&self, range: &Range<usize>) -> (Extraction<V>, Limits<V>) {
        let mut place = 0;
        self.common.map_numbers(&mut |_, value| {
            let varied = self.varied.iter().find(|varied| varied.place == place);
            place += 1;
            varied.map_or_else(
                || V::constant(value),
                |varied| {
                    let value = |lane| varied.values[self.at(range, lane)];
                    V::gather(&(0..V::WIDTH).map(value).collect::<Vec<f64>>())
                },
            )
        })
    }

    fn at(&self, range: &Range<usize>, lane: usize) -> usize {
        (range.start + lane).min(range.end - 1)
    }
}

impl Wanted {
    /// What must be counted. An outcome needs a force or a jump only where it has a limit.
    fn groups(&self, batch: &Batch) -> Groups {
        let needs = |needs: Groups, figure: &Figure| needs.with(figure.needs);
        let ends = batch.common.limits.after_release_s.is_finite();
        let groups = Groups { events: ends, ..Groups::NONE };
        let groups = self.figures.iter().fold(groups, needs);
        if !self.outcome {
            return groups;
        }
        let limits = &batch.common.limits;
        let limited = |limit: f64| !batch.varied.is_empty() || limit.is_finite();
        let judged = Groups {
            extremes: limited(limits.peak_force_max_n),
            jump: limited(limits.jump_max_m),
            events: true,
            ..Groups::NONE
        };
        groups.with(judged)
    }
}

/// The results of the runs that go through the step together.
struct Pack<'a> {
    figures: Vec<&'a mut [f64]>,
    outcomes: &'a mut [Outcome],
}

impl Results {
    fn of(runs: usize, figures: usize) -> Self {
        Self {
            figures: vec![vec![f64::NAN; runs]; figures],
            outcomes: vec![Outcome::NotReleased; runs],
        }
    }

    fn packs(&mut self, lanes: usize) -> impl Iterator<Item = Pack<'_>> {
        let mut figures: Vec<_> = self.figures.iter_mut().map(|c| c.chunks_mut(lanes)).collect();
        self.outcomes.chunks_mut(lanes).map(move |outcomes| Pack {
            figures: figures.iter_mut().filter_map(Iterator::next).collect(),
            outcomes,
        })
    }
}

impl Pack<'_> {
    fn keep(&mut self, lane: usize, job: &Job, run: &Run, wanted: &Wanted) {
        for (column, figure) in self.figures.iter_mut().zip(&wanted.figures) {
            column[lane] = (figure.value)(job, run);
        }
        self.outcomes[lane] = run.outcome;
    }
}

/// Part of a batch, at most as many runs as there are lanes. Gives nothing if told to stop.
struct InLanes<'a> {
    batch: &'a Batch<'a>,
    range: Range<usize>,
    groups: Groups,
    going: &'a AtomicBool,
}

impl Kernel for InLanes<'_> {
    type Output = Option<Vec<Run>>;

    #[inline(always)]
    fn run<V: Wide, const N: usize>(self) -> Self::Output {
        const { assert!(N == V::WIDTH) };
        let Self { batch, range, groups, going } = self;
        let job = &batch.common;
        let (extraction, limits) = batch.gather::<V>(&range);
        let lane_of = |lane: usize| move |_: Name<'_>, value: V| value.extract(lane);
        let draws = HeldDraws::<N>::new(
            job.seed,
            std::array::from_fn(|lane| batch.runs[batch.at(&range, lane)]),
            |lane| extraction.disturbance.map(&mut lane_of(lane)),
            |_| job.extraction.timing.control_period_s,
        );
        let mut moving =
            Moving { state: ExtractionState::at_rest(), metrics: Metrics::new(), draws };
        let setpoints = Setpoints::of(&extraction);
        let lockstep = Lockstep {
            samples: job.samples,
            seed: job.seed,
            runs: std::array::from_fn(|lane| batch.runs[batch.at(&range, lane)]),
            limits: &limits,
            setpoints,
            groups,
            going,
        };
        let mut n = 0;
        let ends_early = (0..N).any(|lane| limits.after_release_s.extract(lane).is_finite());
        if let (Some(plain), false) = (plain_kinds(&extraction), ends_early) {
            n = lockstep.trust(&plain, &mut moving);
        }
        lockstep.look(&extraction, &mut moving, n);
        if !going.load(Ordering::Relaxed) {
            return None;
        }
        let Moving { state, metrics, .. } = moving;
        let finish = |lane| {
            let end = state.plant.position_m.extract(lane);
            Run::finished(metrics.map(&mut lane_of(lane)), end, &limits.map(&mut lane_of(lane)))
        };
        Some((0..range.len()).map(finish).collect())
    }
}

/// How many samples go by between two looks at bounds and at whether to go on.
const BLOCK: u64 = 4096;

/// What moves.
#[derive(Clone, Copy)]
struct Moving<V, const N: usize> {
    state: ExtractionState<V>,
    metrics: Metrics<V>,
    draws: HeldDraws<N>,
}

impl<V: Wide, const N: usize> Moving<V, N> {
    fn all_ended(&self) -> bool {
        let goes_on = V::flag(self.metrics.goes_on());
        (0..N).all(|lane| goes_on.extract(lane) == 0.0)
    }

    /// Whether every run is within its bounds, after samples that were counted unseen.
    fn none_left(&self, limits: &Limits<V>) -> bool {
        let within = V::flag(self.metrics.stayed_within(limits));
        let position_m = self.state.plant.position_m;
        (0..N).all(|lane| within.extract(lane) == 1.0 && position_m.extract(lane).is_finite())
    }
}

/// What runs that go through the step together have in common, beside the extraction.
struct Lockstep<'a, V, const N: usize> {
    samples: u64,
    seed: u64,
    runs: [u64; N],
    limits: &'a Limits<V>,
    setpoints: Setpoints<V>,
    groups: Groups,
    going: &'a AtomicBool,
}

impl<V: Wide, const N: usize> Lockstep<'_, V, N> {
    /// Takes blocks of samples without looking at the bounds, until a block has left them; undoes that
    /// one, and gives the number of its first sample. Extractions of the commonest kinds only: for
    /// each way to step, everything is compiled once for each kind of instructions.
    #[inline(always)]
    fn trust(&self, plain: &Extraction<V>, moving: &mut Moving<V, N>) -> u64 {
        let mut n = 0;
        while n < self.samples && self.going.load(Ordering::Relaxed) {
            let start = *moving;
            let end = self.samples.min(n + BLOCK);
            self.advance_plain(plain, moving, n..end);
            if !moving.none_left(self.limits) {
                *moving = start;
                break;
            }
            n = end;
        }
        n
    }

    /// Takes blocks of samples, looking at the bounds at each of them, until all runs have ended.
    #[inline(always)]
    fn look(&self, any: &Extraction<V>, moving: &mut Moving<V, N>, first: u64) {
        let mut n = first;
        while n < self.samples && self.going.load(Ordering::Relaxed) && !moving.all_ended() {
            let end = self.samples.min(n + BLOCK);
            self.advance(any, moving, n..end);
            n = end;
        }
    }

    /// What is read and what moves at every sample is copied first, so that it is known to be this
    /// function's own, and what does not change is computed once.
    #[inline(always)]
    fn advance_plain(&self, plain: &Extraction<V>, moving: &mut Moving<V, N>, samples: Range<u64>) {
        let (extraction, limits) = (*plain, *self.limits);
        let Moving { mut state, mut metrics, .. } = *moving;
        let mut n = samples.start;
        while n < samples.end {
            let redraw = moving.draws.redraw_after(n);
            let factors = disturbed(&extraction, moving.draws.held());
            let end = samples.end.min(redraw);
            while n < end {
                let setpoint = self.setpoints.at(n);
                let none = Noise::none();
                let sample = extraction.follow::<false>(&mut state, &setpoint, &factors, &none);
                metrics.update_unseen(self.groups, &limits, &sample);
                n += 1;
            }
        }
        (moving.state, moving.metrics) = (state, metrics);
    }

    /// Any kinds: what moves stays in memory, where blocks compiled on their own reach it.
    #[inline(always)]
    fn advance(&self, any: &Extraction<V>, moving: &mut Moving<V, N>, samples: Range<u64>) {
        let limits = *self.limits;
        let mut n = samples.start;
        while n < samples.end {
            let redraw = moving.draws.redraw_after(n);
            let factors = disturbed(any, moving.draws.held());
            let end = samples.end.min(redraw);
            while n < end {
                let noise = match any.sensors {
                    Some(_) => {
                        let (seed, runs) = (self.seed, &self.runs);
                        V::apart(NoiseAt { seed, runs, sample: n, number: PhantomData })
                    }
                    None => Noise::none(),
                };
                let setpoint = self.setpoints.at(n);
                let sample = any.follow::<true>(&mut moving.state, &setpoint, &factors, &noise);
                moving.metrics.update(self.groups, &limits, &sample);
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

/// The noise of all lanes at a sample.
struct NoiseAt<'a, V, const N: usize> {
    seed: u64,
    runs: &'a [u64; N],
    sample: u64,
    number: PhantomData<V>,
}

impl<V: Wide, const N: usize> Block for NoiseAt<'_, V, N> {
    type Output = Noise<V>;

    #[inline(always)]
    fn compute(self) -> Noise<V> {
        let [position, force] = noise(self.seed, self.runs, self.sample);
        Noise { position: V::gather(&position), force: V::gather(&force) }
    }
}

/// Where the runs should be: for all of them at once, if they share their reference.
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
