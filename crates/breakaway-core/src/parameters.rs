//! One macro for every struct that holds only numbers.

/// Defines a struct of numbers, generic over their type, with a `map` from one type to another.
///
/// `map` visits the fields in declaration order. It is how a configuration or a state is cast to
/// `f32`, gathered into lanes, seeded with derivatives, or turned into recorded inputs.
macro_rules! parameters {
    ($(#[$meta:meta])* pub struct $name:ident { $( $(#[$field_meta:meta])* pub $field:ident ),+ $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
        pub struct $name<R> { $( $(#[$field_meta])* pub $field: R ),+ }

        impl<R: Copy> $name<R> {
            /// Applies `f` to every number, in declaration order, with the field's name.
            pub fn map<S>(&self, f: &mut impl FnMut($crate::name::Name<'_>, R) -> S) -> $name<S> {
                $name { $( $field: f($crate::name::Name::of(stringify!($field)), self.$field) ),+ }
            }
        }

        impl<R: $crate::real::Real> $name<R> {
            /// Every number of `yes` where `mask` holds, of `no` elsewhere.
            #[inline(always)]
            pub fn select(mask: R::Mask, yes: &Self, no: &Self) -> Self {
                $name { $( $field: R::select(mask, yes.$field, no.$field) ),+ }
            }
        }
    };
}

pub(crate) use parameters;
