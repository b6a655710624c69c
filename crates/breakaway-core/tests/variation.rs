//! Friction that varies: along the way, with the time, with the normal force.

use breakaway_core::disturbance::Factors;
use breakaway_core::joint::{ElastoPlastic, Joint, Law, Lugre};
use breakaway_core::plant::{Integrator, Plant, PlantState, Push};
use breakaway_core::test_models::paper_joint;
use breakaway_core::variation::{
    Course, Field, FieldCell, FieldKeys, FieldLaw, NormalForce, NormalVibration, Over,
    TransverseVibration, Variation,
};
use breakaway_core::{Dual, Maybe, Real};

const LAWS: [FieldLaw; 3] = [FieldLaw::Bounded, FieldLaw::Gaussian, FieldLaw::LogNormal];

fn field(law: FieldLaw) -> Field<f64> {
    let keys = FieldKeys { first: 20_260_101.0, second: -3_141_592.0, offset: 0.37 };
    Field { law, var: 0.2, correlation_length_m: 1e-3, keys }
}

fn at(field: &Field<f64>, x: f64) -> f64 {
    field.factor(&mut FieldCell::nowhere(), x)
}

#[test]
fn a_field_is_the_same_wherever_one_comes_from() {
    for law in LAWS {
        let field = field(law);
        let mut cell = FieldCell::nowhere();
        let mut x = 0.0;
        for n in 0..20_000_u32 {
            x += 3e-6 * f64::from(n % 7) - 8e-6 * f64::from(u8::from(n % 11 == 0));
            assert_eq!(field.factor(&mut cell, x), at(&field, x), "{law:?} at {x}");
        }
    }
}

#[test]
fn its_slope_is_exact_and_continuous() {
    for law in LAWS {
        let field = field(law);
        let exact = field.map(&mut |_, value| Dual::<f64, 1>::constant(value));
        let mut last: Option<f64> = None;
        for n in 0..40_000_u32 {
            let x = 0.02 + 1e-7 * f64::from(n);
            let found = exact.factor(&mut FieldCell::nowhere(), Dual::variable(x, 0));
            assert_eq!(found.value, at(&field, x));
            let by_difference = (at(&field, x + 1e-8) - at(&field, x - 1e-8)) / 2e-8;
            // 1e-8 m of the largest curvature, and of a jump of the curvature between cells.
            assert!((found.derivative[0] - by_difference).abs() < 0.02, "{law:?} at {x}");
            if let Some(last) = last {
                assert!((found.derivative[0] - last).abs() < 0.4, "{law:?} at {x}");
            }
            last = Some(found.derivative[0]);
        }
    }
}

#[test]
fn a_level_stays_above_zero() {
    for (law, var, low, high) in [
        (FieldLaw::Bounded, 0.999, 0.0, 2.0),
        (FieldLaw::Gaussian, 0.2, 0.0, 2.0),
        (FieldLaw::LogNormal, 0.9, 0.0, 40.0),
    ] {
        let field = Field { var, ..field(law) };
        for n in 0..200_000_u32 {
            let factor = at(&field, 1e-3 * 0.317 * f64::from(n));
            assert!(low < factor && factor < high, "{law:?} {factor}");
        }
    }
}

#[test]
fn a_course_goes_along_straight_lines_and_stays_at_its_ends() {
    let (mut at, mut values) = ([0.0; 8], [0.0; 8]);
    (at[0], at[1], at[2]) = (1.0, 2.0, 4.0);
    (values[0], values[1], values[2]) = (1.0, 3.0, -1.0);
    let course = Course { over: Over::Time, points: 3, at, values };
    for (t, expected) in [(0.0, 1.0), (1.0, 1.0), (1.5, 2.0), (2.0, 3.0), (3.0, 1.0), (9.0, -1.0)] {
        assert!((course.at(77.0, t) - expected).abs() < 1e-14, "{t}");
    }
    let travel = Course { over: Over::Travel, ..course };
    assert!((travel.at(1.5, 77.0) - 2.0).abs() < 1e-14);
}

fn constant_force(nominal_n: f64) -> NormalForce<f64> {
    NormalForce {
        nominal_n,
        constant_n: nominal_n,
        course_gain: 0.0,
        course: None,
        vibration: None,
        transverse: None,
    }
}

#[test]
fn bodies_that_part_carry_nothing() {
    let vibration = NormalVibration {
        amplitude_m: 3e-6,
        stiffness_n_per_m: 1e9,
        frequency_hz: 50.0,
        phase_turns: 0.0,
    };
    let normal = NormalForce { vibration: Some(vibration), ..constant_force(1000.0) };
    assert!((normal.share(0.0, 5e-3) - 4.0).abs() < 1e-12); // a quarter of a cycle: 1000 + 3000 N
    assert_eq!(normal.share(0.0, 15e-3), 1e-9);
}

