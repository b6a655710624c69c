//! Every kind of joint, reference, actuator, disturbance, controller and integrator, combined: a
//! miniature of the paper's loop, whose part breaks loose, slides and leaves within 4 ms.

use breakaway_batch::draws::{Stream, noise, uniform};
use breakaway_core::actuator::{Actuator, Contact, FeedAxis, ForceActuator, Piezo, PushOnly, Tip};
use breakaway_core::control::{
    AntiWindup, Controller, DerivativeOf, FirstStep, FmVibration, ForceRamp, Gains, Pid,
    PulseShape, SecondStep, StackPulses, SteadyFeed, TimedImpacts, TwoStep, VelocityFrom,
    VibratedFeed, VibratingPid, Watch,
};
use breakaway_core::disturbance::{Disturbance, DisturbedQuantity, DrawLaw};
use breakaway_core::extraction::{Part, Timing};
use breakaway_core::joint::{
    CoulombStiction, ElastoPlastic, Gms, Joint, Lugre, TwoRegion, default_shares,
};
use breakaway_core::metrics::{Groups, Limits};
use breakaway_core::plant::Integrator;
use breakaway_core::reference::{Motion, Reference, Step, Trapezoid};
use breakaway_core::sensor::{Noise, Sensor, Sensors};
use breakaway_core::variation::{
    Course, Field, FieldKeys, FieldLaw, NormalForce, NormalVibration, Over, TransverseVibration,
    Variation,
};
use breakaway_core::{Draws, Extraction, ExtractionState, Maybe, Metrics, Name, Real};

/// Samples that each case is run for.
pub(crate) const SAMPLES: u32 = 400;
/// Samples that a draw of the disturbance is held for.
const HOLD: u32 = 16;
/// l_f in m.
const LENGTH_M: f64 = 8e-4;
fn lugre() -> Lugre<f64> {
    Lugre {
        stiction_n: 450.0,
        coulomb_n: 360.0,
        stiffness_n_per_m: 6e6,
        damping_n_s_per_m: 1500.0,
        viscous_n_s_per_m: Maybe::some(40.0),
        stribeck_velocity_m_per_s: 0.09,
        engagement_length_m: LENGTH_M,
        residual_n: 150.0,
        damping_velocity_m_per_s: Maybe::none(),
        backward_ratio: Maybe::none(),
    }
}
fn two_region() -> TwoRegion<f64> {
    TwoRegion {
        stiction_n: 450.0,
        coulomb_n: 360.0,
        stiffness_n_per_m: 6e6,
        damping_n_s_per_m: 1500.0,
        engagement_length_m: LENGTH_M,
        residual_n: 150.0,
        backward_ratio: Maybe::none(),
    }
}
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
                let derivative_filter_s =
                    if pids.len() % 2 == 0 { Maybe::none() } else { Maybe::some(2e-5) };
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
        let gains = Gains { kp_n_per_m: 3e6, ki_n_per_m_s: 5e8, kd_n_s_per_m: 700.0 };
        let pid = Pid { gains, ..pids[4 - i] };
        let ramp = FirstStep::ForceRamp(ForceRamp { rate_n_per_s: 1.4e6, travel_m: LENGTH_M });
        let pulses = SecondStep::FmVibration(VibratingPid { pid, vibration });
        let (breakaway, vibration) = match i {
            0 => (FirstStep::Pid(pids[5]), pulses),
            1 => (ramp, pulses),
            _ => (ramp, SecondStep::TimedImpacts(IMPACTS)),
        };
        let breakaway_travel_m = 2e-4;
        controllers.push(Controller::TwoStep(TwoStep { breakaway, vibration, breakaway_travel_m }));
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

/// LuGre with every option, and the laws that are not in the full product.
fn more_joints() -> Vec<Joint<f64>> {
    let friction = Lugre {
        damping_velocity_m_per_s: Maybe::some(0.4),
        backward_ratio: Maybe::some(0.7),
        ..lugre()
    };
    let (stiffness_shares, level_shares) = default_shares(5);
    let gms =
        Gms { friction, attraction_n_per_s: 2e6, elements: 5, stiffness_shares, level_shares };
    let (stiffness_shares, level_shares) = default_shares(10);
    let plain = Gms { friction: lugre(), elements: 10, stiffness_shares, level_shares, ..gms };
    vec![
        Joint::Lugre(friction),
        Joint::TwoRegion(TwoRegion { backward_ratio: Maybe::some(0.7), ..two_region() }),
        Joint::ElastoPlastic(ElastoPlastic { friction, elastic_share: 0.6 }),
        Joint::Gms(gms),
        Joint::Gms(plain),
        Joint::CoulombStiction(CoulombStiction {
            stiction_n: 450.0,
            coulomb_n: 360.0,
            viscous_n_s_per_m: Maybe::some(40.0),
            stribeck_velocity_m_per_s: 0.09,
            engagement_length_m: LENGTH_M,
            residual_n: 150.0,
            backward_ratio: Maybe::some(0.7),
        }),
    ]
}

