//! Wall time of the paper's loop: one run, batches, and both reduced by hand.
//!
//! The cases take turns, so that whatever else the machine does meets all of them, and the fastest of
//! many turns counts: ratios within one run are worth more than times. Prints one line for each
//! case: its name and wall seconds per simulated second and run.

use std::convert::Infallible;
use std::hint::black_box;
use std::time::Instant;

use breakaway_batch::yardstick::{iae_by_hand, iae_of_one_by_hand};
use breakaway_batch::{Batch, FIGURES, Figure, Instructions, Job, Wanted, run, run_batch};
use breakaway_core::test_models::{paper_as_computed, paper_limits};
use breakaway_core::variation::{Field, FieldKeys, FieldLaw};

/// 0.5 simulated seconds at 100 kHz.
const SAMPLES: u64 = 50_000;
const SIMULATED_S: f64 = 0.5;
/// Turns that each case takes.
const TURNS: usize = 100;
/// Packs of lanes for each thread.
const PACKS: usize = 2;

/// A case: its name, the runs it computes, and how.
struct Case {
    name: String,
    runs: usize,
    compute: Box<dyn Fn() -> f64>,
}

fn main() {
    let cases = cases();
    let mut fastest_s = vec![f64::INFINITY; cases.len()];
    for _ in 0..TURNS {
        for (case, fastest) in cases.iter().zip(&mut fastest_s) {
            let start = Instant::now();
            black_box((case.compute)());
            *fastest = fastest.min(start.elapsed().as_secs_f64());
        }
    }
    for (case, fastest) in cases.iter().zip(fastest_s) {
        println!("{} {:e}", case.name, fastest / SIMULATED_S / case.runs as f64);
    }
}

fn cases() -> Vec<Case> {
    let fast = Instructions::fastest();
    let lanes = fast.lanes();
    let plain = job(0.0);
    let traced = Job { trace_every: 10, ..plain };
    let batch = move |job: Job, threads: usize, figures: &[&str]| {
        let figures = named(figures);
        move || mean_of_first(&job, fast, threads, &figures)
    };
    let all: Vec<&str> = FIGURES.iter().map(|figure| figure.name).collect();
    let case = |name: &str, runs: usize, compute: Box<dyn Fn() -> f64>| Case {
        name: name.to_owned(),
        runs,
        compute,
    };
    let mut cases = vec![
        case("single_run", 1, Box::new(move || single(&plain))),
        case("single_run_traced", 1, Box::new(move || single(&traced))),
        case("single_run_by_hand", 1, Box::new(|| iae_of_one_by_hand(SAMPLES))),
        case("batch_1_thread", PACKS * lanes, Box::new(batch(plain, 1, &["iae_m_s"]))),
        case("batch_2_threads", 2 * PACKS * lanes, Box::new(batch(plain, 2, &["iae_m_s"]))),
        case("batch_all_metrics", PACKS * lanes, Box::new(batch(plain, 1, &all))),
        case("batch_disturbed", PACKS * lanes, Box::new(batch(job(0.1), 1, &["iae_m_s"]))),
        case("batch_field", PACKS * lanes, Box::new(batch(along(1e-3), 1, &["iae_m_s"]))),
        case("batch_fine_field", PACKS * lanes, Box::new(batch(along(1e-4), 1, &["iae_m_s"]))),
        case("batch_field_all_metrics", PACKS * lanes, Box::new(batch(along(1e-3), 1, &all))),
    ];
    for with in Instructions::available() {
        let (name, runs) = (with.name(), with.lanes());
        let figures = named(&["iae_m_s"]);
        let by_batch = move || mean_of_first(&plain, with, 1, &figures);
        cases.push(case(&format!("batch_{name}"), PACKS * runs, Box::new(by_batch)));
        let by_hand = move || (0..PACKS).map(|_| iae_by_hand(with, SAMPLES)).sum();
        cases.push(case(&format!("by_hand_{name}"), PACKS * runs, Box::new(by_hand)));
    }
    cases
}

fn job(var: f64) -> Job {
    let mut extraction = paper_as_computed();
    extraction.disturbance.var = var;
    let (limits, samples) = (paper_limits(), SAMPLES);
    Job { extraction, limits, samples, seed: 0, run: 0, trace_every: 0 }
}

/// The plain job with a field of friction along the way, of a correlation length in m.
fn along(correlation_length_m: f64) -> Job {
    let mut job = job(0.0);
    let keys = FieldKeys { first: 0.0, second: 0.0, offset: 0.0 };
    let field = Field { law: FieldLaw::Bounded, var: 0.3, correlation_length_m, keys };
    job.extraction.variation.field = Some(field);
    job
}

fn named(names: &[&str]) -> Vec<Figure> {
    FIGURES.iter().filter(|figure| names.contains(&figure.name)).copied().collect()
}

fn single(job: &Job) -> f64 {
    let Ok(result) = run::<Infallible>(black_box(job), || Ok(()));
    result.metrics.iae_m_s
}

fn mean_of_first(job: &Job, with: Instructions, threads: usize, figures: &[Figure]) -> f64 {
    let runs: Vec<u64> = (0..(PACKS * with.lanes() * threads) as u64).collect();
    let batch = Batch { common: *black_box(job), runs: &runs, varied: Vec::new() };
    let wanted = Wanted { figures: figures.to_vec(), outcome: false };
    let results = run_batch::<Infallible>(&batch, &wanted, threads, with, |_| Ok(()))
        .expect("a few threads start");
    results.figures[0].iter().sum::<f64>() / runs.len() as f64
}
