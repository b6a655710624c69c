//! Fewer operations for the same bits.
//!
//! Every rule here holds for all numbers, zeros of either sign, subnormals, infinities and NaN
//! included; which NaN it is may differ. Sums are not reordered, and x + 0 stays, since it makes +0 of
//! -0. Constants are folded in the arithmetic of the numbers that the graph is meant for.

use breakaway_core::Real;

use crate::graph::{Bits, Builder, Graph, Label, Node, NodeId};

/// Numbers whose arithmetic is known when code is made: `f32` and `f64`.
pub trait Scalar: Real<Mask = bool> + Into<f64> {}

impl Scalar for f32 {}
impl Scalar for f64 {}

/// The same computation for numbers `R`, with constants folded, what is known left out, and nothing
/// that no output needs: no dead operation, and no dead input.
///
/// # Example
/// ```
/// use breakaway_core::Real;
/// use breakaway_export::{Expr, passes::simplify, record};
/// let graph = record(|recorder| {
///     let (x, _unused) = (recorder.input("x"), recorder.input("unused"));
///     recorder.output("y", (Expr::one() - Expr::constant(0.5)) * x * Expr::one());
/// });
/// let simple = simplify::<f64>(&graph);
/// assert_eq!((simple.nodes().len(), simple.inputs().len()), (3, 1));
/// assert_eq!(simple.evaluate(&[3.0]), graph.evaluate(&[3.0, 9.0]));
/// ```
#[must_use]
pub fn simplify<R: Scalar>(graph: &Graph) -> Graph {
    simplify_knowing::<R>(graph, |_| None, |_| true)
}

/// [`simplify`] where `known` inputs are constants and only some outputs are `wanted`.
pub(crate) fn simplify_knowing<R: Scalar>(
    graph: &Graph,
    known: impl Fn(&str) -> Option<f64>,
    wanted: impl Fn(&str) -> bool,
) -> Graph {
    let once = rewrite::<R>(graph, known, wanted);
    rewrite::<R>(&once, |_| None, |_| true) // drops what the first time made superfluous
}

fn rewrite<R: Scalar>(
    graph: &Graph,
    known: impl Fn(&str) -> Option<f64>,
    wanted: impl Fn(&str) -> bool,
) -> Graph {
    let outputs: Vec<_> = graph.outputs().iter().filter(|(name, _)| wanted(name)).collect();
    let needed = needed(graph, outputs.iter().map(|(_, id)| *id));
    let mut builder = Builder::default();
    let mut new: Vec<Option<NodeId>> = vec![None; graph.nodes().len()];
    for (i, (&node, &label)) in graph.nodes().iter().zip(graph.labels()).enumerate() {
        if !needed[i] {
            continue;
        }
        new[i] = Some(match node {
            Node::Input(n) => {
                let name = &graph.inputs()[n as usize];
                match known(name) {
                    Some(value) => constant::<R>(&mut builder, value),
                    None => builder.input(name.clone()),
                }
            }
            Node::Constant(bits) => constant::<R>(&mut builder, bits.value()),
            _ => {
                let node = node.on(|id| new[id.index()].expect("operands come first"));
                reduced::<R>(&mut builder, node, label)
            }
        });
    }
    for (name, id) in outputs {
        builder.output(name.clone(), new[id.index()].expect("outputs are needed"));
    }
    builder.finish()
}

/// The same graph without nodes and inputs that no output needs.
pub(crate) fn without_dead(graph: &Graph) -> Graph {
    let needed = needed(graph, graph.outputs().iter().map(|(_, id)| *id));
    let mut builder = Builder::default();
    let mut new: Vec<Option<NodeId>> = vec![None; graph.nodes().len()];
    for (i, (&node, &label)) in graph.nodes().iter().zip(graph.labels()).enumerate() {
        if needed[i] {
            new[i] = Some(match node {
                Node::Input(n) => builder.input(graph.inputs()[n as usize].clone()),
                _ => builder
                    .labeled(node.on(|id| new[id.index()].expect("operands come first")), label),
            });
        }
    }
    for (name, id) in graph.outputs() {
        builder.output(name.clone(), new[id.index()].expect("outputs are needed"));
    }
    builder.finish()
}

