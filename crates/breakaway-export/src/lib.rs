//! Records the core's arithmetic as an expression graph.
//!
//! [`Expr`] is one more number type for the core: adding two of them writes down an addition. The
//! recorded [`Graph`] is the very step that is simulated, node by node, so whatever is made of it
//! (today its evaluation, later C) computes the same bits.
//!
//! # Example
//! ```
//! use breakaway_core::Real;
//! use breakaway_export::record;
//!
//! fn soft_stop<R: Real>(x: R) -> R {
//!     R::select(x.lt(R::zero()), R::zero(), x / (R::one() + x))
//! }
//! let graph = record(|recorder| {
//!     let x = recorder.input("x");
//!     recorder.output("y", soft_stop(x));
//! });
//! assert_eq!(graph.evaluate(&[3.0]), [soft_stop(3.0)]);
//! assert_eq!(graph.evaluate(&[-1.0]), [0.0]);
//! ```
#![forbid(unsafe_code)]

pub mod c;
pub mod derive;
pub mod expr;
pub mod graph;
pub mod model;
pub mod passes;
pub mod program;
mod record_model;
pub mod reference;
pub mod routine;

pub use expr::{Expr, ExprMask, Recorder, record};
pub use graph::{Bits, Graph, Label, Node, NodeId};
pub use model::What;
pub use program::Program;
