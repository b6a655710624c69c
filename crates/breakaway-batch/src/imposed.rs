//! A joint whose motion is imposed, as on a friction test rig.

use breakaway_core::imposed::impose_motion;
use breakaway_core::joint::Joint;
use breakaway_core::plant::PlantState;

/// What an imposed motion gave, one value for each step.
#[derive(Clone, Debug, Default)]
pub struct ImposedMotion {
    /// x in m at the middle of each step.
    pub position_m: Vec<f64>,
    /// z in m after each step.
    pub bristle_m: Vec<f64>,
    /// R in N at the middle of each step.
    pub joint_force_n: Vec<f64>,
}

/// Moves a relaxed joint from position `start_m` with the given velocities in m/s, each held for
/// `period_s`.
///
/// # Example
/// ```
/// use breakaway_batch::imposed_motion;
/// use breakaway_core::{joint::Joint, test_models::paper_joint};
/// // Sliding at 0.3 m/s long enough: friction is at the Coulomb level of equation (6).
/// let motion = imposed_motion(&Joint::Lugre(paper_joint()), 0.0, 1e-5, &[0.3; 1000]);
/// let coulomb_n = 360.0 + (9.81 - 360.0) * motion.position_m[999] / 0.1;
/// assert!((motion.joint_force_n[999] - coulomb_n).abs() < 0.01 * coulomb_n);
/// ```
#[must_use]
pub fn imposed_motion(
    joint: &Joint<f64>,
    start_m: f64,
    period_s: f64,
    velocities_m_per_s: &[f64],
) -> ImposedMotion {
    let mut state = PlantState { position_m: start_m, ..PlantState::at_rest() };
    let mut motion = ImposedMotion::default();
    for &v in velocities_m_per_s {
        motion.position_m.push(state.position_m + 0.5 * period_s * v);
        motion.joint_force_n.push(impose_motion(joint, &mut state, v, period_s));
        motion.bristle_m.push(state.bristle_m);
    }
    motion
}
