//! Many runs of one extraction: in lanes, on threads, each with numbers and draws of its own.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use breakaway_core::metrics::{Groups, Limits};
use breakaway_core::{Extraction, Outcome};

use crate::figures::Figure;
use crate::instructions::Instructions;
use crate::lanes::Wide;
use crate::lockstep::{Lockstep, Queue, Work};
use crate::run::{Job, Run, plain_kinds};
use crate::trusted::Trusted;

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

/// How many finished runs may wait to be kept.
const DONE_MOST: usize = 256;
/// How often progress is told, and asked whether to go on.
const TELL_EVERY: Duration = Duration::from_millis(50);

/// Runs a batch on `threads` threads. Which threads, lanes or instructions compute a run
/// changes no bit of it: each has the bits of [`crate::run()`].
///
/// `tell` is told now and then how many runs are done; once it answers `Err`, so does the batch.
///
/// # Errors
/// What `tell` gave, or what kept a thread from being started.
pub fn run_batch<E>(
    batch: &Batch,
    wanted: &Wanted,
    threads: usize,
    instructions: Instructions,
    tell: impl FnMut(usize) -> Result<(), E>,
) -> Result<Results, Ended<E>> {
    let groups = wanted.groups(batch);
    let mut results = Results::of(batch.runs.len(), wanted.figures.len());
    let (queue, going) = (Queue::of(0..batch.runs.len()), AtomicBool::new(true));
    thread::scope(|scope| {
        let (sender, done) = mpsc::sync_channel(DONE_MOST);
        for _ in 0..threads.clamp(1, batch.runs.len().max(1)) {
            let work = Work { batch, groups, going: &going, done: sender.clone() };
            let queue = &queue;
            let part = move || take_part(&work, queue, instructions);
            if let Err(error) = thread::Builder::new().spawn_scoped(scope, part) {
                going.store(false, Ordering::Relaxed);
                return Err(Ended::NoThread(error));
            }
        }
        drop(sender);
        let kept =
            keep_until_done(&done, |i, run| results.keep(i, &batch.job(i), run, wanted), tell);
        going.store(kept.is_ok(), Ordering::Relaxed);
        kept.map_err(Ended::Told)
    })?;
    Ok(results)
}

/// Why a batch has no results.
#[derive(Debug)]
pub enum Ended<E> {
    /// `tell` has had enough, and gave this.
    Told(E),
    /// The system starts no further thread.
    NoThread(io::Error),
}

/// What a thread does of a batch.
fn take_part(work: &Work, queue: &Queue, instructions: Instructions) {
    let Job { extraction, limits, .. } = &work.batch.common;
    if plain_kinds(extraction).is_none() || limits.after_release_s.is_finite() {
        return instructions.run_large(Lockstep { work, queue });
    }
    while let (Some(runs), true) = (queue.take(instructions.lanes()), work.goes_on()) {
        if !instructions.run(Trusted { work, runs: runs.clone() }) {
            instructions.run_large(Lockstep { work, queue: &Queue::of(runs) });
        }
    }
}

/// Keeps runs as they are done and tells how many, until all threads have ended or `tell` has had
/// enough.
fn keep_until_done<E>(
    done: &Receiver<(usize, Run)>,
    mut keep: impl FnMut(usize, &Run),
    mut tell: impl FnMut(usize) -> Result<(), E>,
) -> Result<(), E> {
    let (mut total, mut told) = (0, Instant::now());
    loop {
        match done.recv_timeout(TELL_EVERY) {
            Ok((i, run)) => {
                keep(i, &run);
                total += 1;
            }
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

    /// The numbers of several runs side by side: in each lane those of run number `runs[lane]`.
    pub(crate) fn gather<V: Wide>(&self, runs: &[usize]) -> (Extraction<V>, Limits<V>) {
        let mut place = 0;
        self.common.map_numbers(&mut |_, value| {
            let varied = self.varied.iter().find(|varied| varied.place == place);
            place += 1;
            varied.map_or_else(
                || V::constant(value),
                |varied| V::gather(&runs.iter().map(|&i| varied.values[i]).collect::<Vec<f64>>()),
            )
        })
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

impl Results {
    fn of(runs: usize, figures: usize) -> Self {
        Self {
            figures: vec![vec![f64::NAN; runs]; figures],
            outcomes: vec![Outcome::NotReleased; runs],
        }
    }

    fn keep(&mut self, i: usize, job: &Job, run: &Run, wanted: &Wanted) {
        for (column, figure) in self.figures.iter_mut().zip(&wanted.figures) {
            column[i] = (figure.value)(job, run);
        }
        self.outcomes[i] = run.outcome;
    }
}
