//! What was recorded: operations in the order they were first written down.

use std::collections::HashMap;

use breakaway_core::Real;

/// The place of a node in its [`Graph`].
///
/// # Example
/// ```
/// let graph = breakaway_export::record(|recorder| {
///     let x = recorder.input("x");
///     recorder.output("square", x * x);
/// });
/// let (name, id) = &graph.outputs()[0];
/// assert_eq!((name.as_str(), id.index()), ("square", 1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(u32);

impl NodeId {
    /// The index into [`Graph::nodes`]. Operands have smaller indices than their operation.
    ///
    /// # Example
    /// ```
    /// let graph = breakaway_export::record(|recorder| {
    ///     let x = recorder.input("x");
    ///     recorder.output("x", x);
    /// });
    /// assert_eq!(graph.outputs()[0].1.index(), 0);
    /// ```
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    pub(crate) fn at(index: usize) -> Self {
        Self(u32::try_from(index).expect("fewer than 2^32 nodes"))
    }
}

/// The bits of a constant: zeros of different sign differ, and a NaN equals itself.
///
/// # Example
/// ```
/// use breakaway_export::Bits;
/// assert_ne!(Bits::of(0.0), Bits::of(-0.0));
/// assert_eq!(Bits::of(0.1).value(), 0.1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Bits(u64);

impl Bits {
    /// The bits of `value`.
    ///
    /// # Example
    /// ```
    /// use breakaway_export::Bits;
    /// assert_eq!(Bits::of(f64::NAN), Bits::of(f64::NAN));
    /// ```
    #[must_use]
    pub fn of(value: f64) -> Self {
        Self(value.to_bits())
    }

    /// The number they stand for.
    ///
    /// # Example
    /// ```
    /// assert_eq!(breakaway_export::Bits::of(2.5).value(), 2.5);
    /// ```
    #[must_use]
    pub fn value(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// One operation. Conditions are nodes too: their value is 1 where they hold, else 0.
///
/// # Example
/// ```
/// use breakaway_core::Real;
/// use breakaway_export::{Node, record};
/// let graph = record(|recorder| {
///     let (x, y) = (recorder.input("x"), recorder.input("y"));
///     recorder.output("fused", x.mul_add(y, x));
/// });
/// assert!(matches!(graph.nodes()[2], Node::MulAdd(..)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// Input number n, named in [`Graph::inputs`].
    Input(u32),
    /// A constant.
    Constant(Bits),
    /// a + b.
    Add(NodeId, NodeId),
    /// a − b.
    Sub(NodeId, NodeId),
    /// a · b.
    Mul(NodeId, NodeId),
    /// a / b.
    Div(NodeId, NodeId),
    /// −a.
    Neg(NodeId),
    /// a · b + c with one rounding.
    MulAdd(NodeId, NodeId, NodeId),
    /// |a|.
    Abs(NodeId),
    /// The whole number nearest to a: [`Real::round`], whose constant differs between numbers.
    Round(NodeId),
    /// The fraction of 2ᵃ, first part of [`Real::exp2_parts`].
    Exp2Fraction(NodeId),
    /// The power of two of 2ᵃ, second part of [`Real::exp2_parts`].
    Exp2Power(NodeId),
    /// a < b.
    Lt(NodeId, NodeId),
    /// a ≤ b.
    Le(NodeId, NodeId),
    /// Both conditions.
    And(NodeId, NodeId),
    /// Either condition.
    Or(NodeId, NodeId),
    /// The opposite condition.
    Not(NodeId),
    /// Where the first, a condition, holds: the second; elsewhere the third.
    Select(NodeId, NodeId, NodeId),
}

/// A recorded computation: named inputs, operations in an order in which they can be computed,
/// named outputs.
///
/// Identical operations on identical operands are one node.
///
/// # Example
/// ```
/// let graph = breakaway_export::record(|recorder| {
///     let (x, y) = (recorder.input("x"), recorder.input("y"));
///     recorder.output("f", (x + y) * (x + y)); // x + y is recorded once
/// });
/// assert_eq!(graph.nodes().len(), 4);
/// assert_eq!(graph.evaluate(&[1.0, 2.0]), [9.0]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    nodes: Vec<Node>,
    labels: Vec<Label>,
    inputs: Vec<String>,
    outputs: Vec<(String, NodeId)>,
}

/// What the recorded code says of a node.
///
/// # Example
/// ```
/// use breakaway_core::Real;
/// use breakaway_export::{Expr, record};
/// let graph = record(|recorder| {
///     let (r, x) = (recorder.input("r"), recorder.input("x"));
///     Expr::section("error: e = r - x");
///     recorder.output("e", (r - x).named("error_m"));
/// });
/// let label = graph.labels()[2];
/// assert_eq!((label.name, label.section), (Some("error_m"), Some("error: e = r - x")));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Label {
    /// Its name, by [`Real::named`].
    pub name: Option<&'static str>,
    /// The title of its section, by [`Real::section`].
    pub section: Option<&'static str>,
}

