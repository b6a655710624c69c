//! A number that follows the time or the way, piece by piece along straight lines.

// Indexed loops over fixed arrays are inlined within any caller's instruction set; closures are not.
#![allow(clippy::needless_range_loop)]

use crate::name::Name;
use crate::real::Real;

/// The most points of a course.
pub const POINTS_MAX: usize = 8;

/// What a course follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Over {
    /// The time since the start, s.
    Time,
    /// The part's travel from its seat, m.
    Travel,
}

/// Straight lines between points; before the first and after the last the number stays.
///
/// ```text
/// c(u) = c_0 + Σ_i (c_{i+1} − c_i) clip((u − u_i) / (u_{i+1} − u_i), 0, 1)
/// ```
///
/// Not checked: that the places of the points that count rise.
///
/// # Example
/// ```
/// use breakaway_core::variation::{Course, Over};
/// let (mut at, mut values) = ([0.0; 8], [0.0; 8]);
/// (at[1], values[0], values[1]) = (0.125, 2000.0, 500.0);
/// let course = Course { over: Over::Travel, points: 2, at, values };
/// assert_eq!(course.at(0.0625, 7.0), 1250.0);
/// assert_eq!(course.at(0.2, 0.0), 500.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Course<R> {
    /// What it follows.
    pub over: Over,
    /// How many points count, 1 to [`POINTS_MAX`].
    pub points: u32,
    /// u_i in s or m.
    pub at: [R; POINTS_MAX],
    /// c_i.
    pub values: [R; POINTS_MAX],
}

impl<R: Real> Course<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Course<S> {
        Course {
            over: self.over,
            points: self.points,
            at: self.at.map(|at| f(Name::of("at"), at)),
            values: self.values.map(|value| f(Name::of("values"), value)),
        }
    }

    /// c at travel `x` in m and time `t` in s.
    #[inline(always)]
    pub fn at(&self, x: R, t: R) -> R {
        let u = match self.over {
            Over::Time => t,
            Over::Travel => x,
        };
        let mut value = self.values[0];
        for i in 1..(self.points as usize).min(POINTS_MAX) {
            let width = (self.at[i] - self.at[i - 1]).named("width");
            let slope = ((self.values[i] - self.values[i - 1]) / width).named("slope");
            value = slope.mul_add((u - self.at[i - 1]).clamp(R::zero(), width), value);
        }
        value.named("course")
    }
}
