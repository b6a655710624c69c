//! The equations of `breakaway`, each written once.
//!
//! Every block is generic over the number type [`Real`]. What the number is decides what the
//! same step computes: one run (`f64`), firmware arithmetic (`f32`), many runs at once (lanes),
//! exact derivatives ([`Dual`]), or a recording of the arithmetic that can be exported.
//!
//! Rules that keep this true: no branch on a number (use [`Real::select`]), no allocation, no
//! clock, no random draw, no input or output. Random draws arrive as numbers in [`Draws`].
//!
//! Configurations are immutable and separate from the states they move. They are not checked
//! here: the scenario models of the Python package hold every valid range. A number outside them
//! gives a meaningless run, and never a panic.
//!
//! # Example
//! ```
//! use breakaway_core::Maybe;
//! use breakaway_core::joint::{Joint, Law, Lugre};
//! let joint = Joint::Lugre(Lugre {
//!     stiction_n: 450.0, coulomb_n: 360.0, stiffness_n_per_m: 3.6e7, damping_n_s_per_m: 9000.0,
//!     viscous_n_s_per_m: Maybe::none(), stribeck_velocity_m_per_s: 0.09, engagement_length_m: 0.1,
//!     residual_n: 9.81, damping_velocity_m_per_s: Maybe::none(), backward_ratio: Maybe::none(),
//! });
//! // Halfway out, half of the contact area is left: equation (5).
//! assert!((joint.breakaway_force(0.05) - (450.0 + 9.81) / 2.0_f64).abs() < 1e-12);
//! ```
#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "std")]
extern crate std;

pub mod exp2;
mod float;
mod fused;
mod parameters;
mod sine;
mod states;

pub mod actuator;
pub mod control;
pub mod crossing;
pub mod disturbance;
pub mod dual;
pub mod extraction;
pub mod imposed;
pub mod joint;
mod maybe;
pub mod metrics;
pub mod name;
pub mod period;
pub mod plant;
pub mod real;
pub mod reference;
pub mod rig;
pub mod sensor;
pub mod test_models;
pub mod variation;

pub use disturbance::Draws;
pub use dual::Dual;
pub use extraction::{Extraction, ExtractionState};
pub use maybe::Maybe;
pub use metrics::{Metrics, Outcome};
pub use name::Name;
pub use real::Real;
