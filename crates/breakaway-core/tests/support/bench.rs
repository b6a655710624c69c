//! An actuator before a part in a joint, without a loop around them.

use breakaway_core::Maybe;
use breakaway_core::actuator::{
    Actuator, ActuatorState, Command, Contact, Effort, FeedAxis, Piezo, Tip,
};
use breakaway_core::disturbance::Factors;
use breakaway_core::joint::Joint;
use breakaway_core::plant::{Integrator, Moved, Plant, PlantState};
use breakaway_core::variation::Variation;

/// About a stack of 10 x 10 x 36 mm and a fast amplifier.
pub(crate) const STACK: Piezo<f64> = Piezo {
    stroke_m: 38e-6,
    stiffness_n_per_m: 1e8,
    tip_mass_kg: 0.01,
    damping_n_s_per_m: 200.0,
    hysteresis_share: 0.4,
    preload_n: 800.0,
    capacitance_f: 13e-6,
    loss_tangent: 0.015,
    voltage_max_v: 120.0,
    current_max_a: 10.0,
    amplifier_bandwidth_hz: 5000.0,
};

pub(crate) fn axis() -> FeedAxis<f64> {
    FeedAxis {
        speed_max_m_per_s: 0.05,
        acceleration_max_m_per_s2: 10.0,
        stiffness_n_per_m: 3e7,
        damping_n_s_per_m: 8e3,
        tool_mass_kg: 3.0,
        tip: Tip::Rigid,
        contact: Contact {
            stiffness_n_per_m: 2e8,
            damping_n_s_per_m: 3e3,
            gap_m: 1e-5,
            backlash_m: Maybe::none(),
        },
    }
}

pub(crate) fn with_stack(piezo: Piezo<f64>) -> FeedAxis<f64> {
    FeedAxis { tip: Tip::Piezo(piezo), ..axis() }
}

pub(crate) fn stack(share: f64) -> Command<f64> {
    Command { force_n: 0.0, feed_m_per_s: 0.0, stack_share: share }
}

pub(crate) fn feed(speed: f64) -> Command<f64> {
    Command { force_n: 0.0, feed_m_per_s: speed, stack_share: 0.0 }
}

/// An actuator before a part in a joint, without a loop around them.
pub(crate) struct Bench {
    pub(crate) actuator: Actuator<f64>,
    pub(crate) state: ActuatorState<f64>,
    pub(crate) joint: Joint<f64>,
    pub(crate) mass_kg: f64,
    pub(crate) part: PlantState<f64>,
}

impl Bench {
    pub(crate) fn new(actuator: Actuator<f64>, joint: Joint<f64>) -> Self {
        let (state, part) = (ActuatorState::at_rest(), PlantState::at_rest());
        Self { actuator, state, joint, mass_kg: 1.0, part }
    }

    /// The part cannot move: gives the force on it, and the effort.
    pub(crate) fn hold(&mut self, command: &Command<f64>, h: f64) -> (f64, Effort<f64>) {
        let driven = self.actuator.drive(&mut self.state, command, self.part.position_m, h);
        let push = driven.push.meets(0.0, 0.0);
        (push, self.actuator.settle(&mut self.state, &driven, push, 0.0, h))
    }

    /// The part moves.
    pub(crate) fn step(
        &mut self,
        command: &Command<f64>,
        factors: Factors<f64>,
        h: f64,
    ) -> (Moved<f64>, Effort<f64>) {
        let driven = self.actuator.drive(&mut self.state, command, self.part.position_m, h);
        let push = driven.push;
        let plant = Plant {
            joint: &self.joint,
            mass_kg: self.mass_kg,
            push,
            factors,
            variation: &Variation::none(),
        };
        let moved = plant.step(Integrator::LinearlyImplicitMidpoint, &mut self.part, 0.0, h);
        let (force_n, v) = (moved.push_force_n, moved.mean_velocity_m_per_s);
        (moved, self.actuator.settle(&mut self.state, &driven, force_n, v, h))
    }

    pub(crate) fn hold_long(&mut self, command: &Command<f64>, h: f64, steps: u32) -> f64 {
        (0..steps).fold(0.0, |_, _| self.hold(command, h).0)
    }
}
