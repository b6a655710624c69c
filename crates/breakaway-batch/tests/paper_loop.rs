//! The paper's loop against its known answers.

use std::convert::Infallible;

use breakaway_batch::{Job, Run, run};
use breakaway_core::Outcome;
use breakaway_core::plant::Integrator;
use breakaway_core::test_models::{paper_as_computed, paper_limits};

/// IAE in m s and peak force in N of the loop by RK4 at 0.1 us, found independently.
const KNOWN_IAE_M_S: f64 = 3.036_154_9e-6;
const KNOWN_PEAK_N: f64 = 601.3447;

fn job() -> Job {
    Job {
        extraction: paper_as_computed(),
        limits: paper_limits(),
        samples: 50_000,
        seed: 0,
        run: 0,
        trace_every: 0,
    }
}

fn finish(job: &Job) -> Run {
    let Ok(run) = run::<Infallible>(job, || Ok(()));
    run
}

fn with_integrator(mut job: Job, integrator: Integrator, steps_per_period: u32) -> Job {
    job.extraction.timing.integrator = integrator;
    job.extraction.timing.steps_per_period = steps_per_period;
    job
}

#[test]
fn the_oracle_gives_the_known_answer() {
    let oracle = finish(&with_integrator(job(), Integrator::Rk4, 100));
    assert_eq!(oracle.outcome, Outcome::Released, "{oracle:?}");
    let error = oracle.metrics.iae_m_s / KNOWN_IAE_M_S - 1.0;
    assert!(error.abs() < 2e-8, "IAE {} off by {error:e}", oracle.metrics.iae_m_s);
    assert!((oracle.metrics.peak_force_n - KNOWN_PEAK_N).abs() < 1e-3, "{oracle:?}");
}

#[test]
fn one_step_per_period_gives_the_known_answer() {
    let ours = finish(&job());
    let error = ours.metrics.iae_m_s / KNOWN_IAE_M_S - 1.0;
    assert!(error.abs() < 2e-5, "IAE {} off by {error:e}", ours.metrics.iae_m_s);
}
