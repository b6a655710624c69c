//! A saturating, unilateral actuator.

use super::ForceRange;
use crate::parameters::parameters;
use crate::real::Real;

parameters! {
    /// Delivers 0 ≤ F ≤ F_max: the tip touches the part without being fixed to it.
    pub struct PushOnly {
        /// F_max in N.
        pub force_max_n,
    }
}

impl<R: Real> PushOnly<R> {
    /// What it can deliver.
    #[inline(always)]
    pub fn range(&self) -> ForceRange<R> {
        ForceRange { min_n: R::zero(), max_n: self.force_max_n }
    }
}
