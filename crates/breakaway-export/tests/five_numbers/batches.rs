//! A run of a batch has the bits of the run on its own: for every combination of blocks, on every
//! kind of instructions this processor has, on any number of threads, and beside runs that diverge.

use std::convert::Infallible;

use breakaway_batch::draws::{Stream, uniform};
use breakaway_batch::{
    Batch, Ended, FIGURES, Figure, Instructions, Job, Results, Varied, Wanted, run, run_batch,
};
use breakaway_core::Outcome;
use breakaway_core::disturbance::DrawLaw;

use crate::cases::{self, SAMPLES, assert_same};

/// One more than fills the widest lanes.
const RUNS: u64 = 33;

fn job(case: &cases::Case) -> Job {
    Job {
        extraction: case.extraction,
        limits: cases::limits(),
        samples: u64::from(SAMPLES),
        seed: 7,
        run: 0,
        trace_every: 0,
    }
}

/// Every number of a job, differently for each run.
fn columns(job: &Job, runs: u64) -> Vec<(usize, Vec<f64>)> {
    let move_by =
        |place: usize, run: u64| 0.1 * uniform(11, run, Stream::Disturbance, place as u32);
    let period = period_place(job);
    let numbers = job.numbers().into_iter().enumerate();
    numbers
        .filter(|&(place, number)| place != period && number.is_finite())
        .map(|(place, number)| {
            (place, (0..runs).map(|run| number * (1.0 + move_by(place, run))).collect())
        })
        .collect()
}

/// The control period is the one number that all runs of a batch share.
fn period_place(job: &Job) -> usize {
    let mut marked = *job;
    marked.extraction.timing.control_period_s = f64::NAN;
    marked.numbers().iter().position(|number| number.is_nan()).expect("it is among the numbers")
}

fn everything() -> Wanted {
    Wanted { figures: FIGURES.to_vec(), outcome: true }
}

fn finish(batch: &Batch, wanted: &Wanted, threads: usize, with: Instructions) -> Results {
    run_batch::<Infallible>(batch, wanted, threads, with, |_| Ok(())).expect("a few threads start")
}

fn assert_same_as_single(context: &str, batch: &Batch, wanted: &Wanted, results: &Results) {
    for i in 0..batch.runs.len() {
        let job = batch.job(i);
        let Ok(single) = run::<Infallible>(&job, || Ok(()));
        for (figure, column) in wanted.figures.iter().zip(&results.figures) {
            let expected = (figure.value)(&job, &single);
            assert_same(context, figure.name, i as u32, column[i], expected);
        }
        if wanted.outcome {
            assert_eq!(results.outcomes[i], single.outcome, "run {i} of {context}");
        }
    }
}

#[test]
fn every_kind_on_every_instruction_set() {
    let runs: Vec<u64> = (5..5 + RUNS).collect();
    let wanted = everything();
    let kinds = Instructions::available();
    for (i, case) in cases::all().iter().enumerate() {
        let mut job = job(case);
        if i % 3 == 1 {
            job.extraction.disturbance.law = DrawLaw::Gaussian;
        } else if i % 3 == 2 {
            job.extraction.disturbance.law = DrawLaw::BandLimited { bandwidth_hz: 2e3 };
        }
        let columns = columns(&job, RUNS);
        let varied = columns.iter().map(|(place, values)| Varied { place: *place, values });
        let batch = Batch { common: job, runs: &runs, varied: varied.collect() };
        for (j, with) in kinds.iter().enumerate() {
            if j == i % 2 || i % 16 == 0 {
                let results = finish(&batch, &wanted, 1 + i % 3, *with);
                assert_same_as_single(&case.name, &batch, &wanted, &results);
            }
        }
    }
}

