//! Records the routines of a step.

use breakaway_core::actuator::Command;
use breakaway_core::disturbance::Factors;
use breakaway_core::period::Period;
use breakaway_core::sensor::Noise;
use breakaway_core::{Draws, Extraction, ExtractionState, Name, Real};

use crate::expr::{Expr, Recorder, record};
use crate::model::{self, What};
use crate::routine::{Routine, Value, parameters, states};

/// What the numbers of an extraction and of its state are called in a recording.
struct Model<'a> {
    extraction: &'a Extraction<f64>,
    parameters: Vec<Value>,
    states: Vec<Value>,
}

/// Records the routines of a step in the order in which they are computed. Where a controller is not
/// given the `velocity`, it is zero: for a watch, a number that can be true.
pub(crate) fn record_model(
    what: What,
    extraction: &Extraction<f64>,
    velocity: bool,
) -> Vec<Routine> {
    let model = Model { extraction, parameters: parameters(extraction), states: states() };
    let several = extraction.timing.steps_per_period > 1;
    match (what, several) {
        (What::Controller, _) => vec![model.controller(velocity)],
        (What::Plant, false) => vec![model.plant_at_once(), model.show()],
        (What::Plant, true) => {
            vec![model.plant_begins(), model.moves(), model.plant_ends(), model.show()]
        }
        (What::Loop, false) => vec![model.loop_at_once()],
        (What::Loop, true) => vec![model.loop_begins(), model.moves(), model.loop_ends()],
    }
}

impl Model<'_> {
    /// Records a routine of the configuration and the state, both inputs; the state is an output, too.
    fn routine(
        &self,
        name: &'static str,
        times: u32,
        build: impl FnOnce(&mut Recorder, &Extraction<Expr>, &mut ExtractionState<Expr>),
    ) -> Routine {
        let graph = record(|recorder| {
            let mut paths = self.parameters.iter();
            let extraction = self.extraction.map(&mut |_, _| {
                let path = &paths.next().expect("one path for each number").path;
                recorder.input(format!("parameter/{path}"))
            });
            let mut paths = self.states.iter();
            let mut state = ExtractionState::at_rest().map(&mut |_, _: f64| {
                let path = &paths.next().expect("one path for each number").path;
                recorder.input(format!("state/{path}"))
            });
            build(recorder, &extraction, &mut state);
            let mut paths = self.states.iter();
            state.map(&mut |_, number| {
                let path = &paths.next().expect("one path for each number").path;
                recorder.output(format!("state/{path}"), number);
            });
        });
        Routine { name, graph, times }
    }

    fn controller(&self, velocity: bool) -> Routine {
        self.routine("compute", 1, |recorder, extraction, state| {
            let [position_m, mut velocity_m_per_s, force_n] = inputs(recorder, What::Controller);
            if !velocity {
                velocity_m_per_s = Expr::zero();
            }
            let seen = [position_m, velocity_m_per_s, force_n];
            let result = model::control(extraction, state, seen);
            outputs(recorder, What::Controller.outputs(), &result);
        })
    }

    fn plant_at_once(&self) -> Routine {
        self.routine("move", 1, |recorder, extraction, state| {
            let commanded = inputs(recorder, What::Plant);
            let draw = recorder.input("signal/draw");
            let (command, factors, time_s) = model::begin(extraction, state, commanded, draw);
            let (period, _) = extraction.move_once(state, &command, &factors, time_s);
            let forces = model::end(state, &period);
            outputs(recorder, &FORCES, &forces);
        })
    }

    fn plant_begins(&self) -> Routine {
        self.routine("begin", 1, |recorder, extraction, state| {
            let commanded = inputs(recorder, What::Plant);
            let draw = recorder.input("signal/draw");
            let (command, factors, time_s) = model::begin(extraction, state, commanded, draw);
            hand_over(recorder, &command, &factors, time_s);
        })
    }

    /// One integration step of several; its forces and works are added up.
    fn moves(&self) -> Routine {
        let times = self.extraction.timing.steps_per_period;
        self.routine("move", times, |recorder, extraction, state| {
            let command = Command::force(0.0).map(&mut of(recorder, "command"));
            let factors = Factors {
                joint_force: recorder.input("signal/factor.joint_force"),
                friction_level: recorder.input("signal/factor.friction_level"),
            };
            let sum = Period::<f64>::none().map(&mut of(recorder, "sum"));
            let time_s = recorder.input("signal/time_s");
            let (step, _) = extraction.move_once(state, &command, &factors, time_s);
            if extraction.variation.reads_time() {
                recorder.output("signal/time_s", time_s + extraction.step_s());
            }
            Expr::section("sums over the steps of a period");
            sum.and(&step).map(&mut to(recorder, "sum"));
        })
    }

    fn plant_ends(&self) -> Routine {
        self.routine("end", 1, |recorder, extraction, state| {
            let sum = Period::<f64>::none().map(&mut of(recorder, "sum"));
            Expr::section("means over the period");
            let forces = model::end(state, &sum.mean(extraction.step_share()));
            outputs(recorder, &FORCES, &forces);
        })
    }

    fn show(&self) -> Routine {
        self.routine("show", 1, |recorder, extraction, state| {
            let noise = noise(recorder);
            let shown = model::show(extraction, state, &noise);
            outputs(recorder, &What::Plant.outputs()[..6], &shown);
        })
    }

    fn loop_at_once(&self) -> Routine {
        self.routine("compute", 1, |recorder, extraction, state| {
            let (command, factors, time_s) = begin_loop(recorder, extraction, state);
            let (period, _) = extraction.move_once(state, &command, &factors, time_s);
            end_loop(recorder, state, &period);
        })
    }

    fn loop_begins(&self) -> Routine {
        self.routine("begin", 1, |recorder, extraction, state| {
            let (command, factors, time_s) = begin_loop(recorder, extraction, state);
            hand_over(recorder, &command, &factors, time_s);
        })
    }

    fn loop_ends(&self) -> Routine {
        self.routine("end", 1, |recorder, extraction, state| {
            let sum = Period::<f64>::none().map(&mut of(recorder, "sum"));
            Expr::section("means over the period");
            end_loop(recorder, state, &sum.mean(extraction.step_share()));
        })
    }
}

