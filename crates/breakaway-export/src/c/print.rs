//! Function bodies in C.

use std::fmt::Write;

use crate::c::names::{ParameterNames, Taken, called, joined, state};
use crate::c::{Precision, Used};
use crate::graph::{Graph, Node, NodeId};
use crate::routine::Slot;

/// The longest expression that is written inline.
const INLINE: usize = 66;

/// A function body, and what it uses.
#[derive(Clone, Debug)]
pub struct Body {
    /// Statements, indented by four spaces.
    pub text: String,
    /// Which structures and helpers they use.
    pub used: Used,
}

/// Names of members of structures in C.
#[derive(Clone, Debug, Default)]
pub(crate) struct Members {
    /// Of the parameters.
    pub(crate) parameters: ParameterNames,
    /// Of the derived numbers, by their place.
    pub(crate) derived: Vec<String>,
}

/// Prints a routine.
pub(crate) fn body(graph: &Graph, precision: Precision, prefix: &str, names: &Members) -> Body {
    let mut printer = Printer::new(graph, precision, prefix, names);
    printer.reads();
    printer.computes();
    printer.writes();
    Body { text: printer.text, used: printer.used }
}

/// Prints a function of numbers: its inputs are its arguments, and it ends by returning its output.
pub(crate) fn function_body(graph: &Graph, precision: Precision, prefix: &str, real: &str) -> Body {
    let none = Members::default();
    let mut printer = Printer::new(graph, precision, prefix, &none);
    printer.real = real.into();
    for (i, node) in graph.nodes().iter().enumerate() {
        if let Node::Input(n) = node {
            let name = Slot::parse(&graph.inputs()[*n as usize]).name().to_string();
            let name = printer.taken.unlike(&name);
            (printer.texts[i], printer.names[i]) = (name.clone(), Some(name));
        }
    }
    printer.computes();
    let (_, result) = &graph.outputs()[0];
    _ = writeln!(printer.text, "    return {};", bare(&printer.texts[result.index()]));
    Body { text: printer.text, used: printer.used }
}

/// What a derived number is, as a formula for a comment.
pub(crate) fn formula(graph: &Graph, precision: Precision, id: NodeId) -> String {
    let none = Members::default();
    let mut printer = Printer::new(graph, precision, "", &none);
    for i in 0..=id.index() {
        let of = NodeId::at(i);
        let text = match graph.nodes()[i] {
            Node::Input(n) => Slot::parse(&graph.inputs()[n as usize]).name().to_string(),
            node => printer.expression(node),
        };
        printer.texts[of.index()] = text;
    }
    let text = printer.texts[id.index()].clone();
    text.replace("(real)", "")
}

struct Printer<'a> {
    graph: &'a Graph,
    precision: Precision,
    prefix: &'a str,
    /// The name of the real type.
    real: String,
    members: &'a Members,
    uses: Vec<usize>,
    /// What stands for each node: a local name, or an expression.
    texts: Vec<String>,
    /// Local names.
    names: Vec<Option<String>>,
    taken: Taken,
    used: Used,
    text: String,
}

impl<'a> Printer<'a> {
    fn new(graph: &'a Graph, precision: Precision, prefix: &'a str, members: &'a Members) -> Self {
        let mut uses = vec![0; graph.nodes().len()];
        for node in graph.nodes() {
            node.operands().for_each(|id| uses[id.index()] += 1);
        }
        graph.outputs().iter().for_each(|(_, id)| uses[id.index()] += 1);
        Self {
            graph,
            precision,
            prefix,
            real: format!("{prefix}_real"),
            members,
            uses,
            texts: vec![String::new(); graph.nodes().len()],
            names: vec![None; graph.nodes().len()],
            taken: Taken::new(),
            used: Used::default(),
            text: String::new(),
        }
    }

    /// Copies states, signals and inputs: what is written at the end may be one of them.
    fn reads(&mut self) {
        for (i, node) in self.graph.nodes().iter().enumerate() {
            let Node::Input(n) = node else { continue };
            let slot = Slot::parse(&self.graph.inputs()[*n as usize]);
            let place = self.place(&slot);
            if matches!(slot, Slot::Parameter(_) | Slot::Derived(_)) {
                self.texts[i] = place;
                self.names[i] = place_name(&self.texts[i]);
                continue;
            }
            let name = match &slot {
                Slot::State(path) => state(path),
                other => joined(other.name()),
            };
            let name = self.taken.unlike(&name);
            let real = &self.real;
            _ = writeln!(self.text, "    const {real} {name} = {place};");
            (self.texts[i], self.names[i]) = (name.clone(), Some(name));
        }
    }

