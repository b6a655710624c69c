//! A number that writes down what is done to it.

use std::cell::RefCell;
use std::fmt::Display;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};
use std::sync::atomic::{AtomicU64, Ordering};

use breakaway_core::Real;

use crate::graph::{Bits, Builder, Graph, Node, NodeId};

/// A number of a graph under construction; operations on it become nodes of that graph.
///
/// It is only an index, so it can be copied freely, but it means something only inside the call
/// of [`record`] that made it.
///
/// # Panics
/// Every operation, and [`Real::constant`], panics outside [`record`], and when it is given a
/// number of another recording (one that is over, or one on another thread).
///
/// # Example
/// ```
/// use breakaway_core::Real;
/// use breakaway_export::{Expr, record};
/// let graph = record(|recorder| {
///     let x: Expr = recorder.input("x");
///     recorder.output("y", x.max(Expr::zero()).min(Expr::one()));
/// });
/// assert_eq!(graph.evaluate(&[1.5]), [1.0]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Expr(Recorded);

/// A condition of a graph under construction. Like [`Expr`], it panics outside its recording.
///
/// # Example
/// ```
/// use breakaway_core::Real;
/// use breakaway_export::{Expr, ExprMask, record};
/// let graph = record(|recorder| {
///     let x = recorder.input("x");
///     let inside: ExprMask = Expr::zero().le(x) & x.lt(Expr::one());
///     recorder.output("outside", Expr::flag(!inside));
/// });
/// assert_eq!(graph.evaluate(&[0.5]), [0.0]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ExprMask(Recorded);

/// A node, and the recording it belongs to.
#[derive(Clone, Copy, Debug)]
struct Recorded {
    recording: u64,
    node: NodeId,
}

/// The recording of this thread.
#[derive(Debug)]
struct Recording {
    number: u64,
    builder: Builder,
}

thread_local! {
    static CURRENT: RefCell<Option<Recording>> = const { RefCell::new(None) };
}

/// Recordings so far on all threads, so that no two share a number.
static RECORDINGS: AtomicU64 = AtomicU64::new(0);

impl Recording {
    fn with<T>(f: impl FnOnce(&mut Self) -> T) -> T {
        CURRENT.with_borrow_mut(|current| {
            f(current.as_mut().expect("an Expr was used outside of breakaway_export::record"))
        })
    }

    fn node_of(&self, operand: Recorded) -> NodeId {
        assert!(
            operand.recording == self.number,
            "an Expr of one recording was used in another; each belongs to the call of \
             breakaway_export::record that made it"
        );
        operand.node
    }
}

/// Writes down an operation on operands of the current recording.
fn write<const N: usize>(
    operands: [Recorded; N],
    node: impl FnOnce([NodeId; N]) -> Node,
) -> Recorded {
    Recording::with(|recording| {
        let ids = operands.map(|operand| recording.node_of(operand));
        let node = recording.builder.node(node(ids));
        Recorded { recording: recording.number, node }
    })
}

/// Names the inputs and outputs of a recording. Only [`record`] makes one.
///
/// # Example
/// ```
/// let graph = breakaway_export::record(|recorder| {
///     let (x, y) = (recorder.input("x"), recorder.input("y"));
///     recorder.output("difference", x - y);
/// });
/// assert_eq!(graph.evaluate(&[5.0, 3.0]), [2.0]);
/// ```
#[derive(Debug)]
pub struct Recorder(());

impl Recorder {
    /// A new input.
    ///
    /// # Panics
    /// If an input of that name exists.
    ///
    /// # Example
    /// ```
    /// let graph = breakaway_export::record(|recorder| {
    ///     recorder.input("x");
    /// });
    /// assert_eq!(graph.inputs(), ["x"]);
    /// ```
    pub fn input(&mut self, name: impl Into<String>) -> Expr {
        Recording::with(|recording| {
            let node = recording.builder.input(name.into());
            Expr(Recorded { recording: recording.number, node })
        })
    }

    /// A new input for a field of a structure, named `group.field`; `group.field.2`, `group.field.3`
    /// and so on where several numbers have that name, as the elements of an array do. Meant for the
    /// closures of the core's `map`, which get names.
    ///
    /// # Example
    /// ```
    /// use breakaway_core::{joint::Law, test_models::paper_joint};
    /// let graph = breakaway_export::record(|recorder| {
    ///     let joint = paper_joint().map(&mut |name, _| recorder.field("joint", name));
    ///     let (x, v) = (recorder.input("x"), recorder.input("v"));
    ///     recorder.output("g", joint.friction_level(x, v, recorder.constant(1.0)));
    /// });
    /// assert_eq!(graph.inputs()[0], "joint.stiction_n");
    /// ```
    pub fn field(&mut self, group: &str, field: impl Display) -> Expr {
        let first = format!("{group}.{field}");
        let taken = |name: &str| Recording::with(|recording| recording.builder.has_input(name));
        let numbered = (2..).map(|n| format!("{first}.{n}"));
        let mut names = std::iter::once(first.clone()).chain(numbered);
        let free = names.find(|name| !taken(name)).expect("numbers do not run out");
        self.input(free)
    }

