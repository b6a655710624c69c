//! Every kind of joint, reference, actuator, disturbance, controller and integrator, combined: a
//! miniature of the paper's loop, whose part breaks loose, slides and leaves within 4 ms.

use breakaway_batch::draws::{Stream, uniform};
use breakaway_core::actuator::{Actuator, PushOnly};
use breakaway_core::control::{
    AntiWindup, Controller, DerivativeOf, FmVibration, Gains, Pid, PulseShape, TwoStep,
    VelocityFrom, VibratingPid,
};
use breakaway_core::disturbance::{Disturbance, DisturbedQuantity, DrawLaw};
use breakaway_core::extraction::{Part, Timing};
use breakaway_core::joint::{Joint, Lugre, TwoRegion};
use breakaway_core::metrics::{Groups, Limits};
use breakaway_core::plant::Integrator;
use breakaway_core::reference::{Motion, Reference, Step, Trapezoid};
use breakaway_core::{Draws, Extraction, ExtractionState, Metrics, Real};

/// Samples that each case is run for.
pub(crate) const SAMPLES: u32 = 400;
/// Samples that a draw of the disturbance is held for.
const HOLD: u32 = 16;
/// Numbers in a state.
pub(crate) const STATE_NUMBERS: usize = 13;
/// l_f in m.
const LENGTH_M: f64 = 8e-4;
const LUGRE: Lugre<f64> = Lugre {
    stiction_n: 450.0,
    coulomb_n: 360.0,
    stiffness_n_per_m: 6e6,
    damping_n_s_per_m: 1500.0,
    viscous_n_s_per_m: Some(40.0),
    stribeck_velocity_m_per_s: 0.09,
    engagement_length_m: LENGTH_M,
    residual_n: 150.0,
};
const TWO_REGION: TwoRegion<f64> = TwoRegion {
    stiction_n: 450.0,
    coulomb_n: 360.0,
    stiffness_n_per_m: 6e6,
    damping_n_s_per_m: 1500.0,
    engagement_length_m: LENGTH_M,
    residual_n: 150.0,
};
const STEP: Step<f64> = Step { distance_m: 1e-3, start_s: 3e-4 };
const MOTION: Motion<f64> = Motion { distance_m: 1e-3, start_s: 3e-4, duration_s: 2e-3 };
const TRAPEZOID: Trapezoid<f64> = Trapezoid {
    distance_m: 1e-3,
    start_s: 3e-4,
    velocity_m_per_s: 0.7,
    acceleration_m_per_s2: 1500.0,
};
const GAINS: Gains<f64> = Gains { kp_n_per_m: 2e6, ki_n_per_m_s: 8e8, kd_n_s_per_m: 900.0 };
const PULSES: FmVibration<f64> = FmVibration {
    frequency_min_hz: 2000.0,
    frequency_max_hz: 3500.0,
    error_full_scale_m: 2e-4,
    pulse_width_s: 2e-4,
    base_fraction: 0.3,
    shape: PulseShape::Rectangular,
};

/// An extraction and what it is made of.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) extraction: Extraction<f64>,
}

/// Every PID: each combination of its options, filtered or not in turn.
fn pids() -> Vec<Pid<f64>> {
    let mut pids = Vec::new();
    for derivative_of in [DerivativeOf::Error, DerivativeOf::Measurement] {
        for velocity_from in [VelocityFrom::Sensor, VelocityFrom::PositionDifference] {
            for anti_windup in
                [AntiWindup::Off, AntiWindup::Conditional, AntiWindup::BackCalculation]
            {
                let derivative_filter_s = if pids.len() % 2 == 0 { None } else { Some(2e-5) };
                pids.push(Pid {
                    gains: GAINS,
                    derivative_of,
                    velocity_from,
                    derivative_filter_s,
                    anti_windup,
                    tracking_time_s: 1e-3,
                });
            }
        }
    }
    pids
}

/// Every controller: each PID alone, and with each shape of pulses from the start or after
/// breakaway, where the PID's options take turns.
fn controllers() -> Vec<Controller<f64>> {
    let pids = pids();
    let mut controllers: Vec<_> = pids.iter().map(|&pid| Controller::Pid(pid)).collect();
    let shapes = [PulseShape::Rectangular, PulseShape::HalfSine, PulseShape::RaisedCosine];
    for (i, shape) in shapes.into_iter().enumerate() {
        let vibration = FmVibration { shape, ..PULSES };
        controllers.push(Controller::FmVibration(VibratingPid { pid: pids[i], vibration }));
        controllers.push(Controller::TwoStep(TwoStep {
            pid: pids[5 - i],
            vibration_gains: Gains { kp_n_per_m: 3e6, ki_n_per_m_s: 5e8, kd_n_s_per_m: 700.0 },
            vibration,
            breakaway_travel_m: 1e-4,
        }));
    }
    controllers
}