/// [`more_joints`] under a few of the controllers of other cases.
fn more_cases(cases: &[Case]) -> Vec<Case> {
    let midpoint = |case: &&Case| {
        let timing = case.extraction.timing;
        timing.integrator == Integrator::LinearlyImplicitMidpoint
    };
    let some: Vec<_> = cases.iter().filter(midpoint).step_by(71).take(MORE_PER_JOINT).collect();
    let under = |joint| some.iter().map(move |case| Extraction { joint, ..case.extraction });
    let extractions = more_joints().into_iter().flat_map(under);
    extractions.map(|extraction| Case { name: format!("{extraction:?}"), extraction }).collect()
}

/// Cases of each of [`more_joints`].
const MORE_PER_JOINT: usize = 5;

/// All cases.
pub(crate) fn all() -> Vec<Case> {
    let joints = [Joint::Lugre(lugre()), Joint::TwoRegion(two_region())];
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
                                variation: Variation::none(),
                                disturbance,
                                actuator,
                                sensors: None,
                                watch: None,
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
    let more = more_cases(&cases);
    let pushed = pushed_cases(&cases);
    cases.extend(more);
    cases.extend(pushed);
    cases
}

const STACK: Piezo<f64> = Piezo {
    stroke_m: 38e-6,
    stiffness_n_per_m: 1e8,
    tip_mass_kg: 0.05,
    damping_n_s_per_m: 400.0,
    hysteresis_share: 0.4,
    preload_n: 800.0,
    capacitance_f: 13e-6,
    loss_tangent: 0.02,
    voltage_max_v: 120.0,
    current_max_a: 20.0,
    amplifier_bandwidth_hz: 5000.0,
};
fn axis() -> FeedAxis<f64> {
    FeedAxis {
        speed_max_m_per_s: 0.4,
        acceleration_max_m_per_s2: 800.0,
        stiffness_n_per_m: 3e7,
        damping_n_s_per_m: 8e3,
        tool_mass_kg: 1.0,
        tip: Tip::Rigid,
        contact: Contact {
            stiffness_n_per_m: 5e7,
            damping_n_s_per_m: 3e3,
            gap_m: 1e-6,
            backlash_m: Maybe::none(),
        },
    }
}
const FORCE: Actuator<f64> = Actuator::Force(ForceActuator {
    force_max_n: 900.0,
    bandwidth_hz: 4000.0,
    force_rate_max_n_per_s: 3e6,
});
/// Bandwidth, steps and delay of every kind; noise small enough for a part to be watched by.
fn sensors() -> Sensors<f64> {
    Sensors {
        position: Sensor {
            noise_rms: 1e-8,
            quantum: Maybe::some(1e-8),
            bandwidth_hz: Maybe::some(2e4),
            delay_samples: 1,
        },
        force: Sensor {
            noise_rms: 1.0,
            quantum: Maybe::none(),
            bandwidth_hz: Maybe::none(),
            delay_samples: 0,
        },
    }
}
/// Trusts what these parts do.
const WATCH: Watch<f64> = Watch { jump_max_m: 1e-4, frozen_max_s: f64::INFINITY };
/// Takes the faster ones of these parts for a jump.
const NERVOUS: Watch<f64> = Watch { jump_max_m: 6e-6, frozen_max_s: 1e-3 };

/// Impacts as fast as these parts.
const IMPACTS: TimedImpacts<f64> = TimedImpacts {
    travel_m: LENGTH_M,
    target_s: 4e-3,
    force_start_n: 310.0,
    search_time_constant_s: 5e-4,
    rise_time_constant_s: 3e-4,
    rise_min_s: 2e-4,
    rise_per_slip: 0.6,
    slowing_m_per_s: 0.2,
    holding_m_per_s: 0.6,
    step_min_m: 2e-4,
    step_max_m: 9e-4,
    travel_min_m: 1.2e-4,
    restart_ratio: 0.6,
    probe_ratio: 0.06,
    breakaway_share: 0.3,
    dwell_from_ratio: 0.9,
    dwell_step_s: 5e-5,
    dwell_max_s: 2e-4,
    dwell_kept_share: 0.9,
    rough_slip_m: 6e-4,
    rough_cut_ratio: 0.1,
    patience_s: 1e-4,
    patience_max_s: 1e-3,
    caution_per_s: 100.0,
    low_force_ratio: 0.1,
    low_step_ratio: 0.9,
    latest_s: 6e-3,
    coast_min_s: 1e-4,
    settled_m: 1e-5,
    lead_start_s: 1e-4,
    lead_min_s: 1e-5,
    lead_max_s: 1e-3,
    noise_rms_m: 1e-8,
    noise_margin: 2.0,
    free_margin_m: 3e-6,
    actuator_lag_s: 4e-5,
};

