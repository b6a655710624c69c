//! The names of the numbers of a configuration or a state.

use core::fmt::{self, Display, Formatter};

/// The name of a number within a structure: its field, and the fields that lead there.
///
/// What [`Extraction::map`](crate::Extraction::map) and all other `map`s hand to their closure.
/// Elements of an array share a name; they come in order.
///
/// # Example
/// ```
/// extern crate std;
/// use breakaway_core::test_models::paper_as_computed;
/// let mut names = std::vec::Vec::new();
/// paper_as_computed().map(&mut |name, value| {
///     names.push((std::format!("{name}"), name.field()));
///     value
/// });
/// assert!(names.contains(&("controller.gains.kp_n_per_m".into(), "kp_n_per_m")));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Name<'a> {
    first: &'static str,
    rest: Option<&'a Name<'a>>,
}

impl Name<'_> {
    /// That of a field that is a number.
    #[inline(always)]
    pub(crate) fn of(field: &'static str) -> Self {
        Self { first: field, rest: None }
    }

    /// The last field: the one that holds the number.
    #[must_use]
    pub fn field(&self) -> &'static str {
        match self.rest {
            Some(rest) => rest.field(),
            None => self.first,
        }
    }
}

impl Display for Name<'_> {
    /// All fields, with a dot between them.
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.first)?;
        match self.rest {
            Some(rest) => write!(formatter, ".{rest}"),
            None => Ok(()),
        }
    }
}

/// `f` for the numbers of field `outer`: their names begin with it.
#[inline(always)]
pub(crate) fn inner<R, S>(
    outer: &'static str,
    f: &mut impl FnMut(Name<'_>, R) -> S,
) -> impl FnMut(Name<'_>, R) -> S {
    move |inner, value| f(Name { first: outer, rest: Some(&inner) }, value)
}

/// Maps a field that is a structure itself: the names of its numbers begin with that of the field.
macro_rules! within {
    ($outer:literal, $value:expr, $f:expr) => {{
        let mut inner = $crate::name::inner($outer, $f);
        $value.map(&mut inner)
    }};
}

pub(crate) use within;