/// Which nodes these outputs depend on.
pub(crate) fn needed(graph: &Graph, outputs: impl Iterator<Item = NodeId>) -> Vec<bool> {
    let mut needed = vec![false; graph.nodes().len()];
    outputs.for_each(|id| needed[id.index()] = true);
    for (i, node) in graph.nodes().iter().enumerate().rev() {
        if needed[i] {
            node.operands().for_each(|id| needed[id.index()] = true);
        }
    }
    needed
}

/// A constant, as these numbers hold it.
fn constant<R: Scalar>(builder: &mut Builder, value: f64) -> NodeId {
    builder.labeled(Node::Constant(Bits::of(R::constant(value).into())), Label::default())
}

/// The node of an operation, or of what it comes to.
fn reduced<R: Scalar>(builder: &mut Builder, node: Node, label: Label) -> NodeId {
    let mut node = node;
    loop {
        if let Some(value) = folded::<R>(builder, node) {
            return constant::<R>(builder, value);
        }
        match shorter(builder, node) {
            Shorter::Operand(id) => {
                if let Some(name) = label.name {
                    builder.name(id, name);
                }
                return id;
            }
            Shorter::Constant(value) => return constant::<R>(builder, value),
            Shorter::Operation(other) => node = other,
            Shorter::No => return builder.labeled(node, label),
        }
    }
}

/// The value of an operation on constants.
fn folded<R: Scalar>(builder: &Builder, node: Node) -> Option<f64> {
    let value = |id: NodeId| match builder.operation(id) {
        Node::Constant(bits) => Some(R::constant(bits.value())),
        _ => None,
    };
    node.operands().all(|id| value(id).is_some()).then(|| {
        let folded: R = node.value(&[], |id| value(id).expect("all operands are constants"));
        folded.into()
    })
}

/// What an operation comes to.
enum Shorter {
    /// One of its operands, or one of theirs.
    Operand(NodeId),
    /// A constant.
    Constant(f64),
    /// A simpler operation.
    Operation(Node),
    /// Nothing shorter.
    No,
}

fn shorter(builder: &Builder, node: Node) -> Shorter {
    match node {
        Node::Add(..) | Node::Sub(..) | Node::Neg(_) | Node::Abs(_) => shorter_sum(builder, node),
        Node::Mul(..) | Node::Div(..) | Node::MulAdd(..) => shorter_product(builder, node),
        Node::Lt(a, b) | Node::Le(a, b) => shorter_comparison(builder, node, a, b),
        Node::And(..) | Node::Or(..) | Node::Not(_) => shorter_condition(builder, node),
        Node::Select(mask, yes, no) => shorter_select(builder, mask, yes, no),
        _ => Shorter::No,
    }
}

/// Whether a node is this constant, to the bit.
fn is(builder: &Builder, id: NodeId, value: f64) -> bool {
    builder.operation(id) == Node::Constant(Bits::of(value))
}

fn shorter_sum(builder: &Builder, node: Node) -> Shorter {
    let negated = |id: NodeId| match builder.operation(id) {
        Node::Neg(a) => Some(a),
        _ => None,
    };
    match node {
        Node::Add(a, b) if is(builder, b, -0.0) => Shorter::Operand(a),
        Node::Add(a, b) if is(builder, a, -0.0) => Shorter::Operand(b),
        Node::Sub(a, b) if is(builder, b, 0.0) => Shorter::Operand(a),
        Node::Add(a, b) => match (negated(a), negated(b)) {
            (_, Some(b)) => Shorter::Operation(Node::Sub(a, b)),
            (Some(a), None) => Shorter::Operation(Node::Sub(b, a)),
            (None, None) => Shorter::No,
        },
        Node::Sub(a, b) => match negated(b) {
            Some(b) => Shorter::Operation(Node::Add(a, b)),
            None => Shorter::No,
        },
        Node::Neg(a) => negated(a).map_or(Shorter::No, Shorter::Operand),
        Node::Abs(a) => match (negated(a), builder.operation(a)) {
            (Some(a), _) => Shorter::Operation(Node::Abs(a)),
            (None, Node::Abs(_)) => Shorter::Operand(a),
            _ => Shorter::No,
        },
        _ => Shorter::No,
    }
}