    /// Statements for what is shared, named or long; everything else is inline.
    fn computes(&mut self) {
        let mut section = None;
        for (i, (&node, label)) in self.graph.nodes().iter().zip(self.graph.labels()).enumerate() {
            if matches!(node, Node::Input(_)) {
                continue;
            }
            let text = self.expression(node);
            let leaf = matches!(node, Node::Constant(_));
            let stated = !leaf && (self.uses[i] > 1 || label.name.is_some() || text.len() > INLINE);
            if !stated {
                self.texts[i] = text;
                continue;
            }
            if label.section != section {
                section = label.section;
                if let Some(title) = section {
                    self.heading(title);
                }
            }
            let name = called(self.graph, NodeId::at(i), &self.names, &mut self.taken);
            let kind = if node.is_condition() { "bool".into() } else { self.real.clone() };
            _ = writeln!(self.text, "    const {kind} {name} = {};", bare(&text));
            (self.texts[i], self.names[i]) = (name.clone(), Some(name));
        }
    }

    fn writes(&mut self) {
        if !self.text.is_empty() {
            self.heading("results");
        }
        for (name, id) in self.graph.outputs() {
            let place = self.place(&Slot::parse(name));
            _ = writeln!(self.text, "    {place} = {};", bare(&self.texts[id.index()]));
        }
    }

    fn heading(&mut self, title: &str) {
        let gap = if self.text.is_empty() { "" } else { "\n" };
        _ = writeln!(self.text, "{gap}    /* {title} */");
    }

    fn place(&mut self, slot: &Slot) -> String {
        match slot {
            Slot::Parameter(path) => {
                self.used.parameters = true;
                format!("p->{}", self.members.parameters.get(path))
            }
            Slot::Derived(number) => {
                self.used.derived = true;
                let number: usize = number.parse().expect("the number of a derived number");
                format!("d->{}", self.members.derived[number])
            }
            Slot::State(path) => {
                self.used.state = true;
                format!("s->{}", state(path))
            }
            Slot::Input(name) => {
                self.used.input = true;
                format!("in->{name}")
            }
            Slot::Signal(name) => {
                self.used.signals = true;
                format!("w->{}", joined(name))
            }
            Slot::Output(name) => {
                self.used.output = true;
                format!("out->{name}")
            }
        }
    }

    /// The C of an operation, in parentheses where it is not a call or a name.
    fn expression(&mut self, node: Node) -> String {
        let prefix = self.prefix;
        let suffix = self.precision.suffix();
        let t = |id: NodeId| self.texts[id.index()].as_str();
        match node {
            Node::Input(_) => unreachable!("inputs are places"),
            Node::Constant(bits) => self.precision.literal(bits.value()),
            Node::Add(a, b) => format!("({} + {})", t(a), t(b)),
            Node::Sub(a, b) => format!("({} - {})", t(a), t(b)),
            Node::Mul(a, b) => format!("({} * {})", t(a), t(b)),
            Node::Div(a, b) => format!("({} / {})", t(a), t(b)),
            Node::Neg(a) => format!("(-{})", t(a)),
            Node::MulAdd(a, b, c) => {
                format!("fma{suffix}({}, {}, {})", bare(t(a)), bare(t(b)), bare(t(c)))
            }
            Node::Abs(a) => format!("fabs{suffix}({})", bare(t(a))),
            Node::Round(a) => {
                let text = format!("{prefix}_round({})", bare(t(a)));
                self.used.round = true;
                text
            }
            Node::Exp2Fraction(a) => {
                let text = format!("{prefix}_exp2_fraction({})", bare(t(a)));
                self.used.exp2 = true;
                text
            }
            Node::Exp2Power(a) => {
                let text = format!("{prefix}_exp2_power({})", bare(t(a)));
                self.used.exp2 = true;
                text
            }
            Node::Lt(a, b) => format!("({} < {})", t(a), t(b)),
            Node::Le(a, b) => format!("({} <= {})", t(a), t(b)),
            Node::And(a, b) => format!("({} && {})", t(a), t(b)),
            Node::Or(a, b) => format!("({} || {})", t(a), t(b)),
            Node::Not(a) => format!("(!{})", t(a)),
            Node::Select(mask, yes, no) => format!("({} ? {} : {})", t(mask), t(yes), t(no)),
        }
    }
}

/// An expression without the parentheses around it.
fn bare(text: &str) -> &str {
    let inner = text.strip_prefix('(').and_then(|text| text.strip_suffix(')'));
    inner.filter(|inner| balanced(inner)).unwrap_or(text)
}

/// Whether every parenthesis closes one that was opened within.
fn balanced(text: &str) -> bool {
    let mut open = 0_i32;
    for c in text.chars() {
        open += i32::from(c == '(') - i32::from(c == ')');
        if open < 0 {
            return false;
        }
    }
    open == 0
}

/// The last part of a place, for names that are made of it.
fn place_name(place: &str) -> Option<String> {
    let member = place.rsplit("->").next()?;
    (place.starts_with("d->")).then(|| member.to_string())
}
