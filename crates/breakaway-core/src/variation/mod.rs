//! How friction varies: along the way, during a pull, and with the normal force.
//!
//! Everything here is a factor on the friction levels, a function of where the part is and of the
//! time. What is drawn for a run is drawn before it: waiting changes nothing, and a part that goes back
//! meets the same friction again. What is redrawn by the clock is the paper's:
//! [`crate::disturbance`].

mod course;
mod field;
mod normal_force;

pub use course::{Course, Over, POINTS_MAX};
pub use field::{Field, FieldCell, FieldKeys, FieldLaw};
pub use normal_force::{NormalForce, NormalVibration, TransverseVibration};
pub(crate) use normal_force::{hypotenuse, speed};

use crate::maybe::Maybe;
use crate::name::{Name, within};
use crate::real::{Block, Real};

/// What varies the friction levels of a joint; what is left out does not.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Variation<R> {
    /// Along the way.
    pub field: Option<Field<R>>,
    /// During a pull, slowly: a factor on the levels.
    pub drift: Option<Course<R>>,
    /// With the force across the joint.
    pub normal_force: Option<NormalForce<R>>,
}

/// What varies the levels other than a field does. By value: what a block refers to stays in memory.
struct Meanwhile<R> {
    variation: Variation<R>,
    x: R,
    t: R,
}

impl<R: Real> Block for Meanwhile<R> {
    type Output = R;

    #[inline(always)]
    fn compute(self) -> R {
        let Self { variation, x, t } = self;
        let mut factor = R::one();
        if let Some(drift) = &variation.drift {
            R::section("drift: a factor on the friction levels");
            factor = drift.at(x, t);
        }
        if let Some(normal) = &variation.normal_force {
            factor = factor * normal.share(x, t);
        }
        factor
    }
}

impl<R: Real> Variation<R> {
    /// None.
    #[inline(always)]
    pub fn none() -> Self {
        Self { field: None, drift: None, normal_force: None }
    }

    /// Whether there is none.
    #[inline(always)]
    pub fn is_none(&self) -> bool {
        self.field.is_none() && self.is_field_at_most()
    }

    /// Whether there is none but a field.
    #[inline(always)]
    pub fn is_field_at_most(&self) -> bool {
        self.drift.is_none() && self.normal_force.is_none()
    }

    /// Whether it depends on the time.
    pub fn reads_time(&self) -> bool {
        self.levels_read_time()
            || self.normal_force.is_some_and(|normal| normal.transverse.is_some())
    }

    /// Whether the friction levels depend on the time: where they do, they may fall while the part
    /// is stuck.
    #[inline(always)]
    pub fn levels_read_time(&self) -> bool {
        self.drift.is_some_and(|drift| drift.over == Over::Time)
            || self.normal_force.is_some_and(|normal| normal.reads_time())
    }

    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Variation<S> {
        Variation {
            field: self.field.as_ref().map(|field| within!("field", field, f)),
            drift: self.drift.as_ref().map(|drift| within!("drift", drift, f)),
            normal_force: self
                .normal_force
                .as_ref()
                .map(|normal| within!("normal_force", normal, f)),
        }
    }

    /// The factor on the friction levels at position `x` in m and time `t` in s. `cell` remembers
    /// where in the field the part was last, which saves time and changes nothing.
    ///
    /// ```text
    /// φ = [1 + s(x)] · drift · N / N_0
    /// ```
    #[inline(always)]
    pub fn factor(&self, cell: &mut FieldCell<R>, x: R, t: R) -> R {
        let along = match &self.field {
            Some(field) => field.factor(cell, x),
            None => R::one(),
        };
        if self.is_field_at_most() {
            return along;
        }
        along * R::apart(Meanwhile { variation: *self, x, t })
    }

    /// The velocity in m/s that vibration adds across the motion at time `t` in s, if there is any.
    #[inline(always)]
    pub fn transverse_m_per_s(&self, t: R) -> Maybe<R> {
        match self.normal_force.and_then(|normal| normal.transverse) {
            Some(vibration) => Maybe::some(vibration.velocity_m_per_s(t)),
            None => Maybe::none(),
        }
    }
}