/// What can push, with what may push it, what it sees and who watches.
type Pushed = (Actuator<f64>, Controller<f64>, Option<Sensors<f64>>, Option<Watch<f64>>);

fn pushed() -> Vec<Pushed> {
    let ramp = Controller::ForceRamp(ForceRamp { rate_n_per_s: 3e5, travel_m: LENGTH_M });
    let settings = SteadyFeed { speed_m_per_s: 0.35, approach_m_per_s: 0.02, approach_s: 2e-4 };
    let feed = Controller::SteadyFeed(settings);
    let pulses = StackPulses {
        frequency_hz: 2500.0,
        pulse_width_s: 2e-4,
        amplitude_ratio: 0.7,
        stack_force_n: 2000.0,
        force_filter_s: 1e-4,
    };
    let vibrated = Controller::VibratedFeed(VibratedFeed { feed: settings, pulses });
    let stacked = Actuator::FeedAxis(FeedAxis { tip: Tip::Piezo(STACK), ..axis() });
    let contact = Contact { backlash_m: Maybe::some(4e-6), ..axis().contact };
    let gripping = Actuator::FeedAxis(FeedAxis { tip: Tip::Piezo(STACK), contact, ..axis() });
    let shared = |controllers: &[Controller<f64>]| controllers[0];
    let pid = shared(&controllers()[3..]);
    let pulsed = shared(&controllers()[12..]);
    let (seen, watch) = (Some(sensors()), Some(WATCH));
    let push_only = Actuator::PushOnly(PushOnly { force_max_n: 800.0 });
    vec![
        (FORCE, pid, None, None),
        (FORCE, pulsed, seen, None),
        (FORCE, ramp, seen, watch),
        (FORCE, Controller::TimedImpacts(IMPACTS), None, None),
        (push_only, Controller::TimedImpacts(IMPACTS), seen, watch),
        (Actuator::Ideal, ramp, None, watch),
        (Actuator::Ideal, pid, seen, watch),
        (Actuator::FeedAxis(axis()), feed, None, None),
        (Actuator::FeedAxis(axis()), feed, seen, watch),
        (stacked, feed, None, None),
        (stacked, vibrated, None, None),
        (stacked, vibrated, seen, watch),
        (gripping, vibrated, None, None),
    ]
}

/// [`pushed`] on [`one_joint_of_each_law`], with one step in a period and three.
fn pushed_cases(cases: &[Case]) -> Vec<Case> {
    let base = cases[0].extraction;
    let joints = one_joint_of_each_law();
    let mut all = Vec::new();
    for (i, (actuator, controller, sensors, watch)) in pushed().into_iter().enumerate() {
        for (j, &joint) in joints.iter().enumerate() {
            let steps_per_period = [1, 3][(i + j) % 2];
            let timing = Timing { steps_per_period, one_sample_delay: i % 2 == 0, ..base.timing };
            let case = Extraction { joint, actuator, controller, sensors, watch, timing, ..base };
            all.push(Case { name: format!("{case:?}"), extraction: case });
        }
    }
    all
}

/// [`more_joints`] with one of elements instead of two.
fn one_joint_of_each_law() -> Vec<Joint<f64>> {
    let mut joints = more_joints();
    joints.remove(3);
    joints
}

/// [`all`], and what single precision cannot hold: friction that varies along the way; with it,
/// friction that drifts, and follows a normal force that shakes.
pub(crate) fn in_double() -> Vec<Case> {
    let mut cases = all();
    let base = cases[0].extraction;
    let mut joints = one_joint_of_each_law();
    joints.push(Joint::Lugre(lugre()));
    for (i, variation) in variations().into_iter().enumerate() {
        for (j, &joint) in joints.iter().enumerate() {
            let steps_per_period = [1, 3][(i + j) % 2];
            let timing = Timing { steps_per_period, ..base.timing };
            let extraction = Extraction { joint, variation, timing, ..base };
            cases.push(Case { name: format!("{extraction:?}"), extraction });
        }
    }
    cases
}

