//! What a program is made of: routines, where their numbers are kept, and the numbers' first values.

use breakaway_batch::paths::numbered;
use breakaway_core::{Extraction, ExtractionState};

use crate::graph::Graph;

/// Where a number of a routine is kept. Written as `kind/name` where a graph names its inputs and
/// outputs.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Slot {
    /// A parameter, by its path in the extraction.
    Parameter(String),
    /// What follows from parameters alone.
    Derived(String),
    /// A state, by its path in the extraction's state.
    State(String),
    /// An input of a step.
    Input(String),
    /// A number that one routine hands to another, or a draw.
    Signal(String),
    /// An output of a step.
    Output(String),
}

impl Slot {
    /// Reads `kind/name`.
    ///
    /// # Panics
    /// If it is none.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        let (kind, name) = text.split_once('/').expect("kind/name");
        let name = name.to_string();
        match kind {
            "parameter" => Self::Parameter(name),
            "derived" => Self::Derived(name),
            "state" => Self::State(name),
            "input" => Self::Input(name),
            "signal" => Self::Signal(name),
            "output" => Self::Output(name),
            _ => panic!("{kind} is no kind of slot"),
        }
    }

    /// Its name without its kind.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Parameter(name)
            | Self::Derived(name)
            | Self::State(name)
            | Self::Input(name)
            | Self::Signal(name)
            | Self::Output(name) => name,
        }
    }
}

/// A stretch of a step.
#[derive(Clone, Debug)]
pub struct Routine {
    /// Its name, such as `move`.
    pub name: &'static str,
    /// What it does.
    pub graph: Graph,
    /// How many times in a row it is computed in a step.
    pub times: u32,
}

/// A number with what it is at first: a parameter's default, or a state's value after a reset.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// Its path.
    pub path: String,
    /// In double precision, as the scenario has it.
    pub value: f64,
}

/// Every number of an extraction; the elements of an array are numbered from 0.
#[must_use]
pub fn parameters(extraction: &Extraction<f64>) -> Vec<Value> {
    let (mut paths, mut values) = (Vec::new(), Vec::new());
    extraction.map(&mut |name, value| {
        paths.push(name.to_string());
        values.push(value);
        value
    });
    told(paths, values)
}

/// Every number of a state at rest, named likewise.
#[must_use]
pub fn states() -> Vec<Value> {
    let (mut paths, mut values) = (Vec::new(), Vec::new());
    ExtractionState::at_rest().map(&mut |name, value| {
        paths.push(name.to_string());
        values.push(value);
    });
    told(paths, values)
}

fn told(paths: Vec<String>, values: Vec<f64>) -> Vec<Value> {
    numbered(paths).into_iter().zip(values).map(|(path, value)| Value { path, value }).collect()
}
