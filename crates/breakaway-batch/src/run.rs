//! One run, with the trace that was asked for.

use breakaway_core::actuator::{Actuator, Tip};
use breakaway_core::control::{Controller, Pid};
use breakaway_core::extraction::{Sample, Timing};
use breakaway_core::joint::Joint;
use breakaway_core::metrics::{Groups, Limits};
use breakaway_core::sensor::Noise;
use breakaway_core::variation::Variation;
use breakaway_core::{Draws, Extraction, ExtractionState, Metrics, Name, Outcome, Real};

use std::ops::Range;

use crate::draws::{HeldDraws, field_keys, noise};
use crate::paths::numbered;

/// The names of a trace's columns. The last three are of a feed axis, and empty without one.
pub const TRACE_COLUMNS: [&str; 10] = [
    "t_s",
    "reference_m",
    "position_m",
    "velocity_m_per_s",
    "bristle_m",
    "applied_force_n",
    "joint_force_n",
    "feed_m",
    "tool_m",
    "tip_m",
];

/// How many columns a feed axis adds.
const AXIS_COLUMNS: usize = 3;

/// An extraction to run.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// What is run.
    pub extraction: Extraction<f64>,
    /// Where it ends, and how it is judged.
    pub limits: Limits<f64>,
    /// Control periods to run for.
    pub samples: u64,
    /// Seed of all random draws.
    pub seed: u64,
    /// Number of the run among the runs of that seed.
    pub run: u64,
    /// Every how many samples the trace keeps a row; 0 for no trace.
    pub trace_every: u64,
}

/// A trace: a column of numbers for each of [`TRACE_COLUMNS`].
pub type Trace = [Vec<f64>; TRACE_COLUMNS.len()];

/// What a run gave.
#[derive(Clone, Debug)]
pub struct Run {
    /// How it ended.
    pub outcome: Outcome,
    /// Its sums and extremes.
    pub metrics: Metrics<f64>,
    /// The rows that were asked for.
    pub trace: Trace,
}

/// How often a run asks whether it should go on.
const STEPS_PER_CHECK: u64 = 1 << 14;

/// Runs a job to its end, or until it diverges.
///
/// `keep_going` is asked now and then; once it answers `Err`, so does the run.
///
/// A row of the trace holds the state at a sample and the forces during the period after it. The
/// last row is the state after the last period, with the forces of that period; in a run that
/// diverges, the sample that left the bounds.
///
/// Feed, tool and tip of a feed axis are given as the place of the tip's face, were what lies beyond
/// each of them relaxed: position − tip is the gap (below zero: how far the contact is pressed),
/// tip − tool what the stack lengthens, feed − tool what the axis yields. Those of the last row are
/// always as after the last period.
///
/// The loop is compiled twice, because compilers target the oldest processor of a family, where
/// a fused multiply-add is a library call. Both give the same bits. A loop of one number has nothing
/// to gain from wider vectors. A loop that also traces a feed axis is one of its own: the others, in
/// which nothing looks at the actuator, are several times as fast.
///
/// # Errors
/// What `keep_going` gave.
pub fn run<E>(job: &Job, keep_going: impl FnMut() -> Result<(), E>) -> Result<Run, E> {
    if job.trace_every != 0 && matches!(job.extraction.actuator, Actuator::FeedAxis(_)) {
        run_on_processor::<true, E>(job, keep_going)
    } else {
        run_on_processor::<false, E>(job, keep_going)
    }
}

fn run_on_processor<const AXIS: bool, E>(
    job: &Job,
    keep_going: impl FnMut() -> Result<(), E>,
) -> Result<Run, E> {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        // SAFETY: the processor was just asked for both features.
        #[allow(unsafe_code)]
        return unsafe { run_with_fma::<AXIS, E>(job, keep_going) };
    }
    run_kinds::<AXIS, E>(job, keep_going)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