const FORCES: [&str; 2] = ["applied_force_n", "joint_force_n"];

fn inputs(recorder: &mut Recorder, what: What) -> [Expr; 3] {
    let names: [&str; 3] = what.inputs().try_into().expect("three inputs");
    names.map(|name| recorder.input(format!("input/{name}")))
}

fn outputs(recorder: &mut Recorder, names: &[&str], numbers: &[Expr]) {
    for (name, &number) in names.iter().zip(numbers) {
        recorder.output(format!("output/{name}"), number);
    }
}

fn noise(recorder: &mut Recorder) -> Noise<Expr> {
    Noise {
        position: recorder.input("signal/noise.position"),
        force: recorder.input("signal/noise.force"),
    }
}

/// Takes the numbers of a structure from signals.
fn of<R>(recorder: &mut Recorder, group: &str) -> impl FnMut(Name<'_>, R) -> Expr {
    move |name, _| recorder.input(format!("signal/{group}.{name}"))
}

/// Gives the numbers of a structure to signals.
fn to(recorder: &mut Recorder, group: &str) -> impl FnMut(Name<'_>, Expr) {
    move |name, number| recorder.output(format!("signal/{group}.{name}"), number)
}

/// Gives what the integration steps need to signals.
fn hand_over(
    recorder: &mut Recorder,
    command: &Command<Expr>,
    factors: &Factors<Expr>,
    time_s: Expr,
) {
    recorder.output("signal/time_s", time_s);
    command.map(&mut to(recorder, "command"));
    recorder.output("signal/factor.joint_force", factors.joint_force);
    recorder.output("signal/factor.friction_level", factors.friction_level);
    Period::<Expr>::none().map(&mut to(recorder, "sum"));
}

fn begin_loop(
    recorder: &mut Recorder,
    extraction: &Extraction<Expr>,
    state: &mut ExtractionState<Expr>,
) -> (Command<Expr>, Factors<Expr>, Expr) {
    let draws = Draws { disturbance: recorder.input("signal/draw"), noise: noise(recorder) };
    let (command, factors, time_s, [reference_m, stop_reason]) =
        model::begin_loop(extraction, state, draws);
    let Command { force_n, feed_m_per_s, stack_share } = command;
    let numbers = [reference_m, force_n, feed_m_per_s, stack_share, stop_reason];
    outputs(recorder, &What::Loop.outputs()[..5], &numbers);
    (command, factors, time_s)
}

fn end_loop(recorder: &mut Recorder, state: &mut ExtractionState<Expr>, period: &Period<Expr>) {
    let [applied_force_n, joint_force_n] = model::end(state, period);
    let plant = &state.plant;
    let numbers =
        [plant.position_m, plant.velocity_m_per_s, plant.bristle_m, applied_force_n, joint_force_n];
    outputs(recorder, &What::Loop.outputs()[5..], &numbers);
}