fn shorter_product(builder: &Builder, node: Node) -> Shorter {
    let one = |id: NodeId| is(builder, id, 1.0);
    match node {
        Node::Mul(a, b) | Node::Div(a, b) if one(b) => Shorter::Operand(a),
        Node::Mul(a, b) if one(a) => Shorter::Operand(b),
        Node::MulAdd(a, b, c) if one(b) => Shorter::Operation(Node::Add(a, c)),
        Node::MulAdd(a, b, c) if one(a) => Shorter::Operation(Node::Add(b, c)),
        _ => Shorter::No,
    }
}

/// A constant compared with a choice between two: a flag that is asked whether it is set.
fn shorter_comparison(builder: &Builder, node: Node, a: NodeId, b: NodeId) -> Shorter {
    let choice = |id: NodeId| match builder.operation(id) {
        Node::Select(mask, yes, no) => Some((mask, yes, no)),
        _ => None,
    };
    let constant = |id: NodeId| match builder.operation(id) {
        Node::Constant(bits) => Some(bits.value()),
        _ => None,
    };
    // Comparing what a narrower type holds exactly gives the same in `f64`.
    let holds = |a: f64, b: f64| if matches!(node, Node::Lt(..)) { a < b } else { a <= b };
    let (mask, yes, no) = match (choice(a), choice(b)) {
        (None, Some((mask, yes, no))) => {
            let (Some(a), Some(yes), Some(no)) = (constant(a), constant(yes), constant(no)) else {
                return Shorter::No;
            };
            (mask, holds(a, yes), holds(a, no))
        }
        (Some((mask, yes, no)), None) => {
            let (Some(yes), Some(no), Some(b)) = (constant(yes), constant(no), constant(b)) else {
                return Shorter::No;
            };
            (mask, holds(yes, b), holds(no, b))
        }
        _ => return Shorter::No,
    };
    match (yes, no) {
        (true, false) => Shorter::Operand(mask),
        (false, true) => Shorter::Operation(Node::Not(mask)),
        (same, _) => Shorter::Constant(f64::flag(same)),
    }
}

fn shorter_condition(builder: &Builder, node: Node) -> Shorter {
    let always = |id: NodeId| is(builder, id, 1.0);
    let never = |id: NodeId| is(builder, id, 0.0);
    match node {
        Node::And(a, b) if always(a) || a == b => Shorter::Operand(b),
        Node::And(a, b) if always(b) => Shorter::Operand(a),
        Node::And(a, b) if never(a) || never(b) => Shorter::Constant(0.0),
        Node::Or(a, b) if never(a) || a == b => Shorter::Operand(b),
        Node::Or(a, b) if never(b) => Shorter::Operand(a),
        Node::Or(a, b) if always(a) || always(b) => Shorter::Constant(1.0),
        Node::Not(a) => match builder.operation(a) {
            Node::Not(a) => Shorter::Operand(a),
            _ => Shorter::No,
        },
        _ => Shorter::No,
    }
}

fn shorter_select(builder: &Builder, mask: NodeId, yes: NodeId, no: NodeId) -> Shorter {
    if yes == no || is(builder, mask, 1.0) {
        return Shorter::Operand(yes);
    }
    if is(builder, mask, 0.0) {
        return Shorter::Operand(no);
    }
    if let Node::Not(mask) = builder.operation(mask) {
        return Shorter::Operation(Node::Select(mask, no, yes));
    }
    match (builder.operation(yes), builder.operation(no)) {
        (Node::Select(inner, yes, _), _) if inner == mask => {
            Shorter::Operation(Node::Select(mask, yes, no))
        }
        (_, Node::Select(inner, _, no)) if inner == mask => {
            Shorter::Operation(Node::Select(mask, yes, no))
        }
        _ => Shorter::No,
    }
}