#[allow(unsafe_code)]
unsafe fn run_with_fma<const AXIS: bool, E>(
    job: &Job,
    keep_going: impl FnMut() -> Result<(), E>,
) -> Result<Run, E> {
    run_kinds::<AXIS, E>(job, keep_going)
}

/// The extraction again if it is of the commonest kinds, written so that the compiler sees them; with
/// friction that varies along the way, or with friction that does not.
#[inline(always)]
pub(crate) fn plain_kinds<R: Real, const FIELD: bool>(
    extraction: &Extraction<R>,
) -> Option<Extraction<R>> {
    let Extraction { joint, controller, actuator, timing, .. } = *extraction;
    match (joint, controller, actuator) {
        (Joint::Lugre(joint), Controller::Pid(pid), Actuator::Ideal)
            if joint.is_plain()
                && extraction.variation.is_field_at_most()
                && extraction.variation.field.is_some() == FIELD
                && extraction.sensors.is_none()
                && extraction.watch.is_none()
                && pid.is_plain()
                && timing.is_every_period_once() =>
        {
            Some(Extraction {
                joint: Joint::Lugre(joint.plain()),
                controller: Controller::Pid(Pid::plain(pid.gains)),
                actuator: Actuator::Ideal,
                variation: match extraction.variation.field {
                    Some(field) if FIELD => Variation { field: Some(field), ..Variation::none() },
                    _ => Variation::none(),
                },
                sensors: None,
                watch: None,
                timing: Timing::every_period_once(timing.control_period_s),
                ..*extraction
            })
        }
        _ => None,
    }
}

#[inline(always)]
fn run_kinds<const AXIS: bool, E>(
    job: &Job,
    mut keep_going: impl FnMut() -> Result<(), E>,
) -> Result<Run, E> {
    let mut progress = Progress { state: ExtractionState::at_rest(), metrics: Metrics::new() };
    let job = &job.drawn();
    let Extraction { disturbance, timing, .. } = job.extraction;
    let mut draws =
        HeldDraws::new(job.seed, [job.run], |_| disturbance, |_| timing.control_period_s);
    let mut rows = Rows::of(job);
    let plain = if AXIS { None } else { plain_kinds::<_, false>(&job.extraction) };
    let per_check = (STEPS_PER_CHECK / u64::from(job.extraction.timing.steps_per_period)).max(1);
    let mut n = 0;
    while n < job.samples && progress.metrics.goes_on() {
        let redraw = draws.redraw_after(n);
        let disturbance = draws.held()[0];
        let check = (n / per_check + 1) * per_check;
        let end = job.samples.min(redraw).min(check);
        let (taken, last) = match &plain {
            Some(plain) => progress.advance::<false>(plain, job, disturbance, n..end, &mut rows),
            None => progress.advance::<AXIS>(&job.extraction, job, disturbance, n..end, &mut rows),
        };
        n = taken;
        if let (Some(sample), true) = (last, job.trace_every != 0) {
            let end = progress.metrics.bounded == 1.0;
            let row = if end { job.end_of(&sample, &progress.state) } else { sample };
            if AXIS {
                rows.drop_axis_beyond();
                rows.keep_axis(&job.extraction, &progress.state);
            }
            record(&mut rows.trace, row_of(&row));
        }
        if n == check {
            keep_going()?;
        }
    }
    let Progress { state, metrics } = progress;
    Ok(Run { trace: rows.trace, ..Run::finished(metrics, state.plant.position_m, &job.limits) })
}

/// The rows that were kept so far.
struct Rows {
    trace: Trace,
    next: u64,
    every: u64,
}

impl Rows {
    fn of(job: &Job) -> Self {
        match job.trace_every {
            0 => Self { trace: Trace::default(), next: u64::MAX, every: 0 },
            every => {
                let most = usize::try_from(job.samples / every + 2).unwrap_or(0);
                let trace = std::array::from_fn(|_| Vec::with_capacity(most));
                Self { trace, next: 0, every }
            }
        }
    }
}

