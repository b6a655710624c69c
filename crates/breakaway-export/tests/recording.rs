//! What a recording holds, and what it refuses.

use std::panic::{AssertUnwindSafe, catch_unwind};

use breakaway_core::Real;
use breakaway_export::{Bits, Expr, Node, record};

/// The message of the panic that `f` ends in.
fn refusal(f: impl FnOnce()) -> String {
    let panic = catch_unwind(AssertUnwindSafe(f)).expect_err("it must be refused");
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned()).expect("a panic with a text")
}

#[test]
fn every_operation_is_evaluated_as_f64_does_it() {
    fn all<R: Real>(x: R, y: R) -> [R; 12] {
        let inside = x.lt(y) & !y.le(R::zero()) | y.lt(x);
        let (fraction, power) = x.exp2_parts();
        let picked = R::select(inside, x, y);
        [
            x + y,
            x - y,
            x * y,
            x / y,
            -x,
            x.abs(),
            x.mul_add(y, x),
            fraction,
            power,
            picked,
            R::flag(x.le(y)),
            x.clamp(R::constant(-0.5), y),
        ]
    }
    let graph = record(|recorder| {
        let (x, y) = (recorder.input("x"), recorder.input("y"));
        for (i, result) in all(x, y).into_iter().enumerate() {
            recorder.output(i.to_string(), result);
        }
    });
    let values = [0.0, -0.0, 0.1, -7.3, 1e300, -1e-310, f64::INFINITY, f64::NAN];
    for x in values {
        for y in values {
            let recorded = graph.evaluate(&[x, y]).map_bits();
            assert_eq!(recorded, all(x, y).to_vec().map_bits(), "at {x}, {y}");
        }
    }
}

/// Bits that can be compared: those of all NaN are made equal, since IEEE 754 leaves them open.
trait MapBits {
    fn map_bits(self) -> Vec<u64>;
}

impl MapBits for Vec<f64> {
    fn map_bits(self) -> Vec<u64> {
        let bits = |x: f64| if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() };
        self.into_iter().map(bits).collect()
    }
}

#[test]
fn what_is_written_twice_is_recorded_once() {
    let graph = record(|recorder| {
        let (x, y) = (recorder.input("x"), recorder.input("y"));
        let first = x.mul_add(y, Expr::constant(0.5));
        let second = x.mul_add(y, Expr::constant(0.5));
        recorder.output("twice", first * second);
    });
    let [_, _, half, fused, square] = *graph.nodes() else { panic!("{graph:?}") };
    assert_eq!(half, Node::Constant(Bits::of(0.5)));
    assert!(matches!(fused, Node::MulAdd(..)));
    assert!(matches!(square, Node::Mul(a, b) if a == b && a.index() == 3));
}

#[test]
fn constants_are_shared_by_their_bits() {
    let graph = record(|recorder| {
        for (i, value) in [0.0, -0.0, 0.0, f64::NAN, f64::NAN].into_iter().enumerate() {
            let constant = recorder.constant(value);
            recorder.output(i.to_string(), constant);
        }
    });
    assert_eq!(graph.nodes().len(), 3);
    let values = graph.evaluate::<f64>(&[]);
    assert!(values[0].is_sign_positive() && values[1].is_sign_negative() && values[4].is_nan());
}

#[test]
fn operands_come_before_their_operation() {
    let graph = record(|recorder| {
        let x = recorder.input("x");
        recorder.output("y", (x + Expr::one()) / (x * x));
    });
    for (i, node) in graph.nodes().iter().enumerate() {
        if let Node::Add(a, b) | Node::Mul(a, b) | Node::Div(a, b) = node {
            assert!(a.index() < i && b.index() < i, "{node:?} at {i}");
        }
    }
}

#[test]
fn fields_of_the_same_name_are_numbered() {
    let graph = record(|recorder| {
        for group in ["a", "a", "b", "a"] {
            recorder.field(group, "kp");
        }
    });
    assert_eq!(graph.inputs(), ["a.kp", "a.kp.2", "b.kp", "a.kp.3"]);
}

#[test]
fn a_number_does_not_outlive_its_recording() {
    let mut kept = None;
    record(|recorder| kept = Some(recorder.input("x")));
    let kept = kept.expect("recorded");
    assert!(refusal(|| _ = kept + kept).contains("outside of breakaway_export::record"));
    assert!(refusal(|| _ = Expr::constant(1.0)).contains("outside of breakaway_export::record"));
    let mixed = refusal(|| {
        record(|recorder| _ = recorder.input("y") + kept);
    });
    assert!(mixed.contains("an Expr of one recording was used in another"), "{mixed}");
    let given_out = refusal(|| {
        record(|recorder| recorder.output("y", kept));
    });
    assert!(given_out.contains("an Expr of one recording was used in another"), "{given_out}");
}

#[test]
fn a_number_does_not_cross_threads() {
    let message = refusal(|| {
        record(|recorder| {
            let x = recorder.input("x");
            let elsewhere = std::thread::spawn(move || {
                refusal(|| {
                    record(|recorder| _ = recorder.input("y") + x);
                })
            });
            panic!("{}", elsewhere.join().expect("a refusal"));
        });
    });
    assert!(message.contains("an Expr of one recording was used in another"), "{message}");
}

#[test]
fn recordings_do_not_nest_and_a_panic_ends_one() {
    let nested = refusal(|| {
        record(|_| {
            record(|_| {});
        });
    });
    assert!(nested.contains("record was called inside itself"), "{nested}");
    // Refusing the inner one leaves the outer one whole.
    let outer = record(|recorder| {
        let x = recorder.input("x");
        refusal(|| _ = record(|_| {}));
        recorder.output("x", x);
    });
    assert_eq!(outer.evaluate(&[2.0]), [2.0]);
}

#[test]
fn names_and_counts_are_checked() {
    let twice = refusal(|| {
        record(|recorder| {
            recorder.input("x");
            recorder.input("x");
        });
    });
    assert!(twice.contains("two inputs are named \"x\""), "{twice}");
    let twice = refusal(|| {
        record(|recorder| {
            let x = recorder.input("x");
            recorder.output("y", x);
            recorder.output("y", x);
        });
    });
    assert!(twice.contains("two outputs are named \"y\""), "{twice}");
    let graph = record(|recorder| _ = recorder.input("x"));
    let count = refusal(|| _ = graph.evaluate(&[1.0, 2.0]));
    assert!(count.contains("1 inputs, but 2 values"), "{count}");
}
