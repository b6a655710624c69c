//! The block diagram of an extraction: one named call per block (paper, figure 5).

use crate::actuator::Actuator;
use crate::control::{Controller, ControllerState, Measurement};
use crate::disturbance::{Disturbance, Draws, Factors};
use crate::joint::Joint;
use crate::parameters::parameters;
use crate::plant::{Integrator, Plant, PlantState};
use crate::real::Real;
use crate::reference::{Reference, Setpoint};

parameters! {
    /// The part that is extracted.
    pub struct Part {
        /// m in kg.
        pub mass_kg,
    }
}

/// How the loop runs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Timing<R> {
    /// T_s in s: the controller is sampled at this period and its force held.
    pub control_period_s: R,
    /// Whether a force takes effect one period after the sample it was computed from.
    pub one_sample_delay: bool,
    /// How the plant is stepped.
    pub integrator: Integrator,
    /// Integration steps in a control period, at least 1.
    pub steps_per_period: u32,
}

impl<R> Timing<R> {
    /// One linearly implicit step in each control period, without delay.
    pub fn every_period_once(control_period_s: R) -> Self {
        Self {
            control_period_s,
            one_sample_delay: false,
            integrator: Integrator::LinearlyImplicitMidpoint,
            steps_per_period: 1,
        }
    }

    /// Whether this is [`Timing::every_period_once`].
    pub fn is_every_period_once(&self) -> bool {
        !self.one_sample_delay
            && self.integrator == Integrator::LinearlyImplicitMidpoint
            && self.steps_per_period == 1
    }
}

/// Everything that defines an extraction, but for random draws and its duration.
///
/// `Extraction` never changes; [`ExtractionState`] is what moves.
///
/// # Example
/// ```
/// use breakaway_core::test_models::paper_as_computed;
/// use breakaway_core::{Draws, ExtractionState};
/// let extraction = paper_as_computed();
/// let mut state = ExtractionState::at_rest();
/// let sample = extraction.step(&mut state, Draws { disturbance: 0.0 });
/// assert_eq!((sample.time_s, sample.applied_force_n), (0.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Extraction<R> {
    /// The seized joint.
    pub joint: Joint<R>,
    /// The part in it.
    pub part: Part<R>,
    /// Where the part should be.
    pub reference: Reference<R>,
    /// What is not known of the joint.
    pub disturbance: Disturbance<R>,
    /// What pushes.
    pub actuator: Actuator<R>,
    /// What decides how hard.
    pub controller: Controller<R>,
    /// How the loop runs.
    pub timing: Timing<R>,
}

parameters! {
    /// The clock and the delayed force.
    pub struct LoopState {
        /// Samples so far.
        pub samples,
        /// The command that waits for the next period, N.
        pub waiting_command_n,
    }
}

/// What moves during an extraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtractionState<R> {
    /// The part and its joint.
    pub plant: PlantState<R>,
    /// The controller.
    pub controller: ControllerState<R>,
    /// The loop.
    pub sampling: LoopState<R>,
}

impl<R: Real> ExtractionState<R> {
    /// On the seat, at rest, before the first sample.
    pub fn at_rest() -> Self {
        let plant = PlantState::at_rest();
        Self {
            plant,
            controller: ControllerState::at_rest(plant.position_m),
            sampling: LoopState { samples: R::zero(), waiting_command_n: R::zero() },
        }
    }

    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(&'static str, R) -> S) -> ExtractionState<S> {
        ExtractionState {
            plant: self.plant.map(f),
            controller: self.controller.map(f),
            sampling: self.sampling.map(f),
        }
    }
}

parameters! {
    /// One control period: the state at its sample, the forces during it, the state after it.
    pub struct Sample {
        /// Time of the sample, s.
        pub time_s,
        /// Control period, s.
        pub period_s,
        /// r at the sample, m.
        pub reference_m,
        /// dr/dt at the sample, m/s.
        pub reference_rate_m_per_s,
        /// x at the sample, m.
        pub position_m,
        /// v at the sample, m/s.
        pub velocity_m_per_s,
        /// z at the sample, m.
        pub bristle_m,
        /// What the controller asked for, N; with a delay, one period ago.
        pub command_n,
        /// F during the period, N.
        pub applied_force_n,
        /// R during the period, N: the mean, disturbance included.
        pub joint_force_n,
        /// x one period later, m.
        pub next_position_m,
        /// v one period later, m/s.
        pub next_velocity_m_per_s,
        /// z one period later, m.
        pub next_bristle_m,
    }
}