fn stepped(
    joint: &Joint<f64>,
    variation: &Variation<f64>,
    integrator: Integrator,
    h: f64,
) -> PlantState<f64> {
    let mut state = PlantState::at_rest();
    let factors = Factors { joint_force: 1.0, friction_level: 1.0 };
    for n in 0..(0.02 / h).round() as u32 {
        let t = f64::from(n) * h;
        let push = Push::rigid(40e3 * (t + 0.5 * h));
        Plant { joint, mass_kg: 1.0, push, factors, variation }.step(integrator, &mut state, t, h);
    }
    state
}

/// Midpoint and Runge-Kutta converge on the same motion, the midpoint by the square of the step.
#[test]
fn varying_levels_keep_the_order_of_the_step() {
    let joint = Joint::Lugre(paper_joint());
    let (mut at, mut values) = ([0.0; 8], [0.0; 8]);
    (at[1], values[0], values[1]) = (0.02, 1.0, 0.8);
    let vibration = NormalVibration {
        amplitude_m: 1e-6,
        stiffness_n_per_m: 1e8,
        frequency_hz: 400.0,
        phase_turns: 0.1,
    };
    let variation = Variation {
        field: Some(field(FieldLaw::LogNormal)),
        drift: Some(Course { over: Over::Time, points: 2, at, values }),
        normal_force: Some(NormalForce { vibration: Some(vibration), ..constant_force(2000.0) }),
    };
    let exact = stepped(&joint, &variation, Integrator::Rk4, 1e-7);
    let error = |h| {
        let found = stepped(&joint, &variation, Integrator::LinearlyImplicitMidpoint, h);
        (found.position_m - exact.position_m).abs()
    };
    let (coarse, fine) = (error(4e-6), error(1e-6));
    assert!(exact.position_m > 1e-3, "{}", exact.position_m);
    assert!(fine < 1e-6 * exact.position_m, "{fine:e}");
    assert!(coarse / fine > 10.0 && coarse / fine < 24.0, "{coarse:e} {fine:e}");
}

/// Levels that are μ N: twice the force across breaks loose at twice the push.
#[test]
fn breakaway_goes_with_the_normal_force() {
    let variation = |n| Variation {
        normal_force: Some(NormalForce { constant_n: n, ..constant_force(1000.0) }),
        ..Variation::none()
    };
    let joint = Joint::Lugre(Lugre { damping_n_s_per_m: 0.0, ..paper_joint() });
    let loose = |n: f64, push_n: f64| {
        let (mut state, variation) = (PlantState::at_rest(), variation(n));
        let factors = Factors { joint_force: 1.0, friction_level: 1.0 };
        for k in 0..200_000_u32 {
            let (t, h) = (f64::from(k) * 1e-5, 1e-5);
            let push = Push::rigid(push_n * (2.0 * t).min(1.0));
            Plant { joint: &joint, mass_kg: 1.0, push, factors, variation: &variation }.step(
                Integrator::LinearlyImplicitMidpoint,
                &mut state,
                t,
                h,
            );
        }
        state.position_m > 0.01
    };
    for n in [500.0, 1000.0, 2000.0] {
        let level = joint.breakaway_force(0.0) * n / 1000.0;
        assert!(!loose(n, 0.98 * level) && loose(n, 1.005 * level), "{n}");
    }
}

/// Fast vibration across the motion leaves v / √(v² + v_y²) of the friction along it, at each moment,
/// once the bristles have settled: here v_y is nearly constant while they settle.
#[test]
fn friction_across_the_motion_is_a_vector() {
    let lugre = Lugre { stiction_n: 360.0, damping_n_s_per_m: 0.0, ..paper_joint() };
    let transverse = TransverseVibration { amplitude_m: 0.05, frequency_hz: 1.0, phase_turns: 0.0 };
    let normal = NormalForce { transverse: Some(transverse), ..constant_force(1000.0) };
    let variation = Variation { normal_force: Some(normal), ..Variation::none() };
    let elastic = ElastoPlastic { friction: lugre, elastic_share: 0.9 };
    for joint in [Joint::Lugre(lugre), Joint::ElastoPlastic(elastic)] {
        let v = 0.2;
        let factors = Factors { joint_force: 1.0, friction_level: 1.0 };
        let mut state = PlantState { velocity_m_per_s: v, ..PlantState::at_rest() };
        let mut force_n = 0.0;
        for k in 0..3000_u32 {
            // A heavy part goes on at its speed.
            let plant = Plant {
                joint: &joint,
                mass_kg: 1e5,
                push: Push::rigid(0.0),
                factors,
                variation: &variation,
            };
            let t = f64::from(k) * 1e-6;
            force_n =
                plant.step(Integrator::LinearlyImplicitMidpoint, &mut state, t, 1e-6).joint_force_n;
        }
        let level = joint.friction_level(state.position_m, 0.0, 1.0);
        let v_y = variation.transverse_m_per_s(3e-3);
        let across = v_y.get().copied().unwrap_or(f64::NAN);
        let expected = level * v / v.hypot(across);
        assert!((force_n / expected - 1.0).abs() < 1e-3, "{force_n} {expected}");
    }
    let none: Maybe<f64> = Variation::none().transverse_m_per_s(0.0);
    assert!(none.is_none());
}
