//! One macro for every struct that moves: a state.

/// Defines a state, generic over its numbers, that is all zeros at rest.
///
/// It has numbers, states of its own after `with`, or both. `map` visits all numbers in declaration
/// order, under names that begin with those of the fields that lead to them.
macro_rules! states {
    ($(#[$meta:meta])* pub struct $name:ident
        $( { $( $(#[$number_meta:meta])* pub $number:ident ),+ $(,)? } )?
        $( with { $( $(#[$state_meta:meta])* pub $state:ident: $kind:ident ),+ $(,)? } )?
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name<R> {
            $( $( $(#[$number_meta])* pub $number: R, )+ )?
            $( $( $(#[$state_meta])* pub $state: $kind<R>, )+ )?
        }

        impl<R: $crate::real::Real> $name<R> {
            /// Before the first sample, with the part on its seat: every number is zero.
            pub fn at_rest() -> Self {
                Self {
                    $( $( $number: R::zero(), )+ )?
                    $( $( $state: $kind::at_rest(), )+ )?
                }
            }

            /// Applies `f` to every number, in declaration order, with its name.
            pub fn map<S>(&self, f: &mut impl FnMut($crate::name::Name<'_>, R) -> S) -> $name<S> {
                $name {
                    $( $( $number: f($crate::name::Name::of(stringify!($number)), self.$number), )+ )?
                    $( $( $state: {
                        self.$state.map(&mut $crate::name::inner(stringify!($state), f))
                    }, )+ )?
                }
            }

            /// Every number of `yes` where `mask` holds, of `no` elsewhere.
            #[inline(always)]
            pub fn select(mask: R::Mask, yes: &Self, no: &Self) -> Self {
                Self {
                    $( $( $number: R::select(mask, yes.$number, no.$number), )+ )?
                    $( $( $state: $kind::select(mask, &yes.$state, &no.$state), )+ )?
                }
            }
        }
    };
}

pub(crate) use states;
