//! Runs the core: one run with a trace, lanes of runs, and the random draws both need.
//!
//! This crate may use threads, memory and seeded random draws. It adds no physics.

#![deny(unsafe_code)]

pub mod batch;
pub mod draws;
pub mod field;
pub mod figures;
pub mod imposed;
pub mod instructions;
pub mod lanes;
mod lockstep;
pub mod normal;
pub mod paths;
pub mod rig;
pub mod run;
pub mod steady;
pub mod threads;
mod trusted;
mod work;
#[cfg(feature = "yardstick")]
pub mod yardstick;

pub use batch::{Batch, Results, Varied, Wanted};
pub use draws::HeldDraws;
pub use field::{FieldCourse, field_course};
pub use figures::{FIGURES, Figure};
pub use imposed::{ImposedMotion, imposed_motion};
pub use instructions::Instructions;
pub use lanes::Four;
pub use rig::{
    Differentiated, Kept, Misfit, Record, Simulated, differentiate_rig, rig_misfits, simulate_rig,
};
pub use run::{Job, Run, TRACE_COLUMNS, Trace, run};
pub use steady::{
    FrictionCurve, SteadyFriction, breakaway_forces, friction_curve, steady_friction,
};
pub use threads::{Ended, run_batch};
