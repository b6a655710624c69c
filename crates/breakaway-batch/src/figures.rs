//! The figures that a finished run is reported by.

use breakaway_core::metrics::Groups;

use crate::run::{Job, Run};
use breakaway_core::actuator::{Actuator, FeedAxis, Piezo, Tip};
use breakaway_core::joint::Law;
use breakaway_core::variation::FieldCell;
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

/// A metric reported by its own name; with `finite`, as no number where it is infinite.
macro_rules! metric {
    ($name:ident, $needs:expr) => {
        Figure { name: stringify!($name), needs: $needs, value: |_, run| run.metrics.$name }
    };
    ($name:ident, $needs:expr, finite) => {
        Figure { value: |_, run| finite(run.metrics.$name), ..metric!($name, $needs) }
    };
}

/// Every figure.
pub const FIGURES: &[Figure] = &[
    metric!(simulated_s, TIME),
    metric!(iae_m_s, IAE),
    metric!(ise_m2_s, ERROR),
    metric!(itae_m_s2, ERROR),
    metric!(largest_error_m, EXTREMES),
    metric!(peak_force_n, EXTREMES),
    Figure {
        name: "peak_over_breakaway",
        needs: EXTREMES,
        value: |job, run| run.metrics.peak_force_n / breakaway_force_n(job),
    },
    Figure {
        name: "mean_force_n",
        needs: FORCE_AND_TIME,
        value: |_, run| run.metrics.impulse_n_s / run.metrics.simulated_s,
    },
    Figure {
        name: "rms_force_n",
        needs: FORCE_AND_TIME,
        value: |_, run| (run.metrics.force_square_n2_s / run.metrics.simulated_s).sqrt(),
    },
    metric!(impulse_n_s, FORCE),
    metric!(work_j, FORCE),
    Figure {
        name: "friction_loss_j",
        needs: FORCE_AND_END,
        value: |_, run| run.metrics.joint_work_j - run.metrics.end_stored_j,
    },
    metric!(impacts, IMPACTS),
    metric!(contact_time_s, IMPACTS),
    Figure {
        name: "mean_impact_s",
        needs: IMPACTS,
        value: |_, run| run.metrics.contact_time_s / run.metrics.impacts,
    },
    metric!(largest_step_m, IMPACTS),
    metric!(largest_impact_work_j, IMPACTS),
    metric!(largest_jump_m, JUMP),
    metric!(time_to_breakaway_s, EVENTS, finite),
    metric!(time_to_release_s, EVENTS, finite),
    Figure {
        name: "release_velocity_m_per_s",
        needs: EVENTS,
        value: |_, run| {
            if run.metrics.time_to_release_s.is_finite() {
                run.metrics.release_velocity_m_per_s
            } else {
                f64::NAN
            }
        },
    },
    metric!(saturation_time_s, FORCE),
    metric!(supplied_work_j, EFFORT),
    metric!(actuator_loss_j, EFFORT),
    Figure {
        name: "rms_current_a",
        needs: EFFORT_AND_TIME,
        value: |_, run| (run.metrics.current_square_a2_s / run.metrics.simulated_s).sqrt(),
    },
    Figure { name: "stack_cycles", needs: EFFORT, value: stack_cycles },
    Figure { name: "stack_loss_w", needs: EFFORT_AND_TIME, value: stack_loss_w },
    metric!(stack_tension_n, EFFORT, finite),
    metric!(stop_reason, END),
    metric!(final_position_m, END),
];

/// The largest force that friction can hold the part with, anywhere along its guide: what it takes to
/// get it out. Without variation that is F_s at the seat. As it is at the start, and without a factor
/// that is redrawn; a field is looked at in eighths of its cells, which misses at most 0.8 % of var.
fn breakaway_force_n(job: &Job) -> f64 {
    let (joint, variation) = (&job.extraction.joint, job.drawn().extraction.variation);
    if variation.is_none() {
        return joint.breakaway_force(0.0);
    }
    let length_m = joint.engagement_length_m();
    let step_m = variation.field.map_or(length_m / 1000.0, |field| field.cell_m() / 8.0);
    let mut cell = FieldCell::nowhere();
    let places = (length_m / step_m).ceil() as u64;
    (0..places)
        .map(|n| n as f64 * step_m)
        .map(|x| joint.breakaway_force(x) * variation.factor(&mut cell, x, 0.0))
        .fold(0.0, f64::max)
}

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
        resistance_ohm * run.metrics.current_square_a2_s / run.metrics.simulated_s
    })
}

fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}
