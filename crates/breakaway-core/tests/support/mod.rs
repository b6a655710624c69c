#![allow(dead_code)] // each test uses what it needs
//! A part in its joint without a loop around it: forces in, motion out.

pub(crate) mod bench;

use breakaway_core::disturbance::Factors;
use breakaway_core::joint::Joint;
use breakaway_core::plant::{Integrator, Moved, Plant, PlantState, Push};
use breakaway_core::variation::Variation;

/// No disturbance.
pub(crate) const UNDISTURBED: Factors<f64> = Factors { joint_force: 1.0, friction_level: 1.0 };

/// A part of 1 kg in a joint.
pub(crate) struct Rig {
    pub(crate) joint: Joint<f64>,
    pub(crate) integrator: Integrator,
    pub(crate) state: PlantState<f64>,
}

impl Rig {
    /// At rest at position `x`, stepped by the linearly implicit midpoint rule.
    pub(crate) fn at(joint: Joint<f64>, x: f64) -> Self {
        let state = PlantState { position_m: x, ..PlantState::at_rest() };
        Self { joint, integrator: Integrator::LinearlyImplicitMidpoint, state }
    }

    /// Applies a force for `h` seconds; gives the joint force.
    pub(crate) fn push(&mut self, force_n: f64, h: f64) -> f64 {
        self.push_disturbed(force_n, h, UNDISTURBED)
    }

    /// Applies a force for `h` seconds under a disturbance; gives the joint force.
    pub(crate) fn push_disturbed(&mut self, force_n: f64, h: f64, factors: Factors<f64>) -> f64 {
        let push = Push::rigid(force_n);
        let plant = Plant {
            joint: &self.joint,
            mass_kg: 1.0,
            push,
            factors,
            variation: &Variation::none(),
        };
        plant.step(self.integrator, &mut self.state, 0.0, h).joint_force_n
    }

    /// Pushes for `h` seconds.
    pub(crate) fn moved(&mut self, push: Push<f64>, h: f64) -> Moved<f64> {
        let plant = Plant {
            joint: &self.joint,
            mass_kg: 1.0,
            push,
            factors: UNDISTURBED,
            variation: &Variation::none(),
        };
        plant.step(self.integrator, &mut self.state, 0.0, h)
    }

    /// Applies a force for a time, in steps of 10 us; gives the last joint force.
    pub(crate) fn hold(&mut self, force_n: f64, time_s: f64) -> f64 {
        let steps = (time_s / 1e-5).round() as u32;
        (0..steps).fold(0.0, |_, _| self.push(force_n, 1e-5))
    }
}

/// Uniform on [-1, 1): SplitMix64.
pub(crate) fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 * 2.0_f64.powi(-52) - 1.0
}
