//! Outcomes as codes and names.

use breakaway_core::Outcome;

/// The names of the outcomes, each at the place of its code.
pub(crate) const OUTCOMES: [&str; 4] = ["released", "not_released", "diverged", "limit_exceeded"];

pub(crate) fn outcome_code(outcome: Outcome) -> u8 {
    match outcome {
        Outcome::Released => 0,
        Outcome::NotReleased => 1,
        Outcome::Diverged => 2,
        Outcome::LimitExceeded => 3,
    }
}