impl Graph {
    /// The operations, operands first.
    ///
    /// # Example
    /// ```
    /// use breakaway_export::{Node, record};
    /// let graph = record(|recorder| {
    ///     recorder.input("unused");
    /// });
    /// assert_eq!(graph.nodes(), [Node::Input(0)]);
    /// ```
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// What is said of each operation.
    ///
    /// # Example
    /// ```
    /// let graph = breakaway_export::record(|recorder| {
    ///     recorder.input("x");
    /// });
    /// assert_eq!(graph.labels()[0].name, None);
    /// ```
    #[must_use]
    pub fn labels(&self) -> &[Label] {
        &self.labels
    }

    /// The names of the inputs, in the order in which [`Graph::evaluate`] takes them.
    ///
    /// # Example
    /// ```
    /// let graph = breakaway_export::record(|recorder| {
    ///     recorder.input("x");
    ///     recorder.input("y");
    /// });
    /// assert_eq!(graph.inputs(), ["x", "y"]);
    /// ```
    #[must_use]
    pub fn inputs(&self) -> &[String] {
        &self.inputs
    }

    /// The outputs' names and nodes, in the order in which [`Graph::evaluate`] gives them.
    ///
    /// # Example
    /// ```
    /// let graph = breakaway_export::record(|recorder| {
    ///     let x = recorder.input("x");
    ///     recorder.output("minus_x", -x);
    /// });
    /// assert_eq!(graph.outputs()[0].0, "minus_x");
    /// ```
    #[must_use]
    pub fn outputs(&self) -> &[(String, NodeId)] {
        &self.outputs
    }

    /// The outputs for these inputs, by the core's own operations on these numbers and in the recorded
    /// order: bit for bit what the recorded code gives for them.
    ///
    /// # Panics
    /// If there are not as many `inputs` as the graph has.
    ///
    /// # Example
    /// ```
    /// use breakaway_core::Real;
    /// let graph = breakaway_export::record(|recorder| {
    ///     let x = recorder.input("x");
    ///     recorder.output("exp", x.exp());
    /// });
    /// assert_eq!(graph.evaluate(&[0.3_f64])[0].to_bits(), Real::exp(0.3_f64).to_bits());
    /// assert_eq!(graph.evaluate(&[0.3_f32])[0].to_bits(), Real::exp(0.3_f32).to_bits());
    /// ```
    #[must_use]
    pub fn evaluate<R: Real>(&self, inputs: &[R]) -> Vec<R> {
        let (given, needed) = (inputs.len(), self.inputs.len());
        assert!(given == needed, "the graph has {needed} inputs, but {given} values were given");
        let mut values = Vec::with_capacity(self.nodes.len());
        for &node in &self.nodes {
            values.push(node.value(inputs, |id| values[id.index()]));
        }
        self.outputs.iter().map(|(_, id)| values[id.index()]).collect()
    }
}

impl Node {
    /// The node's value, given those of its operands.
    pub(crate) fn value<R: Real>(self, inputs: &[R], of: impl Fn(NodeId) -> R) -> R {
        let holds = |id: NodeId| of(id).is_set();
        match self {
            Self::Input(n) => inputs[n as usize],
            Self::Constant(bits) => R::constant(bits.value()),
            Self::Add(a, b) => of(a) + of(b),
            Self::Sub(a, b) => of(a) - of(b),
            Self::Mul(a, b) => of(a) * of(b),
            Self::Div(a, b) => of(a) / of(b),
            Self::Neg(a) => -of(a),
            Self::MulAdd(a, b, c) => of(a).mul_add(of(b), of(c)),
            Self::Abs(a) => of(a).abs(),
            Self::Round(a) => of(a).round(),
            Self::Exp2Fraction(a) => of(a).exp2_parts().0,
            Self::Exp2Power(a) => of(a).exp2_parts().1,
            Self::Lt(a, b) => R::flag(of(a).lt(of(b))),
            Self::Le(a, b) => R::flag(of(a).le(of(b))),
            Self::And(a, b) => R::flag(holds(a) & holds(b)),
            Self::Or(a, b) => R::flag(holds(a) | holds(b)),
            Self::Not(a) => R::flag(!holds(a)),
            Self::Select(mask, yes, no) => R::select(holds(mask), of(yes), of(no)),
        }
    }

    /// Whether it is a condition.
    pub(crate) fn is_condition(self) -> bool {
        matches!(self, Self::Lt(..) | Self::Le(..) | Self::And(..) | Self::Or(..) | Self::Not(..))
    }

