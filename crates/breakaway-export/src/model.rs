//! What is exported: parts of the block diagram, generic over the number.
//!
//! The same functions are recorded with [`Expr`](crate::Expr), and run with `f64` and `f32` to know what
//! exported code has to give.

use breakaway_core::actuator::Command;
use breakaway_core::control::Measurement;
use breakaway_core::disturbance::Factors;
use breakaway_core::period::Period;
use breakaway_core::reference::Setpoint;
use breakaway_core::sensor::Noise;
use breakaway_core::{Draws, Extraction, ExtractionState, Real};

/// What of an extraction is exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// Reference, controller and watch: what runs at the rig.
    Controller,
    /// Delay, actuator, joint, part, disturbance and sensors: what the controller meets.
    Plant,
    /// Both, closed.
    Loop,
}

impl What {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Controller, Self::Plant, Self::Loop];

    /// What names in the C begin with.
    #[must_use]
    pub fn prefix(self) -> &'static str {
        match self {
            Self::Controller => "controller",
            Self::Plant => "plant",
            Self::Loop => "loop",
        }
    }

    /// The inputs of a step.
    #[must_use]
    pub fn inputs(self) -> &'static [&'static str] {
        match self {
            Self::Controller => &["position_m", "velocity_m_per_s", "force_n"],
            Self::Plant => &["force_n", "feed_m_per_s", "stack_share"],
            Self::Loop => &[],
        }
    }

    /// The outputs of a step.
    #[must_use]
    pub fn outputs(self) -> &'static [&'static str] {
        match self {
            Self::Controller => &CONTROLLER_OUTPUTS,
            Self::Plant => &PLANT_OUTPUTS,
            Self::Loop => &LOOP_OUTPUTS,
        }
    }
}

const CONTROLLER_OUTPUTS: [&str; 5] =
    ["force_n", "feed_m_per_s", "stack_share", "stop_reason", "reference_m"];

const PLANT_OUTPUTS: [&str; 8] = [
    "measured_position_m",
    "measured_velocity_m_per_s",
    "measured_force_n",
    "position_m",
    "velocity_m_per_s",
    "bristle_m",
    "applied_force_n",
    "joint_force_n",
];

const LOOP_OUTPUTS: [&str; 10] = [
    "reference_m",
    "command_force_n",
    "command_feed_m_per_s",
    "command_stack_share",
    "stop_reason",
    "position_m",
    "velocity_m_per_s",
    "bristle_m",
    "applied_force_n",
    "joint_force_n",
];

/// A sample of the controller: reference, controller, watch. `seen` are [`What::inputs`], the
/// result [`What::outputs`].
pub fn control<R: Real>(
    extraction: &Extraction<R>,
    state: &mut ExtractionState<R>,
    seen: [R; 3],
) -> [R; 5] {
    let [position_m, velocity_m_per_s, force_n] = seen;
    R::section("reference");
    let setpoint = extraction.next_setpoint(&mut state.sampling);
    let measured = Measurement {
        reference_m: setpoint.position_m,
        reference_rate_m_per_s: setpoint.rate_m_per_s,
        position_m,
        velocity_m_per_s,
        force_n,
        period_s: extraction.timing.control_period_s,
        range: extraction.actuator.range(),
    };
    let command = extraction.decide(state, &measured);
    // The delay is the plant's; the watch here only remembers what was commanded last.
    extraction.delay(&mut state.sampling, command);
    let Command { force_n, feed_m_per_s, stack_share } = command;
    [force_n, feed_m_per_s, stack_share, state.watch.reason, setpoint.position_m]
}

/// What begins a period of the plant: the command that takes effect, the disturbance, and the time,
/// which runs where the joint varies with it.
pub fn begin<R: Real>(
    extraction: &Extraction<R>,
    state: &mut ExtractionState<R>,
    command: [R; 3],
    draw: R,
) -> (Command<R>, Factors<R>, R) {
    let [force_n, feed_m_per_s, stack_share] = command;
    R::section("command and disturbance");
    let decided = Command { force_n, feed_m_per_s, stack_share };
    let command = extraction.delay(&mut state.sampling, decided);
    let time_s = state.sampling.samples * extraction.timing.control_period_s;
    if extraction.variation.reads_time() {
        state.sampling.samples = state.sampling.samples + R::one();
    }
    (command, factors(extraction, draw), time_s)
}

/// The disturbance of a period.
pub fn factors<R: Real>(extraction: &Extraction<R>, draw: R) -> Factors<R> {
    extraction.factors(Draws { disturbance: draw, noise: Noise::none() })
}

/// What ends a period of the plant: the force that its sensor sees next.
pub fn end<R: Real>(state: &mut ExtractionState<R>, period: &Period<R>) -> [R; 2] {
    state.sampling.force_n = period.force_n;
    [period.force_n, period.joint_force_n]
}

/// What the sensors show at a sample, and what is.
pub fn show<R: Real>(
    extraction: &Extraction<R>,
    state: &mut ExtractionState<R>,
    noise: &Noise<R>,
) -> [R; 6] {
    let zero = R::zero();
    let nowhere = Setpoint { time_s: zero, position_m: zero, rate_m_per_s: zero };
    R::section("sensors");
    let seen = extraction.measure(state, &nowhere, noise);
    let plant = &state.plant;
    [
        seen.position_m,
        seen.velocity_m_per_s,
        seen.force_n,
        plant.position_m,
        plant.velocity_m_per_s,
        plant.bristle_m,
    ]
}

/// What begins a period of the loop: measure, decide, delay, disturb. Gives the time, reference and
/// stop reason, too.
pub fn begin_loop<R: Real>(
    extraction: &Extraction<R>,
    state: &mut ExtractionState<R>,
    draws: Draws<R>,
) -> (Command<R>, Factors<R>, R, [R; 2]) {
    R::section("reference");
    let setpoint = extraction.next_setpoint(&mut state.sampling);
    R::section("sensors");
    let measured = extraction.measure(state, &setpoint, &draws.noise);
    let decided = extraction.decide(state, &measured);
    R::section("command and disturbance");
    let command = extraction.delay(&mut state.sampling, decided);
    let outputs = [setpoint.position_m, state.watch.reason];
    (command, factors(extraction, draws.disturbance), setpoint.time_s, outputs)
}
