//! The faster a force grows, the sooner LuGre lets go: bristles need time to yield. No seized joint is
//! known to do so, which is why the other laws are measured beside it.

mod laws;
mod support;

use breakaway_core::joint::{Joint, Lugre};
use support::Rig;

/// The largest force in N that a joint without damping opposes to one that grows by `rate` in N/s.
fn breakaway_force_n(joint: Joint<f64>, rate: f64) -> f64 {
    let mut rig = Rig::at(joint, 0.0);
    let h = (0.05 / rate).clamp(1e-6, 1e-5);
    let (mut force_n, mut largest_n) = (0.0, 0.0_f64);
    while rig.state.velocity_m_per_s < 0.05 {
        force_n += rate * h;
        largest_n = largest_n.max(rig.push(force_n, h));
    }
    largest_n
}

/// Breakaway forces in N as found, at 1e3, 1e4 and 1e5 N/s; F_s is 450 N. Elements fall short by what
/// their level has lost at the speed that they reach while the last of them lets go.
const FOUND: [(&str, [f64; 3]); 6] = [
    ("lugre", [449.04, 445.61, 431.25]),
    ("elasto_plastic", [449.11, 446.61, 439.66]),
    ("gms of 4", [450.0, 449.99, 448.97]),
    ("gms of 10", [450.0, 449.92, 448.25]),
    ("two_region", [450.0, 450.0, 450.0]),
    ("coulomb_stiction", [450.0, 450.0, 450.0]),
];

#[test]
fn breakaway_depends_on_the_loading_rate_as_found() {
    let law = Lugre { damping_n_s_per_m: 0.0, ..laws::endless() };
    for ((name, joint), (known, found)) in laws::all(law).into_iter().zip(FOUND) {
        assert_eq!(name, known);
        let forces = [1e3, 1e4, 1e5].map(|rate| breakaway_force_n(joint, rate));
        for (force, found) in forces.into_iter().zip(found) {
            assert!((force - found).abs() < 0.06, "{name}: {forces:?}");
        }
    }
}
