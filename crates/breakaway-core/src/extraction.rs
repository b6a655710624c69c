//! The block diagram of an extraction: one named call per block (paper, figure 5).

use crate::actuator::{Actuator, ActuatorState, Command, Effort};
use crate::control::{Control, Controller, ControllerState, Measurement, Watch, WatchState};
use crate::crossing::Motion;
use crate::disturbance::{Disturbance, Draws, Factors};
use crate::joint::Joint;
use crate::name::{Name, within};
use crate::parameters::parameters;
use crate::period::{Nobody, Period, Stretch, Witness};
use crate::plant::{Integrator, Plant, PlantState};
use crate::real::{Block, Real};
use crate::reference::{Reference, Setpoint};
use crate::sensor::{Noise, Sensors, SensorsState};
use crate::variation::Variation;

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

impl<R: Copy> Timing<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Timing<S> {
        Timing {
            control_period_s: f(Name::of("control_period_s"), self.control_period_s),
            one_sample_delay: self.one_sample_delay,
            integrator: self.integrator,
            steps_per_period: self.steps_per_period,
        }
    }
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
/// let sample = extraction.step(&mut state, Draws::none());
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
    /// How its friction varies along the way, during a pull, and with the normal force.
    pub variation: Variation<R>,
    /// The paper's random factor on the joint.
    pub disturbance: Disturbance<R>,
    /// What pushes.
    pub actuator: Actuator<R>,
    /// What the controller sees through, if not what is.
    pub sensors: Option<Sensors<R>>,
    /// What stops the controller where its sensors cannot be right, if anything does.
    pub watch: Option<Watch<R>>,
    /// What decides how hard.
    pub controller: Controller<R>,
    /// How the loop runs.
    pub timing: Timing<R>,
}

/// The clock and the delayed command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopState<R> {
    /// Samples so far.
    pub samples: R,
    /// The command that waits for the next period.
    pub waiting: Command<R>,
    /// F at the last sample, N: what a force sensor sees.
    pub force_n: R,
}

impl<R: Copy> LoopState<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> LoopState<S> {
        LoopState {
            samples: f(Name::of("samples"), self.samples),
            waiting: within!("waiting", self.waiting, f),
            force_n: f(Name::of("force_n"), self.force_n),
        }
    }
}

/// What moves during an extraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtractionState<R> {
    /// The part and its joint.
    pub plant: PlantState<R>,
    /// What pushes.
    pub actuator: ActuatorState<R>,
    /// What is seen.
    pub sensors: SensorsState<R>,
    /// What is watched.
    pub watch: WatchState<R>,
    /// The controller.
    pub controller: ControllerState<R>,
    /// The loop.
    pub sampling: LoopState<R>,
}

impl<R: Real> ExtractionState<R> {
    /// On the seat, at rest, before the first sample.
    pub fn at_rest() -> Self {
        let plant = PlantState::at_rest();
        let zero = R::zero();
        Self {
            plant,
            actuator: ActuatorState::at_rest(),
            sensors: SensorsState::at_rest(),
            watch: WatchState::at_rest(),
            controller: ControllerState::at_rest(),
            sampling: LoopState { samples: zero, waiting: Command::force(zero), force_n: zero },
        }
    }

    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> ExtractionState<S> {
        ExtractionState {
            plant: within!("plant", self.plant, f),
            actuator: within!("actuator", self.actuator, f),
            sensors: within!("sensors", self.sensors, f),
            watch: within!("watch", self.watch, f),
            controller: within!("controller", self.controller, f),
            sampling: within!("sampling", self.sampling, f),
        }
    }
}

/// One control period: the state at its sample, the forces during it, the state after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<R> {
    /// Time of the sample, s.
    pub time_s: R,
    /// Control period, s.
    pub period_s: R,
    /// r at the sample, m.
    pub reference_m: R,
    /// x at the sample, m.
    pub position_m: R,
    /// v at the sample, m/s.
    pub velocity_m_per_s: R,
    /// z at the sample, m.
    pub bristle_m: R,
    /// What the controller asked for, N; with a delay, one period ago.
    pub command_n: R,
    /// F during the period, N: the mean.
    pub applied_force_n: R,
    /// Largest F of an integration step in it, N.
    pub largest_force_n: R,
    /// R during the period, N: the mean, disturbance included.
    pub joint_force_n: R,
    /// ∫ F dx over the period, J.
    pub work_j: R,
    /// ∫ R dx over the period, J.
    pub joint_work_j: R,
    /// What the actuator took.
    pub effort: Effort<R>,
    /// Why the watch has stopped the controller; 0 while it has not.
    pub stop_reason: R,
    /// x one period later, m.
    pub next_position_m: R,
    /// v one period later, m/s.
    pub next_velocity_m_per_s: R,
    /// Energy in the bristles one period later, J.
    pub next_stored_j: R,
}

