//! A number that may be missing.

use crate::real::Real;

/// A number, or none.
///
/// An `Option` that has a number in its empty place, too: one. Compilers compute with what is there
/// before they look whether it counts, and the undefined bits of an empty `Option` may be those of a
/// denormal number, with which processors are many times slower. It is read as an `Option` is.
///
/// # Example
/// ```
/// use breakaway_core::Maybe;
/// let [given, missing] = [Maybe::some(2.0), Maybe::none()];
/// assert_eq!((given.get(), missing.get()), (Some(&2.0), None));
/// assert_eq!(given.map(|x| 3.0 * x), Maybe::some(6.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Maybe<R> {
    is_some: bool,
    value: R,
}

impl<R> Maybe<R> {
    /// A number.
    #[inline(always)]
    pub const fn some(value: R) -> Self {
        Self { is_some: true, value }
    }

    /// The number, if there is one. By reference, because an `Option` of it has an empty place again.
    #[inline(always)]
    pub const fn get(&self) -> Option<&R> {
        if self.is_some { Some(&self.value) } else { None }
    }

    /// Whether there is none.
    #[inline(always)]
    pub const fn is_none(&self) -> bool {
        !self.is_some
    }
}

impl<R: Real> Maybe<R> {
    /// No number.
    #[inline(always)]
    pub fn none() -> Self {
        Self { is_some: false, value: R::one() }
    }

    /// The number, or `other` where there is none.
    #[inline(always)]
    pub fn unwrap_or(&self, other: R) -> R {
        if self.is_some { self.value } else { other }
    }

    /// Applies `f` to the number, if there is one.
    #[inline(always)]
    pub fn map<S: Real>(&self, f: impl FnOnce(R) -> S) -> Maybe<S> {
        if self.is_some { Maybe::some(f(self.value)) } else { Maybe::none() }
    }
}

#[cfg(feature = "serde")]
impl<'de, R: serde::Deserialize<'de>> serde::Deserialize<'de> for Maybe<R> {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        use serde::de::IntoDeserializer;
        match Option::deserialize(from)? {
            Some(value) => Ok(Self::some(value)),
            None => R::deserialize(1.0_f64.into_deserializer())
                .map(|one| Self { is_some: false, value: one }),
        }
    }
}
