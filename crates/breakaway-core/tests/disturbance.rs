//! What a disturbance multiplies decides whether it can free a stuck joint by itself.

mod support;

use breakaway_core::Draws;
use breakaway_core::disturbance::{Disturbance, DisturbedQuantity, DrawLaw};
use breakaway_core::joint::Joint;
use breakaway_core::test_models::paper_joint;
use support::Rig;

/// Travel in m, and when it came free in s, of a part under a constant push in N for 4 s, with
/// var = 0.3 redrawn every millisecond.
fn push(acts_on: DisturbedQuantity, force_n: f64) -> (f64, Option<f64>) {
    let disturbance = Disturbance { law: DrawLaw::Uniform, var: 0.3, hold_s: 1e-3, acts_on };
    let mut rig = Rig::at(Joint::Lugre(paper_joint()), 0.0);
    let (mut random, mut draw) = (1, 0.0);
    for n in 0..400_000 {
        if n % 100 == 0 {
            draw = uniform(&mut random);
        }
        rig.push_disturbed(
            force_n,
            1e-5,
            disturbance.factors(Draws { disturbance: draw, ..Draws::none() }),
        );
        if rig.state.position_m > 0.1 {
            return (rig.state.position_m, Some(f64::from(n) * 1e-5));
        }
    }
    (rig.state.position_m, None)
}

/// Uniform on [-1, 1): SplitMix64.
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 * 2.0_f64.powi(-52) - 1.0
}

/// A redraw of the whole joint force also changes what the bristles hold at this moment. The part
/// jumps to a new balance, the bristles yield a little, and after thousands of jolts it has walked
/// off, although at half of F_s0 even the weakest draw, 0.7 F_s0, would hold it.
#[test]
fn a_disturbed_joint_force_walks_a_stuck_part_out() {
    // Found: 5.2 mm, 415 times the presliding travel; and two thirds of F_s0 free it in 3.3 s.
    let (travel, freed) = push(DisturbedQuantity::JointForce, 225.0);
    assert!((4e-3..7e-3).contains(&travel) && freed.is_none(), "{travel:e} {freed:?}");
    let (_, freed) = push(DisturbedQuantity::JointForce, 300.0);
    assert!(freed.is_some_and(|time| (2.0..4.0).contains(&time)), "{freed:?}");
}

/// A redraw of the friction level alone leaves a stuck part at rest where the force fell short: it
/// stays within its presliding travel.
#[test]
fn a_disturbed_friction_level_leaves_it_stuck() {
    for force_n in [225.0, 300.0] {
        let (travel, freed) = push(DisturbedQuantity::FrictionLevel, force_n);
        let presliding = 450.0 / 3.6e7;
        assert!(travel > 0.0 && travel < 1.5 * presliding && freed.is_none(), "{travel:e}");
    }
}