/// Runs of 2000 samples that are over with their release, and so at different times: draws, noise and
/// reference of the next run in a lane begin anew.
#[test]
fn a_lane_takes_the_next_run_when_its_own_has_ended() {
    let runs: Vec<u64> = (9..9 + 3 * RUNS).collect();
    let mut ended = 0;
    for (i, case) in cases::all().iter().enumerate().step_by(5) {
        let mut job = job(case);
        job.samples = 2000;
        job.limits.after_release_s = 1e-4;
        if i % 2 == 1 {
            job.extraction.disturbance.law = DrawLaw::BandLimited { bandwidth_hz: 2e3 };
        }
        let columns = columns(&job, 3 * RUNS);
        let varied = columns.iter().map(|(place, values)| Varied { place: *place, values });
        let batch = Batch { common: job, runs: &runs, varied: varied.collect() };
        let with = Instructions::available();
        let results = finish(&batch, &everything(), 1 + i % 2, with[i % with.len()]);
        assert_same_as_single(&case.name, &batch, &everything(), &results);
        ended += results.outcomes.iter().filter(|&&o| o == Outcome::Released).count();
    }
    assert!(ended > 500, "{ended}");
}

/// The mask of bounds comes in when the first run leaves them, and only then.
#[test]
fn runs_that_diverge_disturb_no_other() {
    let case = cases::smooth();
    let mut job = job(&case);
    job.samples = 3000; // more than one look at the bounds
    let gain = job.numbers().iter().position(|&n| n == 900.0).expect("kd is among the numbers");
    let runs: Vec<u64> = (0..70).collect();
    for diverging in [vec![], vec![3], vec![0, 31, 32, 69], (0..70).collect()] {
        let values: Vec<f64> =
            (0..70).map(|i| if diverging.contains(&i) { -4e4 } else { 900.0 }).collect();
        let varied = vec![Varied { place: gain, values: &values }];
        let batch = Batch { common: job, runs: &runs, varied };
        let wanted = everything();
        for with in Instructions::available() {
            let results = finish(&batch, &wanted, 2, with);
            assert_same_as_single(with.name(), &batch, &wanted, &results);
            let diverged = results.outcomes.iter().filter(|&&o| o == Outcome::Diverged).count();
            assert_eq!(diverged, diverging.len(), "{}", with.name());
        }
    }
}

/// What is not wanted is not counted, and what is has the same bits.
#[test]
fn every_figure_alone_is_the_figure_among_all() {
    let case = cases::smooth();
    let runs: Vec<u64> = (0..5).collect();
    let batch = Batch { common: job(&case), runs: &runs, varied: Vec::new() };
    for figure in FIGURES {
        let wanted = Wanted { figures: vec![*figure], outcome: false };
        for with in Instructions::available() {
            let results = finish(&batch, &wanted, 1, with);
            assert_same_as_single(figure.name, &batch, &wanted, &results);
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let case = &cases::all()[0];
    let runs: Vec<u64> = (0..200).collect();
    let batch = Batch { common: job(case), runs: &runs, varied: Vec::new() };
    let figures: Vec<Figure> = FIGURES.iter().filter(|f| f.name == "iae_m_s").copied().collect();
    let wanted = Wanted { figures, outcome: true };
    let one = finish(&batch, &wanted, 1, Instructions::fastest());
    for threads in [2, 3, 8] {
        assert_eq!(finish(&batch, &wanted, threads, Instructions::fastest()), one);
    }
}

#[test]
fn a_batch_stops_when_it_is_told_to() {
    let case = &cases::all()[0];
    let runs: Vec<u64> = (0..64).collect();
    let mut endless = job(case);
    endless.samples = 1 << 40;
    endless.extraction.reference =
        breakaway_core::reference::Reference::Step(breakaway_core::reference::Step {
            distance_m: 1e-6,
            start_s: 0.0,
        });
    let batch = Batch { common: endless, runs: &runs, varied: Vec::new() };
    let stopped = run_batch(&batch, &everything(), 2, Instructions::fastest(), |_| Err("enough"));
    assert!(matches!(stopped, Err(Ended::Told("enough"))));
}
