//! Wall time of the paper's loop: one run, a batch, and both reduced by hand.

use std::convert::Infallible;

use breakaway_batch::yardstick::iae_by_hand;
use breakaway_batch::{Batch, FIGURES, Figure, Instructions, Job, Wanted, run, run_batch};
use breakaway_core::test_models::{paper_as_computed, paper_limits};
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

/// 0.5 simulated seconds at 100 kHz.
const SAMPLES: u64 = 50_000;

fn job() -> Job {
    Job {
        extraction: black_box(paper_as_computed()),
        limits: paper_limits(),
        samples: SAMPLES,
        seed: 0,
        run: 0,
        trace_every: 0,
    }
}

#[divan::bench]
fn single_run() -> f64 {
    let Ok(result) = run::<Infallible>(&job(), || Ok(()));
    result.metrics.iae_m_s
}

/// One pack of runs for each thread that is asked for, figure by figure.
#[divan::bench(args = available())]
fn batch_of_one_pack(bencher: Bencher, name: &str) {
    bencher.bench_local(|| mean_iae(&job(), named(name), 1, &["iae_m_s"]));
}

/// With draws at every tenth sample.
#[divan::bench]
fn disturbed_batch_of_one_pack() -> f64 {
    let mut job = job();
    job.extraction.disturbance.var = 0.1;
    mean_iae(&job, Instructions::fastest(), 1, &["iae_m_s"])
}

/// Counting everything.
#[divan::bench]
fn batch_of_one_pack_with_all_metrics() -> f64 {
    let all: Vec<&str> = FIGURES.iter().map(|figure| figure.name).collect();
    mean_iae(&job(), Instructions::fastest(), 1, &all)
}

#[divan::bench(args = [1, 2])]
fn batch_of_16_packs_per_thread(threads: usize) -> f64 {
    mean_iae(&job(), Instructions::fastest(), threads, &["iae_m_s"])
}

#[divan::bench(args = available())]
fn by_hand(bencher: Bencher, name: &str) {
    bencher.bench_local(|| iae_by_hand(named(name), SAMPLES));
}

fn available() -> Vec<&'static str> {
    Instructions::available().into_iter().map(Instructions::name).collect()
}

fn named(name: &str) -> Instructions {
    let mut all = Instructions::available().into_iter();
    all.find(|one| one.name() == name).expect("it is available")
}

fn mean_iae(job: &Job, instructions: Instructions, threads: usize, names: &[&str]) -> f64 {
    let runs: Vec<u64> = (0..instructions.lanes() as u64 * threads as u64).collect();
    let figures: Vec<Figure> =
        FIGURES.iter().filter(|figure| names.contains(&figure.name)).copied().collect();
    let batch = Batch { common: *job, runs: &runs, varied: Vec::new() };
    let wanted = Wanted { figures, outcome: false };
    let Ok(results) = run_batch::<Infallible>(&batch, &wanted, threads, instructions, |_| Ok(()));
    results.figures[0].iter().sum::<f64>() / runs.len() as f64
}
