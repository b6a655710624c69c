//! Names in C.

use std::collections::{BTreeMap, BTreeSet};

use crate::graph::{Bits, Graph, Node, NodeId};
use crate::routine::Slot;

/// A path as one C identifier: dots become underscores.
///
/// # Example
/// ```
/// use breakaway_export::c::names::joined;
/// assert_eq!(joined("controller.gains.kp_n_per_m"), "controller_gains_kp_n_per_m");
/// ```
#[must_use]
pub fn joined(path: &str) -> String {
    path.replace('.', "_")
}

/// The names of parameters in C, by their paths.
#[derive(Clone, Debug, Default)]
pub struct ParameterNames(BTreeMap<String, String>);

impl ParameterNames {
    /// Joined paths; where two come to the same, the deeper one is told by its last field first.
    ///
    /// # Example
    /// ```
    /// use breakaway_export::c::names::ParameterNames;
    /// let names = ParameterNames::of(["a.b_c", "a.b.c", "a.d"]);
    /// assert_eq!([names.get("a.b_c"), names.get("a.b.c")], ["a_b_c", "c_of_a_b"]);
    /// ```
    pub fn of<'a>(paths: impl IntoIterator<Item = &'a str>) -> Self {
        let mut by_name: BTreeMap<String, Vec<&str>> = BTreeMap::new();
        for path in paths {
            by_name.entry(joined(path)).or_default().push(path);
        }
        let mut names = BTreeMap::new();
        for (name, mut paths) in by_name {
            paths.sort_by_key(|path| path.matches('.').count());
            names.insert(paths[0].to_string(), name);
            for path in &paths[1..] {
                let (rest, last) = path.rsplit_once('.').expect("the deeper has a parent");
                names.insert((*path).to_string(), format!("{last}_of_{}", joined(rest)));
            }
        }
        Self(names)
    }

    /// The name of one of them.
    ///
    /// # Panics
    /// If it is none of them.
    #[must_use]
    pub fn get(&self, path: &str) -> &str {
        &self.0[path]
    }
}

/// The name of a state in C: its path without `controller` or `sampling`, which say nothing there.
///
/// # Example
/// ```
/// use breakaway_export::c::names::state;
/// assert_eq!(state("controller.pid.integral_n"), "pid_integral_n");
/// assert_eq!(state("plant.position_m"), "plant_position_m");
/// ```
#[must_use]
pub fn state(path: &str) -> String {
    let within = |first: &str| path.strip_prefix(first).map(joined);
    within("controller.").or_else(|| within("sampling.")).unwrap_or_else(|| joined(path))
}

/// Names that are taken, and how others are made unlike them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Taken(BTreeSet<String>);

/// What means something else in C99, its headers that are included, or in the generated functions.
const RESERVED: [&str; 30] = [
    "auto", "break", "case", "char", "const", "continue", "default", "do", "else", "enum",
    "extern", "for", "if", "inline", "int", "long", "register", "return", "short", "signed",
    "static", "switch", "union", "void", "volatile", "while", "p", "d", "s", "w",
];

impl Taken {
    pub(crate) fn new() -> Self {
        let more = ["in", "out", "exp", "log", "gamma", "y0", "y1", "yn", "j0", "j1", "jn"];
        Self(RESERVED.into_iter().chain(more).map(String::from).collect())
    }

    /// The name, or the name with a number where it is taken; it is taken from now on.
    pub(crate) fn unlike(&mut self, name: &str) -> String {
        if self.0.insert(name.to_string()) { name.to_string() } else { self.numbered(name, 2) }
    }

    /// The name with the first number that makes it unlike all others.
    pub(crate) fn numbered(&mut self, name: &str, first: usize) -> String {
        let mut names = (first..).map(|n| format!("{name}_{n}"));
        let free = names.find(|name| !self.0.contains(name)).expect("numbers do not run out");
        self.0.insert(free.clone());
        free
    }
}

/// The longest name that is made of what a number is computed from.
const LONGEST: usize = 40;

/// Names a node: as it was named, by what it is computed from, or by its section and a number.
pub(crate) fn called(
    graph: &Graph,
    id: NodeId,
    names: &[Option<String>],
    taken: &mut Taken,
) -> String {
    let label = graph.labels()[id.index()];
    if let Some(name) = label.name {
        return taken.unlike(name);
    }
    if let Some(name) = description(graph, id, names, 0).filter(|text| text.len() <= LONGEST) {
        return taken.unlike(&name);
    }
    let section = label.section.unwrap_or("step");
    let title = section.split(':').next().unwrap_or(section);
    let word = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let title: String = title.chars().map(word).collect();
    let words: Vec<_> = title.split('_').filter(|word| !word.is_empty()).collect();
    taken.numbered(&words.join("_"), 1)
}

fn description(
    graph: &Graph,
    id: NodeId,
    names: &[Option<String>],
    depth: usize,
) -> Option<String> {
    if let (Some(name), true) = (&names[id.index()], depth > 0) {
        return Some(name.clone());
    }
    let of = |id: NodeId| description(graph, id, names, depth + 1);
    let both = |a: NodeId, word: &str, b: NodeId| Some(format!("{}_{word}_{}", of(a)?, of(b)?));
    match graph.nodes()[id.index()] {
        Node::Input(n) => {
            let slot = Slot::parse(&graph.inputs()[n as usize]);
            let is_place = |part: &str| part.starts_with(|c: char| c.is_ascii_digit());
            let parts: Vec<_> = slot.name().split('.').collect();
            let last = parts.iter().rposition(|part| !is_place(part))?;
            Some(parts[last..].join("_"))
        }
        Node::Constant(bits) => whole(bits.value()),
        _ if depth > 1 => None,
        Node::Add(a, b) => both(a, "plus", b),
        Node::Sub(a, b) => both(a, "minus", b),
        Node::Mul(a, b) if a == b => Some(format!("{}_squared", of(a)?)),
        Node::Mul(a, b) => both(a, "times", b),
        Node::Div(a, b) => both(a, "over", b),
        Node::Neg(a) => Some(format!("minus_{}", of(a)?)),
        Node::Abs(a) => Some(format!("magnitude_of_{}", of(a)?)),
        Node::Lt(a, b) if is_half(graph, a) => Some(format!("{}_is_set", of(b)?)),
        Node::Lt(a, b) => both(a, "below", b),
        Node::Le(a, b) => both(a, "at_most", b),
        Node::And(a, b) => both(a, "and", b),
        Node::Or(a, b) => both(a, "or", b),
        Node::Not(a) => Some(format!("not_{}", of(a)?)),
        _ => None,
    }
}

/// What a flag is compared with.
fn is_half(graph: &Graph, id: NodeId) -> bool {
    graph.nodes()[id.index()] == Node::Constant(Bits::of(0.5))
}

/// Small constants have names.
fn whole(value: f64) -> Option<String> {
    let words = [(0.0, "zero"), (0.5, "half"), (1.0, "one"), (2.0, "two"), (3.0, "three")];
    words.iter().find(|(known, _)| *known == value).map(|(_, word)| (*word).to_string())
}
