//! Runs the core: one run with a trace, lanes of runs, and the random draws both need.
//!
//! This crate may use threads, memory and seeded random draws. It adds no physics.

#![deny(unsafe_code)]

pub mod draws;
pub mod figures;
pub mod imposed;
pub mod lanes;
pub mod run;

pub use draws::HeldDraws;
pub use figures::FIGURES;
pub use imposed::{ImposedMotion, imposed_motion};
pub use lanes::Lanes;
pub use run::{Job, Run, TRACE_COLUMNS, Trace, run};
