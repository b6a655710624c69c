//! What a law answers for steady sliding is what it ends at when it is moved, and how it gets there.

mod laws;

use breakaway_core::imposed::impose_motion;
use breakaway_core::joint::{Form, Joint, Law, Lugre, Steady, form, steady};
use breakaway_core::plant::PlantState;
use breakaway_core::test_models::paper_joint;
use breakaway_core::{Dual, Maybe, Real};

const VELOCITIES: [f64; 6] = [1e-3, -1e-3, 0.06, -0.06, 0.5, -0.5];

/// A joint that differs with the direction and damps, and does not fall along the guide.
fn joint() -> Lugre<f64> {
    Lugre {
        viscous_n_s_per_m: Maybe::some(60.0),
        backward_ratio: Maybe::some(0.7),
        damping_velocity_m_per_s: Maybe::some(0.3),
        ..laws::endless()
    }
}

/// g(v, 0) in N by equation (3), 0.7 times for backward motion.
fn level(v: f64) -> f64 {
    let level = 360.0 + 90.0 * (-(v / 0.09_f64).powi(2)).exp();
    if v < 0.0 { 0.7 * level } else { level }
}

#[test]
fn moved_at_a_speed_every_law_ends_at_its_steady_force() {
    for (name, joint) in laws::all(joint()) {
        for v in VELOCITIES {
            // Twenty deflections of the bristles, and twenty time constants of the elements.
            let time_s = f64::max(20.0 * 450.0 / 3.6e7 / v.abs(), 20.0 * 450.0 / 1e6);
            let (steps, mut state) = (20_000, PlantState::at_rest());
            let h = time_s / f64::from(steps);
            let end = (0..steps).fold(0.0, |_, _| impose_motion(&joint, &mut state, v, h));
            let expected = steady(&joint, 0.0, v).force_n(v);
            assert!((end / expected - 1.0).abs() < 1e-7, "{name} at {v}: {end} is {expected}");
        }
    }
}

#[test]
fn levels_damping_rate_and_lead_are_those_of_the_equations() {
    for (name, joint) in laws::all(joint()) {
        for v in VELOCITIES {
            let Steady { level_n, viscous_n_s_per_m, damping_n_s_per_m, rate_per_s, lead } =
                steady(&joint, 0.0, v);
            let backward = if v < 0.0 { 0.7 } else { 1.0 };
            let (g, c) = (level(v), 9000.0 * (-(v / 0.3_f64).powi(2)).exp());
            let follows = 3.6e7 * v.abs() / g;
            let at_once = f64::INFINITY;
            let expected = match name {
                "lugre" | "elasto_plastic" => [g, 60.0, c, follows, c * v.abs() / g],
                "gms of 4" | "gms of 10" => [g, 60.0, c, 1e6 / g, 0.0],
                "two_region" => [360.0 * backward, 0.0, 9000.0, at_once, 1.0],
                _ => [g, 60.0, 0.0, at_once, 1.0],
            };
            let found = [level_n, viscous_n_s_per_m, damping_n_s_per_m, rate_per_s, lead];
            for (found, expected) in found.into_iter().zip(expected) {
                let equal = found == expected || (found / expected - 1.0).abs() < 1e-13;
                assert!(equal, "{name} at {v}: {found} is {expected}");
            }
        }
    }
}

/// dg/dv = −2 (F_s − F_c) v / v_s² exp(−(v / v_s)²), and the same once more.
#[test]
fn slope_and_curvature_of_the_curve_are_exact() {
    type Bending = Dual<Dual<f64, 1>, 1>;
    for v in [1e-4, 0.03, 0.0636, 0.09, 0.2] {
        let joint = paper_joint().map(&mut |_, value| Bending::constant(value));
        let at = Dual::variable(Dual::variable(v, 0), 0);
        let force = steady(&joint, Bending::constant(0.02), at).force_n(at);
        let (share, u) = (1.0 - 0.02 / 0.1, v / 0.09);
        let bell = 90.0 * share * (-u * u).exp();
        let slope = -2.0 * u / 0.09 * bell;
        let curvature = bell * (4.0 * u * u - 2.0) / (0.09 * 0.09);
        assert!((force.derivative[0].value / slope - 1.0).abs() < 1e-13);
        assert!((force.derivative[0].derivative[0] - curvature).abs() < 1e-9, "{v}");
    }
}

#[test]
fn a_law_at_rest_has_no_steady_force() {
    for (name, joint) in laws::all(joint()) {
        assert_eq!(steady(&joint, 0.0, 0.0).force_n(0.0), 0.0, "{name}");
    }
}

#[test]
fn each_law_has_its_form_stiffness_and_breakaway_force() {
    let law = Lugre { backward_ratio: Maybe::some(0.7), ..paper_joint() };
    for (name, joint) in laws::all(law) {
        let (expected, k_e) = match name {
            "gms of 4" | "gms of 10" => (Form::Elements, 3.6e7),
            "coulomb_stiction" => (Form::Rigid, f64::INFINITY),
            _ => (Form::Bristle, 3.6e7),
        };
        assert_eq!(form(&joint), expected, "{name}");
        assert_eq!(joint.stiffness_n_per_m(), k_e, "{name}");
        // Halfway out, half of the contact area is left: equation (5).
        assert!((joint.breakaway_force(0.05) - (450.0 + 9.81) / 2.0).abs() < 1e-12, "{name}");
        assert_eq!(Joint::engagement_length_m(&joint), 0.1, "{name}");
    }
}