fn variations() -> Vec<Variation<f64>> {
    let (mut at, mut values) = ([0.0; 8], [0.0; 8]);
    (at[1], at[2]) = (1e-3, 4e-3);
    (values[0], values[1], values[2]) = (1.0, 0.9, 1.1);
    let drift = Course { over: Over::Time, points: 3, at, values };
    let (mut at, mut values) = ([0.0; 8], [0.0; 8]);
    (at[1], values[1]) = (LENGTH_M, -400.0);
    let course = Course { over: Over::Travel, points: 2, at, values };
    let vibration = NormalVibration {
        amplitude_m: 2e-6,
        stiffness_n_per_m: 1e8,
        frequency_hz: 900.0,
        phase_turns: 0.2,
    };
    let transverse =
        TransverseVibration { amplitude_m: 5e-6, frequency_hz: 2000.0, phase_turns: 0.0 };
    let normal_force = NormalForce {
        nominal_n: 1000.0,
        constant_n: 1000.0,
        course_gain: 1.0,
        course: Some(course),
        vibration: Some(vibration),
        transverse: Some(transverse),
    };
    let keys = FieldKeys { first: 20_000_001.0, second: -123_456.0, offset: 0.4 };
    let field = |law| Some(Field { law, var: 0.2, correlation_length_m: 2e-5, keys });
    vec![
        Variation { field: field(FieldLaw::Bounded), ..Variation::none() },
        Variation { field: field(FieldLaw::Gaussian), drift: Some(drift), normal_force: None },
        Variation {
            field: field(FieldLaw::LogNormal),
            drift: None,
            normal_force: Some(normal_force),
        },
    ]
}

/// How many [`more_cases`] and [`pushed_cases`] there are.
pub(crate) fn more_count() -> usize {
    more_joints().len() * MORE_PER_JOINT + pushed().len() * one_joint_of_each_law().len()
}

/// Cases in which a watch stops some parts; these need not leave their joint.
pub(crate) fn nervous() -> Vec<Case> {
    let watched = pushed_cases(&all()).into_iter().filter(|case| case.extraction.watch.is_some());
    let nervous = |case: Case| {
        let extraction = Extraction { watch: Some(NERVOUS), ..case.extraction };
        Case { name: format!("{extraction:?}"), extraction }
    };
    watched.map(nervous).collect()
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
        after_release_s: f64::INFINITY,
        breakaway_travel_m: 1.5e-4,
        contact_force_n: 0.0,
        peak_force_max_n: f64::INFINITY,
        jump_max_m: f64::INFINITY,
        release_velocity_max_m_per_s: f64::INFINITY,
    }
}

/// The same extraction with every number but keys moved by up to 10 %, differently for each lane.
pub(crate) fn varied(extraction: &Extraction<f64>, lane: u64) -> Extraction<f64> {
    let mut field = 0;
    extraction.map(&mut |name, value| {
        field += 1;
        if matches!(name.field(), "first" | "second") {
            return value; // keys are whole
        }
        value * (1.0 + 0.1 * uniform(11, lane, Stream::Disturbance, field))
    })
}

/// The held draw of a lane at a sample, never zero, and the noise of its sensors.
pub(crate) fn draw(lane: u64, sample: u32) -> Draws<f64> {
    let [[position], [force]] = noise(5, &[lane], &[u64::from(sample)]);
    Draws {
        disturbance: uniform(5, lane, Stream::Disturbance, sample / HOLD),
        noise: Noise { position, force },
    }
}

/// Draws as another number.
pub(crate) fn cast<R>(draws: &Draws<f64>, number: impl Fn(f64) -> R) -> Draws<R> {
    Draws {
        disturbance: number(draws.disturbance),
        noise: Noise { position: number(draws.noise.position), force: number(draws.noise.force) },
    }
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
        cast: &mut impl FnMut(Name<'_>, f64) -> R,
    ) -> Self {
        Self {
            extraction: extraction.map(cast),
            limits: limits().map(cast),
            state: ExtractionState::at_rest(),
            metrics: Metrics::new(),
        }
    }

    /// The step that all five numbers take.
    pub(crate) fn step(&mut self, draws: Draws<R>) {
        let Self { extraction, limits, state, metrics } = self;
        metrics.step(Groups::ALL, limits, extraction, state, draws);
    }

    /// Everything that moves, with its name: first the state, then the metrics.
    pub(crate) fn moving(&self) -> Vec<(&'static str, R)> {
        let mut numbers = Vec::with_capacity(40);
        self.state.map(&mut |name, value| numbers.push((name.field(), value)));
        self.metrics.map(&mut |name, value| numbers.push((name.field(), value)));
        numbers
    }
}

/// Panics where two numbers differ in a bit, unless both are not a number.
pub(crate) fn assert_same(context: &str, name: &str, sample: u32, ours: f64, scalar: f64) {
    let same = ours.to_bits() == scalar.to_bits() || (ours.is_nan() && scalar.is_nan());
    assert!(same, "{name} at sample {sample} is {ours:e}, for f64 {scalar:e}, in {context}");
}
