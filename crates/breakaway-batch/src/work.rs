//! What the threads of a batch share: the runs that are left, and where finished ones go.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::SyncSender;

use breakaway_core::metrics::Groups;

use crate::batch::Batch;
use crate::run::Run;

/// Runs of a batch that nobody has taken yet.
pub(crate) struct Queue {
    next: AtomicUsize,
    end: usize,
}

impl Queue {
    pub(crate) fn of(runs: Range<usize>) -> Self {
        Self { next: AtomicUsize::new(runs.start), end: runs.end }
    }

    /// Takes up to `count` runs.
    pub(crate) fn take(&self, count: usize) -> Option<Range<usize>> {
        let first = self.next.fetch_add(count, Ordering::Relaxed).min(self.end);
        let taken = first..self.end.min(first.saturating_add(count));
        (!taken.is_empty()).then_some(taken)
    }
}

/// What the threads of a batch share.
pub(crate) struct Work<'a> {
    pub(crate) batch: &'a Batch<'a>,
    pub(crate) groups: Groups,
    pub(crate) going: &'a AtomicBool,
    /// Where finished runs go, each with its number in the batch.
    pub(crate) done: SyncSender<(usize, Run)>,
}

impl Work<'_> {
    pub(crate) fn goes_on(&self) -> bool {
        self.going.load(Ordering::Relaxed)
    }
}
