//! What every controller answers, and a list of controllers as one.

use super::Measurement;
use crate::actuator::Command;
use crate::real::Real;
use crate::reference::Setpoint;

/// What every controller answers.
pub trait Control<R: Real> {
    /// What moves in it.
    type State;

    /// The command at a sample.
    fn step(&self, state: &mut Self::State, measured: &Measurement<R>) -> Command<R>;

    /// The speed in m/s that the part is meant to have after a step: what is faster is a jump. That
    /// of the feed, unless a controller follows the reference.
    #[inline(always)]
    fn commanded_speed(
        &self,
        _state: &Self::State,
        _setpoint: &Setpoint<R>,
        command: &Command<R>,
    ) -> R {
        command.feed_m_per_s
    }
}

/// Defines an enum of controllers, and a state in which each has what moves in it.
///
/// A controller is a line: `Variant(Config) with field: State`.
macro_rules! controllers {
    (
        $(#[$enum_meta:meta])* pub enum $name:ident;
        $(#[$state_meta:meta])* pub struct $state:ident;
        $( $(#[$meta:meta])* $variant:ident($config:ident) with $field:ident: $moving:ident ),+ $(,)?
    ) => {
        $(#[$enum_meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
        pub enum $name<R> { $( $(#[$meta])* $variant($config<R>) ),+ }

        $crate::states::states! {
            $(#[$state_meta])*
            pub struct $state with { $( $(#[$meta])* pub $field: $moving ),+ }
        }

        impl<R: $crate::real::Real> $name<R> {
            /// Applies `f` to every number.
            pub fn map<S: $crate::real::Real>(
                &self,
                f: &mut impl FnMut($crate::name::Name<'_>, R) -> S,
            ) -> $name<S> {
                match self { $( Self::$variant(one) => $name::$variant(one.map(f)) ),+ }
            }
        }

        impl<R: $crate::real::Real> $crate::control::Control<R> for $name<R> {
            type State = $state<R>;

            #[inline(always)]
            fn step(
                &self,
                state: &mut $state<R>,
                measured: &$crate::control::Measurement<R>,
            ) -> $crate::actuator::Command<R> {
                match self { $( Self::$variant(one) => one.step(&mut state.$field, measured) ),+ }
            }

            #[inline(always)]
            fn commanded_speed(
                &self,
                state: &$state<R>,
                setpoint: &$crate::reference::Setpoint<R>,
                command: &$crate::actuator::Command<R>,
            ) -> R {
                match self {
                    $( Self::$variant(one) => {
                        one.commanded_speed(&state.$field, setpoint, command)
                    } ),+
                }
            }
        }
    };
}

pub(super) use controllers;