    /// Its operands, in order.
    pub(crate) fn operands(self) -> impl Iterator<Item = NodeId> {
        let all = match self {
            Self::Input(_) | Self::Constant(_) => [None; 3],
            Self::Neg(a)
            | Self::Abs(a)
            | Self::Round(a)
            | Self::Exp2Fraction(a)
            | Self::Exp2Power(a)
            | Self::Not(a) => [Some(a), None, None],
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Div(a, b)
            | Self::Lt(a, b)
            | Self::Le(a, b)
            | Self::And(a, b)
            | Self::Or(a, b) => [Some(a), Some(b), None],
            Self::MulAdd(a, b, c) | Self::Select(a, b, c) => [Some(a), Some(b), Some(c)],
        };
        all.into_iter().flatten()
    }

    /// The same operation on other operands.
    pub(crate) fn on(self, of: impl Fn(NodeId) -> NodeId) -> Self {
        match self {
            Self::Input(_) | Self::Constant(_) => self,
            Self::Add(a, b) => Self::Add(of(a), of(b)),
            Self::Sub(a, b) => Self::Sub(of(a), of(b)),
            Self::Mul(a, b) => Self::Mul(of(a), of(b)),
            Self::Div(a, b) => Self::Div(of(a), of(b)),
            Self::Neg(a) => Self::Neg(of(a)),
            Self::MulAdd(a, b, c) => Self::MulAdd(of(a), of(b), of(c)),
            Self::Abs(a) => Self::Abs(of(a)),
            Self::Round(a) => Self::Round(of(a)),
            Self::Exp2Fraction(a) => Self::Exp2Fraction(of(a)),
            Self::Exp2Power(a) => Self::Exp2Power(of(a)),
            Self::Lt(a, b) => Self::Lt(of(a), of(b)),
            Self::Le(a, b) => Self::Le(of(a), of(b)),
            Self::And(a, b) => Self::And(of(a), of(b)),
            Self::Or(a, b) => Self::Or(of(a), of(b)),
            Self::Not(a) => Self::Not(of(a)),
            Self::Select(mask, yes, no) => Self::Select(of(mask), of(yes), of(no)),
        }
    }
}

/// A graph under construction: finds the node that an operation already has.
#[derive(Debug, Default)]
pub(crate) struct Builder {
    graph: Graph,
    ids: HashMap<Node, NodeId>,
    section: Option<&'static str>,
}

impl Builder {
    /// The node of this operation, new or known.
    pub(crate) fn node(&mut self, node: Node) -> NodeId {
        let Graph { nodes, labels, .. } = &mut self.graph;
        *self.ids.entry(node).or_insert_with(|| {
            let id = u32::try_from(nodes.len()).expect("fewer than 2^32 nodes");
            nodes.push(node);
            labels.push(Label { name: None, section: self.section });
            NodeId(id)
        })
    }

    /// What an operation known by its node is.
    pub(crate) fn operation(&self, id: NodeId) -> Node {
        self.graph.nodes[id.index()]
    }

    /// Names a node, unless it has a name: the first to compute it knows best what it is.
    pub(crate) fn name(&mut self, id: NodeId, name: &'static str) {
        self.graph.labels[id.index()].name.get_or_insert(name);
    }

    /// The section of the nodes that are new from now on.
    pub(crate) fn section(&mut self, title: &'static str) {
        self.section = Some(title);
    }

    /// Continues in the section of a node of another graph, and keeps its name.
    pub(crate) fn labeled(&mut self, node: Node, label: Label) -> NodeId {
        self.section = label.section;
        let id = self.node(node);
        if let Some(name) = label.name {
            self.name(id, name);
        }
        id
    }

    pub(crate) fn has_input(&self, name: &str) -> bool {
        self.graph.inputs.iter().any(|taken| taken == name)
    }

    pub(crate) fn input(&mut self, name: String) -> NodeId {
        assert!(!self.has_input(&name), "two inputs are named {name:?}");
        let index = u32::try_from(self.graph.inputs.len()).expect("fewer than 2^32 inputs");
        self.graph.inputs.push(name);
        self.node(Node::Input(index))
    }

    /// The input of this name, new or known.
    pub(crate) fn input_once(&mut self, name: &str) -> NodeId {
        match self.graph.inputs.iter().position(|taken| taken == name) {
            Some(index) => self.node(Node::Input(u32::try_from(index).expect("few inputs"))),
            None => self.input(name.into()),
        }
    }

    pub(crate) fn output(&mut self, name: String, id: NodeId) {
        let taken = self.graph.outputs.iter().any(|(taken, _)| *taken == name);
        assert!(!taken, "two outputs are named {name:?}");
        self.graph.outputs.push((name, id));
    }

    pub(crate) fn finish(self) -> Graph {
        self.graph
    }
}
