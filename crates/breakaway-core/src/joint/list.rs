//! Makes one joint of a list of laws.

/// Defines [`super::Joint`], a choice of the listed laws, which answers as the chosen one does. Each
/// is `file::Law`; in a scenario it has the law's name in `snake_case`.
macro_rules! joint_of {
    ($( $(#[$meta:meta])* $file:ident :: $law:ident ),+ $(,)?) => {
        $( pub use $file::$law; )+

        /// A seized joint: one of the friction laws.
        // The largest law sets the size of all. Joints are few, and no indirection is possible
        // without an allocator.
        #[allow(clippy::large_enum_variant)]
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(tag = "law", rename_all = "snake_case"))]
        pub enum Joint<R> {
            $( $(#[$meta])* $law($law<R>) ),+
        }

        impl<R: Real> Joint<R> {
            /// Applies `f` to every number of the law.
            pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Joint<S> {
                match self { $( Self::$law(law) => Joint::$law(law.map(f)) ),+ }
            }
        }

        impl<R: Real> Law<R> for Joint<R> {
            #[inline(always)]
            fn engagement_length_m(&self) -> R {
                match self { $( Self::$law(law) => law.engagement_length_m() ),+ }
            }

            #[inline(always)]
            fn stiffness_n_per_m(&self) -> R {
                match self { $( Self::$law(law) => law.stiffness_n_per_m() ),+ }
            }

            #[inline(always)]
            fn breakaway_force(&self, x: R) -> R {
                match self { $( Self::$law(law) => law.breakaway_force(x) ),+ }
            }

            #[inline(always)]
            fn friction_level(&self, x: R, v: R, factor: R) -> R {
                match self { $( Self::$law(law) => law.friction_level(x, v, factor) ),+ }
            }

            #[inline(always)]
            fn stored_energy_j(&self, bristle_m: R, elements: &ElementState<R>) -> R {
                match self { $( Self::$law(law) => law.stored_energy_j(bristle_m, elements) ),+ }
            }

            #[inline(always)]
            fn settle(&self, state: JointState<R>, x: R, v: R, factor: R) -> JointState<R> {
                match self { $( Self::$law(law) => law.settle(state, x, v, factor) ),+ }
            }

            #[inline(always)]
            fn let_go(
                &self,
                state: JointState<R>,
                elements: &mut ElementState<R>,
                x: R,
                factor: R,
            ) -> JointState<R> {
                match self { $( Self::$law(law) => law.let_go(state, elements, x, factor) ),+ }
            }

            #[inline(always)]
            fn frozen<F: Frozen<R>>(&self, state: &JointState<R>, at: &At<R>, then: F) -> F::Output {
                match self { $( Self::$law(law) => law.frozen(state, at, then) ),+ }
            }
        }
    };
}

pub(super) use joint_of;
