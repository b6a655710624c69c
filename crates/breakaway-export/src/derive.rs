//! What follows from parameters alone is computed when they change, not in every step.

use std::collections::HashMap;

use crate::graph::{Builder, Graph, Label, Node, NodeId};
use crate::passes::without_dead;
use crate::routine::{Routine, Slot};

/// What follows from parameters alone.
#[derive(Clone, Debug, Default)]
pub struct Derivation {
    /// From parameters to derived numbers, which are its outputs: `derived/0` and so on.
    pub graph: Graph,
}

/// Takes what depends on parameters only out of routines.
///
/// A number is derived where it is more than a parameter, a constant or one with its sign turned.
/// Conditions stay, their operands do not: derived numbers are all of one type.
pub(crate) fn derive(routines: Vec<Routine>) -> (Vec<Routine>, Derivation) {
    let mut derived = Derived::default();
    let routines = routines
        .into_iter()
        .map(|routine| Routine { graph: derived.taken_out_of(&routine.graph), ..routine });
    let routines = routines.collect();
    (routines, derived.finish())
}

#[derive(Default)]
struct Derived {
    builder: Builder,
    /// Nodes that are derived numbers, in the order of their slots.
    slots: Vec<NodeId>,
    inputs: HashMap<String, NodeId>,
}

impl Derived {
    fn taken_out_of(&mut self, graph: &Graph) -> Graph {
        let alone = depends_on_parameters_only(graph);
        let mut here = Builder::default();
        // Where each node is: in the derivation, in the routine, or both.
        let mut there: Vec<Option<NodeId>> = vec![None; graph.nodes().len()];
        let mut local: Vec<Option<NodeId>> = vec![None; graph.nodes().len()];
        for (i, (&node, &label)) in graph.nodes().iter().zip(graph.labels()).enumerate() {
            if alone[i] {
                there[i] = Some(self.node(graph, node, label, &there));
                continue;
            }
            let operands: Vec<_> = node.operands().collect();
            for id in operands {
                self.bring(graph, id, &there, &mut local, &mut here);
            }
            local[i] = Some(match node {
                Node::Input(n) => here.input(graph.inputs()[n as usize].clone()),
                _ => here.labeled(
                    node.on(|id| local[id.index()].expect("operands were brought")),
                    label,
                ),
            });
        }
        for (name, id) in graph.outputs() {
            self.bring(graph, *id, &there, &mut local, &mut here);
            here.output(name.clone(), local[id.index()].expect("it was brought"));
        }
        here.finish()
    }

    /// Writes a node into the derivation.
    fn node(
        &mut self,
        graph: &Graph,
        node: Node,
        label: Label,
        there: &[Option<NodeId>],
    ) -> NodeId {
        if let Node::Input(n) = node {
            let name = &graph.inputs()[n as usize];
            let builder = &mut self.builder;
            let new = || builder.input(name.clone());
            return *self.inputs.entry(name.clone()).or_insert_with(new);
        }
        let of = |id: NodeId| there[id.index()].expect("its operands depend on parameters only");
        self.builder.labeled(node.on(of), label)
    }

    /// Makes a node that depends on parameters only known to the routine.
    fn bring(
        &mut self,
        graph: &Graph,
        id: NodeId,
        there: &[Option<NodeId>],
        local: &mut [Option<NodeId>],
        here: &mut Builder,
    ) {
        if local[id.index()].is_some() {
            return;
        }
        let (node, label) = (graph.nodes()[id.index()], graph.labels()[id.index()]);
        let leaf =
            |id: NodeId| matches!(graph.nodes()[id.index()], Node::Input(_) | Node::Constant(_));
        let stays = match node {
            Node::Neg(a) => leaf(a),
            _ => node.is_condition() || leaf(id),
        };
        local[id.index()] = Some(if !stays {
            let origin = there[id.index()].expect("it depends on parameters only");
            let name = format!("derived/{}", self.slot(origin));
            here.input_once(&name)
        } else if let Node::Input(n) = node {
            here.input_once(&graph.inputs()[n as usize])
        } else {
            for operand in node.operands() {
                self.bring(graph, operand, there, local, here);
            }
            here.labeled(node.on(|id| local[id.index()].expect("just brought")), label)
        });
    }

    fn slot(&mut self, origin: NodeId) -> usize {
        self.slots.iter().position(|&id| id == origin).unwrap_or_else(|| {
            self.slots.push(origin);
            self.slots.len() - 1
        })
    }

    fn finish(mut self) -> Derivation {
        for (slot, &id) in self.slots.iter().enumerate() {
            self.builder.output(format!("derived/{slot}"), id);
        }
        Derivation { graph: without_dead(&self.builder.finish()) }
    }
}

fn depends_on_parameters_only(graph: &Graph) -> Vec<bool> {
    let mut alone: Vec<bool> = Vec::with_capacity(graph.nodes().len());
    for node in graph.nodes() {
        alone.push(match node {
            Node::Input(n) => {
                matches!(Slot::parse(&graph.inputs()[*n as usize]), Slot::Parameter(_))
            }
            _ => node.operands().all(|id| alone[id.index()]),
        });
    }
    alone
}
