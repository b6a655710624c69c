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
    inputs: Vec<String>,
    outputs: Vec<(String, NodeId)>,
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

    /// The outputs for these inputs, by the core's own operations on `f64` and in the recorded
    /// order: bit for bit what the recorded code gives for `f64`.
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
    /// assert_eq!(graph.evaluate(&[0.3])[0].to_bits(), Real::exp(0.3_f64).to_bits());
    /// ```
    #[must_use]
    pub fn evaluate(&self, inputs: &[f64]) -> Vec<f64> {
        let (given, needed) = (inputs.len(), self.inputs.len());
        assert!(given == needed, "the graph has {needed} inputs, but {given} values were given");
        let mut values = Vec::with_capacity(self.nodes.len());
        for &node in &self.nodes {
            values.push(node.value(inputs, &values));
        }
        self.outputs.iter().map(|(_, id)| values[id.index()]).collect()
    }
}

impl Node {
    /// The node's value, given the values of all nodes before it.
    fn value(self, inputs: &[f64], values: &[f64]) -> f64 {
        let of = |id: NodeId| values[id.index()];
        let holds = |id: NodeId| of(id).is_set();
        match self {
            Self::Input(n) => inputs[n as usize],
            Self::Constant(bits) => bits.value(),
            Self::Add(a, b) => of(a) + of(b),
            Self::Sub(a, b) => of(a) - of(b),
            Self::Mul(a, b) => of(a) * of(b),
            Self::Div(a, b) => of(a) / of(b),
            Self::Neg(a) => -of(a),
            Self::MulAdd(a, b, c) => Real::mul_add(of(a), of(b), of(c)),
            Self::Abs(a) => Real::abs(of(a)),
            Self::Exp2Fraction(a) => of(a).exp2_parts().0,
            Self::Exp2Power(a) => of(a).exp2_parts().1,
            Self::Lt(a, b) => Real::flag(Real::lt(of(a), of(b))),
            Self::Le(a, b) => Real::flag(Real::le(of(a), of(b))),
            Self::And(a, b) => Real::flag(holds(a) & holds(b)),
            Self::Or(a, b) => Real::flag(holds(a) | holds(b)),
            Self::Not(a) => Real::flag(!holds(a)),
            Self::Select(mask, yes, no) => Real::select(holds(mask), of(yes), of(no)),
        }
    }
}

/// A graph under construction: finds the node that an operation already has.
#[derive(Debug, Default)]
pub(crate) struct Builder {
    graph: Graph,
    ids: HashMap<Node, NodeId>,
}

impl Builder {
    /// The node of this operation, new or known.
    pub(crate) fn node(&mut self, node: Node) -> NodeId {
        let nodes = &mut self.graph.nodes;
        *self.ids.entry(node).or_insert_with(|| {
            let id = u32::try_from(nodes.len()).expect("fewer than 2^32 nodes");
            nodes.push(node);
            NodeId(id)
        })
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

    pub(crate) fn output(&mut self, name: String, id: NodeId) {
        let taken = self.graph.outputs.iter().any(|(taken, _)| *taken == name);
        assert!(!taken, "two outputs are named {name:?}");
        self.graph.outputs.push((name, id));
    }

    pub(crate) fn finish(self) -> Graph {
        self.graph
    }
}
