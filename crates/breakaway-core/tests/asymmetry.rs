//! Levels that differ between the directions: backward ones are a multiple of the forward ones.

mod laws;
mod support;

use breakaway_core::Maybe;
use breakaway_core::imposed::impose_motion;
use breakaway_core::joint::Lugre;
use breakaway_core::plant::PlantState;
use support::Rig;

/// What backward levels are multiplied by.
const RATIO: f64 = 0.6;

fn asymmetric() -> Lugre<f64> {
    Lugre { backward_ratio: Maybe::some(RATIO), ..laws::endless() }
}

/// Sliding at a speed at which the Stribeck curve has fallen to F_c, joints carry ± their level.
#[test]
fn sliding_backward_they_carry_a_multiple() {
    for (name, joint) in laws::all_with_backward_ratio(asymmetric()) {
        for (v, level) in [(0.5, 360.0), (-0.5, -360.0 * RATIO)] {
            let mut state = PlantState::at_rest();
            let force = (0..10_000).fold(0.0, |_, _| impose_motion(&joint, &mut state, v, 1e-6));
            let error = (force / level - 1.0).abs();
            assert!(error < 1e-8, "{name} at {v}: {force}");
        }
    }
}

/// Held at 97 % of the level of the direction they stay, at 103 % they go.
#[test]
fn they_break_loose_at_the_level_of_the_direction() {
    for (name, joint) in laws::all_with_backward_ratio(asymmetric()) {
        for breakaway_n in [450.0, -450.0 * RATIO] {
            let speed = |share: f64| {
                let mut rig = Rig::at(joint, 0.0);
                for n in 0..100_000 {
                    rig.push(share * breakaway_n * (f64::from(n) / 8e4).min(1.0), 1e-5);
                }
                rig.state.velocity_m_per_s / breakaway_n.signum()
            };
            let (below, above) = (speed(0.97), speed(1.03));
            assert!(below.abs() < 1e-9 && above > 0.1, "{name}: {below:e} {above:e}");
        }
    }
}

/// A ratio of one is no ratio, to the bit.
#[test]
fn a_ratio_of_one_changes_nothing() {
    let law = laws::endless();
    let twins = laws::all(Lugre { backward_ratio: Maybe::some(1.0), ..law });
    for ((name, plain), (_, ratio)) in laws::all(law).into_iter().zip(twins) {
        let [plain, ratio] = [plain, ratio].map(|joint| {
            let mut rig = Rig::at(joint, 0.0);
            (0..20_000).for_each(|n| _ = rig.push(600.0 * (f64::from(n) * 1e-3).sin(), 1e-5));
            rig.state
        });
        assert_eq!(plain, ratio, "{name}");
    }
}