    /// A constant: what a number of a configuration becomes that is not to be changed later.
    ///
    /// # Example
    /// ```
    /// let graph = breakaway_export::record(|recorder| {
    ///     let two = recorder.constant(2.0);
    ///     recorder.output("two", two);
    /// });
    /// assert_eq!(graph.evaluate::<f64>(&[]), [2.0]);
    /// ```
    #[must_use]
    pub fn constant(&self, value: f64) -> Expr {
        Expr::constant(value)
    }

    /// Makes a number an output.
    ///
    /// # Panics
    /// If an output of that name exists, or the number is of another recording.
    ///
    /// # Example
    /// ```
    /// let graph = breakaway_export::record(|recorder| {
    ///     let x = recorder.input("x");
    ///     recorder.output("same", x);
    /// });
    /// assert_eq!(graph.evaluate(&[4.0]), [4.0]);
    /// ```
    pub fn output(&mut self, name: impl Into<String>, number: Expr) {
        Recording::with(|recording| {
            let node = recording.node_of(number.0);
            recording.builder.output(name.into(), node);
        });
    }
}

/// Records what `build` computes.
///
/// # Panics
/// If it is called inside another recording on the same thread. A panic inside `build` ends the
/// recording, and passes on.
///
/// # Example
/// The whole loop, its configuration fixed and its state an input:
/// ```
/// use breakaway_core::test_models::paper_as_computed;
/// use breakaway_core::{Draws, ExtractionState};
/// use breakaway_export::record;
///
/// let graph = record(|recorder| {
///     let loop_ = paper_as_computed().map(&mut |_, value| recorder.constant(value));
///     let mut state =
///         ExtractionState::at_rest().map(&mut |name, _: f64| recorder.field("state", name));
///     let draws = Draws { disturbance: recorder.input("disturbance"), ..Draws::none() };
///     loop_.step(&mut state, draws);
///     let mut place = 0;
///     state.map(&mut |name, value| {
///         place += 1;
///         recorder.output(format!("{name} {place}"), value);
///     });
/// });
/// assert_eq!(graph.inputs().len(), graph.outputs().len() + 1);
/// ```
pub fn record(build: impl FnOnce(&mut Recorder)) -> Graph {
    let number = RECORDINGS.fetch_add(1, Ordering::Relaxed);
    let guard = Guard::begin(Recording { number, builder: Builder::default() });
    build(&mut Recorder(()));
    guard.finish()
}

/// Ends the recording when it is dropped, also by a panic.
struct Guard(());

impl Guard {
    fn begin(recording: Recording) -> Self {
        CURRENT.with_borrow_mut(|current| {
            assert!(current.is_none(), "breakaway_export::record was called inside itself");
            *current = Some(recording);
        });
        Self(())
    }

    fn finish(self) -> Graph {
        let recording = CURRENT.take().expect("the recording that was begun");
        recording.builder.finish()
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        CURRENT.set(None);
    }
}

macro_rules! recorded_operation {
    ($type:ident, $trait:ident, $method:ident, $node:ident) => {
        impl $trait for $type {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(write([self.0, other.0], |[a, b]| Node::$node(a, b)))
            }
        }
    };
}

recorded_operation!(Expr, Add, add, Add);
recorded_operation!(Expr, Sub, sub, Sub);
recorded_operation!(Expr, Mul, mul, Mul);
recorded_operation!(Expr, Div, div, Div);
recorded_operation!(ExprMask, BitAnd, bitand, And);
recorded_operation!(ExprMask, BitOr, bitor, Or);

impl Neg for Expr {
    type Output = Self;
    fn neg(self) -> Self {
        Self(write([self.0], |[a]| Node::Neg(a)))
    }
}

impl Not for ExprMask {
    type Output = Self;
    fn not(self) -> Self {
        Self(write([self.0], |[a]| Node::Not(a)))
    }
}

impl Real for Expr {
    type Mask = ExprMask;

    fn constant(value: f64) -> Self {
        Self(write([], |[]| Node::Constant(Bits::of(value))))
    }
    fn lt(self, other: Self) -> ExprMask {
        ExprMask(write([self.0, other.0], |[a, b]| Node::Lt(a, b)))
    }
    fn le(self, other: Self) -> ExprMask {
        ExprMask(write([self.0, other.0], |[a, b]| Node::Le(a, b)))
    }
    fn select(mask: ExprMask, yes: Self, no: Self) -> Self {
        Self(write([mask.0, yes.0, no.0], |[m, a, b]| Node::Select(m, a, b)))
    }
    fn named(self, name: &'static str) -> Self {
        Recording::with(|recording| {
            let node = recording.node_of(self.0);
            recording.builder.name(node, name);
        });
        self
    }
    fn section(title: &'static str) {
        Recording::with(|recording| recording.builder.section(title));
    }
    fn abs(self) -> Self {
        Self(write([self.0], |[a]| Node::Abs(a)))
    }
    fn round(self) -> Self {
        Self(write([self.0], |[a]| Node::Round(a)))
    }
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(write([self.0, factor.0, addend.0], |[a, b, c]| Node::MulAdd(a, b, c)))
    }
    fn exp2_parts(self) -> (Self, Self) {
        let fraction = write([self.0], |[a]| Node::Exp2Fraction(a));
        (Self(fraction), Self(write([self.0], |[a]| Node::Exp2Power(a))))
    }
}