impl Rows {
    /// Keeps where a feed axis is, if there is one, for the row that comes next.
    #[inline(always)]
    fn keep_axis(&mut self, extraction: &Extraction<f64>, state: &ExtractionState<f64>) {
        let Actuator::FeedAxis(axis) = &extraction.actuator else { return };
        let actuator = &state.actuator;
        let tip_m = match axis.tip {
            Tip::Rigid => actuator.tool_m,
            Tip::Piezo(_) => actuator.tip_m,
        };
        let gap_m = axis.contact.gap_m;
        record_axis(&mut self.trace, gap_m, actuator.feed_m, actuator.tool_m, tip_m);
    }

    /// Forgets where the axis was at a sample whose row was not kept, since it left the bounds.
    fn drop_axis_beyond(&mut self) {
        let (part, axis) = self.trace.split_at_mut(TRACE_COLUMNS.len() - AXIS_COLUMNS);
        for column in axis {
            column.truncate(part[0].len());
        }
    }
}

/// A run under way.
struct Progress {
    state: ExtractionState<f64>,
    metrics: Metrics<f64>,
}

impl Progress {
    /// Takes samples with one draw of the disturbance. Stops at one that ends the run, and gives it
    /// after the number of the next. What moves at every sample is kept in local variables, and so in
    /// registers.
    #[inline(always)]
    fn advance<const AXIS: bool>(
        &mut self,
        extraction: &Extraction<f64>,
        job: &Job,
        disturbance: f64,
        samples: Range<u64>,
        rows: &mut Rows,
    ) -> (u64, Option<Sample<f64>>) {
        let (extraction, limits) = (*extraction, job.limits);
        let (mut state, mut metrics) = (self.state, self.metrics);
        metrics.bounded = 1.0; // as it is; said here, it need not be asked at every sample
        metrics.over = 0.0; // likewise
        let mut next_row = rows.next;
        let mut last = None;
        let mut n = samples.start;
        while n < samples.end {
            if AXIS && n == next_row {
                rows.keep_axis(&extraction, &state); // before the step moves it
            }
            let draws = job.draws(&extraction, disturbance, n);
            let sample = metrics.step(Groups::ALL, &limits, &extraction, &mut state, draws);
            let bounded = metrics.bounded == 1.0;
            if n == next_row && bounded {
                record(&mut rows.trace, row_of(&sample));
                next_row += rows.every;
            }
            n += 1;
            if !metrics.goes_on() || n == job.samples {
                last = Some(sample);
                break;
            }
        }
        rows.next = next_row;
        (self.state, self.metrics) = (state, metrics);
        (n, last)
    }
}

/// What a row has of the part.
type PartRow = [f64; TRACE_COLUMNS.len() - AXIS_COLUMNS];

#[inline(always)]
fn row_of(sample: &Sample<f64>) -> PartRow {
    [
        sample.time_s,
        sample.reference_m,
        sample.position_m,
        sample.velocity_m_per_s,
        sample.bristle_m,
        sample.applied_force_n,
        sample.joint_force_n,
    ]
}

#[inline(never)]
fn record(trace: &mut Trace, row: PartRow) {
    for (column, value) in trace.iter_mut().zip(row) {
        column.push(value);
    }
}

/// Keeps where the tip's face would be by feed, tool and tip, which moved this far. Values are given
/// and not the state, which stays in registers.
#[cold]
#[inline(never)]
fn record_axis(trace: &mut Trace, gap_m: f64, feed_m: f64, tool_m: f64, tip_m: f64) {
    let columns = trace.iter_mut().skip(TRACE_COLUMNS.len() - AXIS_COLUMNS);
    for (column, moved_m) in columns.zip([feed_m, tool_m, tip_m]) {
        column.push(moved_m - gap_m);
    }
}

impl Run {
    /// A run without a trace that ended at position `end_m`.
    pub(crate) fn finished(mut metrics: Metrics<f64>, end_m: f64, limits: &Limits<f64>) -> Self {
        if !end_m.is_finite() {
            metrics.bounded = 0.0; // the last step of all left the numbers
        }
        Self { outcome: metrics.outcome(limits), metrics, trace: Trace::default() }
    }
}