/// Both integrators, with one step per period and several; the delay takes turns.
fn timings(one_sample_delay: bool) -> [Timing<f64>; 2] {
    let timing = Timing {
        control_period_s: 1e-5,
        one_sample_delay,
        integrator: Integrator::LinearlyImplicitMidpoint,
        steps_per_period: 1,
    };
    let integrator = Integrator::Rk4;
    [timing, Timing { integrator, steps_per_period: 2, ..timing }]
}

/// All cases.
pub(crate) fn all() -> Vec<Case> {
    let joints = [Joint::Lugre(LUGRE), Joint::TwoRegion(TWO_REGION)];
    let references = [
        Reference::Step(STEP),
        Reference::Ramp(MOTION),
        Reference::MinimumJerk(MOTION),
        Reference::TrapezoidalVelocity(TRAPEZOID),
    ];
    let actuators = [Actuator::Ideal, Actuator::PushOnly(PushOnly { force_max_n: 800.0 })];
    let targets = [DisturbedQuantity::JointForce, DisturbedQuantity::FrictionLevel];
    let mut cases = Vec::new();
    for joint in joints {
        for controller in controllers() {
            for reference in references {
                for actuator in actuators {
                    for acts_on in targets {
                        for timing in timings(cases.len() % 3 == 0) {
                            let disturbance = Disturbance {
                                law: DrawLaw::Uniform,
                                var: 0.15,
                                hold_s: 1.6e-4,
                                acts_on,
                            };
                            let part = Part { mass_kg: 1.0 };
                            let extraction = Extraction {
                                joint,
                                part,
                                reference,
                                disturbance,
                                actuator,
                                controller,
                                timing,
                            };
                            cases.push(Case { name: format!("{extraction:?}"), extraction });
                        }
                    }
                }
            }
        }
    }
    cases
}

/// A case without switches: LuGre friction under a PID, pulled slowly at first.
pub(crate) fn smooth() -> Case {
    let mut cases = all().into_iter();
    let smooth = |case: &Case| {
        let e = &case.extraction;
        e.actuator == Actuator::Ideal
            && e.timing == timings(false)[0]
            && e.reference == Reference::MinimumJerk(MOTION)
            && e.disturbance.acts_on == DisturbedQuantity::JointForce
    };
    cases.find(smooth).expect("it is among the cases")
}

/// The limits of all cases.
pub(crate) fn limits() -> Limits<f64> {
    Limits {
        diverged_error_m: 5e-3,
        diverged_force_n: 9000.0,
        release_position_m: LENGTH_M,
        breakaway_travel_m: 1.5e-4,
        peak_force_max_n: f64::INFINITY,
        jump_max_m: f64::INFINITY,
        release_velocity_max_m_per_s: f64::INFINITY,
    }
}

/// The same extraction with every number moved by up to 10 %, differently for each lane.
pub(crate) fn varied(extraction: &Extraction<f64>, lane: u64) -> Extraction<f64> {
    let mut field = 0;
    extraction.map(&mut |_, value| {
        field += 1;
        value * (1.0 + 0.1 * uniform(11, lane, Stream::Disturbance, field))
    })
}

/// The held draw of a lane at a sample; never zero.
pub(crate) fn draw(lane: u64, sample: u32) -> f64 {
    uniform(5, lane, Stream::Disturbance, sample / HOLD)
}

/// A run under way, in any number.
#[derive(Clone, Debug)]
pub(crate) struct Run<R> {
    pub(crate) extraction: Extraction<R>,
    pub(crate) limits: Limits<R>,
    pub(crate) state: ExtractionState<R>,
    pub(crate) metrics: Metrics<R>,
}

impl<R: Real> Run<R> {
    /// At rest, with the extraction's numbers and the limits cast by `cast`.
    pub(crate) fn new(
        extraction: &Extraction<f64>,
        cast: &mut impl FnMut(&'static str, f64) -> R,
    ) -> Self {
        Self {
            extraction: extraction.map(cast),
            limits: limits().map(cast),
            state: ExtractionState::at_rest(),
            metrics: Metrics::new(),
        }
    }

    /// The step that all five numbers take.
    pub(crate) fn step(&mut self, disturbance: R) {
        let sample = self.extraction.step(&mut self.state, Draws { disturbance });
        self.metrics.update(Groups::ALL, &self.limits, &sample);
    }

    /// Everything that moves, with its name: first the state, then the metrics.
    pub(crate) fn moving(&self) -> Vec<(&'static str, R)> {
        let mut numbers = Vec::with_capacity(40);
        self.state.map(&mut |name, value| numbers.push((name, value)));
        self.metrics.map(&mut |name, value| numbers.push((name, value)));
        numbers
    }
}

/// Panics where two numbers differ in a bit, unless both are not a number.
pub(crate) fn assert_same(context: &str, name: &str, sample: u32, ours: f64, scalar: f64) {
    let same = ours.to_bits() == scalar.to_bits() || (ours.is_nan() && scalar.is_nan());
    assert!(same, "{name} at sample {sample} is {ours:e}, for f64 {scalar:e}, in {context}");
}
