//! The figures that a finished run is reported by.

use breakaway_core::metrics::Groups;

use crate::run::{Job, Run};

/// A figure of a finished run.
#[derive(Clone, Copy)]
pub struct Figure {
    /// Its name, which carries its unit.
    pub name: &'static str,
    /// What must be counted for it.
    pub needs: Groups,
    /// Its value. What did not happen is not a number.
    pub value: fn(&Job, &Run) -> f64,
}

const NONE: Groups = Groups::NONE;
const TIME: Groups = Groups { time: true, ..NONE };
const IAE: Groups = Groups { iae: true, ..NONE };
const ERROR: Groups = Groups { error: true, ..NONE };
const EXTREMES: Groups = Groups { extremes: true, ..NONE };
const FORCE: Groups = Groups { force: true, ..NONE };
const FORCE_AND_TIME: Groups = FORCE.with(TIME);
const IMPACTS: Groups = Groups { impacts: true, ..NONE };
const JUMP: Groups = Groups { jump: true, ..NONE };
const END: Groups = Groups { end: true, ..NONE };
const FORCE_AND_END: Groups = FORCE.with(END);
const EVENTS: Groups = Groups { events: true, ..NONE };

/// Every figure.
pub const FIGURES: &[Figure] = &[
    Figure { name: "simulated_s", needs: TIME, value: |_, run| run.metrics.time_s },
    Figure { name: "iae_m_s", needs: IAE, value: |_, run| run.metrics.iae_m_s },
    Figure { name: "ise_m2_s", needs: ERROR, value: |_, run| run.metrics.ise_m2_s },
    Figure { name: "itae_m_s2", needs: ERROR, value: |_, run| run.metrics.itae_m_s2 },
    Figure {
        name: "largest_error_m",
        needs: EXTREMES,
        value: |_, run| run.metrics.largest_error_m,
    },
    Figure { name: "peak_force_n", needs: EXTREMES, value: |_, run| run.metrics.peak_force_n },
    Figure {
        name: "peak_over_breakaway",
        needs: EXTREMES,
        value: |job, run| run.metrics.peak_force_n / job.extraction.joint.breakaway_force(0.0),
    },
    Figure {
        name: "mean_force_n",
        needs: FORCE_AND_TIME,
        value: |_, run| run.metrics.impulse_n_s / run.metrics.time_s,
    },
    Figure {
        name: "rms_force_n",
        needs: FORCE_AND_TIME,
        value: |_, run| (run.metrics.force_square_n2_s / run.metrics.time_s).sqrt(),
    },
    Figure { name: "impulse_n_s", needs: FORCE, value: |_, run| run.metrics.impulse_n_s },
    Figure { name: "work_j", needs: FORCE, value: |_, run| run.metrics.work_j },
    Figure {
        name: "friction_loss_j",
        needs: FORCE_AND_END,
        value: |job, run| run.metrics.joint_work_j - stored_in_bristles_j(job, run),
    },
    Figure { name: "impacts", needs: IMPACTS, value: |_, run| run.metrics.impacts },
    Figure { name: "contact_time_s", needs: IMPACTS, value: |_, run| run.metrics.contact_s },
    Figure {
        name: "mean_impact_s",
        needs: IMPACTS,
        value: |_, run| run.metrics.contact_s / run.metrics.impacts,
    },
    Figure { name: "largest_step_m", needs: IMPACTS, value: |_, run| run.metrics.largest_step_m },
    Figure {
        name: "largest_impact_work_j",
        needs: IMPACTS,
        value: |_, run| run.metrics.largest_impact_work_j,
    },
    Figure { name: "largest_jump_m", needs: JUMP, value: |_, run| run.metrics.largest_jump_m },
    Figure {
        name: "time_to_breakaway_s",
        needs: EVENTS,
        value: |_, run| known_time(run.metrics.breakaway_s),
    },
    Figure {
        name: "time_to_release_s",
        needs: EVENTS,
        value: |_, run| known_time(run.metrics.release_s),
    },
    Figure {
        name: "release_velocity_m_per_s",
        needs: EVENTS,
        value: |_, run| {
            if run.metrics.release_s.is_finite() {
                run.metrics.release_velocity_m_per_s
            } else {
                f64::NAN
            }
        },
    },
    Figure { name: "saturation_time_s", needs: FORCE, value: |_, run| run.metrics.saturated_s },
    Figure { name: "final_position_m", needs: END, value: |_, run| run.metrics.end_position_m },
];

/// ½ k_e z² in J.
fn stored_in_bristles_j(job: &Job, run: &Run) -> f64 {
    let z = run.metrics.end_bristle_m;
    0.5 * job.extraction.joint.stiffness_n_per_m() * z * z
}

fn known_time(time_s: f64) -> f64 {
    if time_s.is_finite() { time_s } else { f64::NAN }
}