impl Job {
    /// The job with what is drawn for its run before it.
    #[must_use]
    pub fn drawn(&self) -> Self {
        let mut job = *self;
        if let Some(field) = &mut job.extraction.variation.field {
            field.keys = field_keys(self.seed, self.run);
        }
        job
    }

    /// Applies `f` to every number: those of the extraction, then those of the limits.
    pub(crate) fn map_numbers<S: Real>(
        &self,
        f: &mut impl FnMut(Name<'_>, f64) -> S,
    ) -> (Extraction<S>, Limits<S>) {
        (self.extraction.map(f), self.limits.map(f))
    }

    /// Every number, in an order that depends on the kinds only.
    #[must_use]
    pub fn numbers(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        self.map_numbers(&mut |_, value| {
            numbers.push(value);
            value
        });
        numbers
    }

    /// The path of each of [`Job::numbers`], such as `extraction.joint.stiction_n`.
    #[must_use]
    pub fn number_paths(&self) -> Vec<String> {
        let mut paths = Vec::new();
        self.extraction.map(&mut |name, value| {
            paths.push(format!("extraction.{name}"));
            value
        });
        self.limits.map(&mut |name, _| paths.push(format!("limits.{name}")));
        numbered(paths)
    }

    /// The same kinds with other numbers, each by its place in [`Job::numbers`].
    #[must_use]
    pub fn with_numbers(&self, number: impl Fn(usize) -> f64) -> Self {
        let mut place = 0;
        let (extraction, limits) = self.map_numbers(&mut |_, _| {
            place += 1;
            number(place - 1)
        });
        Self { extraction, limits, ..*self }
    }

    /// The draws of a sample.
    #[inline(always)]
    fn draws(&self, extraction: &Extraction<f64>, disturbance: f64, sample: u64) -> Draws<f64> {
        if extraction.sensors.is_none() {
            return Draws { disturbance, ..Draws::none() };
        }
        let [[position], [force]] = noise(self.seed, &[self.run], &[sample]);
        Draws { disturbance, noise: Noise { position, force } }
    }

    /// The state after the last sample, as a row.
    fn end_of(&self, last: &Sample<f64>, state: &ExtractionState<f64>) -> Sample<f64> {
        let time_s = state.sampling.samples * last.period_s;
        Sample {
            time_s,
            reference_m: self.extraction.reference.sample(time_s).position_m,
            position_m: state.plant.position_m,
            velocity_m_per_s: state.plant.velocity_m_per_s,
            bristle_m: state.plant.bristle_m,
            ..*last
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Job, run, run_kinds};
    use breakaway_core::test_models::{paper_as_computed, paper_limits};
    use std::convert::Infallible;

    #[test]
    fn every_compilation_of_the_loop_gives_the_same_bits() {
        let mut job = Job {
            extraction: paper_as_computed(),
            limits: paper_limits(),
            samples: 20_000,
            seed: 3,
            run: 1,
            trace_every: 7,
        };
        job.extraction.disturbance.var = 0.2;
        let Ok(chosen) = run::<Infallible>(&job, || Ok(()));
        let Ok(portable) = run_kinds::<false, Infallible>(&job, || Ok(()));
        assert_eq!(chosen.metrics, portable.metrics);
        assert_eq!(chosen.trace, portable.trace);
    }

    #[test]
    fn a_run_stops_when_it_is_told_to() {
        let job = Job {
            extraction: paper_as_computed(),
            limits: paper_limits(),
            samples: u64::MAX,
            seed: 0,
            run: 0,
            trace_every: 0,
        };
        let mut asked = 0;
        let stopped = run(&job, || {
            asked += 1;
            if asked == 3 { Err("enough") } else { Ok(()) }
        });
        assert_eq!(stopped.err(), Some("enough"));
    }
}
