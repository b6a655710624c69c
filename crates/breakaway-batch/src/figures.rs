//! The figures that a finished run is reported by.

use breakaway_core::metrics::Groups;

use crate::run::{Job, Run};
use breakaway_core::actuator::{Actuator, FeedAxis, Piezo, Tip};
use breakaway_core::joint::Law;
use std::f64::consts::PI;

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
const EFFORT: Groups = Groups { effort: true, ..NONE };
const EFFORT_AND_TIME: Groups = EFFORT.with(TIME);
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
        value: |_, run| run.metrics.joint_work_j - run.metrics.end_stored_j,
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
    Figure { name: "supplied_work_j", needs: EFFORT, value: |_, run| run.metrics.supplied_j },
    Figure { name: "actuator_loss_j", needs: EFFORT, value: |_, run| run.metrics.actuator_loss_j },
    Figure {
        name: "rms_current_a",
        needs: EFFORT_AND_TIME,
        value: |_, run| (run.metrics.current_square_a2_s / run.metrics.time_s).sqrt(),
    },
    Figure { name: "stack_cycles", needs: EFFORT, value: stack_cycles },
    Figure { name: "stack_loss_w", needs: EFFORT_AND_TIME, value: stack_loss_w },
    Figure {
        name: "stack_tension_n",
        needs: EFFORT,
        value: |_, run| known_time(run.metrics.stack_tension_n),
    },
    Figure { name: "stop_reason", needs: END, value: |_, run| run.metrics.stop_reason },
    Figure { name: "final_position_m", needs: END, value: |_, run| run.metrics.end_position_m },
];

/// The stack of an extraction, if it has one.
fn stack(job: &Job) -> Option<Piezo<f64>> {
    match job.extraction.actuator {
        Actuator::FeedAxis(FeedAxis { tip: Tip::Piezo(piezo), .. }) => Some(piezo),
        _ => None,
    }
}

/// ∫ |I| dt / (2 C V_max): full strokes out and back.
fn stack_cycles(job: &Job, run: &Run) -> f64 {
    stack(job).map_or(f64::NAN, |piezo| {
        run.metrics.charge_c / (2.0 * piezo.capacitance_f * piezo.voltage_max_v)
    })
}

/// tan δ / (ω C) · I_rms² in W at 1 kHz: what heats the stack, to first order.
fn stack_loss_w(job: &Job, run: &Run) -> f64 {
    stack(job).map_or(f64::NAN, |piezo| {
        let resistance_ohm = piezo.loss_tangent / (2000.0 * PI * piezo.capacitance_f);
        resistance_ohm * run.metrics.current_square_a2_s / run.metrics.time_s
    })
}

fn known_time(time_s: f64) -> f64 {
    if time_s.is_finite() { time_s } else { f64::NAN }
}
