//! A recorded step as code has it: parameters, states, and routines that are computed in turn.

use std::collections::{BTreeSet, HashMap};

use breakaway_core::Extraction;

use crate::derive::{Derivation, derive};
use crate::graph::{Graph, Node, NodeId};
use crate::model::What;
use crate::passes::{Scalar, needed, simplify_knowing};
use crate::record_model::record_model;
use crate::routine::{Routine, Slot, Value, parameters, states};

/// The recorded step of a controller, a plant or a loop.
#[derive(Clone, Debug)]
pub struct Program {
    /// What it is.
    pub what: What,
    /// Parameters that it needs, in the order of the extraction.
    pub parameters: Vec<Value>,
    /// States that it needs, in the order of the extraction's.
    pub states: Vec<Value>,
    /// Inputs that it needs.
    pub inputs: Vec<String>,
    /// Outputs that are not constant.
    pub outputs: Vec<String>,
    /// Signals between its routines, draws included.
    pub signals: Vec<String>,
    /// What follows from parameters alone: recomputed when they change.
    pub derivation: Derivation,
    /// What a step computes.
    pub routines: Vec<Routine>,
}

/// Parameters that random draws depend on.
const OF_DRAWS: [&str; 3] =
    ["disturbance.bandwidth_hz", "disturbance.hold_s", "timing.control_period_s"];

impl Program {
    /// Records a part of an extraction, for code in numbers `R`.
    ///
    /// # Example
    /// ```
    /// use breakaway_core::test_models::paper_as_computed;
    /// use breakaway_export::{Program, What};
    /// let program = Program::of::<f64>(What::Controller, &paper_as_computed());
    /// assert_eq!(program.inputs, ["position_m", "velocity_m_per_s"]);
    /// assert_eq!(program.outputs, ["force_n", "reference_m"]);
    /// // A plain PID keeps its clock and its integral.
    /// assert_eq!(program.states.len(), 2);
    /// ```
    #[must_use]
    pub fn of<R: Scalar>(what: What, extraction: &Extraction<f64>) -> Self {
        let states = states();
        let velocity = reads_velocity::<R>(extraction, &states);
        let routines = reduce::<R>(record_model(what, extraction, velocity), &states);
        let (routines, derivation) = derive(routines);
        let read = |slot: &Slot| {
            routines
                .iter()
                .map(|routine| &routine.graph)
                .chain([&derivation.graph])
                .any(|graph| graph.inputs().iter().any(|name| Slot::parse(name) == *slot))
        };
        let written = |slot: &Slot| {
            routines.iter().any(|routine| {
                routine.graph.outputs().iter().any(|(name, _)| Slot::parse(name) == *slot)
            })
        };
        let draws = read(&Slot::Signal("draw".into()));
        let given = |names: &[&str], keep: &dyn Fn(&str) -> bool| {
            names.iter().filter(|name| keep(name)).map(ToString::to_string).collect::<Vec<_>>()
        };
        Self {
            what,
            parameters: kept(parameters(extraction), |path| {
                read(&Slot::Parameter(path.into())) || (draws && OF_DRAWS.contains(&path))
            }),
            states: kept(states, |path| read(&Slot::State(path.into()))),
            inputs: given(what.inputs(), &|name| read(&Slot::Input(name.into()))),
            outputs: given(what.outputs(), &|name| written(&Slot::Output(name.into()))),
            signals: signals(&routines),
            derivation,
            routines,
        }
    }
}

/// Whether the controller needs a velocity sensor. A watch alone does not: it would only ask whether
/// the velocity is a number.
fn reads_velocity<R: Scalar>(extraction: &Extraction<f64>, states: &[Value]) -> bool {
    let unwatched = Extraction { watch: None, ..*extraction };
    let routines = reduce::<R>(record_model(What::Controller, &unwatched, true), states);
    routines
        .iter()
        .any(|routine| routine.graph.inputs().iter().any(|name| name == "input/velocity_m_per_s"))
}

fn kept(values: Vec<Value>, keep: impl Fn(&str) -> bool) -> Vec<Value> {
    values.into_iter().filter(|value| keep(&value.path)).collect()
}

fn signals(routines: &[Routine]) -> Vec<String> {
    let mut names = Vec::new();
    for routine in routines {
        for name in routine.graph.inputs() {
            if let Slot::Signal(name) = Slot::parse(name) {
                if !names.contains(&name) {
                    names.push(name);
                }
            }
        }
    }
    names
}

/// Drops what never moves, what is constant, and what is never read, over all routines together.
fn reduce<R: Scalar>(routines: Vec<Routine>, states: &[Value]) -> Vec<Routine> {
    let mut known: HashMap<String, f64> = HashMap::new();
    let mut routines = routines;
    loop {
        let live = live(&routines);
        for routine in &mut routines {
            let same = left_alone(&routine.graph);
            routine.graph = simplify_knowing::<R>(
                &routine.graph,
                |name| known.get(name).copied(),
                |name| live.contains(name) && !known.contains_key(name) && !same.contains(name),
            );
        }
        let found = constants::<R>(&routines, states);
        if found.is_empty() && self::live(&routines) == live {
            return routines;
        }
        known.extend(found);
    }
}

/// The outputs that are the input of the same name.
fn left_alone(graph: &Graph) -> BTreeSet<String> {
    let same = |(name, id): &&(String, NodeId)| match graph.nodes()[id.index()] {
        Node::Input(n) => graph.inputs()[n as usize] == *name,
        _ => false,
    };
    graph.outputs().iter().filter(same).map(|(name, _)| name.clone()).collect()
}

/// The outputs of routines that an output of the step depends on.
fn live(routines: &[Routine]) -> BTreeSet<String> {
    let mut live: BTreeSet<String> = BTreeSet::new();
    let outputs = || routines.iter().flat_map(|routine| routine.graph.outputs());
    live.extend(outputs().map(|(name, _)| name.clone()).filter(|name| name.starts_with("output/")));
    loop {
        let before = live.len();
        for Routine { graph, .. } in routines {
            let ends = graph.outputs().iter().filter(|(name, _)| live.contains(name));
            let needed = needed(graph, ends.map(|(_, id)| *id));
            for (node, needed) in graph.nodes().iter().zip(needed) {
                if let (Node::Input(n), true) = (node, needed) {
                    live.insert(graph.inputs()[*n as usize].clone());
                }
            }
        }
        if live.len() == before {
            return live;
        }
    }
}

/// States that keep what they are at first, and signals and outputs that are one constant.
fn constants<R: Scalar>(routines: &[Routine], states: &[Value]) -> HashMap<String, f64> {
    let mut values: HashMap<String, Option<f64>> = HashMap::new();
    for state in states {
        let first: f64 = R::constant(state.value).into();
        values.insert(format!("state/{}", state.path), Some(first));
    }
    for Routine { graph, .. } in routines {
        for (name, id) in graph.outputs() {
            let value = match graph.nodes()[id.index()] {
                Node::Constant(bits) => Some(bits.value()),
                _ => None,
            };
            let same = |old: &Option<f64>| old.map(f64::to_bits) == value.map(f64::to_bits);
            match values.get_mut(name) {
                Some(old) if same(old) => {}
                Some(old) => *old = None,
                None => _ = values.insert(name.clone(), value),
            }
        }
    }
    let used = |name: &String| {
        routines.iter().any(|Routine { graph, .. }| {
            graph.inputs().contains(name) || graph.outputs().iter().any(|(out, _)| out == name)
        })
    };
    let constant = values.into_iter().filter_map(|(name, value)| Some((name, value?)));
    constant.filter(|(name, _)| used(name)).collect()
}
