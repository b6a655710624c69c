//! Many runs of one extraction, each with numbers and draws of its own, and what they give.

use breakaway_core::metrics::{Groups, Limits};
use breakaway_core::variation::FieldKeys;
use breakaway_core::{Extraction, Outcome};

use crate::draws::field_keys;
use crate::figures::Figure;
use crate::lanes::Wide;
use crate::run::{Job, Run};

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
        let (mut extraction, limits) = self.common.map_numbers(&mut |_, value| {
            let varied = self.varied.iter().find(|varied| varied.place == place);
            place += 1;
            varied.map_or_else(
                || V::constant(value),
                |varied| V::gather(&runs.iter().map(|&i| varied.values[i]).collect::<Vec<f64>>()),
            )
        });
        if let Some(field) = &mut extraction.variation.field {
            field.keys = self.field_keys(runs);
        }
        (extraction, limits)
    }

    /// What makes the fields of several runs their own.
    fn field_keys<V: Wide>(&self, runs: &[usize]) -> FieldKeys<V> {
        let keys: Vec<_> =
            runs.iter().map(|&i| field_keys(self.common.seed, self.runs[i])).collect();
        let gathered =
            |of: fn(&FieldKeys<f64>) -> f64| V::gather(&keys.iter().map(of).collect::<Vec<f64>>());
        FieldKeys {
            first: gathered(|keys| keys.first),
            second: gathered(|keys| keys.second),
            offset: gathered(|keys| keys.offset),
        }
    }
}

impl Wanted {
    /// What must be counted. An outcome needs a force or a jump only where it has a limit.
    pub(crate) fn groups(&self, batch: &Batch) -> Groups {
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
    pub(crate) fn of(runs: usize, figures: usize) -> Self {
        Self {
            figures: vec![vec![f64::NAN; runs]; figures],
            outcomes: vec![Outcome::NotReleased; runs],
        }
    }

    pub(crate) fn keep(&mut self, i: usize, job: &Job, run: &Run, wanted: &Wanted) {
        for (column, figure) in self.figures.iter_mut().zip(&wanted.figures) {
            column[i] = (figure.value)(job, run);
        }
        self.outcomes[i] = run.outcome;
    }
}
