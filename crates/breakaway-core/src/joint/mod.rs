//! Friction laws of a seized joint, one file each.
//!
//! With the velocity and the position frozen, every law is one of three things ([`Frozen`]): a bristle
//! whose equation is affine in its deflection, several of them, or rigid. That is all the plant
//! needs to step any law, stuck or sliding, without iteration. To add a law: one file here, and one
//! line in the list of [`Joint`].

mod coulomb_stiction;
mod directional_lugre;
mod elasto_plastic;
mod elements;
mod engagement;
mod frozen;
mod gms;
mod law;
mod list;
mod lugre;
mod onset;
mod steady;
mod two_region;

pub use directional_lugre::DirectionalLugre;
pub use elements::{ELEMENTS_MAX, ElementState, Elements};
pub use engagement::engaged_level;
pub use frozen::{At, Bristle, Frozen, JointState, Rigid};
pub use gms::default_shares;
pub use law::Law;
pub use steady::{Form, Steady, form, steady};

use crate::name::Name;
use crate::real::Real;

list::joint_of! {
    /// Modified LuGre, equations (1) to (8).
    lugre::Lugre,
    /// The two-region law that the controller is designed with, equation (9).
    two_region::TwoRegion,
    /// LuGre with a bristle that is elastic at first.
    elasto_plastic::ElastoPlastic,
    /// Generalized Maxwell-slip.
    gms::Gms,
    /// Rigid Coulomb friction with stiction.
    coulomb_stiction::CoulombStiction,
}
