//! Runs of the commonest kinds that end together: their bounds are looked at now and then only.

use std::ops::Range;

use breakaway_core::metrics::Limits;
use breakaway_core::reference::{Reference, Setpoint};
use breakaway_core::sensor::Noise;
use breakaway_core::{Extraction, ExtractionState, Metrics};

use crate::draws::HeldDraws;
use crate::instructions::Kernel;
use crate::lanes::Wide;
use crate::lockstep::{disturbed, lane_of};
use crate::run::{Run, plain_kinds};
use crate::work::Work;

/// How many samples go by between two looks at the bounds.
const BLOCK: u64 = 4096;

/// At most as many runs as there are lanes, which are trusted to keep their bounds. Everything is
/// compiled into one loop for them; into one more where friction varies along the way.
pub(crate) struct Trusted<'a, const FIELD: bool> {
    pub(crate) work: &'a Work<'a>,
    pub(crate) runs: Range<usize>,
}

impl<const FIELD: bool> Kernel for Trusted<'_, FIELD> {
    /// Whether the trust was justified; if not, nothing was done.
    type Output = bool;

    #[inline(always)]
    fn run<V: Wide, const N: usize>(self) -> bool {
        const { assert!(N == V::WIDTH) };
        let Self { work, runs } = self;
        let batch = work.batch;
        let run: [usize; N] = std::array::from_fn(|lane| (runs.start + lane).min(runs.end - 1));
        let (extraction, limits) = batch.gather::<V>(&run);
        let ends_early = (0..N).any(|lane| limits.after_release_s.extract(lane).is_finite());
        let (Some(plain), false) = (plain_kinds::<_, FIELD>(&extraction), ends_early) else {
            return false;
        };
        let disturbance = |lane| extraction.disturbance.map(&mut lane_of(lane));
        let period_s = batch.common.extraction.timing.control_period_s;
        let number = run.map(|run| batch.runs[run]);
        let mut moving = Moving {
            state: ExtractionState::at_rest(),
            metrics: Metrics::new(),
            draws: HeldDraws::new(batch.common.seed, number, disturbance, |_| period_s),
        };
        let setpoints = Setpoints::of(&extraction);
        let (mut n, samples) = (0, batch.common.samples);
        while n < samples && work.goes_on() {
            let end = samples.min(n + BLOCK);
            moving.advance(work, &plain, &limits, &setpoints, n..end);
            if !moving.all_within(&limits) {
                return false;
            }
            n = end;
        }
        if n < samples {
            return true; // told to stop
        }
        for (lane, i) in runs.enumerate() {
            let metrics = moving.metrics.map(&mut lane_of(lane));
            let end_m = moving.state.plant.position_m.extract(lane);
            let run = Run::finished(metrics, end_m, &limits.map(&mut lane_of(lane)));
            let _ = work.done.send((i, run)); // nobody listens once the batch was stopped
        }
        true
    }
}

/// What moves.
struct Moving<V, const N: usize> {
    state: ExtractionState<V>,
    metrics: Metrics<V>,
    draws: HeldDraws<N>,
}

impl<V: Wide, const N: usize> Moving<V, N> {
    /// Whether every run is within its bounds, after samples that were counted unseen.
    fn all_within(&self, limits: &Limits<V>) -> bool {
        let within = V::flag(self.metrics.stayed_within(limits));
        let position_m = self.state.plant.position_m;
        (0..N).all(|lane| within.extract(lane) == 1.0 && position_m.extract(lane).is_finite())
    }

    /// What is read and what moves at every sample is copied first, so that it is known to be this
    /// function's own, and what does not change is computed once.
    #[inline(always)]
    fn advance(
        &mut self,
        work: &Work,
        plain: &Extraction<V>,
        limits: &Limits<V>,
        setpoints: &Setpoints<V>,
        samples: Range<u64>,
    ) {
        let (extraction, limits, groups) = (*plain, *limits, work.groups);
        let Self { mut state, mut metrics, .. } = *self;
        let draws = &mut self.draws;
        let mut n = samples.start;
        while n < samples.end {
            let redraw = draws.redraw_after(n);
            let factors = disturbed(&extraction, draws.held());
            let end = samples.end.min(redraw);
            while n < end {
                let setpoint = setpoints.at(n);
                let none = Noise::none();
                let mut seeing = metrics.seeing_unseen(groups, &limits);
                let sample = extraction.follow::<_, false>(
                    &mut state,
                    &setpoint,
                    &factors,
                    &none,
                    &mut seeing,
                );
                metrics.update_unseen(groups, &sample);
                n += 1;
            }
        }
        (self.state, self.metrics) = (state, metrics);
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
