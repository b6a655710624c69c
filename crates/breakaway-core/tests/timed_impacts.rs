//! Timed impacts, shown positions that are made up: what they learn from a slip.

use breakaway_core::actuator::ForceRange;
use breakaway_core::control::{Control, Measurement, TimedImpacts, TimedImpactsState};

const PERIOD_S: f64 = 5e-5;
const IMPACTS: TimedImpacts<f64> = TimedImpacts {
    travel_m: 0.1,
    target_s: 5.0,
    force_start_n: 300.0,
    search_time_constant_s: 60e-3,
    rise_time_constant_s: 30e-3,
    rise_min_s: 5e-3,
    rise_per_slip: 28.0,
    slowing_m_per_s: 0.004,
    holding_m_per_s: 0.01,
    step_min_m: 30e-6,
    step_max_m: 100e-6,
    travel_min_m: 3e-6,
    restart_ratio: 0.9,
    probe_ratio: 0.025,
    breakaway_share: 0.2,
    dwell_from_ratio: 2.0,
    dwell_step_s: 0.0,
    dwell_max_s: 0.0,
    dwell_kept_share: 0.9,
    rough_slip_m: 150e-6,
    rough_cut_ratio: 0.1,
    patience_s: 0.6,
    patience_max_s: 3.2,
    caution_per_s: 0.1,
    low_force_ratio: 0.3,
    low_step_ratio: 0.6,
    latest_s: 9.0,
    coast_min_s: 1e-3,
    settled_m: 2e-6,
    lead_start_s: 1e-3,
    lead_min_s: 1e-4,
    lead_max_s: 4e-3,
    noise_rms_m: 0.0,
    noise_margin: 1.0,
    free_margin_m: 3e-6,
    actuator_lag_s: 1.6e-4,
};

/// Impacts at a part that does what it is told.
struct Rig {
    state: TimedImpactsState<f64>,
    position_m: f64,
    force_n: f64,
}

impl Rig {
    fn new() -> Self {
        Self { state: TimedImpactsState::at_rest(), position_m: 0.0, force_n: 0.0 }
    }

    fn show(&mut self, position_m: f64) {
        self.position_m = position_m;
        let measured = Measurement {
            reference_m: 0.0,
            reference_rate_m_per_s: 0.0,
            position_m,
            velocity_m_per_s: 0.0,
            force_n: 0.0,
            period_s: PERIOD_S,
            range: ForceRange { min_n: 0.0, max_n: 8000.0 },
        };
        self.force_n = IMPACTS.step(&mut self.state, &measured).force_n;
    }

    /// The part goes this far at this speed, and back, and rests until the next impact begins.
    fn slips(&mut self, way_m: f64, speed_m_per_s: f64, back_m: f64) {
        let from = self.position_m;
        let samples = (way_m / (speed_m_per_s * PERIOD_S)).round();
        for n in 1..=samples as u32 {
            self.show(from + way_m * f64::from(n) / samples);
        }
        let rests_at = from + way_m - back_m;
        for _ in 0..200 {
            self.show(rests_at);
            if self.state.numbers.coasting == 0.0 {
                return;
            }
        }
        panic!("it never rested");
    }

    /// The first impact, which finds the part: F_b and the first ceiling.
    fn found(way_m: f64, speed_m_per_s: f64) -> Self {
        let mut rig = Self::new();
        (0..400).for_each(|_| rig.show(0.0));
        rig.slips(way_m, speed_m_per_s, 0.0);
        rig
    }
}

/// τ of the next rise, by its growth in a sample: F (1 + T_s/τ).
fn rise_s(rig: &mut Rig) -> f64 {
    let before = rig.force_n;
    rig.show(rig.position_m);
    PERIOD_S / (rig.force_n / before - 1.0)
}

/// A slip of 100 µm at 0.2 m/s takes 0.5 ms, and τ is 28 times that; at 0.01 m/s it would be 280 ms,
/// and is the largest. One that is over within a sample seems to take two, which would be 2.8 ms, and is
/// the smallest.
#[test]
fn an_impact_rises_as_quickly_as_its_part_slips() {
    for (speed_m_per_s, expected_s) in [(0.2, 14e-3), (0.01, 30e-3), (2.0, 5e-3)] {
        let mut rig = Rig::found(100e-6, speed_m_per_s);
        let found_s = rise_s(&mut rig);
        assert!((found_s / expected_s - 1.0).abs() < 1e-9, "{speed_m_per_s} m/s: {found_s} s");
    }
}

/// Of two impacts that end alike since the part seems to slip 40 µm, the one after which it stays lowers
/// the ceiling towards its own peak, and sets the time of a slip; the other, after which it is back,
/// leaves both, and only the step counts.
#[test]
fn a_part_that_comes_back_has_not_slipped() {
    let after = |back_m: f64| {
        let mut rig = Rig::found(100e-6, 0.2);
        let before = rig.state.numbers;
        rig.slips(40e-6, 0.4, back_m);
        (before, rig.state.numbers)
    };
    let correction = |step_m: f64| 1.0 + 0.025 * ((step_m - 40e-6) / step_m).clamp(-3.0, 1.0);
    let (before, back) = after(40e-6);
    let expected = before.ceiling_n * correction(before.step_m);
    assert!((back.ceiling_n / expected - 1.0).abs() < 1e-12, "{} {expected}", back.ceiling_n);
    assert_eq!(back.slip_s, before.slip_s);
    let (before, stayed) = after(0.0);
    let unmoved = before.ceiling_n * correction(before.step_m);
    assert!(stayed.ceiling_n < 0.95 * unmoved, "{} {unmoved}", stayed.ceiling_n);
    let expected = before.slip_s + 0.2 * (40e-6 / 0.4 - before.slip_s);
    assert!((stayed.slip_s / expected - 1.0).abs() < 1e-9, "{} {expected}", stayed.slip_s);
}

/// With 0.1 m to go at 8.9 s, being out at 9 s takes more than the largest step: as much as is rough.
/// Of slips of 200 µm, one that is asked for 150 µm is not rough, up to 1.5 times 150 µm; one that is asked
/// for 100 µm is.
#[test]
fn a_part_that_is_late_makes_larger_steps() {
    let mut rig = Rig::found(100e-6, 0.2);
    rig.state.numbers.elapsed_s = 8.9;
    rig.slips(60e-6, 0.2, 0.0);
    assert!((rig.state.numbers.step_m / 150e-6 - 1.0).abs() < 1e-12);
    let put_off_s = rig.state.numbers.put_off_s;
    rig.slips(200e-6, 0.2, 0.0);
    assert_eq!(rig.state.numbers.put_off_s, put_off_s);
    let mut early = Rig::found(100e-6, 0.2);
    early.slips(200e-6, 0.2, 0.0);
    assert_eq!(early.state.numbers.put_off_s, 0.6);
}
