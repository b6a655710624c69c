//! Energy is neither lost nor found: what the actuator does on the part goes into the joint or into
//! motion. The midpoint rule keeps this balance exactly, whatever its error in the motion, since
//! m (v₁ − v₀) v_m = (F − R) v_m h and v_m is the mean of v₀ and v₁.

use breakaway_core::metrics::Groups;
use breakaway_core::test_models::{paper_as_computed, paper_limits};
use breakaway_core::{Draws, ExtractionState, Metrics};

#[test]
fn work_is_joint_work_and_kinetic_energy() {
    for var in [0.0, 0.3] {
        let mut extraction = paper_as_computed();
        extraction.disturbance.var = var;
        let (mut state, mut metrics) = (ExtractionState::at_rest(), Metrics::new());
        for n in 0..50_000 {
            let disturbance = f64::from(n / 10 * 7 % 11) / 5.5 - 1.0;
            let draws = Draws { disturbance, ..Draws::none() };
            metrics.step(Groups::ALL, &paper_limits(), &extraction, &mut state, draws);
            let v = state.plant.velocity_m_per_s;
            let kinetic = 0.5 * extraction.part.mass_kg * v * v;
            let missing = metrics.work_j - metrics.joint_work_j - kinetic;
            assert!(missing.abs() <= 1e-9 * metrics.work_j.max(1e-3), "{missing:e} J at {n}");
        }
        assert!(metrics.time_to_release_s.is_finite() && metrics.work_j > 10.0, "{metrics:?}");
    }
}