impl<R: Real> Extraction<R> {
    /// Applies `f` to every number, for example to gather runs into lanes.
    pub fn map<S>(&self, f: &mut impl FnMut(&'static str, R) -> S) -> Extraction<S> {
        Extraction {
            joint: self.joint.map(f),
            part: self.part.map(f),
            reference: self.reference.map(f),
            disturbance: self.disturbance.map(f),
            actuator: self.actuator.map(f),
            controller: self.controller.map(f),
            timing: Timing {
                control_period_s: f("control_period_s", self.timing.control_period_s),
                one_sample_delay: self.timing.one_sample_delay,
                integrator: self.timing.integrator,
                steps_per_period: self.timing.steps_per_period,
            },
        }
    }

    /// One control period.
    #[inline(always)]
    pub fn step(&self, state: &mut ExtractionState<R>, draws: Draws<R>) -> Sample<R> {
        let setpoint = self.reference.sample(state.sampling.samples * self.timing.control_period_s);
        state.sampling.samples = state.sampling.samples + R::one();
        self.follow(state, &setpoint, &self.disturbance.factors(draws))
    }

    /// One control period towards a setpoint that the caller has sampled from the reference, once
    /// for many runs that share it, and with factors that the caller has computed when they were
    /// drawn. The clock of the state stands still.
    #[inline(always)]
    pub fn follow(
        &self,
        state: &mut ExtractionState<R>,
        setpoint: &Setpoint<R>,
        factors: &Factors<R>,
    ) -> Sample<R> {
        let period_s = self.timing.control_period_s;
        let before = state.plant;
        let measured = Measurement {
            reference_m: setpoint.position_m,
            reference_rate_m_per_s: setpoint.rate_m_per_s,
            position_m: before.position_m,
            velocity_m_per_s: before.velocity_m_per_s,
            period_s,
            range: self.actuator.range(),
        };
        let decided = self.controller.step(&mut state.controller, &measured);
        let command_n = self.delay(&mut state.sampling, decided);
        let applied_force_n = self.actuator.force(command_n);
        let joint_force_n = self.move_plant(&mut state.plant, applied_force_n, factors);
        Sample {
            time_s: setpoint.time_s,
            period_s,
            reference_m: setpoint.position_m,
            reference_rate_m_per_s: setpoint.rate_m_per_s,
            position_m: before.position_m,
            velocity_m_per_s: before.velocity_m_per_s,
            bristle_m: before.bristle_m,
            command_n,
            applied_force_n,
            joint_force_n,
            next_position_m: state.plant.position_m,
            next_velocity_m_per_s: state.plant.velocity_m_per_s,
            next_bristle_m: state.plant.bristle_m,
        }
    }

    #[inline(always)]
    fn delay(&self, sampling: &mut LoopState<R>, decided_n: R) -> R {
        if !self.timing.one_sample_delay {
            return decided_n;
        }
        core::mem::replace(&mut sampling.waiting_command_n, decided_n)
    }

    /// Integrates over one period with a constant force; gives the mean joint force in N.
    #[inline(always)]
    fn move_plant(&self, state: &mut PlantState<R>, force_n: R, factors: &Factors<R>) -> R {
        let plant =
            Plant { joint: &self.joint, mass_kg: self.part.mass_kg, force_n, factors: *factors };
        let Timing { integrator, steps_per_period: steps, control_period_s, .. } = self.timing;
        if steps == 1 {
            return plant.step(integrator, state, control_period_s);
        }
        let share = R::constant(1.0 / f64::from(steps));
        let mut sum = R::zero();
        for _ in 0..steps {
            sum = sum + plant.step(integrator, state, control_period_s * share);
        }
        sum * share
    }
}