impl<R: Real> Extraction<R> {
    /// Applies `f` to every number, for example to gather runs into lanes.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Extraction<S> {
        Extraction {
            joint: within!("joint", self.joint, f),
            part: within!("part", self.part, f),
            reference: within!("reference", self.reference, f),
            variation: within!("variation", self.variation, f),
            disturbance: within!("disturbance", self.disturbance, f),
            actuator: within!("actuator", self.actuator, f),
            sensors: self.sensors.as_ref().map(|sensors| within!("sensors", sensors, f)),
            watch: self.watch.as_ref().map(|watch| within!("watch", watch, f)),
            controller: within!("controller", self.controller, f),
            timing: within!("timing", self.timing, f),
        }
    }

    /// One control period.
    #[inline(always)]
    pub fn step(&self, state: &mut ExtractionState<R>, draws: Draws<R>) -> Sample<R> {
        let setpoint = self.next_setpoint(&mut state.sampling);
        let factors = self.factors(draws);
        self.follow::<_, false>(state, &setpoint, &factors, &draws.noise, &mut Nobody)
    }

    /// The paper's random factor for a held draw. Friction that varies along the way has none.
    #[inline(always)]
    pub fn factors(&self, draws: Draws<R>) -> Factors<R> {
        if self.variation.field.is_some() {
            return Factors { joint_force: R::one(), friction_level: R::one() };
        }
        self.disturbance.factors(draws)
    }

    /// What the reference asks for at this sample; moves the clock on to the next.
    #[inline(always)]
    pub fn next_setpoint(&self, sampling: &mut LoopState<R>) -> Setpoint<R> {
        let time_s = (sampling.samples * self.timing.control_period_s).named("time_s");
        sampling.samples = sampling.samples + R::one();
        self.reference.sample(time_s)
    }

    /// One control period towards a setpoint that the caller has sampled from the reference, once
    /// for many runs that share it, and with factors that the caller has computed when they were
    /// drawn. The clock of the state stands still. With `APART`, what depends on kinds is computed in
    /// functions of their own ([`Real::apart`]). The witness sees every integration step.
    #[inline(always)]
    pub fn follow<W: Witness<R>, const APART: bool>(
        &self,
        state: &mut ExtractionState<R>,
        setpoint: &Setpoint<R>,
        factors: &Factors<R>,
        noise: &Noise<R>,
        witness: &mut W,
    ) -> Sample<R> {
        let (before, time_s) = (state.plant, setpoint.time_s);
        let measured = self.measure(state, setpoint, noise);
        let decided = apart::<R, _, APART>(Deciding { loop_: self, state, measured: &measured });
        let command = self.delay(&mut state.sampling, decided);
        let commanded_m_per_s =
            self.controller.commanded_speed(&state.controller, setpoint, &command);
        let moving = Moving {
            loop_: self,
            state,
            command: &command,
            factors,
            time_s,
            commanded_m_per_s,
            witness,
        };
        let period = apart::<R, _, APART>(moving);
        state.sampling.force_n = period.force_n;
        Sample {
            time_s,
            period_s: self.timing.control_period_s,
            reference_m: setpoint.position_m,
            position_m: before.position_m,
            velocity_m_per_s: before.velocity_m_per_s,
            bristle_m: before.bristle_m,
            command_n: command.force_n,
            applied_force_n: period.force_n,
            largest_force_n: period.largest_force_n,
            joint_force_n: period.joint_force_n,
            work_j: period.work_j,
            joint_work_j: period.joint_work_j,
            effort: period.effort,
            stop_reason: state.watch.reason,
            next_position_m: state.plant.position_m,
            next_velocity_m_per_s: state.plant.velocity_m_per_s,
            next_stored_j: state.plant.stored_energy_j(&self.joint),
        }
    }

    /// What the controller gets to see.
    #[inline(always)]
    pub fn measure(
        &self,
        state: &mut ExtractionState<R>,
        setpoint: &Setpoint<R>,
        noise: &Noise<R>,
    ) -> Measurement<R> {
        let period_s = self.timing.control_period_s;
        let (x, force) = (state.plant.position_m, state.sampling.force_n);
        let (position_m, force_n) = match &self.sensors {
            Some(Sensors { position, force: load }) => (
                position.read(&mut state.sensors.position, x, noise.position, period_s),
                load.read(&mut state.sensors.force, force, noise.force, period_s),
            ),
            None => (x, force),
        };
        Measurement {
            reference_m: setpoint.position_m,
            reference_rate_m_per_s: setpoint.rate_m_per_s,
            position_m,
            velocity_m_per_s: state.plant.velocity_m_per_s,
            force_n,
            period_s,
            range: self.actuator.range(),
        }
    }

    /// The controller's command, unless the watch has stopped it.
    #[inline(always)]
    pub fn decide(&self, state: &mut ExtractionState<R>, measured: &Measurement<R>) -> Command<R> {
        let decided = self.controller.step(&mut state.controller, measured);
        let Some(watch) = &self.watch else {
            return decided;
        };
        let zero = R::zero();
        let last = &state.sampling.waiting;
        let pushing =
            zero.lt(last.force_n) | zero.lt(last.feed_m_per_s) | zero.lt(last.stack_share);
        let trusted = watch.trusts(&mut state.watch, measured, pushing);
        if !self.timing.one_sample_delay {
            state.sampling.waiting = decided;
        }
        Command {
            force_n: R::select(trusted, decided.force_n, zero),
            feed_m_per_s: R::select(trusted, decided.feed_m_per_s, zero),
            stack_share: R::select(trusted, decided.stack_share, zero),
        }
    }

    /// The command that takes effect now: where a sample is late, the one before.
    #[inline(always)]
    pub fn delay(&self, sampling: &mut LoopState<R>, decided: Command<R>) -> Command<R> {
        if !self.timing.one_sample_delay {
            return decided;
        }
        core::mem::replace(&mut sampling.waiting, decided)
    }

    /// Integrates over one period from time `time_s` on, with a command held.
    #[inline(always)]
    pub fn move_plant(
        &self,
        state: &mut ExtractionState<R>,
        command: &Command<R>,
        factors: &Factors<R>,
        time_s: R,
        commanded_m_per_s: R,
        witness: &mut impl Witness<R>,
    ) -> Period<R> {
        let steps = self.timing.steps_per_period;
        let (h, mut sum, mut time_s) = (self.step_s(), Period::none(), time_s);
        for _ in 0..steps {
            let (step, motion) = self.move_once(state, command, factors, time_s);
            witness.see(&Stretch {
                time_s,
                motion,
                next_position_m: state.plant.position_m,
                commanded_m_per_s,
                force_n: step.force_n,
            });
            time_s = time_s + h;
            if steps == 1 {
                return step;
            }
            sum = sum.and(&step);
        }
        sum.mean(self.step_share())
    }

    /// The share of a control period that an integration step takes.
    #[inline(always)]
    pub fn step_share(&self) -> R {
        R::constant(1.0 / f64::from(self.timing.steps_per_period))
    }

    /// h in s, the duration of an integration step.
    #[inline(always)]
    pub fn step_s(&self) -> R {
        let period_s = self.timing.control_period_s;
        if self.timing.steps_per_period == 1 { period_s } else { period_s * self.step_share() }
    }

    /// One integration step from time `time_s` on: the actuator drives, the plant solves, the actuator
    /// yields. Gives the part's motion as well, as if the joint held to the end of the step.
    #[inline(always)]
    pub fn move_once(
        &self,
        state: &mut ExtractionState<R>,
        command: &Command<R>,
        factors: &Factors<R>,
        time_s: R,
    ) -> (Period<R>, Motion<R>) {
        let h = self.step_s();
        let (part_m, part_m_per_s) = (state.plant.position_m, state.plant.velocity_m_per_s);
        let driven = self.actuator.drive(&mut state.actuator, command, part_m, h);
        let plant = Plant {
            joint: &self.joint,
            mass_kg: self.part.mass_kg,
            push: driven.push,
            factors: *factors,
            variation: &self.variation,
        };
        let moved = plant.step(self.timing.integrator, &mut state.plant, time_s, h);
        let (push, v) = (moved.push_force_n, moved.mean_velocity_m_per_s);
        let period = Period {
            force_n: push,
            largest_force_n: push.abs(),
            joint_force_n: moved.joint_force_n,
            work_j: push * (v * h),
            joint_work_j: moved.joint_work_j,
            effort: self.actuator.settle(&mut state.actuator, &driven, push, v, h),
        };
        let motion = Motion {
            position_m: part_m,
            velocity_m_per_s: part_m_per_s,
            change_m_per_s: moved.change_m_per_s,
            duration_s: h,
        };
        (period, motion)
    }
}

