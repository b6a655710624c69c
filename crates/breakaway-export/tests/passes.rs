//! Passes over a graph leave its values alone, to the bit, on whatever numbers.

use breakaway_core::Real;
use breakaway_core::test_models::paper_as_computed;
use breakaway_export::passes::{Scalar, simplify};
use breakaway_export::{Expr, ExprMask, Graph, Program, What, record};

/// Zeros, subnormals, ends of the ranges, infinities, NaN; for both types.
const SPECIAL: [f64; 18] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    5e-324,
    -1e-310,
    1e-45,
    -1e-40,
    1.2e-38,
    3.4e38,
    -3.4e38,
    1.7e308,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    0.1,
    -7.3e5,
];

/// SplitMix64: random words without a crate.
struct Random(u64);

impl Random {
    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.word() % end as u64) as usize
    }

    fn of<T: Copy>(&mut self, among: &[T]) -> T {
        among[self.below(among.len())]
    }

    /// Special in half of the cases.
    fn number(&mut self) -> f64 {
        if self.below(2) == 0 {
            return self.of(&SPECIAL);
        }
        let unit = (self.word() >> 11) as f64 * 2.0_f64.powi(-53) - 0.5;
        unit * 10.0_f64.powi(self.below(13) as i32 - 6)
    }
}

/// A graph of random operations on two inputs and special constants.
fn random_graph(random: &mut Random) -> Graph {
    record(|recorder| {
        let mut numbers = vec![recorder.input("x"), recorder.input("y")];
        for value in [0.0, -0.0, 1.0, 0.5, random.number()] {
            numbers.push(recorder.constant(value));
        }
        let mut masks: Vec<ExprMask> = vec![numbers[0].lt(numbers[1]), Expr::known(true)];
        for _ in 0..40 {
            let [a, b, c] = [(); 3].map(|()| random.of(&numbers));
            let [m, n] = [(); 2].map(|()| random.of(&masks));
            match random.below(17) {
                0 => numbers.push(a + b),
                1 => numbers.push(a - b),
                2 => numbers.push(a * b),
                3 => numbers.push(a / b),
                4 => numbers.push(-a),
                5 => numbers.push(a.abs()),
                6 => numbers.push(a.mul_add(b, c)),
                7 => numbers.push(a.round()),
                8 => numbers.push(a.exp2_parts().0),
                9 => numbers.push(a.exp2_parts().1),
                10 | 11 => numbers.push(Expr::select(m, a, b)),
                12 => masks.push(a.lt(b)),
                13 => masks.push(a.le(b)),
                14 => masks.push(m & n),
                15 => masks.push(m | !n),
                _ => {
                    numbers.push(Expr::flag(m));
                    masks.push(Expr::flag(n).is_set());
                }
            }
        }
        for (i, &number) in numbers.iter().enumerate() {
            recorder.output(i.to_string(), number);
        }
        for (i, &mask) in masks.iter().enumerate() {
            recorder.output(format!("mask {i}"), Expr::flag(mask));
        }
    })
}

/// The value of every output, by name, with all NaN made equal.
fn outputs<R: Scalar>(graph: &Graph, of: &dyn Fn(&str) -> f64) -> Vec<(String, u64)> {
    let inputs: Vec<R> = graph.inputs().iter().map(|name| R::constant(of(name))).collect();
    let values = graph.evaluate(&inputs);
    let bits = |value: R| {
        let value: f64 = value.into();
        if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() }
    };
    graph
        .outputs()
        .iter()
        .zip(values)
        .map(|((name, _), value)| (name.clone(), bits(value)))
        .collect()
}

fn is_harmless<R: Scalar>(graph: &Graph, random: &mut Random, times: usize) {
    let simple = simplify::<R>(graph);
    assert!(simple.nodes().len() <= graph.nodes().len());
    for _ in 0..times {
        let values: Vec<f64> = graph.inputs().iter().map(|_| random.number()).collect();
        let of = |name: &str| {
            let place = graph.inputs().iter().position(|one| one == name).expect("an input of it");
            values[place]
        };
        assert_eq!(outputs::<R>(&simple, &of), outputs::<R>(graph, &of), "for {values:?}");
    }
}

#[test]
fn simplifying_random_graphs_is_harmless() {
    let mut random = Random(1);
    for _ in 0..1500 {
        let graph = random_graph(&mut random);
        is_harmless::<f64>(&graph, &mut random, 30);
        is_harmless::<f32>(&graph, &mut random, 30);
    }
}

#[test]
fn simplifying_twice_finds_nothing_more() {
    let mut random = Random(2);
    for _ in 0..200 {
        let simple = simplify::<f64>(&random_graph(&mut random));
        assert_eq!(simplify::<f64>(&simple).nodes().len(), simple.nodes().len());
    }
}

#[test]
fn the_recorded_loop_is_simplified_harmlessly() {
    let mut random = Random(3);
    for what in What::ALL {
        for routine in Program::of::<f64>(what, &paper_as_computed()).routines {
            is_harmless::<f64>(&routine.graph, &mut random, 2000);
            is_harmless::<f32>(&routine.graph, &mut random, 2000);
        }
    }
}

#[test]
fn every_rule_shortens() {
    /// Nodes that are left of `f(x, y)`.
    fn left(f: impl FnOnce(Expr, Expr) -> Expr) -> usize {
        let graph = record(|recorder| {
            let (x, y) = (recorder.input("x"), recorder.input("y"));
            recorder.output("f", f(x, y));
        });
        simplify::<f64>(&graph).nodes().len()
    }
    let c = Expr::constant;
    assert_eq!(left(|x, _| x * c(1.0)), 1);
    assert_eq!(left(|x, _| c(1.0) * x / c(1.0)), 1);
    assert_eq!(left(|x, _| x + c(-0.0)), 1);
    assert_eq!(left(|x, _| x - c(0.0)), 1);
    assert_eq!(left(|x, _| -(-x)), 1);
    assert_eq!(left(|x, y| x + -y), 3);
    assert_eq!(left(|x, y| x - -y), 3);
    assert_eq!(left(|x, y| x.mul_add(c(1.0), y)), 3);
    assert_eq!(left(|x, _| (-x).abs().abs()), 2);
    assert_eq!(left(|_, _| c(2.0).mul_add(c(3.0), c(4.0)).exp()), 1);
    assert_eq!(left(|x, y| Expr::select(Expr::known(true), x, y)), 1);
    assert_eq!(left(|x, y| Expr::select(x.lt(y), x, x)), 1);
    assert_eq!(left(|x, y| Expr::select(Expr::flag(x.lt(y)).is_set(), x, y)), 4);
    assert_eq!(left(|x, y| Expr::select(!x.lt(y) & Expr::known(true), x, y)), 4);
    // What would not hold for every number stays.
    assert_eq!(left(|x, _| x + c(0.0)), 3);
    assert_eq!(left(|x, _| x * c(0.0)), 3);
    assert_eq!(left(|x, _| x - x), 2);
    assert_eq!(left(|x, _| x.max(c(f64::NEG_INFINITY))), 4);
}

#[test]
fn constants_are_folded_in_the_arithmetic_of_the_code() {
    let graph = record(|recorder| {
        recorder.output("third", Expr::one() / Expr::constant(3.0));
    });
    let third = |graph: &Graph| graph.evaluate::<f64>(&[])[0];
    assert_eq!(third(&simplify::<f64>(&graph)), 1.0 / 3.0);
    assert_eq!(third(&simplify::<f32>(&graph)), f64::from(1.0_f32 / 3.0));
}
