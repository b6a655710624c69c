//! The figures that a finished run is reported by.

use crate::run::{Job, Run};

/// A figure of a finished run.
type Figure = fn(&Job, &Run) -> f64;

/// Every figure by its name, which carries its unit. What did not happen is not a number.
pub const FIGURES: &[(&str, Figure)] = &[
    ("simulated_s", |_, run| run.metrics.time_s),
    ("iae_m_s", |_, run| run.metrics.iae_m_s),
    ("ise_m2_s", |_, run| run.metrics.ise_m2_s),
    ("itae_m_s2", |_, run| run.metrics.itae_m_s2),
    ("largest_error_m", |_, run| run.metrics.largest_error_m),
    ("peak_force_n", |_, run| run.metrics.peak_force_n),
    ("peak_over_breakaway", |job, run| {
        run.metrics.peak_force_n / job.extraction.joint.breakaway_force(0.0)
    }),
    ("mean_force_n", |_, run| run.metrics.impulse_n_s / run.metrics.time_s),
    ("rms_force_n", |_, run| (run.metrics.force_square_n2_s / run.metrics.time_s).sqrt()),
    ("impulse_n_s", |_, run| run.metrics.impulse_n_s),
    ("work_j", |_, run| run.metrics.work_j),
    ("friction_loss_j", |job, run| run.metrics.joint_work_j - stored_in_bristles_j(job, run)),
    ("impacts", |_, run| run.metrics.impacts),
    ("contact_time_s", |_, run| run.metrics.contact_s),
    ("mean_impact_s", |_, run| run.metrics.contact_s / run.metrics.impacts),
    ("largest_step_m", |_, run| run.metrics.largest_step_m),
    ("largest_impact_work_j", |_, run| run.metrics.largest_impact_work_j),
    ("largest_jump_m", |_, run| run.metrics.largest_jump_m),
    ("time_to_breakaway_s", |_, run| known_time(run.metrics.breakaway_s)),
    ("time_to_release_s", |_, run| known_time(run.metrics.release_s)),
    ("release_velocity_m_per_s", |_, run| {
        if run.metrics.release_s.is_finite() {
            run.metrics.release_velocity_m_per_s
        } else {
            f64::NAN
        }
    }),
    ("saturation_time_s", |_, run| run.metrics.saturated_s),
    ("final_position_m", |_, run| run.state.plant.position_m),
];

/// ½ k_e z² in J.
fn stored_in_bristles_j(job: &Job, run: &Run) -> f64 {
    let z = run.state.plant.bristle_m;
    0.5 * job.extraction.joint.stiffness_n_per_m() * z * z
}

fn known_time(time_s: f64) -> f64 {
    if time_s.is_finite() { time_s } else { f64::NAN }
}
