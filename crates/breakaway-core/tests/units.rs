//! An equation does not know its units. Measured in other units of mass, length and time, the same
//! extraction must run the same; a term with a missing factor (equation (2) as printed lacks k_e)
//! cannot pass. With powers of two for the units even the bits agree.

use breakaway_core::disturbance::DisturbedQuantity;
use breakaway_core::metrics::Groups;
use breakaway_core::plant::Integrator;
use breakaway_core::test_models::{paper_as_computed, paper_limits};
use breakaway_core::{Draws, ExtractionState, Metrics};

/// How many new units one kg, one m and one s are.
struct Units {
    kg: f64,
    m: f64,
    s: f64,
}

impl Units {
    /// One of a unit's symbol, in new units; none for what is no unit.
    fn of(&self, symbol: &str) -> Option<f64> {
        let n = self.kg * self.m / (self.s * self.s);
        Some(match symbol {
            "kg" => self.kg,
            "m" => self.m,
            "m2" => self.m * self.m,
            "s" => self.s,
            "s2" => self.s * self.s,
            "hz" => 1.0 / self.s,
            "n" => n,
            "n2" => n * n,
            "j" => n * self.m,
            _ => return None,
        })
    }

    /// The factor on a number whose name ends in its unit, such as `stiffness_n_per_m`.
    fn factor(&self, name: &str) -> f64 {
        let (mut unit, mut part) = (1.0, 1.0);
        for symbol in name.rsplit('_') {
            match self.of(symbol) {
                Some(factor) => part *= factor,
                None if symbol == "per" => (unit, part) = (unit / part, 1.0),
                None => break,
            }
        }
        unit * part
    }
}

#[test]
fn names_tell_their_units() {
    let units = Units { kg: 2.0, m: 8.0, s: 32.0 };
    let n = 2.0 * 8.0 / 1024.0;
    assert_eq!(units.factor("ki_n_per_m_s"), n / (8.0 * 32.0));
    assert_eq!(units.factor("damping_n_s_per_m"), n * 32.0 / 8.0);
    assert_eq!(units.factor("force_square_n2_s"), n * n * 32.0);
    assert_eq!(units.factor("samples"), 1.0);
}

#[test]
fn the_loop_runs_the_same_in_other_units() {
    for units in [Units { kg: 8.0, m: 0.25, s: 1.0 }, Units { kg: 0.5, m: 1024.0, s: 128.0 }] {
        for integrator in [Integrator::LinearlyImplicitMidpoint, Integrator::Rk4] {
            let mut ours = paper_as_computed();
            ours.disturbance.var = 0.2;
            ours.disturbance.acts_on = DisturbedQuantity::JointForce;
            ours.timing.integrator = integrator;
            ours.timing.steps_per_period = 4;
            let theirs = ours.map(&mut |name, value| value * units.factor(name.field()));
            let (limits, their_limits) = (
                paper_limits(),
                paper_limits().map(&mut |name, value: f64| value * units.factor(name.field())),
            );
            let (mut state, mut their_state) =
                (ExtractionState::at_rest(), ExtractionState::at_rest());
            let (mut metrics, mut their_metrics) = (Metrics::new(), Metrics::new());
            for n in 0..20_000 {
                let disturbance = f64::from(n / 10 * 7 % 11) / 5.5 - 1.0;
                let draws = Draws { disturbance, ..Draws::none() };
                metrics.step(Groups::ALL, &limits, &ours, &mut state, draws);
                their_metrics.step(Groups::ALL, &their_limits, &theirs, &mut their_state, draws);
            }
            assert!(metrics.time_to_breakaway_s.is_finite() && state.plant.position_m > 0.02);
            let converted = state.map(&mut |name, value| value * units.factor(name.field()));
            assert_eq!(their_state, converted);
            let converted = metrics.map(&mut |name, value| value * units.factor(name.field()));
            assert_eq!(their_metrics, converted);
        }
    }
}
