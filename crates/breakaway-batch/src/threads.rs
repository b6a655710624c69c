//! Runs a batch on threads, each of which takes runs until there are none.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use crate::batch::{Batch, Results, Wanted};
use crate::instructions::Instructions;
use crate::lockstep::Lockstep;
use crate::run::{Job, Run, plain_kinds};
use crate::trusted::Trusted;
use crate::work::{Queue, Work};

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
    if limits.after_release_s.is_finite() {
        instructions.run_large(Lockstep { work, queue });
    } else if plain_kinds::<_, false>(extraction).is_some() {
        trust::<false>(work, queue, instructions);
    } else if plain_kinds::<_, true>(extraction).is_some() {
        trust::<true>(work, queue, instructions);
    } else {
        instructions.run_large(Lockstep { work, queue });
    }
}

/// What a thread does of a batch of the commonest kinds.
fn trust<const FIELD: bool>(work: &Work, queue: &Queue, instructions: Instructions) {
    while let (Some(runs), true) = (queue.take(instructions.lanes()), work.goes_on()) {
        if !instructions.run(Trusted::<FIELD> { work, runs: runs.clone() }) {
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
