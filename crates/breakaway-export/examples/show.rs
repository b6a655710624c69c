//! Shows.
use breakaway_core::test_models::paper_as_computed;
use breakaway_export::{What, c::{Precision, code}};
fn main() {
    let mut e = paper_as_computed();
    e.timing.steps_per_period = std::env::args().nth(1).map_or(1, |n| n.parse().unwrap());
    for what in What::ALL {
        let program = Precision::Single.program(what, &e);
        println!("=== {what:?}\n{:?}\n{:?}\n{:?} {:?} {:?}", program.parameters.iter().map(|p| &p.path).collect::<Vec<_>>(), program.states, program.inputs, program.outputs, program.signals);
        let code = code(&program, Precision::Single);
        for d in &code.derived { println!("  {} = {}", d.name, d.formula); }
        println!("{}", code.derive.text);
        for (n, t, b) in &code.routines { println!("--- {n} x{t}\n{}", b.text); }
    }
}
