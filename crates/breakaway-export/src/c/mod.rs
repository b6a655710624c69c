//! C99 from a recorded step: numbers, names and function bodies. What stands around them (header,
//! checks, documents) is composed in Python, where units and ranges are known.

pub mod names;
mod print;

use breakaway_batch::{draws, normal};
use breakaway_core::exp2::{exp2_parts_in_double, exp2_parts_in_single};
use breakaway_core::{Extraction, Real};

pub use print::Body;

use crate::c::names::{ParameterNames, Taken, called};
use crate::c::print::Members;
use crate::expr::{Expr, record};
use crate::graph::Graph;
use crate::model::What;
use crate::passes::simplify;
use crate::program::Program;

/// The real type of the C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// `float`.
    Single,
    /// `double`.
    Double,
}

impl Precision {
    /// The type in C.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "float",
            Self::Double => "double",
        }
    }

    /// What the names of `math.h` end with.
    #[must_use]
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Single => "f",
            Self::Double => "",
        }
    }

    /// A constant: the fewest digits that are read back as the same number.
    ///
    /// # Example
    /// ```
    /// use breakaway_export::c::Precision;
    /// assert_eq!(Precision::Single.literal(0.1), "0.1f");
    /// assert_eq!(Precision::Double.literal(-2.0), "(-2.0)");
    /// ```
    #[must_use]
    pub fn literal(self, value: f64) -> String {
        let narrow = value as f32;
        let finite = match self {
            Self::Single => narrow.is_finite(),
            Self::Double => value.is_finite(),
        };
        let text = match self {
            _ if value.is_nan() => return format!("(({})NAN)", self.name()),
            _ if !finite => format!("(({})INFINITY)", self.name()),
            Self::Single => format!("{:?}f", narrow.abs()),
            Self::Double => format!("{:?}", value.abs()),
        };
        if value.is_sign_negative() { format!("(-{text})") } else { text }
    }

    /// A part of an extraction, recorded for this type.
    #[must_use]
    pub fn program(self, what: What, extraction: &Extraction<f64>) -> Program {
        match self {
            Self::Single => Program::of::<f32>(what, extraction),
            Self::Double => Program::of::<f64>(what, extraction),
        }
    }

    fn simplify(self, graph: &Graph) -> Graph {
        match self {
            Self::Single => simplify::<f32>(graph),
            Self::Double => simplify::<f64>(graph),
        }
    }
}

/// Which structures and helpers a function uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Used {
    /// Parameters, `p`.
    pub parameters: bool,
    /// Derived numbers, `d`.
    pub derived: bool,
    /// States, `s`.
    pub state: bool,
    /// Inputs, `in`.
    pub input: bool,
    /// Signals, `w`.
    pub signals: bool,
    /// Outputs, `out`.
    pub output: bool,
    /// The powers of two.
    pub exp2: bool,
    /// Rounding to a whole number.
    pub round: bool,
}

/// A derived number in C.
#[derive(Clone, Debug)]
pub struct DerivedNumber {
    /// Its name.
    pub name: String,
    /// What it is.
    pub formula: String,
}

/// The C of a program.
#[derive(Clone, Debug)]
pub struct Code {
    /// Names of the parameters.
    pub parameters: ParameterNames,
    /// Members of the structure of derived numbers.
    pub derived: Vec<DerivedNumber>,
    /// Computes them.
    pub derive: Body,
    /// The routines: name, how many times in a row, body.
    pub routines: Vec<(&'static str, u32, Body)>,
}

/// Prints a program.
#[must_use]
pub fn code(program: &Program, precision: Precision) -> Code {
    let prefix = program.what.prefix();
    let graph = &program.derivation.graph;
    let mut taken = Taken::new();
    let none = vec![None; graph.nodes().len()];
    let derived: Vec<DerivedNumber> = graph
        .outputs()
        .iter()
        .map(|(_, id)| DerivedNumber {
            name: called(graph, *id, &none, &mut taken),
            formula: print::formula(graph, precision, *id),
        })
        .collect();
    let members = Members {
        parameters: ParameterNames::of(program.parameters.iter().map(|one| one.path.as_str())),
        derived: derived.iter().map(|one| one.name.clone()).collect(),
    };
    let body = |graph: &Graph| print::body(graph, precision, prefix, &members);
    Code {
        derive: body(graph),
        routines: program
            .routines
            .iter()
            .map(|routine| (routine.name, routine.times, body(&routine.graph)))
            .collect(),
        derived,
        parameters: members.parameters,
    }
}

/// The bodies of the two parts of 2ʸ: the fraction, and the number whose lowest bits become the exponent
/// of the power. Their argument is `y`; the power's is left in `power.number`.
#[must_use]
pub fn exp2_bodies(precision: Precision, prefix: &str) -> [Body; 2] {
    let real = format!("{prefix}_real");
    exp2_parts(precision).map(|graph| print::function_body(&graph, precision, prefix, &real))
}

fn exp2_parts(precision: Precision) -> [Graph; 2] {
    [true, false].map(|fraction| {
        let graph = record(|recorder| {
            let y = recorder.input("signal/y");
            let (f, power) = match precision {
                Precision::Single => exp2_parts_in_single(y, |n: Expr| n),
                Precision::Double => exp2_parts_in_double(y, |n: Expr| n),
            };
            recorder.output("output/result", if fraction { f } else { power });
        });
        precision.simplify(&graph)
    })
}

/// 1.5·2⁵² or 1.5·2²³, which rounds.
#[must_use]
pub fn round_constant(precision: Precision) -> String {
    precision.literal(match precision {
        Precision::Single => <f32 as Real>::ROUND,
        Precision::Double => <f64 as Real>::ROUND,
    })
}

/// Bodies of what random draws compute with numbers, in `double`, recorded from the core's own: each
/// by its name, with the names of its arguments.
#[must_use]
pub fn draw_bodies(prefix: &str) -> Vec<(&'static str, Vec<&'static str>, Body)> {
    let stem = format!("{prefix}_draw");
    let function = |name, arguments: Vec<&'static str>, of: fn(&[Expr]) -> Expr| {
        let graph = record(|recorder| {
            let numbers: Vec<_> =
                arguments.iter().map(|name| recorder.input(format!("signal/{name}"))).collect();
            recorder.output("output/result", of(&numbers));
        });
        let graph = simplify::<f64>(&graph);
        (name, arguments, print::function_body(&graph, Precision::Double, &stem, "double"))
    };
    let [fraction, power] = exp2_parts(Precision::Double);
    let exp2 = |name, graph| {
        (name, vec!["y"], print::function_body(&graph, Precision::Double, &stem, "double"))
    };
    vec![
        function("ln_of_parts", vec!["m", "k"], |x| normal::ln_of_parts(x[0], x[1])),
        function("quantile_middle", vec!["q"], |x| normal::quantile_middle(x[0])),
        function("quantile_tail", vec!["r"], |x| normal::quantile_tail(x[0])),
        exp2("exp2_fraction", fraction),
        exp2("exp2_power", power),
        function("kept", vec!["bandwidth_hz", "hold_s"], |x| draws::kept(x[0], x[1])),
    ]
}