/// The controller's part of a period.
struct Deciding<'a, R> {
    loop_: &'a Extraction<R>,
    state: &'a mut ExtractionState<R>,
    measured: &'a Measurement<R>,
}

impl<R: Real> Block for Deciding<'_, R> {
    type Output = Command<R>;

    #[inline(always)]
    fn compute(self) -> Command<R> {
        self.loop_.decide(self.state, self.measured)
    }
}

/// The part of a period in which things move.
struct Moving<'a, R, W> {
    loop_: &'a Extraction<R>,
    state: &'a mut ExtractionState<R>,
    command: &'a Command<R>,
    factors: &'a Factors<R>,
    time_s: R,
    commanded_m_per_s: R,
    witness: &'a mut W,
}

impl<R: Real, W: Witness<R>> Block for Moving<'_, R, W> {
    type Output = Period<R>;

    #[inline(always)]
    fn compute(self) -> Period<R> {
        let Self { loop_, state, command, factors, time_s, commanded_m_per_s, witness } = self;
        loop_.move_plant(state, command, factors, time_s, commanded_m_per_s, witness)
    }
}

#[inline(always)]
fn apart<R: Real, B: Block, const APART: bool>(block: B) -> B::Output {
    if APART { R::apart(block) } else { block.compute() }
}
